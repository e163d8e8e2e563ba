//! Holes.
mod candidates;
mod fill;
mod front;
mod graph;
mod loops;
mod relax;
mod width;
pub use fill::{Fill, Filled, fill};
pub use loops::{Kind, Loop, loops};
