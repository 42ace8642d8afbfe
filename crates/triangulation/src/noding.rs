//! Cutting lines where they meet, so that they only touch in common end points.
//!
//! Where an end point lies on another line (exactly: a T-junction, an overlap, a repetition), that
//! line is cut there; no new point is made. Where two lines cross properly in a point X, a point P is
//! needed that both can be cut at. Distances below are in terms of `reach`, 2^-49 max(|x|, |y|) at P.
//!
//! * If X is a pair of doubles, as for axis-parallel lines, P is X.
//! * Otherwise P is one of the doubles around X, at most `reach` away, and preferably one on a line that
//!   blocks.
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
//! * *Two lines that do not block.* No sight is lost.
//!
//! A bent wall must not sweep over a third line's end point, or a gap of that width could close. P is
//! chosen so that none lies between a wall and its bent pieces; where no choice avoids it, the piece that
//! sweeps over it no longer blocks.
//!
//! The pieces are then treated as lines and cut again until nothing crosses. The argument holds for each round, with
//! the walls of the previous round as the true ones, and therefore for all rounds.
//!
//! Regions narrower than `reach` may vanish where a rounded crossing is next to an end or to another
//! crossing, and with them a side that names a group. So the lines that meet there name all their groups
//! on both sides ([`Noded::extra`]).
//!
//! # Joints
//! Where a plan has joints (see [`Plan::joined`]), an end that misses a wall by no more than 8 `reach` becomes a corner of that wall, which is
//! bent through it, and ends that miss each other by so little become one corner. Any other joint is a piece of its own; one that leads to the
//! inside of a wall ends where the wall is cut for it. All this is done once, before lines are cut again, so what was joined meets in common
//! corners and stays so. Within `reach`, which is a sixteenth of the least gap at most, nothing is then swept over that is not joined: ends that near to a
//! wall are joined to it, or hang together with it beside an opening narrower than the gap.
//!
//! What remains is the ordinary limit of a rounded model: a viewer within `reach` of a bent wall may be located in the
//! cell on its other side.

use crate::TriangulationError;
use crate::crossing::cuts_at_crossing;
use crate::grid::{PointGrid, SegmentGrid};
use crate::joined::Joined;
use crate::piece::{Cut, reach_of, sweeps};

pub use crate::piece::{JOINT, Piece};
use sightlines_cells::Plan;
use sightlines_geometry::{Point2, Segment2};

/// Lines that touch in common end points only.
#[derive(Debug, Clone, Default)]
pub struct Noded {
    /// Pieces of the plan's lines. Pieces may repeat.
    pub pieces: Vec<Piece>,
    /// For each line, groups that both of its sides name in addition to their own; ascending.
    pub extra: Vec<Vec<u32>>,
    /// Groups that count as present everywhere, because the piece that named them was removed.
    pub everywhere: Vec<u32>,
    /// Crossings whose point had to be rounded off a line.
    pub n_rounded_crossings: usize,
    /// Pieces of opaque lines that no longer block.
    pub n_dropped_pieces: usize,
}

/// Number of rounds of cutting, after which pieces that still cross are removed. Bent pieces cross only if two lines
/// are within a rounding error of each other, so even a second round is rare.
const MAX_ROUNDS: usize = 8;

/// Largest number of places where lines meet; each makes up to four pieces.
pub const MAX_MEETINGS: usize = 1 << 19;

/// Cuts all lines of `plan` where they meet. Cost: O(n sqrt(n)) for n lines of any length, plus the
/// places where they meet.
///
/// # Errors
/// [`TriangulationError::TooManyMeetings`] beyond [`MAX_MEETINGS`].
pub fn node(plan: &Plan) -> Result<Noded, TriangulationError> {
    let piece = |(line, l): (u32, &sightlines_cells::PlanLine)| Piece { a: l.a, b: l.b, opaque: l.opaque, line };
    let mut noded = Noded {
        pieces: (0..).zip(plan.lines()).map(piece).collect(),
        extra: vec![Vec::new(); plan.lines().len()],
        ..Noded::default()
    };
    let mut joined = Joined::new(plan);
    for _ in 0..MAX_ROUNDS {
        let meetings = find_meetings(&noded.pieces)?;
        if meetings.is_empty() && joined.is_empty() {
            tidy(&mut noded);
            return Ok(noded);
        }
        cut(plan, &mut noded, &meetings, &std::mem::take(&mut joined));
    }
    give_up_crossings(plan, &mut noded)?;
    tidy(&mut noded);
    Ok(noded)
}

fn tidy(noded: &mut Noded) {
    for list in noded.extra.iter_mut().chain([&mut noded.everywhere]) {
        list.sort_unstable();
        list.dedup();
    }
}

/// Two lines that meet elsewhere than in common end points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Meeting {
    lines: [usize; 2],
    crossing: bool,
}

/// All pairs of pieces that cross, overlap or touch, in order.
fn find_meetings(pieces: &[Piece]) -> Result<Vec<Meeting>, TriangulationError> {
    let segments: Vec<Segment2> = pieces.iter().map(Piece::segment).collect();
    let boxes: Vec<[Point2; 2]> = segments.iter().map(|s| [s.a.min(s.b), s.a.max(s.b)]).collect();
    let grid = SegmentGrid::new(&segments);
    let mut meetings = Vec::new();
    for bucket in grid.buckets() {
        for (k, &i) in bucket.iter().enumerate() {
            let [lo, hi] = boxes[i as usize];
            for &j in &bucket[..k] {
                let [low, high] = boxes[j as usize];
                if low.x <= hi.x && lo.x <= high.x && low.y <= hi.y && lo.y <= high.y {
                    meetings.extend(meeting(&segments, j as usize, i as usize));
                }
            }
        }
        // A pair may share buckets: four on average is plenty.
        if meetings.len() > 4 * MAX_MEETINGS {
            meetings.sort_unstable();
            meetings.dedup();
            if meetings.len() > MAX_MEETINGS {
                return Err(TriangulationError::TooManyMeetings { limit: MAX_MEETINGS });
            }
        }
    }
    meetings.sort_unstable();
    meetings.dedup();
    if meetings.len() > MAX_MEETINGS {
        return Err(TriangulationError::TooManyMeetings { limit: MAX_MEETINGS });
    }
    Ok(meetings)
}

/// Whether `p` is on the segment but not one of its ends.
fn inside(s: &Segment2, p: Point2) -> bool {
    p != s.a && p != s.b && s.contains(p)
}

fn meeting(segments: &[Segment2], i: usize, j: usize) -> Option<Meeting> {
    let (s, t) = (&segments[i], &segments[j]);
    let crossing = s.crosses(t);
    let touching = || inside(s, t.a) || inside(s, t.b) || inside(t, s.a) || inside(t, s.b);
    (crossing || touching()).then_some(Meeting { lines: [i, j], crossing })
}

fn cut(plan: &Plan, noded: &mut Noded, meetings: &[Meeting], joined: &Joined) {
    let lines = std::mem::take(&mut noded.pieces);
    let ends = PointGrid::new(lines.iter().flat_map(|l| [l.a, l.b]));
    let mut cuts: Vec<Vec<Cut>> = vec![Vec::new(); lines.len()];
    let mut crossings: Vec<Vec<(Point2, usize)>> = vec![Vec::new(); lines.len()];
    for m in meetings {
        let [i, j] = m.lines;
        if m.crossing {
            let found = cuts_at_crossing(&lines[i], &lines[j], &ends);
            cuts[i].extend(found.cuts[0]);
            cuts[j].extend(found.cuts[1]);
            if found.rounded {
                noded.n_rounded_crossings += 1;
                crossings[i].push((found.at, j));
                crossings[j].push((found.at, i));
            }
        } else {
            for (from, to) in [(i, j), (j, i)] {
                let s = lines[from].segment();
                let on = [lines[to].a, lines[to].b].into_iter().filter(|&p| inside(&s, p));
                cuts[from].extend(on.map(Cut::At));
            }
        }
    }
    joined.cuts.iter().for_each(|&(line, at)| cuts[line as usize].push(Cut::At(at)));
    for (i, near) in crossings.iter_mut().enumerate() {
        blur_crowds(plan, &mut noded.extra, &lines, i, near);
    }
    for (line, cuts) in lines.iter().zip(cuts) {
        for mut piece in pieces(line, cuts) {
            if piece.opaque && plan.joints().is_empty() && sweeps(line, &piece, &ends) {
                piece.opaque = false;
                noded.n_dropped_pieces += 1;
            }
            (piece.a, piece.b) = (joined.corner(piece.a), joined.corner(piece.b));
            noded.pieces.extend(Some(piece).filter(|piece| piece.a != piece.b));
        }
    }
    noded.pieces.extend(&joined.pieces);
}

/// Makes lines name all their groups on both sides where rounding may swallow a region: where a rounded
/// crossing is next to another one on the same line, or next to an end of one of its lines.
fn blur_crowds(plan: &Plan, extra: &mut [Vec<u32>], lines: &[Piece], own: usize, crossings: &mut [(Point2, usize)]) {
    crossings.sort_by(|(p, i), (q, j)| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(i.cmp(j)));
    let next_to = |p: Point2, q: Point2| p.distance(q) <= 8.0 * reach_of(p);
    for &(p, other) in crossings.iter() {
        let ends = [lines[own].a, lines[own].b, lines[other].a, lines[other].b];
        if ends.into_iter().any(|end| next_to(p, end)) {
            blur(plan, extra, &[lines[own].line, lines[other].line]);
        }
    }
    // Along a line, lexicographic order is the order of the line, but for rounding along an axis.
    for pair in crossings.windows(2) {
        if next_to(pair[0].0, pair[1].0) {
            blur(plan, extra, &[lines[own].line, lines[pair[0].1].line, lines[pair[1].1].line]);
        }
    }
}

/// Makes lines name all their groups on both sides.
fn blur(plan: &Plan, extra: &mut [Vec<u32>], lines: &[u32]) {
    let lines = || lines.iter().filter(|&&line| line != JOINT);
    let side = |l: &u32| [plan.lines()[*l as usize].left, plan.lines()[*l as usize].right];
    let names: Vec<u32> = lines().flat_map(side).flatten().collect();
    for &line in lines() {
        extra[line as usize].extend(&names);
    }
}

/// The pieces of a line between its cuts.
fn pieces(line: &Piece, mut cuts: Vec<Cut>) -> Vec<Piece> {
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
            pieces.push(Piece { a, b, ..*line });
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

/// Removes pieces until none cross or overlap. Their groups count as present everywhere.
fn give_up_crossings(plan: &Plan, noded: &mut Noded) -> Result<(), TriangulationError> {
    loop {
        let meetings = find_meetings(&noded.pieces)?;
        if meetings.is_empty() {
            return Ok(());
        }
        let mut gone = vec![false; noded.pieces.len()];
        for m in &meetings {
            if m.lines.iter().any(|&i| gone[i]) {
                continue;
            }
            let victim = m.lines.into_iter().find(|&i| !noded.pieces[i].opaque).unwrap_or(m.lines[1]);
            let piece = noded.pieces[victim];
            if piece.line != JOINT {
                let line = &plan.lines()[piece.line as usize];
                noded.everywhere.extend([line.left, line.right].into_iter().flatten());
                noded.everywhere.extend(&noded.extra[piece.line as usize]);
            }
            noded.n_dropped_pieces += usize::from(piece.opaque);
            gone[victim] = true;
        }
        let mut kept = gone.iter();
        noded.pieces.retain(|_| kept.next() == Some(&false));
    }
}
