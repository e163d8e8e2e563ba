//! Parameters of the refinement, under the paper's symbols.

use std::f32::consts::PI;

/// Which one-ring neighbourhood is taken (section 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Neighborhood {
    /// `N^g` (section 4.2): badness after the geodesic projection, for any sampling.
    #[default]
    Accurate,
    /// `N^f` (section 4.1): badness at the points themselves, for well-sampled clouds.
    Fuzzy,
}

/// Which points may lie on a boundary (section 6).
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// None: the surface is closed.
    None,
    /// Those whose ring leaves a gap wider than `θ_b`, radians in (π/2, 2π). Chains of them become boundaries.
    Angle(f32),
    /// Those with a value other than zero in the property of that name.
    Marked(String),
}

impl Boundary {
    /// The property that marks the boundary.
    pub fn property(&self) -> Option<&str> {
        match self {
            Self::Marked(name) => Some(name),
            Self::None | Self::Angle(_) => None,
        }
    }
}

impl Default for Boundary {
    fn default() -> Self {
        Self::Angle(160f32.to_radians())
    }
}

/// Parameters of the refinement. All are free of scale; the defaults fit every cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct RefineParams {
    /// Number of refinement steps; each multiplies the points by about 3. Default 1.
    pub levels: u32,
    /// Which neighbourhood; `simplified` overrides it.
    pub neighborhood: Neighborhood,
    /// Faster, for dense smooth clouds, as section 7 does it: Euclidean distance, plain angle and `N^f`; no look ahead to the next
    /// level's rings, no natural neighbours in open gaps; of a selection among all candidates, only those are asked who discards them that not all three fans have,
    /// and `lambda1` means nothing.
    pub simplified: bool,
    /// The angle between new neighbours is straight instead of curved (eq. 5); `simplified` asks for it too. Without
    /// [`Rules::largest_first`].
    pub plain_angle: bool,
    /// Tolerance angle of the fuzzy planes in radians (section 4.1), in (0, π/2]. Default π/6.
    pub theta_f: f32,
    /// Largest angle of a complete new neighbourhood in radians (section 5), in (0, π); without [`Rules::largest_first`]. Default
    /// 89°: regular grids tie at the paper's π/2.
    pub theta_c: f32,
    /// Share of the radius within which a new point is a new neighbour (section 5), in (0, 1]; see also [`Rules::largest_first`].
    /// Default 1/√3.
    pub lambda1: f32,
    /// Share of a new point's size that is the radius of its discard sphere (eq. 11), in [0, 1]: of its ρ, or with
    /// [`Rules::largest_first`] of its triangle's size. Default 1/2.
    pub lambda2: f32,
    /// Which points may lie on a boundary (section 6). Default: `θ_b` of 160°.
    pub boundary: Boundary,
    /// Rules beyond the paper. Default all; [`Rules::LITERAL`] is the paper's text.
    pub rules: Rules,
    /// Whether the radii of every level are kept, see `Refined::level_radii`. Changes no point.
    pub keep_radii: bool,
}

/// Rules that the paper doesn't have, for irregular samples, sheets that lie close to each other and creases. Each is measured in
/// `docs/algorithm.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rules {
    /// Points whose normals differ by more than 150° are no neighbours.
    pub opposite_pairs: bool,
    /// Eq. 6 rejects pairs from 0.7 of its bound on.
    pub narrow_cones: bool,
    /// A triangle that a corner's normal leaves by more than 110° has no candidate.
    pub steep_faces: bool,
    /// The normal of a sliver is interpolated from its corners.
    pub sliver_normals: bool,
    /// New points on another sheet, with a normal turned by 90° or more, are neither new neighbours nor discard.
    pub own_side: bool,
    /// In the first step a radius counts as no more than 1.25 times the distance to the farthest neighbour when new
    /// neighbours are sought; without `largest_first`, which does not look at radii.
    pub first_radii: bool,
    /// In gaps of a ring from 100° on, members that the fuzzy planes removed come back if they are natural neighbours.
    pub natural_neighbors: bool,
    /// Pairs from 0.5 of the bound of eq. 6 on are neighbours only in gaps of a ring that would stay open without them. It needs
    /// `natural_neighbors`.
    pub sure_neighbors: bool,
    /// Between points on a step, whose normals both lean the same way along their edge, a normal is interpolated without a
    /// bend. It needs `sliver_normals`.
    pub step_normals: bool,
    /// New points are selected among the candidates of the whole cloud, the largest triangles first, instead of around one point
    /// after the other. `theta_c` and `plain_angle` mean nothing then, and `lambda1` is the share of the distance to the farthest
    /// neighbours that a triangle's size is no less than.
    pub largest_first: bool,
    /// Radii cover the ring that a point has at the next level; not with `simplified`.
    pub next_ring: bool,
    /// A crease between two points keeps them from seeing each other.
    pub separating_segments: bool,
    /// A point belongs to a side of a crease only if its normal and its place fit.
    pub valid_sides: bool,
    /// In steps that keep the creases and boundaries as they are, the neighbours of a point along them bound its new
    /// neighbourhood; without `largest_first`, which asks for no gaps.
    pub curve_bounds: bool,
    /// Creases and boundaries are split at the second, fourth, ... step instead of the first, third, ...
    pub even_steps: bool,
}

impl Rules {
    /// All of them.
    pub const ALL: Self = Self {
        opposite_pairs: true,
        narrow_cones: true,
        steep_faces: true,
        sliver_normals: true,
        own_side: true,
        first_radii: true,
        natural_neighbors: true,
        sure_neighbors: true,
        step_normals: true,
        largest_first: true,
        next_ring: true,
        separating_segments: true,
        valid_sides: true,
        curve_bounds: true,
        even_steps: true,
    };

    /// None of them: the paper's text.
    pub const LITERAL: Self = Self {
        opposite_pairs: false,
        narrow_cones: false,
        steep_faces: false,
        sliver_normals: false,
        own_side: false,
        first_radii: false,
        natural_neighbors: false,
        sure_neighbors: false,
        step_normals: false,
        largest_first: false,
        next_ring: false,
        separating_segments: false,
        valid_sides: false,
        curve_bounds: false,
        even_steps: false,
    };

    /// Each rule's name and whether it is on: the names of the kernels' `override`s, but for `even_steps`.
    pub fn named(&self) -> [(&'static str, bool); 15] {
        [
            ("opposite_pairs", self.opposite_pairs),
            ("narrow_cones", self.narrow_cones),
            ("steep_faces", self.steep_faces),
            ("sliver_normals", self.sliver_normals),
            ("own_side", self.own_side),
            ("first_radii", self.first_radii),
            ("natural_neighbors", self.natural_neighbors),
            ("sure_neighbors", self.sure_neighbors),
            ("step_normals", self.step_normals),
            ("largest_first", self.largest_first),
            ("next_ring", self.next_ring),
            ("separating_segments", self.separating_segments),
            ("valid_sides", self.valid_sides),
            ("curve_bounds", self.curve_bounds),
            ("even_steps", self.even_steps),
        ]
    }

    /// The rule of that name, to switch it.
    pub fn get_mut(&mut self, name: &str) -> Option<&mut bool> {
        match name {
            "opposite_pairs" => Some(&mut self.opposite_pairs),
            "narrow_cones" => Some(&mut self.narrow_cones),
            "steep_faces" => Some(&mut self.steep_faces),
            "sliver_normals" => Some(&mut self.sliver_normals),
            "own_side" => Some(&mut self.own_side),
            "first_radii" => Some(&mut self.first_radii),
            "natural_neighbors" => Some(&mut self.natural_neighbors),
            "sure_neighbors" => Some(&mut self.sure_neighbors),
            "step_normals" => Some(&mut self.step_normals),
            "largest_first" => Some(&mut self.largest_first),
            "next_ring" => Some(&mut self.next_ring),
            "separating_segments" => Some(&mut self.separating_segments),
            "valid_sides" => Some(&mut self.valid_sides),
            "curve_bounds" => Some(&mut self.curve_bounds),
            "even_steps" => Some(&mut self.even_steps),
            _ => None,
        }
    }
}

impl Default for Rules {
    fn default() -> Self {
        Self::ALL
    }
}

impl Default for RefineParams {
    fn default() -> Self {
        Self {
            levels: 1,
            neighborhood: Neighborhood::Accurate,
            simplified: false,
            plain_angle: false,
            theta_f: PI / 6.0,
            theta_c: 89.0 * PI / 180.0,
            lambda1: 0.577_350_26,
            lambda2: 0.5,
            boundary: Boundary::default(),
            rules: Rules::ALL,
            keep_radii: false,
        }
    }
}

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {value}, outside {range}")]
pub struct ParamError {
    /// Name of the parameter.
    pub name: &'static str,
    /// Its value.
    pub value: f32,
    /// The range that it must lie in.
    pub range: &'static str,
}

impl RefineParams {
    /// Checks the ranges.
    ///
    /// # Errors
    /// The first parameter that is out of its range.
    pub fn validate(&self) -> Result<(), ParamError> {
        let check = |ok: bool, name, value, range| {
            if ok { Ok(()) } else { Err(ParamError { name, value, range }) }
        };
        // NaN fails every comparison, so it is caught here too.
        check(self.levels <= 20, "levels", self.levels as f32, "0 to 20")?;
        check(
            self.theta_f > 0.0 && self.theta_f <= PI / 2.0,
            "theta_f",
            self.theta_f,
            "(0, π/2] radians",
        )?;
        check(self.theta_c > 0.0 && self.theta_c < PI, "theta_c", self.theta_c, "(0, π) radians")?;
        check(self.lambda1 > 0.0 && self.lambda1 <= 1.0, "lambda1", self.lambda1, "(0, 1]")?;
        check((0.0..=1.0).contains(&self.lambda2), "lambda2", self.lambda2, "[0, 1]")?;
        match self.boundary {
            Boundary::Angle(angle) => {
                check(angle > PI / 2.0 && angle < 2.0 * PI, "theta_b", angle, "(π/2, 2π) radians")
            }
            Boundary::None | Boundary::Marked(_) => Ok(()),
        }
    }

    /// Sine of `theta_f`, through f64 so that every system library rounds it alike.
    pub fn sin_theta_f(&self) -> f32 {
        f64::from(self.theta_f).sin() as f32
    }

    /// Whether the angle between new neighbours is straight: `simplified` asks for it.
    pub fn effective_plain_angle(&self) -> bool {
        self.simplified || self.plain_angle
    }

    /// The neighbourhood that is used: `simplified` asks for the fuzzy one.
    pub fn effective_neighborhood(&self) -> Neighborhood {
        if self.simplified { Neighborhood::Fuzzy } else { self.neighborhood }
    }

    /// Whether contested candidates alone are asked who discards them, where no new points on creases or boundaries can do so:
    /// `simplified` asks for it, of a selection among all candidates.
    pub fn effective_contested(&self) -> bool {
        self.simplified && self.rules.largest_first
    }

    /// The rules that hold: `simplified` is for clouds that do without those for irregular samples.
    pub fn effective_rules(&self) -> Rules {
        let irregular = !self.simplified;
        Rules {
            next_ring: self.rules.next_ring && irregular,
            natural_neighbors: self.rules.natural_neighbors && irregular,
            ..self.rules
        }
    }

    /// The rules that change anything with these parameters: [`RefineParams::effective_rules`] without those that need a rule
    /// that is off, or that mean nothing to the selection. For people; kernels are compiled for the former.
    pub fn rules_in_effect(&self) -> Rules {
        let rules = self.effective_rules();
        let paper_loop = !rules.largest_first;
        Rules {
            sure_neighbors: rules.sure_neighbors && rules.natural_neighbors,
            step_normals: rules.step_normals && rules.sliver_normals,
            first_radii: rules.first_radii && paper_loop,
            curve_bounds: rules.curve_bounds && paper_loop,
            ..rules
        }
    }

    /// Whether radii cover the next level's rings.
    pub fn effective_next_ring(&self) -> bool {
        self.effective_rules().next_ring
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of the rules that change nothing although they are on.
    fn idle(params: &RefineParams) -> Vec<&'static str> {
        let pairs = params.rules.named().into_iter().zip(params.rules_in_effect().named());
        pairs.filter(|(on, in_effect)| on.1 != in_effect.1).map(|(on, _)| on.0).collect()
    }

    #[test]
    fn rules_in_effect_are_those_that_mean_something() {
        let usual = RefineParams::default();
        assert_eq!(idle(&usual), ["first_radii", "curve_bounds"]);
        let simplified = RefineParams { simplified: true, ..usual.clone() };
        let irregular = ["natural_neighbors", "sure_neighbors"];
        let rest = ["next_ring", "curve_bounds"];
        assert_eq!(idle(&simplified), [&["first_radii"], &irregular[..], &rest[..]].concat());
        let without = |name| {
            let mut rules = Rules { largest_first: false, ..Rules::ALL };
            *rules.get_mut(name).unwrap() = false;
            idle(&RefineParams { rules, ..usual.clone() })
        };
        assert!(without("largest_first").is_empty());
        assert_eq!(without("natural_neighbors"), ["sure_neighbors"]);
        assert_eq!(without("sliver_normals"), ["step_normals"]);
        let literal = RefineParams { rules: Rules::LITERAL, ..usual };
        assert_eq!(literal.rules_in_effect(), Rules::LITERAL);
    }
}
