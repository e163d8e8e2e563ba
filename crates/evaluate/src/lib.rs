//! Measures how well a cloud of oriented points shows a surface.
//!
//! [`evaluate()`] holds an output against a [`Truth`], a mesh or a denser cloud, and gives an [`Evaluation`]: plain numbers,
//! serialisable, with a table for people ([`Evaluation::report`]). Each measure answers one question and leaves the
//! others alone: noise shows in the [distance](Distance), a hole in the [coverage](Coverage), a turned normal in the
//! [normal error](NormalError) and the [smoothness](Smoothness), clusters in the [uniformity](Uniformity).
//!
//! The same input gives the same bytes for any number of threads: work is shared out point by point, and sums are taken
//! in the order of the points.
//!
//! ```
//! use surfine_evaluate::{Options, Truth, evaluate};
//! use surfine_points::Model;
//! use surfine_points::shapes::{Sampling, Shape, sample};
//!
//! let truth = Truth::new(&Model::from(&sample(Shape::Torus, Sampling::BlueNoise, 2000, 1)))?;
//! let output = Model::from(&sample(Shape::Torus, Sampling::BlueNoise, 500, 2));
//! let evaluation = evaluate(&output, &truth, None, &Options::default(), &mut |_| ())?;
//! assert!(evaluation.distance.in_spacings.mean < 0.1);
//! println!("{}", evaluation.report());
//! # Ok::<(), surfine_evaluate::Unfit>(())
//! ```

mod chamfer;
mod cloud;
mod colors;
mod coverage;
mod discs;
mod distance;
mod error;
mod evaluation;
mod normals;
mod places;
mod report;
mod smoothness;
mod spread;
mod survival;
mod tree;
mod truth;
mod uniformity;

pub use chamfer::{Chamfer, Plain, Pu};
pub use colors::ColorError;
pub use coverage::{Along, Coverage};
pub use discs::Disc;
pub use distance::Distance;
pub use error::Unfit;
pub use evaluation::{Evaluation, Options, OutputSummary, errors, evaluate};
pub use normals::{AwayFromCreases, NormalError};
pub use smoothness::Smoothness;
pub use spread::{Angles, Spread, percentile};
pub use survival::Survival;
pub use truth::{Closest, Truth, TruthKind, TruthSummary};
pub use uniformity::Uniformity;
