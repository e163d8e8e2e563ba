//! The uniform of a picture: mirror of `View` in `shaders/render/view.wgsl`.

use crate::{Camera, Coloring, Size, Style};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Camera and style as the passes read them; the fields are documented in view.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Uniform {
    pub(crate) eye: [f32; 3],
    pub(crate) near: f32,
    pub(crate) right: [f32; 3],
    pub(crate) pixel: f32,
    pub(crate) up: [f32; 3],
    pub(crate) disc_scale: f32,
    pub(crate) forward: [f32; 3],
    pub(crate) dot_radius: f32,
    pub(crate) light: [f32; 3],
    pub(crate) coloring: u32,
    pub(crate) scale: [f32; 2],
    pub(crate) ramp_low: f32,
    pub(crate) ramp_inverse: f32,
    pub(crate) background: [f32; 4],
    pub(crate) supersampling: u32,
    pub(crate) padding: [u32; 7],
}

pub(crate) const MATERIAL: u32 = 0;
pub(crate) const PAINT: u32 = 1;
pub(crate) const NORMAL: u32 = 2;
pub(crate) const DATA: u32 = 3;
pub(crate) const RADIUS: u32 = 4;
pub(crate) const LEVEL: u32 = 5;

/// The near plane lies at this share of the distance to the farthest point. Depth is near / distance in floats, of the
/// same relative precision at any distance.
const NEAR: f32 = 1e-5;

impl Uniform {
    /// `bounds` are corners of a box around what is shown; without them its size is taken for the distance of the target.
    pub(crate) fn new(
        camera: &Camera,
        style: &Style,
        size: Size,
        bounds: Option<[Vec3; 2]>,
    ) -> Self {
        let far = match bounds {
            Some([low, high]) => (camera.eye - low).abs().max((high - camera.eye).abs()).length(),
            None => camera.distance(),
        };
        let [right, up, forward] = camera.axes();
        let half = (0.5 * camera.fov).tan();
        let rows = (size.height * style.supersampling) as f32;
        let (coloring, low, high) = match style.coloring {
            Coloring::Shaded => (MATERIAL, 0.0, 1.0),
            Coloring::Paint => (PAINT, 0.0, 1.0),
            Coloring::Data => (DATA, 0.0, 1.0),
            Coloring::Normal => (NORMAL, 0.0, 1.0),
            Coloring::Radius { low, high } => (RADIUS, low, high),
            Coloring::Level { high } => (LEVEL, 0.0, high),
        };
        Self {
            eye: camera.eye.to_array(),
            near: (NEAR * far).max(f32::MIN_POSITIVE),
            right: right.to_array(),
            pixel: 2.0 * half / rows,
            up: up.to_array(),
            disc_scale: style.splat_scale,
            forward: forward.to_array(),
            dot_radius: style.dots.map_or(0.0, |radius| radius * style.supersampling as f32),
            light: (0.7 * up - 0.6 * right - 0.8 * forward).normalize_or(Vec3::Z).to_array(),
            coloring,
            scale: [size.height as f32 / size.width as f32 / half, 1.0 / half],
            ramp_low: low,
            // All values alike: the low end.
            ramp_inverse: if high > low { 1.0 / (high - low) } else { 0.0 },
            background: style.background.map(|c| f32::from(c) / 255.0),
            supersampling: style.supersampling,
            padding: [0; 7],
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A shader as the driver's compiler sees it.
    pub(crate) fn module(name: &str) -> naga::Module {
        let text = crate::SHADERS.iter().find(|(n, _)| *n == name).expect(name).1;
        naga::front::wgsl::parse_str(text)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string_with_path(text, name)))
    }

    /// A member of a struct: name, offset and type.
    pub(crate) type Member = (String, usize, String);

    /// The members and the size of a WGSL struct.
    pub(crate) fn wgsl_struct(module: &naga::Module, name: &str) -> (Vec<Member>, usize) {
        let mut types = module.types.iter().map(|(_, ty)| ty);
        let ty = types.find(|ty| ty.name.as_deref() == Some(name)).expect(name);
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct")
        };
        let member = |m: &naga::StructMember| {
            (m.name.clone().unwrap_or_default(), m.offset as usize, rust_name(module, m.ty))
        };
        (members.iter().map(member).collect(), *span as usize)
    }

    /// What a type is called in Rust.
    fn rust_name(module: &naga::Module, ty: naga::Handle<naga::Type>) -> String {
        let scalar = |s: &naga::Scalar| match (s.kind, s.width) {
            (naga::ScalarKind::Float, 4) => "f32",
            (naga::ScalarKind::Uint, 4) => "u32",
            _ => panic!("{s:?} has no counterpart"),
        };
        match &module.types[ty].inner {
            naga::TypeInner::Scalar(s) => scalar(s).into(),
            naga::TypeInner::Vector { size, scalar: s } => {
                format!("[{}; {}]", scalar(s), *size as u8)
            }
            naga::TypeInner::Array { base, size: naga::ArraySize::Constant(size), .. } => {
                format!("[{}; {size}]", rust_name(module, *base))
            }
            other => panic!("{other:?} has no counterpart"),
        }
    }

    /// The members of a Rust struct; those after `padding` are left out. A field that is forgotten does not compile.
    macro_rules! members {
        ($record:expr, $type:ident { $($field:ident),* } $(padding $($padding:ident),*)?) => {{
            let record: $type = $record;
            let $type { $($field: _,)* $($($padding: _,)*)? } = record;
            let member =
                |name: &str, offset, ty: &str| (name.to_owned(), offset, ty.to_owned());
            vec![$(member(
                stringify!($field),
                std::mem::offset_of!($type, $field),
                std::any::type_name_of_val(&record.$field),
            )),*]
        }};
    }
    pub(crate) use members;

    #[test]
    fn the_uniform_is_laid_out_alike() {
        let expected = members!(Zeroable::zeroed(), Uniform {
            eye, near, right, pixel, up, disc_scale, forward, dot_radius, light, coloring, scale, ramp_low,
            ramp_inverse, background, supersampling
        } padding padding);
        for name in ["splat", "resolve"] {
            let (mut members, size) = wgsl_struct(&module(name), "View");
            assert_eq!(members.pop().map(|m| m.0).as_deref(), Some("padding"));
            assert_eq!(members, expected, "{name}");
            assert_eq!(size, size_of::<Uniform>(), "{name}");
        }
    }

    #[test]
    fn colorings_have_the_same_numbers() {
        let module = module("splat");
        for (name, expected) in [
            ("MATERIAL", MATERIAL),
            ("PAINT", PAINT),
            ("NORMAL", NORMAL),
            ("DATA", DATA),
            ("RADIUS", RADIUS),
            ("LEVEL", LEVEL),
        ] {
            let mut all = module.constants.iter().map(|(_, constant)| constant);
            let constant = all.find(|c| c.name.as_deref() == Some(name)).expect(name);
            let found = &module.global_expressions[constant.init];
            let expected = naga::Expression::Literal(naga::Literal::U32(expected));
            assert_eq!(*found, expected, "{name}");
        }
    }
}
