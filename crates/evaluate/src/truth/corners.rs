//! Triangles around vertices, the normals of their corners, and the edges where they don't meet smoothly.

use surfine_points::DVec3;

use crate::places::invert;

/// Triangles with an area, and who shares their vertices.
pub(super) struct Fans {
    /// Places of each triangle's corners: vertices in the same place are one.
    faces: Vec<[u32; 3]>,
    /// Unit normal of each triangle.
    face_normals: Vec<DVec3>,
    /// Angle at each corner, radians.
    angles: Vec<[f64; 3]>,
    /// Where each place's corners begin in `corners`, and the end.
    starts: Vec<u32>,
    /// Corners by place: three times the triangle, plus the number of the corner.
    corners: Vec<u32>,
    /// Cosine of the crease angle, less a little for rounding.
    least_cosine: f64,
}

/// An edge of two or more triangles.
pub(super) struct Edges {
    /// Places at the ends of each sharp edge.
    pub(super) sharp: Vec<[u32; 2]>,
    /// How many are run through twice in the same direction.
    pub(super) inconsistent: usize,
}

impl Fans {
    /// Of triangles with an area, given by their corners' places and those places' positions.
    pub(super) fn new(faces: Vec<[u32; 3]>, positions: &[DVec3], crease_angle: f64) -> Self {
        let at = |f: &[u32; 3]| f.map(|c| positions[c as usize]);
        let face_normals = faces.iter().map(|f| face_normal(at(f)).normalize()).collect();
        let angles = faces.iter().map(|f| corner_angles(at(f))).collect();
        let (starts, corners) = invert(faces.as_flattened(), positions.len());
        let least_cosine = crease_angle.to_radians().cos() - 1e-12;
        Self { faces, face_normals, angles, starts, corners, least_cosine }
    }

    /// The corners at a place: triangle, and number of the corner in it.
    pub(super) fn around(&self, place: u32) -> impl Iterator<Item = (usize, usize)> + '_ {
        let run = self.starts[place as usize] as usize..self.starts[place as usize + 1] as usize;
        self.corners[run].iter().map(|&c| (c as usize / 3, c as usize % 3))
    }

    /// Places of a triangle's corners.
    pub(super) fn face(&self, face: usize) -> [u32; 3] {
        self.faces[face]
    }

    /// Whether two triangles are parts of one smooth side.
    fn smooth(&self, a: usize, b: usize) -> bool {
        self.face_normals[a].dot(self.face_normals[b]) >= self.least_cosine
    }

    /// The unit normal of each corner: see [`super::Truth::with_crease_angle`].
    pub(super) fn corner_normals(&self) -> Vec<[DVec3; 3]> {
        let normal = |face: usize, place: u32| {
            let side = self.around(place).filter(|&(other, _)| self.smooth(face, other));
            let sum: DVec3 = side.map(|(f, c)| self.face_normals[f] * self.angles[f][c]).sum();
            sum.normalize_or(self.face_normals[face])
        };
        let faces = self.faces.iter().enumerate();
        faces.map(|(face, corners)| corners.map(|place| normal(face, place))).collect()
    }

    /// Looks through all edges of more than one triangle.
    pub(super) fn edges(&self) -> Edges {
        let mut sides = self.sides();
        sides.sort_unstable();
        let mut edges = Edges { sharp: Vec::new(), inconsistent: 0 };
        for edge in sides.chunk_by(|a, b| a.0 == b.0) {
            let faces = || edge.iter().map(|side| side.2 as usize);
            if faces().any(|a| faces().any(|b| !self.smooth(a, b))) {
                edges.sharp.push(edge[0].0);
            }
            edges.inconsistent += usize::from(edge.len() == 2 && edge[0].1 == edge[1].1);
        }
        edges
    }

    /// Each side of each triangle: its places, the lower first; whether it runs upwards; the triangle.
    fn sides(&self) -> Vec<([u32; 2], bool, u32)> {
        let sides = |(face, f): (u32, &[u32; 3])| {
            let corners = *f;
            (0..3).map(move |i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                ([a.min(b), a.max(b)], a < b, face)
            })
        };
        (0u32..).zip(&self.faces).flat_map(sides).collect()
    }
}

/// Normal of a triangle, as long as twice its area.
pub(super) fn face_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Angles at the corners of a triangle, radians.
fn corner_angles(p: [DVec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let (a, b) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
        a.cross(b).length().atan2(a.dot(b))
    })
}
