//! Cutting lines where they meet, so that they only touch in common end points.
//!
//! Where an end point lies on another line (exactly: a T-junction, an overlap, a repetition), that
//! line is cut there; no new point is made. Where two lines cross properly in a point X, a point P is
//! needed that both pieces can end in:
//!
//! * If one of the lines is parallel to an axis, P is X rounded along that line: P lies on it exactly.
//! * Otherwise P is X rounded to the nearest doubles, at most `reach` = 2^-51 max(|x|, |y|) away.
//!
//! # Why rounding errs towards visible
//! A wall from A to B that is bent through P becomes A-P-B. Let a sightline avoid the true walls and
//! cross the piece A-P. It enters the triangle A, X, P through A-P, and cannot leave through A-X, which
//! is wall: it leaves through X-P. So only lines through the tiny segment X-P can be lost.
//!
//! * *Two walls cross in X.* If each end point of both walls is farther than 4 `reach` from the other
//!   wall's carrier, no line that passes within `reach` of X avoids both: the two walls divide the
//!   neighbourhood of X into four wedges narrower than a half turn, a full line inside a wedge must
//!   leave it, and of its two directions at least one leaves through a wall nearer to X than that
//!   wall's end. If an end point C of one wall is that near to the other wall, P is C instead: X-C is
//!   then part of C's own wall, and nothing passes it.
//! * *A wall crosses a line that does not block.* Bending the wall could lose lines that graze it, so
//!   the wall stays as it is unless P lies on it exactly; the other line is cut off just short of it on
//!   both sides. Its two ends leave a gap, and the regions on its sides become one, with the groups of
//!   both: more is visible, not less.
//! * *Two lines that do not block.* Nothing can be lost; a region's border moves by `reach`.
//!
//! Last, a bent wall must not sweep over a third line's end point, or a gap of that width could close.
//! If an end point lies in the triangle A, P, B and not on the wall, both pieces are given up: the wall
//! no longer blocks there. What remains is the ordinary limit of a rounded model: a viewer who stands
//! within `reach` of a bent wall may be counted to the cell on the other side of it.

use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use sightlines_cells::{Plan, PlanLine};
use sightlines_geometry::{Aabb, Point2, Segment2, orient2d};

/// Lines that touch in common end points only.
#[derive(Debug, Clone, Default)]
pub struct Noded {
    /// Pieces of the plan's lines, each with the marks of its line. Pieces may repeat.
    pub pieces: Vec<PlanLine>,
    /// Crossings whose point had to be rounded off both lines.
    pub n_rounded_crossings: usize,
    /// Pieces of opaque lines that were given up.
    pub n_dropped_pieces: usize,
}

/// How often pieces of pieces are cut before those that still cross are given up. Crossings of bent
/// pieces need two lines within a rounding error of each other, so a second round is rare already.
const MAX_ROUNDS: usize = 8;

/// Cuts all lines of `plan` where they meet.
pub fn node(plan: &Plan) -> Noded {
    let mut noded = Noded { pieces: plan.lines().to_vec(), ..Noded::default() };
    for _ in 0..MAX_ROUNDS {
        let meetings = find_meetings(&noded.pieces);
        if meetings.is_empty() {
            return noded;
        }
        cut(&mut noded, &meetings);
    }
    give_up_crossings(&mut noded);
    noded
}

/// Two lines that meet elsewhere than in common end points.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    lines: [usize; 2],
    crossing: bool,
}

/// All pairs of lines that cross, overlap or touch. Sweep along x with the lines whose range is open;
/// O(n log n + pairs whose x-ranges overlap).
fn find_meetings(lines: &[PlanLine]) -> Vec<Meeting> {
    let boxes: Vec<Aabb<2>> = lines.iter().map(|l| Aabb::around([[l.a.x, l.a.y], [l.b.x, l.b.y]])).collect();
    let mut order: Vec<usize> = (0..lines.len()).collect();
    order.sort_by(|&i, &j| boxes[i].min[0].total_cmp(&boxes[j].min[0]).then(i.cmp(&j)));
    let mut open: Vec<usize> = Vec::new();
    let mut meetings = Vec::new();
    for &i in &order {
        open.retain(|&j| boxes[j].max[0] >= boxes[i].min[0]);
        for &j in &open {
            if boxes[j].max[1] >= boxes[i].min[1] && boxes[i].max[1] >= boxes[j].min[1] {
                meetings.extend(meeting(lines, j.min(i), j.max(i)));
            }
        }
        open.push(i);
    }
    meetings.sort_by_key(|m| m.lines);
    meetings
}

fn segment(l: &PlanLine) -> Segment2 {
    Segment2::new(l.a, l.b)
}

/// Whether `p` is on the segment but not one of its ends.
fn inside(s: &Segment2, p: Point2) -> bool {
    p != s.a && p != s.b && s.contains(p)
}

fn meeting(lines: &[PlanLine], i: usize, j: usize) -> Option<Meeting> {
    let (s, t) = (segment(&lines[i]), segment(&lines[j]));
    let crossing = s.crosses(&t);
    let touching = || inside(&s, t.a) || inside(&s, t.b) || inside(&t, s.a) || inside(&t, s.b);
    (crossing || touching()).then_some(Meeting { lines: [i, j], crossing })
}

/// Where a line is cut, and whether the point may be off the line.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    At(Point2),
    /// The line stops at the first point and goes on at the second.
    Gap(Point2, Point2),
}

fn cut(noded: &mut Noded, meetings: &[Meeting]) {
    let lines = std::mem::take(&mut noded.pieces);
    let mut cuts: Vec<Vec<Cut>> = vec![Vec::new(); lines.len()];
    for m in meetings {
        let [i, j] = m.lines;
        if m.crossing {
            let (cut_i, cut_j, rounded) = cuts_at_crossing(&lines[i], &lines[j]);
            cuts[i].extend(cut_i);
            cuts[j].extend(cut_j);
            noded.n_rounded_crossings += usize::from(rounded);
        } else {
            for (from, to) in [(i, j), (j, i)] {
                let s = segment(&lines[from]);
                let ends = [lines[to].a, lines[to].b];
                cuts[from].extend(ends.into_iter().filter(|&p| inside(&s, p)).map(Cut::At));
            }
        }
    }
    let ends: Vec<Point2> = lines.iter().flat_map(|l| [l.a, l.b]).collect();
    for (line, cuts) in lines.iter().zip(cuts) {
        if cuts.is_empty() {
            noded.pieces.push(*line);
        } else {
            let pieces = pieces(line, cuts);
            let (kept, dropped) = keep_clear_of(line, pieces, &ends);
            noded.pieces.extend(kept);
            noded.n_dropped_pieces += dropped;
        }
    }
}

/// The pieces of a line between its cuts.
fn pieces(line: &PlanLine, mut cuts: Vec<Cut>) -> Vec<PlanLine> {
    let d = line.b - line.a;
    let horizontal = d.x.abs() >= d.y.abs();
    let place = |p: Point2| if horizontal { p.x * d.x.signum() } else { p.y * d.y.signum() };
    let first = |c: &Cut| match *c {
        Cut::At(p) | Cut::Gap(p, _) => p,
    };
    cuts.sort_by(|c, e| {
        let (p, q) = (first(c), first(e));
        place(p).total_cmp(&place(q)).then(p.x.total_cmp(&q.x)).then(p.y.total_cmp(&q.y))
    });
    let mut from = line.a;
    let mut pieces = Vec::with_capacity(cuts.len() + 1);
    let mut piece = |a: Point2, b: Point2| {
        if a != b {
            pieces.push(PlanLine { a, b, ..*line });
        }
    };
    for cut in cuts {
        match cut {
            Cut::At(p) => {
                piece(from, p);
                from = p;
            }
            Cut::Gap(p, q) => {
                piece(from, p);
                from = q;
            }
        }
    }
    piece(from, line.b);
    pieces
}

/// Gives up the pieces of an opaque line whose bend may have swept over an end point.
fn keep_clear_of(line: &PlanLine, pieces: Vec<PlanLine>, ends: &[Point2]) -> (Vec<PlanLine>, usize) {
    let bent = |p: Point2| orient2d(line.a, line.b, p) != 0.0;
    if !line.opaque || !pieces.iter().any(|p| bent(p.b)) {
        return (pieces, 0);
    }
    let s = segment(line);
    let corners: Vec<Point2> = pieces.iter().flat_map(|p| [p.a, p.b]).collect();
    let swept = |piece: &PlanLine| {
        (bent(piece.a) || bent(piece.b))
            && ends.iter().any(|&v| !s.contains(v) && !corners.contains(&v) && between(line, piece, v))
    };
    let n = pieces.len();
    let kept: Vec<PlanLine> = pieces.into_iter().filter(|p| !swept(p)).collect();
    let dropped = n - kept.len();
    (kept, dropped)
}

/// Whether `v` may lie between a piece and the line it came from. Both are within a rounding error of
/// each other, so the test is one of sides: `v` is between if the two disagree about its side, or if it
/// lies on the piece.
fn between(line: &PlanLine, piece: &PlanLine, v: Point2) -> bool {
    let reach = Aabb::around([[piece.a.x, piece.a.y], [piece.b.x, piece.b.y]]);
    let slack = 4.0 * reach_of(piece.a).max(reach_of(piece.b));
    let near = (0..2).all(|k| reach.min[k] - slack <= [v.x, v.y][k] && [v.x, v.y][k] <= reach.max[k] + slack);
    let side = |a: Point2, b: Point2| {
        let o = orient2d(a, b, v);
        i8::from(o > 0.0) - i8::from(o < 0.0)
    };
    near && side(line.a, line.b) != side(piece.a, piece.b)
}

/// Bound on the distance between a point and its rounding to doubles: 2^-51 of the larger coordinate.
/// Each coordinate moves by at most half a unit in the last place, 2^-53 of itself rounded up to a
/// power of two, so by at most 2^-52 of itself; both together by less than 2^-51.
fn reach_of(p: Point2) -> f64 {
    p.x.abs().max(p.y.abs()) * 2.0 * f64::EPSILON
}

/// What two properly crossing lines are cut into, and whether a rounded point was needed.
fn cuts_at_crossing(l: &PlanLine, m: &PlanLine) -> (Option<Cut>, Option<Cut>, bool) {
    let p = rounded_crossing(l, m);
    let on = |line: &PlanLine| orient2d(line.a, line.b, p) == 0.0;
    let exact = on(l) && on(m);
    match (l.opaque, m.opaque) {
        (true, true) => {
            let p = if exact { p } else { near_end(l, m, reach_of(p)).unwrap_or(p) };
            let cut = |line: &PlanLine| (p != line.a && p != line.b).then_some(Cut::At(p));
            (cut(l), cut(m), !exact)
        }
        (true, false) if !on(l) => (None, Some(short_of(m, l, p)), true),
        (false, true) if !on(m) => (Some(short_of(l, m, p)), None, true),
        _ => (Some(Cut::At(p)), Some(Cut::At(p)), !exact),
    }
}

/// An end point of either line that is within 4 `reach` of the other line's carrier. The distance is
/// computed in doubles with a relative error far below the factor that is added to be safe.
fn near_end(l: &PlanLine, m: &PlanLine, reach: f64) -> Option<Point2> {
    let near = |end: Point2, line: &PlanLine| {
        let d = line.b - line.a;
        orient2d(line.a, line.b, end).abs() <= 8.0 * reach * d.length()
    };
    let candidates = [(l.a, m), (l.b, m), (m.a, l), (m.b, l)];
    candidates.into_iter().find(|&(end, line)| near(end, line)).map(|(end, _)| end)
}

/// Ends `line` just short of `wall` on both sides of their crossing near `p`.
fn short_of(line: &PlanLine, wall: &PlanLine, p: Point2) -> Cut {
    let stop = |end: Point2| {
        let side = orient2d(wall.a, wall.b, end) > 0.0;
        let on_side = |q: Point2| {
            let o = orient2d(wall.a, wall.b, q);
            if side { o > 0.0 } else { o < 0.0 }
        };
        // Steps of growing length towards the end point, which is on its own side.
        let steps = (0..52).rev().map(|k| p + (end - p) * 2f64.powi(-k));
        std::iter::once(p).chain(steps).find(|&q| on_side(q)).unwrap_or(end)
    };
    Cut::Gap(stop(line.a), stop(line.b))
}

/// The crossing of two lines, rounded to doubles; exactly on a line that is parallel to an axis.
fn rounded_crossing(l: &PlanLine, m: &PlanLine) -> Point2 {
    let r = |x: f64| BigRational::from_float(x).unwrap_or_else(BigRational::zero);
    let [ax, ay, bx, by] = [l.a.x, l.a.y, l.b.x, l.b.y].map(r);
    let [cx, cy, dx, dy] = [m.a.x, m.a.y, m.b.x, m.b.y].map(r);
    let (ux, uy) = (&bx - &ax, &by - &ay);
    let (vx, vy) = (&dx - &cx, &dy - &cy);
    // Not zero: the lines cross properly.
    let t = ((&cx - &ax) * &vy - (&cy - &ay) * &vx) / (&ux * &vy - &uy * &vx);
    let round = |x: BigRational| x.to_f64().unwrap_or(0.0);
    let x = [l, m].into_iter().find(|s| s.a.x == s.b.x).map_or_else(|| round(&ax + &t * &ux), |s| s.a.x);
    let y = [l, m].into_iter().find(|s| s.a.y == s.b.y).map_or_else(|| round(&ay + &t * &uy), |s| s.a.y);
    let tidy = |x: f64| sightlines_geometry::check_coordinate(x).unwrap_or(0.0);
    Point2::new(tidy(x), tidy(y))
}

/// Removes pieces until none cross or overlap any more, those that do not block first.
fn give_up_crossings(noded: &mut Noded) {
    loop {
        let meetings = find_meetings(&noded.pieces);
        let Some(m) = meetings.first() else { return };
        let victim = m.lines.into_iter().find(|&i| !noded.pieces[i].opaque).unwrap_or(m.lines[1]);
        noded.n_dropped_pieces += usize::from(noded.pieces[victim].opaque);
        noded.pieces.swap_remove(victim);
    }
}
