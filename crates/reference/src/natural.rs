//! Natural neighbours that come back into a ring where it stays wide open (ours). Twin: `shaders/shared/natural.wgsl`.

use crate::ball::Ball;
use crate::math::{TAU, direction_angle};
use crate::neighborhood::RingEntry;
use crate::pairs::OUT;
use crate::sort_ring::RingOrder;

/// A ring gap from 100° on may miss a natural neighbour, radians.
pub const OPEN_GAP: f32 = 1.745_329_3;

/// By less do the angles between members, and the differences of their angles, differ.
const ROUNDINGS: f32 = 1e-4;

/// Whether two entries that follow each other may leave an open gap: whether anything may come back.
pub(crate) fn has_open_gap(ring: &[RingEntry]) -> bool {
    let open = OPEN_GAP - ROUNDINGS;
    let angle = |i: usize| ring[i].angle;
    let wraps = ring.is_empty() || angle(0) + TAU - angle(ring.len() - 1) >= open;
    wraps || (1..ring.len()).any(|i| angle(i) - angle(i - 1) >= open)
}

/// Appends the members that come back. The others are asked about while these are not there yet:
/// `back` holds them until then.
pub(crate) fn take_back(ball: Ball<'_>, kept: &mut RingOrder, back: &mut Vec<usize>) {
    let comes_back = |i: &usize| {
        let may = ball.verdicts[*i] != OUT && !ball.is_neighbor(*i);
        may && may_be_in_open_gap(ball, kept.members(), *i)
            && is_in_open_gap(ball, kept.members(), *i)
            && is_natural(ball, *i)
    };
    back.clear();
    back.extend((0..ball.len()).filter(comes_back));
    kept.prepare(back.len());
    back.iter().for_each(|&i| kept.offer(i as u32, ball.angle[i], ball.ids[i], true));
}

/// Whether [`is_in_open_gap`] has to be asked: most members are far from open gaps, which their
/// angles tell at less cost.
fn may_be_in_open_gap(ball: Ball<'_>, kept: &[u32], i: usize) -> bool {
    let (mut after, mut before) = (TAU, TAU);
    for &j in kept {
        let turn = ball.angle[j as usize] - ball.angle[i];
        let turn = if turn < 0.0 { turn + TAU } else { turn };
        after = after.min(turn);
        before = before.min(TAU - turn);
    }
    // Where one is at the member's own angle, roundings decide on which side it is.
    after.min(before) < ROUNDINGS || after + before >= OPEN_GAP - ROUNDINGS
}

/// Whether the kept members next to member `i` on both sides leave a gap that may miss a neighbour.
fn is_in_open_gap(ball: Ball<'_>, kept: &[u32], i: usize) -> bool {
    let (mut after, mut before) = (TAU, TAU);
    for j in kept.iter().map(|&j| j as usize) {
        let along = ball.x[i] * ball.x[j] + ball.y[i] * ball.y[j];
        let across = ball.x[i] * ball.y[j] - ball.y[i] * ball.x[j];
        after = after.min(direction_angle(across, along));
        before = before.min(direction_angle(-across, along));
    }
    after + before >= OPEN_GAP
}

/// Whether member `i` is a natural neighbour of the centre on its tangent plane: whether a piece of their bisector, no
/// farther from its middle than the radius, is nearer to both than to every other member.
fn is_natural(ball: Ball<'_>, i: usize) -> bool {
    let (x, y) = (ball.x[i], ball.y[i]);
    // Places on the bisector are q/2 + t (-y, x).
    let mut high = 1.0 / (x * x + y * y).sqrt();
    let mut low = -high;
    for j in (0..ball.len()).filter(|&j| j != i && ball.verdicts[j] != OUT) {
        let (xj, yj) = (ball.x[j], ball.y[j]);
        let along = x * xj + y * yj;
        let across = x * yj - y * xj;
        let room = 0.5 * ((xj * xj + yj * yj) - along);
        if across > 0.0 {
            high = high.min(room / across);
        } else if across < 0.0 {
            low = low.max(room / across);
        } else if room < 0.0 {
            return false;
        }
    }
    low < high
}
