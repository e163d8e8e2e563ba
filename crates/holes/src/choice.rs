//! Which loops are filled.

use crate::fill::{Fill, fill};
use crate::loops::{Kind, Loop, loops};
use crate::natural::raised;
use surfine_points::PointSet;

/// Which loops are filled.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// None: all radii stay as they are.
    None,
    /// Those of which at least half of the points have radii raised by hand ([`raised`]), unless they are outer rims.
    #[default]
    Raised,
    /// All [`Kind::Hole`].
    All,
    /// Those with these ids, of any kind.
    Ids(Vec<u32>),
    /// All up to this span, in the units of the positions, but outer rims.
    MaxSpan(f32),
}

/// Why holes were not filled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No loop has this id.
    #[error("there is no loop {id}: {}", list(.known))]
    UnknownId {
        /// The id.
        id: u32,
        /// Ids that there are.
        known: Vec<u32>,
    },
    /// The cloud has an attribute `hole` that is no 32-bit integer.
    #[error(
        "there is a property hole that is not of type int, so fill points can't be tagged: rename it"
    )]
    Tag,
}

fn list(ids: &[u32]) -> String {
    match ids {
        [] => "the cloud has no loops".into(),
        [one] => format!("the only one is {one}"),
        [.., last] => format!("they are 1 to {last}"),
    }
}

/// A cloud whose holes were filled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filled {
    /// The points of the input, then the fill points loop by loop.
    pub points: PointSet,
    /// What happened at each chosen loop, by id.
    pub fills: Vec<Fill>,
    /// Number of radii raised by hand that are natural again.
    pub restored: usize,
    /// Number of radii raised by hand that stay: no chosen loop has them.
    pub kept_raised: usize,
}

/// Fills the chosen loops. Where any is filled, radii raised by hand become natural.
///
/// The points of the input stay as they are and come first, but for radii along the loops, which grow where new neighbours
/// ask for it. Fill points follow loop by loop; their attributes come from the corners of their triangle. The attribute
/// [`crate::HOLE`] tags them with the id of their loop; if there is one already, the new tags go on from its largest.
/// A loop whose fill leaves a tenth of its points open is left as it was. If there is no fill point the cloud comes
/// back as it is.
///
/// # Errors
/// An id that no loop has; an attribute `hole` of another type than `int`.
pub fn fill_holes(points: &PointSet, choice: &Choice) -> Result<Filled, Error> {
    let raised = if *choice == Choice::None { Vec::new() } else { raised(points) };
    let unchanged = |fills| {
        let kept_raised = raised.len();
        Filled { points: points.clone(), fills, restored: 0, kept_raised }
    };
    let nothing_raised = *choice == Choice::Raised && raised.is_empty();
    if *choice == Choice::None || nothing_raised {
        return Ok(unchanged(Vec::new()));
    }
    let is_raised = |p: &&u32| raised.binary_search_by_key(*p, |raised| raised.point).is_ok();
    let chosen = choose(loops(points), choice, |found| {
        2 * found.points.iter().filter(is_raised).count() >= found.points.len()
    })?;
    let mut natural = points.clone();
    raised.iter().for_each(|raised| natural.radii[raised.point as usize] = raised.radius);
    let (filled, fills) = fill(&natural, &chosen)?;
    if fills.iter().all(|fill| fill.points == 0) {
        return Ok(unchanged(fills));
    }
    Ok(Filled { points: filled, fills, restored: raised.len(), kept_raised: 0 })
}

/// The chosen loops by id.
fn choose(
    mut loops: Vec<Loop>,
    choice: &Choice,
    is_raised: impl Fn(&Loop) -> bool,
) -> Result<Vec<Loop>, Error> {
    if let Choice::Ids(ids) = choice
        && let Some(&id) = ids.iter().find(|id| loops.iter().all(|found| found.id != **id))
    {
        return Err(Error::UnknownId { id, known: loops.iter().map(|found| found.id).collect() });
    }
    loops.retain(|found| match choice {
        Choice::None => false,
        Choice::Raised => found.kind() != Kind::OuterRim && is_raised(found),
        Choice::All => found.kind() == Kind::Hole,
        Choice::Ids(ids) => ids.contains(&found.id),
        Choice::MaxSpan(span) => found.kind() != Kind::OuterRim && found.span <= *span,
    });
    Ok(loops)
}
