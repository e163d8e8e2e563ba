//! Draws clouds of oriented points as splats: each point a disc on its tangent plane, overlapping discs blended, light
//! computed from the blended normals (deferred splatting after Botsch, Hornung, Zwicker and Kobbelt 2005).
//!
//! A picture takes four passes. *Visibility* draws small discs into a depth buffer, pushed back by part of their radius:
//! first those that show their fronts, then those that show their backs. *Attributes* adds up colours and normals of larger
//! discs that are not behind that depth, weighted so that they fade towards their outline. *Resolve* divides by the
//! weights, lights each subpixel that visibility reached, and averages.
//!
//! [`Renderer`] does so on the GPU, from points of the host or straight from the engine's device buffers
//! ([`DeviceSplats::from`]); [`cpu::draw`] draws the same picture without one. The GPU adds up in half floats, which every
//! device can blend: where more than some hundred discs overlap in one pixel, a thousand records of one place for
//! instance, its colours are off, and the CPU's are right.
//!
//! ```no_run
//! use surfine_render::{Camera, Renderer, Size, Style, View};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let points = surfine::PointSet::default();
//! let mut refiner = surfine::Refiner::new(None)?;
//! let refined = refiner.refine_on_device(&points, &surfine::RefineParams::default(), &mut |_| ())?;
//! let size = Size { width: 800, height: 600 };
//! let seen = points.positions.iter().copied();
//! let camera = Camera::look(seen, View::Iso.direction(), View::Iso.up(), size.aspect());
//! let renderer = Renderer::new(refiner.gpu())?;
//! let picture = renderer.draw(&(&refined).into(), &camera, &Style::default(), size)?;
//! picture.write_png("fine.png".as_ref())?;
//! # Ok(())
//! # }
//! ```

mod camera;
mod caption;
pub mod cpu;
mod creases;
mod error;
mod picture;
mod renderer;
mod shading;
mod space;
mod splats;
mod style;
mod view;

pub use camera::{Camera, UnknownView, View};
pub use caption::{Caption, Scale};
pub use error::Error;
pub use picture::{Animation, Picture, Size};
pub use renderer::{DeviceSplats, Renderer, SHADERS};
pub use space::Space;
pub use splats::Splats;
pub use style::{Coloring, Style, ramp};
