//! Behaviour of the refinement, held on the CPU reference: what a user may rely on, whatever the kernels look like.
//!
//! Numbers beside a tolerance were measured with this code unless they are said to be published; "published" means the
//! table of a separate f64 implementation, one seed a row. Models that a clone lacks are looked for beside the checkout
//! (`../shared/data/points`); each property that they show is held on a generated shape as well.

mod attributes;
mod bound;
mod boundaries;
mod clouds;
mod coincident;
mod convergence;
mod creases;
mod curves;
mod degenerate;
mod measure;
mod odd_curves;
mod old_points;
mod quality;
mod rules;
mod scale;
mod schedule;
mod selection;
