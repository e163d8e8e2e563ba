//! The point set and its attributes.

use glam::{DVec3, Vec3};

/// A cloud of oriented points with radii: the `P^l` of the paper (section 2).
///
/// All columns have one entry a point; [`PointSet::validate`] checks that and everything else that the refinement
/// relies on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointSet {
    /// Positions, relative to [`PointSet::origin`], in the units of the input.
    pub positions: Vec<Vec3>,
    /// Normals, unit length, outward. A length that is off by more than rounding is normalised where it is used;
    /// the stored value is kept as it came.
    pub normals: Vec<Vec3>,
    /// Radii in the units of the positions: at least the distance to the farthest natural neighbour (section 2).
    pub radii: Vec<f32>,
    /// Every further scalar property, colours among them, in the order of the file.
    pub attributes: Vec<Attribute>,
    /// Added to every position to get the coordinates of the file; zero for files of 32-bit coordinates.
    pub origin: DVec3,
}

/// One scalar property of every point.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Name of the property in files, for instance `red` or `intensity`.
    pub name: String,
    /// One value a point.
    pub values: Values,
    /// How new points get their value from the three corners of their triangle.
    pub interpolation: Interpolation,
}

/// How an attribute reaches a new point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Mean of the three corners; integers are rounded half up.
    Linear,
    /// The value of the nearest corner, the first of equally near ones.
    Nearest,
    /// The value that two corners share, else that of the nearest: for categories.
    Vote,
    /// Mean of the three corners, and the three attributes of this rule that follow each other brought to unit length
    /// together: for directions. Zero where the mean is.
    Unit,
}

impl Interpolation {
    /// Every rule with its name on the command line.
    pub const NAMED: [(&'static str, Self); 4] = [
        ("linear", Self::Linear),
        ("nearest", Self::Nearest),
        ("vote", Self::Vote),
        ("unit", Self::Unit),
    ];
}

/// A column of attribute values in the type that the file gave.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the variants name their own types")]
pub enum Values {
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Runs `$body` with `$column` bound to the vector inside, whatever its type.
macro_rules! each_type {
    ($values:expr, $column:ident => $body:expr) => {
        match $values {
            Values::I8($column) => $body,
            Values::U8($column) => $body,
            Values::I16($column) => $body,
            Values::U16($column) => $body,
            Values::I32($column) => $body,
            Values::U32($column) => $body,
            Values::F32($column) => $body,
            Values::F64($column) => $body,
        }
    };
}

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        each_type!(self, column => column.len())
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether the values are floating-point numbers.
    pub fn is_float(&self) -> bool {
        matches!(self, Self::F32(_) | Self::F64(_))
    }

    /// Whether an entry is not zero.
    pub fn is_nonzero(&self, index: usize) -> bool {
        each_type!(self, column => column[index] != Default::default())
    }

    /// Overwrites the first entries with all of a column of the same type.
    pub(crate) fn copy_start(&mut self, start: &Self) {
        macro_rules! copy {
            ($($variant:ident)*) => {
                match (self, start) {
                    $((Self::$variant(own), Self::$variant(start)) => own[..start.len()].copy_from_slice(start),)*
                    _ => unreachable!("a refinement keeps the types of its attributes"),
                }
            };
        }
        copy!(I8 U8 I16 U16 I32 U32 F32 F64);
    }

    /// The entries of these indices.
    fn select(&self, order: &[u32]) -> Self {
        macro_rules! select {
            ($($variant:ident)*) => {
                match self {
                    $(Self::$variant(column) => Self::$variant(pick(column, order)),)*
                }
            };
        }
        select!(I8 U8 I16 U16 I32 U32 F32 F64)
    }

    fn push_copy(&mut self, index: usize) {
        each_type!(self, column => column.push(column[index]));
    }

    /// Whether two entries are equal; as bits, so that it holds for NaN too.
    fn are_equal(&self, a: usize, b: usize) -> bool {
        match self {
            Self::F32(column) => column[a].to_bits() == column[b].to_bits(),
            Self::F64(column) => column[a].to_bits() == column[b].to_bits(),
            _ => each_type!(self, column => column[a] == column[b]),
        }
    }

    /// The first of the corners whose value another one shares.
    fn majority(&self, [a, b, c]: [usize; 3]) -> Option<usize> {
        if self.are_equal(a, b) || self.are_equal(a, c) {
            Some(a)
        } else {
            self.are_equal(b, c).then_some(b)
        }
    }

    /// Appends the mean of three entries.
    fn push_mean(&mut self, corners: [usize; 3]) {
        /// Round half up in integers, so that no float rounding enters.
        fn mean(a: i64, b: i64, c: i64) -> i64 {
            (2 * (a + b + c) + 3).div_euclid(6)
        }
        let [a, b, c] = corners;
        macro_rules! integer {
            ($column:ident, $type:ty) => {
                $column.push(mean($column[a] as i64, $column[b] as i64, $column[c] as i64) as $type)
            };
        }
        match self {
            Self::I8(v) => integer!(v, i8),
            Self::U8(v) => integer!(v, u8),
            Self::I16(v) => integer!(v, i16),
            Self::U16(v) => integer!(v, u16),
            Self::I32(v) => integer!(v, i32),
            Self::U32(v) => integer!(v, u32),
            Self::F32(v) => {
                // In f64, where the sum can't overflow.
                let sum = f64::from(v[a]) + f64::from(v[b]) + f64::from(v[c]);
                v.push((sum / 3.0) as f32);
            }
            Self::F64(v) => v.push((v[a] + v[b] + v[c]) / 3.0),
        }
    }
}

impl Attribute {
    /// An attribute with the rule that its name and type call for: colours and floats are linear, other integers are
    /// categories and voted for.
    pub fn new(name: impl Into<String>, values: Values) -> Self {
        let name = name.into();
        let linear =
            values.is_float() || matches!(name.as_str(), "red" | "green" | "blue" | "alpha");
        let interpolation = if linear { Interpolation::Linear } else { Interpolation::Vote };
        Self { name, values, interpolation }
    }
}

/// What makes a point set unfit for refinement, with the first point where it shows.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum Invalid {
    #[error("{column} has {found} entries for {points} points: give one entry a point")]
    Length { column: String, found: usize, points: usize },
    #[error("vertex {point}: {what} is not finite ({value}): remove or repair the point")]
    NotFinite { point: usize, what: &'static str, value: f32 },
    #[error("vertex {point}: coordinate {value:e} is beyond ±1e15: move or scale the cloud")]
    TooFar { point: usize, value: f32 },
    #[error(
        "vertex {point}: the normal has length {length:e}: give it a direction, or remove the point"
    )]
    ZeroNormal { point: usize, length: f32 },
    #[error(
        "vertex {point}: the radius is {radius:e}, not within 1e-10 to 1e15: it must exceed the distance to the \
         farthest natural neighbor"
    )]
    Radius { point: usize, radius: f32 },
    #[error(
        "there is no property {name} to mark the boundary: add it, or find the boundary by angle"
    )]
    NoMarks { name: String },
    #[error("{0} points are too many for indices of 32 bits: split the cloud, or use fewer levels")]
    TooMany(usize),
}

impl Invalid {
    /// The same defect where `order` has the original index of each point.
    #[must_use]
    pub fn in_order(self, order: &[u32]) -> Self {
        match self {
            Self::NotFinite { point, what, value } => {
                Self::NotFinite { point: order[point] as usize, what, value }
            }
            other => other,
        }
    }
}

impl PointSet {
    /// A point set without attributes.
    pub fn new(positions: Vec<Vec3>, normals: Vec<Vec3>, radii: Vec<f32>) -> Self {
        Self { positions, normals, radii, attributes: Vec::new(), origin: DVec3::ZERO }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The points of these indices, in that order.
    pub fn select(&self, order: &[u32]) -> Self {
        let select = |a: &Attribute| Attribute {
            name: a.name.clone(),
            values: a.values.select(order),
            interpolation: a.interpolation,
        };
        Self {
            positions: pick(&self.positions, order),
            normals: pick(&self.normals, order),
            radii: pick(&self.radii, order),
            attributes: self.attributes.iter().map(select).collect(),
            origin: self.origin,
        }
    }

    /// The attribute of that name.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    /// Checks everything that the refinement relies on.
    ///
    /// # Errors
    /// The first defect, with the index of its point.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.validate_lengths()?;
        (0..self.len()).try_for_each(|point| {
            self.validate_finite(point)?;
            self.validate_ranges(point)
        })
    }

    /// Checks the lengths of the columns, and that positions, normals and radii are finite: what a refinement keeps,
    /// while its radii may leave the range that its input must have.
    ///
    /// # Errors
    /// The first defect.
    pub fn validate_numbers(&self) -> Result<(), Invalid> {
        self.validate_lengths()?;
        (0..self.len()).try_for_each(|point| self.validate_finite(point))
    }

    fn validate_lengths(&self) -> Result<(), Invalid> {
        let points = self.len();
        if points > i32::MAX as usize {
            return Err(Invalid::TooMany(points));
        }
        let lengths = [("normals", self.normals.len()), ("radii", self.radii.len())];
        let columns = self.attributes.iter().map(|a| (a.name.as_str(), a.values.len()));
        for (column, found) in lengths.into_iter().chain(columns) {
            if found != points {
                return Err(Invalid::Length { column: column.into(), found, points });
            }
        }
        Ok(())
    }

    fn validate_finite(&self, point: usize) -> Result<(), Invalid> {
        let (position, normal, radius) =
            (self.positions[point], self.normals[point], self.radii[point]);
        for (what, values) in [("a coordinate", position), ("a normal component", normal)] {
            if let Some(value) = values.to_array().into_iter().find(|v| !v.is_finite()) {
                return Err(Invalid::NotFinite { point, what, value });
            }
        }
        if !radius.is_finite() {
            return Err(Invalid::NotFinite { point, what: "the radius", value: radius });
        }
        Ok(())
    }

    fn validate_ranges(&self, point: usize) -> Result<(), Invalid> {
        let (position, normal, radius) =
            (self.positions[point], self.normals[point], self.radii[point]);
        // Squares of radii must stay normal f32 numbers: some drivers flush the others to zero.
        if position.abs().max_element() > 1e15 {
            return Err(Invalid::TooFar { point, value: position.abs().max_element() });
        }
        let length = normal.as_dvec3().length() as f32;
        if !(1e-15..=1e15).contains(&length) {
            return Err(Invalid::ZeroNormal { point, length });
        }
        if !(1e-10..=1e15).contains(&radius) {
            return Err(Invalid::Radius { point, radius });
        }
        Ok(())
    }

    /// The normals as the refinement uses them: those whose squared length is off 1 by more than 1e-6 are normalised.
    pub fn unit_normals(&self) -> Vec<Vec3> {
        self.normals.iter().copied().map(unit_normal).collect()
    }

    /// How many normals [`PointSet::unit_normals`] changes.
    pub fn non_unit_normals(&self) -> usize {
        self.normals.iter().filter(|n| (n.length_squared() - 1.0).abs() > 1e-6).count()
    }

    /// Gives every point from the end of the attribute columns on its values, from its three parents.
    ///
    /// `parents` holds the corners of the new points in order, each corner an earlier point; positions must already
    /// hold the new points.
    pub fn extend_attributes(&mut self, parents: &[[u32; 3]]) {
        let first = self.positions.len() - parents.len();
        for attribute in &mut self.attributes {
            let Attribute { values, interpolation, .. } = attribute;
            for (x, corners) in self.positions[first..].iter().zip(parents) {
                let corners = corners.map(|c| c as usize);
                let nearest = || {
                    let distance = |c: &usize| (self.positions[*c] - *x).length_squared();
                    let near = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
                    corners.into_iter().min_by(near).expect("there are three corners")
                };
                match interpolation {
                    Interpolation::Linear | Interpolation::Unit => values.push_mean(corners),
                    Interpolation::Nearest => values.push_copy(nearest()),
                    Interpolation::Vote => {
                        let chosen = values.majority(corners).unwrap_or_else(nearest);
                        values.push_copy(chosen);
                    }
                }
            }
        }
        let mut vectors: Vec<&mut Values> = self
            .attributes
            .iter_mut()
            .filter(|a| a.interpolation == Interpolation::Unit)
            .map(|a| &mut a.values)
            .collect();
        vectors.as_chunks_mut::<3>().0.iter_mut().for_each(|vector| normalize(vector, first));
    }
}

fn pick<T: Copy>(column: &[T], order: &[u32]) -> Vec<T> {
    order.iter().map(|&i| column[i as usize]).collect()
}

/// A normal as the refinement uses it: normalised if its squared length is off 1 by more than 1e-6.
pub fn unit_normal(n: Vec3) -> Vec3 {
    if (n.length_squared() - 1.0).abs() > 1e-6 { n.as_dvec3().normalize().as_vec3() } else { n }
}

/// Brings the vectors of three columns to unit length, from an entry on; zero vectors stay.
fn normalize(columns: &mut [&mut Values; 3], first: usize) {
    for i in first..columns[0].len() {
        let component = |values: &Values| match values {
            Values::F32(column) => f64::from(column[i]),
            Values::F64(column) => column[i],
            // Directions have fractions; integers stay what they are.
            _ => 0.0,
        };
        let vector = DVec3::from_array([0, 1, 2].map(|axis| component(columns[axis])));
        let unit = vector.normalize_or_zero().to_array();
        for (values, unit) in columns.iter_mut().zip(unit) {
            match values {
                Values::F32(column) => column[i] = unit as f32,
                Values::F64(column) => column[i] = unit,
                _ => {}
            }
        }
    }
}
