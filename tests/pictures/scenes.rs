//! Clouds, and what is seen of them.

use surfine_points::shapes::{Sampling, Shape, sample};
use surfine_points::{Attribute, PointSet, RefineParams, Refined, Values, Vec3};
use surfine_render::{Camera, Size, Space, Splats, Style, View};

/// Everything that makes a picture.
#[derive(Clone)]
pub(crate) struct Scene {
    pub splats: Splats,
    pub camera: Camera,
    pub style: Style,
    pub size: Size,
}

/// A background that no cloud is mistaken for.
pub(crate) const CLEAR: [u8; 4] = [0; 4];

impl Scene {
    /// A cloud from the corner between front, right and top.
    pub(crate) fn new(points: &PointSet) -> Self {
        Self::painted(points, None)
    }

    pub(crate) fn painted(points: &PointSet, paint: Option<&[[u8; 3]]>) -> Self {
        Self::in_space(points, Space::default(), paint)
    }

    pub(crate) fn in_space(points: &PointSet, space: Space, paint: Option<&[[u8; 3]]>) -> Self {
        let size = Size { width: 160, height: 120 };
        let splats = Splats::new(points, space, paint);
        let view = View::Iso;
        let camera = Camera::look(splats.outline(1.0), view.direction(), view.up(), size.aspect());
        Self { splats, camera, style: Style::default(), size }
    }

    /// The same with other properties of style.
    pub(crate) fn style(mut self, change: impl FnOnce(&mut Style)) -> Self {
        change(&mut self.style);
        self
    }

    /// The same from another place.
    pub(crate) fn from(mut self, eye: Vec3, target: Vec3) -> Self {
        self.camera = Camera { eye, target, ..self.camera };
        self
    }

    pub(crate) fn square(mut self, side: u32) -> Self {
        self.size = Size { width: side, height: side };
        self
    }
}

/// 200 even points on the unit sphere after so many levels, with the level of each.
pub(crate) fn sphere(levels: u32) -> PointSet {
    refined(&sample(Shape::Sphere, Sampling::BlueNoise, 200, 1), levels)
}

/// 600 random points on a torus after so many levels, with the level of each.
pub(crate) fn torus(levels: u32) -> PointSet {
    refined(&sample(Shape::Torus, Sampling::Random, 600, 2), levels)
}

fn refined(points: &PointSet, levels: u32) -> PointSet {
    let params = RefineParams { levels, ..RefineParams::default() };
    with_levels(surfine_reference::refine(points, &params).expect("generated clouds are sound"))
}

/// The points with the level of each, as a file would tell it.
pub(crate) fn with_levels(refined: Refined) -> PointSet {
    let levels = Attribute::new("level", Values::U8(refined.levels()));
    let mut points = refined.points;
    points.attributes.push(levels);
    points
}

/// How the further normals of a crease point are told.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Creases {
    /// Properties `nx2 ny2 nz2` and `nx3 ny3 nz3`.
    Properties,
    /// Records that share the position.
    Records,
}

/// A cube from −1 to 1, a lattice of 6 x 6 points on each face: two normals on the edges, three in the corners.
pub(crate) fn cube(creases: Creases) -> PointSet {
    const STEPS: i32 = 5;
    let mut points = PointSet::default();
    let mut further = [const { Vec::new() }; 6];
    let ends = |c: i32| c == 0 || c == STEPS;
    let lattice = (0..=STEPS)
        .flat_map(|x| (0..=STEPS).flat_map(move |y| (0..=STEPS).map(move |z| [x, y, z])));
    for place in lattice.filter(|place| place.iter().any(|&c| ends(c))) {
        let position = Vec3::from(place.map(|c| 2.0 * c as f32 / STEPS as f32 - 1.0));
        let normals: Vec<Vec3> = (0..3)
            .filter(|&axis| ends(place[axis]))
            .map(|axis| Vec3::AXES[axis] * position[axis])
            .collect();
        let (first, rest) = normals.split_at(match creases {
            Creases::Properties => 1,
            Creases::Records => normals.len(),
        });
        for &normal in first {
            points.positions.push(position);
            points.normals.push(normal);
            // The natural radius: 1.25 times the diagonal.
            points.radii.push(1.25 * 2f32.sqrt() * 2.0 / STEPS as f32);
            for (i, column) in further.iter_mut().enumerate() {
                column.push(rest.get(i / 3).map_or(0.0, |normal| normal[i % 3]));
            }
        }
    }
    if creases == Creases::Properties {
        let names = ["nx2", "ny2", "nz2", "nx3", "ny3", "nz3"];
        let attribute = |(name, column)| Attribute::new(name, Values::F32(column));
        points.attributes = names.into_iter().zip(further).map(attribute).collect();
    }
    points
}

/// Turns the normals of the points for which `is_chosen` holds.
pub(crate) fn flip(points: &mut PointSet, is_chosen: impl Fn(Vec3) -> bool) {
    for (normal, &position) in points.normals.iter_mut().zip(&points.positions) {
        if is_chosen(position) {
            *normal = -*normal;
        }
    }
}

/// The points for whose numbers `keep` holds.
pub(crate) fn chosen(points: &PointSet, keep: impl Fn(usize) -> bool) -> PointSet {
    let kept = || (0..points.len()).filter(|&i| keep(i));
    let vectors = |column: &[Vec3]| kept().map(|i| column[i]).collect();
    let radii = kept().map(|i| points.radii[i]).collect();
    PointSet::new(vectors(&points.positions), vectors(&points.normals), radii)
}

/// The clouds as one.
pub(crate) fn union(clouds: &[&PointSet]) -> PointSet {
    let mut all = PointSet::default();
    for cloud in clouds {
        all.positions.extend(&cloud.positions);
        all.normals.extend(&cloud.normals);
        all.radii.extend(&cloud.radii);
    }
    all
}

/// A cloud scaled about the origin, then moved.
pub(crate) fn moved(points: &PointSet, scale: f32, to: Vec3) -> PointSet {
    let positions = points.positions.iter().map(|&p| scale * p + to).collect();
    let radii = points.radii.iter().map(|r| scale * r).collect();
    PointSet::new(positions, points.normals.clone(), radii)
}

/// One point at the origin that looks to +z.
pub(crate) fn one_point(radius: f32) -> PointSet {
    PointSet::new(vec![Vec3::ZERO], vec![Vec3::Z], vec![radius])
}
