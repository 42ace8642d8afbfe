//! The walls of a floor as boxes or sheets that do not overlap: junctions, doors, windows.

use crate::layout::Layout;
use crate::stroke::{Rect, Stroke, merge};

/// Clear height of a floor, in layout steps: 2.75 units.
pub(super) const CEILING: i32 = 22;
/// Height of doors and of the upper edge of windows: 2.125 units.
pub(super) const HEAD: i32 = 17;
/// Height of the lower edge of windows: 1 unit.
const SILL: i32 = 8;
/// Width of windows: 1.25 units.
const WINDOW: i32 = 10;
/// From one window to the next: 2 units.
const WINDOW_PITCH: i32 = 16;
/// From a window to a wall that meets the outer wall, middle lines.
const WINDOW_MARGIN: i32 = 3;

/// A part of a wall: a box, flat if walls have no thickness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct WallPart {
    /// `"wall"`, `"lintel"` or `"sill"`.
    pub(super) kind: &'static str,
    /// The area that it covers in plan.
    pub(super) rect: Rect,
    /// Its lower and upper end above the floor.
    pub(super) heights: [i32; 2],
}

/// A gap in a wall.
#[derive(Debug, Clone, Copy)]
struct Opening {
    along: [i32; 2],
    /// Height of its lower edge: 0 for a door.
    from: i32,
}

/// The walls of `floor`, `half` layout steps thick on each side.
pub(super) fn wall_parts(floor: &Layout, half: i32, windows: bool) -> Vec<WallPart> {
    // Doors join the pieces of a wall, so that each wall is one stroke up to its true ends.
    let walls = merge(floor.strokes.iter().chain(&floor.doors).copied().collect());
    let mut parts = Vec::new();
    for wall in fitted(&walls, half) {
        let mut openings = doors_of(&wall, &floor.doors);
        if windows && is_outer(&wall, floor.outer) {
            openings.extend(windows_of(&wall, &walls));
        }
        cut(&wall, half, &openings, &mut parts);
    }
    parts
}

fn is_outer(wall: &Stroke, outer: Rect) -> bool {
    if wall.horizontal { [outer.y0, outer.y1].contains(&wall.at) } else { [outer.x0, outer.x1].contains(&wall.at) }
}

/// Makes walls meet without overlap: at a crossing the wall along x passes and the other is cut; at a T the passing
/// wall is whole and the other ends at its face; at a corner the wall along x fills the corner.
fn fitted(walls: &[Stroke], half: i32) -> Vec<Stroke> {
    let (along_x, along_y): (Vec<Stroke>, Vec<Stroke>) = walls.iter().partition(|w| w.horizontal);
    let passes = |w: &Stroke, at: i32| w.lo < at && at < w.hi;
    let reaches = |w: &Stroke, at: i32| w.lo <= at && at <= w.hi;
    let mut out = Vec::new();
    for h in &along_x {
        // The growth of the wall beyond its end at `x`.
        let growth = |x: i32| {
            let met = || along_y.iter().filter(|v| v.at == x && reaches(v, h.at));
            if met().any(|v| passes(v, h.at)) {
                -half
            } else if met().next().is_some() {
                half
            } else {
                0
            }
        };
        out.push(Stroke { lo: h.lo - growth(h.lo), hi: h.hi + growth(h.hi), ..*h });
    }
    for v in &along_y {
        let mut met: Vec<i32> = along_x.iter().filter(|h| reaches(h, v.at) && reaches(v, h.at)).map(|h| h.at).collect();
        // Only walls that pass, or at which it ends, cut it.
        met.retain(|&y| !passes(v, y) || along_x.iter().any(|h| h.at == y && passes(h, v.at)));
        let mut ends: Vec<i32> = met.iter().copied().chain([v.lo, v.hi]).collect();
        ends.sort_unstable();
        ends.dedup();
        let face = |y: i32| if met.contains(&y) { half } else { 0 };
        out.extend(ends.windows(2).map(|e| Stroke { lo: e[0] + face(e[0]), hi: e[1] - face(e[1]), ..*v }));
    }
    out.retain(|w| w.lo < w.hi);
    out
}

/// The doors in a wall, ascending.
fn doors_of(wall: &Stroke, doors: &[Stroke]) -> Vec<Opening> {
    let inside = |d: &&Stroke| d.horizontal == wall.horizontal && d.at == wall.at && wall.lo <= d.lo && d.hi <= wall.hi;
    let mut found: Vec<Opening> =
        doors.iter().filter(inside).map(|d| Opening { along: [d.lo, d.hi], from: 0 }).collect();
    found.sort_unstable_by_key(|o| o.along);
    found
}

/// The windows of an outer wall: at regular distances, except where a wall meets it from inside.
fn windows_of(wall: &Stroke, walls: &[Stroke]) -> Vec<Opening> {
    let meets = |w: &&Stroke| w.horizontal != wall.horizontal && w.lo <= wall.at && wall.at <= w.hi;
    let mut met: Vec<i32> = walls.iter().filter(meets).map(|w| w.at).collect();
    met.sort_unstable();
    let mut windows = Vec::new();
    let mut lo = wall.lo + WINDOW_PITCH / 2 - WINDOW / 2;
    while lo + WINDOW + WINDOW_MARGIN <= wall.hi {
        let (from, to) = (lo - WINDOW_MARGIN, lo + WINDOW + WINDOW_MARGIN);
        let next = met.partition_point(|&at| at <= from);
        if met.get(next).is_none_or(|&at| at >= to) {
            windows.push(Opening { along: [lo, lo + WINDOW], from: SILL });
        }
        lo += WINDOW_PITCH;
    }
    windows
}

/// Adds the parts of a wall around its openings (ascending, apart from each other and from its ends).
fn cut(wall: &Stroke, half: i32, openings: &[Opening], parts: &mut Vec<WallPart>) {
    let mut add = |kind, [lo, hi]: [i32; 2], heights: [i32; 2]| {
        let across = [wall.at - half, wall.at + half];
        let [[x0, x1], [y0, y1]] = if wall.horizontal { [[lo, hi], across] } else { [across, [lo, hi]] };
        parts.push(WallPart { kind, rect: Rect { x0, y0, x1, y1 }, heights });
    };
    let mut from = wall.lo;
    for opening in openings {
        add("wall", [from, opening.along[0]], [0, CEILING]);
        if opening.from > 0 {
            add("sill", opening.along, [0, opening.from]);
        }
        add("lintel", opening.along, [HEAD, CEILING]);
        from = opening.along[1];
    }
    add("wall", [from, wall.hi], [0, CEILING]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plan area that thick walls cover, with multiplicity.
    fn area(walls: &[Stroke], half: i32) -> i32 {
        walls.iter().map(|w| (w.hi - w.lo) * 2 * half).sum()
    }

    #[test]
    fn walls_meet_without_overlap() {
        let (h, v) = (Stroke::along_x(0, 0, 20), Stroke::along_y(0, 0, 20));
        // A corner: the wall along x fills it.
        assert_eq!(fitted(&[h, v], 1), [Stroke { lo: -1, ..h }, Stroke { lo: 1, ..v }]);
        // A T from above, and one from the side.
        let foot = Stroke::along_y(10, 0, 20);
        assert_eq!(fitted(&[h, foot], 2), [h, Stroke { lo: 2, ..foot }]);
        let post = Stroke::along_y(0, -20, 20);
        assert_eq!(fitted(&[h, post], 2), [Stroke { lo: 2, ..h }, post]);
        // A crossing, and walls without thickness.
        let across = Stroke::along_y(10, -20, 20);
        let pieces = [Stroke { hi: -1, ..across }, Stroke { lo: 1, ..across }];
        assert_eq!(fitted(&[h, across], 1), [h, pieces[0], pieces[1]]);
        assert_eq!(area(&fitted(&[h, across], 1), 1), 2 * 20 + 2 * 38);
        assert_eq!(fitted(&[h, v, post], 0).len(), 3);
    }

    #[test]
    fn windows_keep_away_from_walls() {
        let outer = Stroke::along_x(0, 0, 64);
        let walls = [outer, Stroke::along_y(0, 0, 50), Stroke::along_y(24, 0, 50), Stroke::along_y(64, 0, 50)];
        let found: Vec<[i32; 2]> = windows_of(&outer, &walls).iter().map(|w| w.along).collect();
        assert_eq!(found, [[3, 13], [35, 45], [51, 61]]);
        assert!(windows_of(&Stroke::along_x(0, 0, 12), &[]).is_empty());
    }
}
