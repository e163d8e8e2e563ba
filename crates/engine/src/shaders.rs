//! The kernels: which files make up each of them. The only place that knows where the shaders are.

/// The source of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Name of the kernel: stem of its file and name of its entry point.
    pub name: &'static str,
    /// The kernel's own file first, so that line numbers in messages are its own, then the shared ones.
    pub files: &'static [&'static str],
}

impl Shader {
    /// The whole WGSL text.
    pub fn source(&self) -> String {
        self.files.join("\n")
    }
}

macro_rules! file {
    ($($part:literal)+) => {
        include_str!(concat!("../../../shaders/", $($part,)+ ".wgsl"))
    };
}

macro_rules! shader {
    ($name:literal $(, $shared:literal)*) => {
        Shader {
            name: $name,
            files: &[file!($name), file!("shared/" "records") $(, file!("shared/" $shared))*],
        }
    };
}

/// All kernels, in the order of the stages.
pub const SHADERS: &[Shader] = &[
    shader!("grid_points", "cells"),
    shader!("grid_candidates", "cells"),
    shader!("sort_fill"),
    shader!("scan_sum"),
    shader!("scan_add"),
    shader!(
        "neighborhood_ball",
        "cells",
        "ball_walk",
        "math",
        "pn_triangle",
        "curves",
        "segments",
        "visible",
        "cut_loops"
    ),
    shader!("neighborhood_badness", "math", "fuzzy_planes", "cut_loops"),
    shader!("neighborhood_natural", "math", "cut_loops"),
    shader!("neighborhood_ring", "math", "cut_loops"),
    shader!("neighborhood_store"),
    shader!("boundary_gaps", "math"),
    shader!("candidates", "math", "pn_triangle", "new_normal", "curves", "fan_triangle"),
    shader!("conflicts", "cells", "ball_walk", "math", "near", "cut_loops"),
    shader!("conflicts_mirror", "cut_loops"),
    shader!("coloring", "cut_loops"),
    shader!("class_count"),
    shader!(
        "insertion",
        "cells",
        "ball_walk",
        "math",
        "pn_triangle",
        "near",
        "same_side",
        "curves",
        "segments",
        "visible",
        "new_ring",
        "choice",
        "discard",
        "next_radii",
        "cut_loops"
    ),
    shader!(
        "next_ring",
        "cells",
        "ball_walk",
        "math",
        "pn_triangle",
        "fuzzy_planes",
        "same_side",
        "curves",
        "segments",
        "visible",
        "ahead",
        "cut_loops"
    ),
    shader!("commit_count"),
    shader!("commit", "math", "pn_triangle", "new_normal", "curves", "fan_triangle"),
];
