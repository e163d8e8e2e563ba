//! Single values and columns of them.

use crate::Values;
use glam::Vec3;
use ply_rs_bw::ply::ScalarType;
use std::io::{self, Write};

use super::Encoding;

/// One value in the type of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    I8(i8),
    U8(u8),
    I16(i16),
    U16(u16),
    I32(i32),
    U32(u32),
    F32(f32),
    F64(f64),
}

/// Runs `$body` for the variant of `$enum` that `$value` has, whichever it is.
macro_rules! each {
    ($enum:ident, $value:expr, $inner:ident => $body:expr) => {
        match $value {
            $enum::I8($inner) => $body,
            $enum::U8($inner) => $body,
            $enum::I16($inner) => $body,
            $enum::U16($inner) => $body,
            $enum::I32($inner) => $body,
            $enum::U32($inner) => $body,
            $enum::F32($inner) => $body,
            $enum::F64($inner) => $body,
        }
    };
}

/// An empty column of that type.
pub(super) fn column(kind: &ScalarType, capacity: usize) -> Values {
    match kind {
        ScalarType::Char => Values::I8(Vec::with_capacity(capacity)),
        ScalarType::UChar => Values::U8(Vec::with_capacity(capacity)),
        ScalarType::Short => Values::I16(Vec::with_capacity(capacity)),
        ScalarType::UShort => Values::U16(Vec::with_capacity(capacity)),
        ScalarType::Int => Values::I32(Vec::with_capacity(capacity)),
        ScalarType::UInt => Values::U32(Vec::with_capacity(capacity)),
        ScalarType::Float => Values::F32(Vec::with_capacity(capacity)),
        ScalarType::Double => Values::F64(Vec::with_capacity(capacity)),
    }
}

/// Appends a value of the type of the column.
pub(super) fn push(column: &mut Values, value: Scalar) {
    match (column, value) {
        (Values::I8(column), Scalar::I8(value)) => column.push(value),
        (Values::U8(column), Scalar::U8(value)) => column.push(value),
        (Values::I16(column), Scalar::I16(value)) => column.push(value),
        (Values::U16(column), Scalar::U16(value)) => column.push(value),
        (Values::I32(column), Scalar::I32(value)) => column.push(value),
        (Values::U32(column), Scalar::U32(value)) => column.push(value),
        (Values::F32(column), Scalar::F32(value)) => column.push(value),
        (Values::F64(column), Scalar::F64(value)) => column.push(value),
        // Both types come from one property of one header.
        (column, value) => unreachable!("a value {value:?} for the column {}", type_name(column)),
    }
}

/// The value of one point.
pub(super) fn get(column: &Values, index: usize) -> Scalar {
    match column {
        Values::I8(column) => Scalar::I8(column[index]),
        Values::U8(column) => Scalar::U8(column[index]),
        Values::I16(column) => Scalar::I16(column[index]),
        Values::U16(column) => Scalar::U16(column[index]),
        Values::I32(column) => Scalar::I32(column[index]),
        Values::U32(column) => Scalar::U32(column[index]),
        Values::F32(column) => Scalar::F32(column[index]),
        Values::F64(column) => Scalar::F64(column[index]),
    }
}

/// The name of the type in a header.
pub(super) fn type_name(column: &Values) -> &'static str {
    match column {
        Values::I8(_) => "char",
        Values::U8(_) => "uchar",
        Values::I16(_) => "short",
        Values::U16(_) => "ushort",
        Values::I32(_) => "int",
        Values::U32(_) => "uint",
        Values::F32(_) => "float",
        Values::F64(_) => "double",
    }
}

/// All values as doubles, which hold each of the types exactly.
pub(super) fn to_f64(column: &Values) -> Vec<f64> {
    fn widened<T: Copy + Into<f64>>(column: &[T]) -> Vec<f64> {
        column.iter().map(|&value| value.into()).collect()
    }
    each!(Values, column, column => widened(column))
}

/// A column as 32-bit floats relative to `origin`.
pub(super) fn narrowed(values: &Values, origin: f64) -> Vec<f32> {
    match values {
        // Their origin is 0; a copy keeps even the bits of a NaN.
        Values::F32(values) => values.clone(),
        values => to_f64(values).into_iter().map(|v| narrow(v - origin)).collect(),
    }
}

/// Vectors of three columns of components.
pub(super) fn vectors([x, y, z]: [Vec<f32>; 3]) -> Vec<Vec3> {
    x.into_iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(x, y, z)).collect()
}

/// The nearest 32-bit float; infinite where there is none.
pub(super) fn narrow(value: f64) -> f32 {
    value as f32
}

/// The first value that is infinite or no number.
pub(super) fn find_not_finite(column: &Values) -> Option<usize> {
    match column {
        Values::F32(column) => column.iter().position(|v| !v.is_finite()),
        Values::F64(column) => column.iter().position(|v| !v.is_finite()),
        _ => None,
    }
}

impl Scalar {
    /// The value without its fraction.
    pub(super) fn to_integer(self) -> i64 {
        each!(Self, self, value => value as i64)
    }

    /// Writes the value; in ASCII without a separator.
    pub(super) fn write(self, out: &mut impl Write, encoding: Encoding) -> io::Result<()> {
        match encoding {
            Encoding::Ascii => self.write_decimal(out),
            Encoding::Binary => each!(Self, self, v => out.write_all(&v.to_le_bytes())),
            Encoding::BinaryBigEndian => each!(Self, self, v => out.write_all(&v.to_be_bytes())),
        }
    }

    /// Rust prints the fewest digits that read back to the same bits. Very large and small numbers get an exponent
    /// in place of zeros.
    fn write_decimal(self, out: &mut impl Write) -> io::Result<()> {
        let zeros = |size: f64| size != 0.0 && !(1e-5..1e9).contains(&size);
        match self {
            Self::F32(v) if zeros(f64::from(v.abs())) => write!(out, "{v:e}"),
            Self::F64(v) if zeros(v.abs()) => write!(out, "{v:e}"),
            value => each!(Self, value, v => write!(out, "{v}")),
        }
    }
}
