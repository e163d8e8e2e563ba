//! Boundary loops of oriented point clouds, and points that fill holes at the density of their surroundings.
//!
//! Guennebaud, Barthe and Paulin 2005 (cited as \[R\]) close large holes by raising the radii of the points around them
//! (figure 9). That closes them, but the coarse first triangles stay visible for ever. Here a hole is filled first, and the cloud
//! refined then. `docs/algorithm.md` has the rules and what was measured.
//!
//! All of it runs on the CPU, in the operations of [`surfine_reference::math`], before either backend: both refine the same
//! bytes. No result depends on the number of threads.

mod candidates;
mod choice;
mod fill;
mod front;
mod graph;
mod loops;
mod natural;
mod relax;
mod width;

pub use choice::{Choice, Error, Filled, fill_holes};
pub use fill::Fill;
pub use loops::{Kind, Loop, loops};
pub use natural::{Raised, raised};

/// Name of the attribute that tags fill points with the id of their loop; it is 0 for all others.
pub const HOLE: &str = "hole";
