//! The discard space (section 5, eq. 11). Twin: `shaders/shared/discard.wgsl`.

use super::{Member, NewRing};
use crate::insertion::Stage;
use crate::visible::same_side;

impl NewRing {
    /// The new point of Y or N' whose discard sphere (eq. 11) holds the candidate: the closest of them, if any.
    pub(super) fn discarded_by(&self, stage: Stage<'_>, candidate: &Member) -> Option<Member> {
        let mut closest: Option<(&Member, f32)> = None;
        for members in [&self.outer, &self.ring] {
            for h in members {
                let d = candidate.offset - h.offset;
                let d2 = d.dot(d);
                // Members that only bound gaps have no sphere.
                if d2 < h.sphere * h.sphere
                    && same_side(stage.params.rules, candidate.normal, h.normal)
                    && closest.is_none_or(|(c, least)| d2 < least || (d2 == least && h.id < c.id))
                {
                    closest = Some((h, d2));
                }
            }
        }
        closest.map(|(h, _)| *h)
    }
}
