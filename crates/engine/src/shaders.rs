//! The kernels: which files make up each of them. The only place that knows where the shaders are.

/// The source of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Name of the kernel.
    pub name: &'static str,
    /// Name of its entry point and stem of its file; the name too but for kernels that are there twice.
    pub entry: &'static str,
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
        shader!($name = $name $(, $shared)*)
    };
    ($name:literal = $entry:literal $(, $shared:literal)*) => {
        Shader {
            name: $name,
            entry: $entry,
            files: &[file!($entry), file!("shared/" "records") $(, file!("shared/" $shared))*],
        }
    };
}

/// A kernel with private rows, and the same with rows in the arena for what these do not hold.
macro_rules! with_rows {
    ($name:literal, $large:literal $(, $shared:literal)*) => {
        [
            shader!($name, "rows", "rows_private" $(, $shared)*),
            shader!($large = $name, "rows", "rows_arena" $(, $shared)*),
        ]
    };
}

const NEIGHBORHOOD: [Shader; 2] = with_rows!(
    "neighborhood",
    "neighborhood_large",
    "ball",
    "fuzzy_planes",
    "sort_ring",
    "natural",
    "cells",
    "ball_walk",
    "within",
    "count_within",
    "math",
    "pn_triangle",
    "curves",
    "segments",
    "visible",
    "fences",
    "cut_loops"
);

const CONFLICTS: [Shader; 2] = with_rows!(
    "conflicts",
    "conflicts_large",
    "around",
    "cover",
    "priority",
    "cells",
    "ball_walk",
    "within",
    "count_within",
    "math",
    "same_side",
    "curves",
    "segments",
    "visible",
    "fences",
    "cut_loops"
);

const INSERTION: [Shader; 2] = with_rows!(
    "insertion",
    "insertion_large",
    "shared_candidate",
    "new_ring",
    "gather",
    "gaps",
    "choice",
    "discard",
    "next_radii",
    "cover",
    "math",
    "pn_triangle",
    "same_side",
    "curves",
    "cut_loops"
);

const NEXT_RING: [Shader; 2] = with_rows!(
    "next_ring",
    "next_ring_large",
    "ahead",
    "cover",
    "fuzzy_planes",
    "sort_ring",
    "math",
    "pn_triangle",
    "curves",
    "cut_loops"
);

/// All kernels, in the order of the stages.
pub const SHADERS: &[Shader] = &[
    shader!("grid_count", "cells"),
    shader!("grid_fill"),
    shader!("scan_sum"),
    shader!("scan_add"),
    NEIGHBORHOOD[0],
    NEIGHBORHOOD[1],
    shader!("boundary_gaps", "math"),
    shader!("candidates_home", "math", "curves", "fan_triangle", "canonical"),
    shader!("candidates_number", "canonical"),
    shader!("candidates_link"),
    shader!("candidates", "math", "pn_triangle", "corners", "new_normal", "curves"),
    shader!(
        "selection_overlaps",
        "links",
        "precedence",
        "priority",
        "cells",
        "ball_walk",
        "count_within",
        "math",
        "same_side",
        "curves",
        "segments",
        "visible",
        "fences",
        "cut_loops"
    ),
    shader!("selection_contested", "cut_loops"),
    shader!("selection_links", "links", "precedence", "priority", "math", "same_side", "cut_loops"),
    shader!("selection_round"),
    shader!("selection", "shared_candidate", "state_of", "cut_loops"),
    shader!("selection_tail", "shared_candidate", "state_of", "cut_loops"),
    shader!("selection_stand_in", "math", "cut_loops"),
    shader!("selection_radii", "cover", "math", "cut_loops"),
    CONFLICTS[0],
    CONFLICTS[1],
    shader!("conflicts_mirror", "links", "cut_loops"),
    shader!("coloring_order", "priority"),
    shader!("coloring_round", "priority"),
    shader!("coloring", "priority", "cut_loops"),
    shader!("class_count"),
    shader!("sort_fill"),
    INSERTION[0],
    INSERTION[1],
    NEXT_RING[0],
    NEXT_RING[1],
    shader!("commit_count"),
    shader!("commit", "math", "curves"),
];
