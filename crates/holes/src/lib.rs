//! Holes.
mod candidates;
mod fill;
mod front;
mod graph;
mod loops;
mod natural;
mod relax;
mod width;
pub use fill::{Fill, Filled, fill};
pub use loops::{Kind, Loop, loops};
pub use natural::{Raised, raised};
