//! How far results may lie apart on adapters that do not round division and square root correctly.
//!
//! Vulkan allows 2.5 units in the last place for a division, and the square root inherits that. Software drivers round
//! correctly, so there nothing may differ.

/// One line of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tolerance {
    /// Largest difference, relative to the scale of the values.
    pub relative: f32,
    /// Why no less.
    pub reason: &'static str,
}

/// Bit for bit.
pub(crate) const EXACT: Tolerance =
    Tolerance { relative: 0.0, reason: "only exact operations, or integers" };

/// Ring angles, radians over 2π.
pub(crate) const ANGLE: Tolerance = Tolerance {
    relative: 4e-6,
    reason: "two roots for the frame, two divisions for the arc tangent",
};

/// Candidate positions and ρ, over the size of the triangle.
pub(crate) const POSITION: Tolerance =
    Tolerance { relative: 4e-6, reason: "six tangents, each with two roots and a division" };

/// Candidate normals.
pub(crate) const NORMAL: Tolerance = Tolerance {
    relative: 2e-4,
    reason: "slivers: the cross product loses what the tangents got wrong",
};

/// Radii, relative.
pub(crate) const RADIUS: Tolerance =
    Tolerance { relative: 8e-6, reason: "a root of a sum of squares of rounded positions" };

/// Share of new points that may differ because a comparison of nearly equal numbers went the other way. Each one that
/// does is counted and printed.
pub(crate) const FLIPPED_DECISIONS: f64 = 2e-3;
