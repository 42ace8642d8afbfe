//! Which plane divides a cell next.
//!
//! 1. Among the planes that faces cover all across the cell: the axis that has most of them (then the
//!    longer side of the cell, then the lower axis), and of that axis the lower median.
//! 2. Otherwise among the planes of which faces cover at least the share `tau`: the one that cleaves fewest
//!    pieces (then the one nearest to the lower median of its axis, then the lower axis, then the lower
//!    coordinate).
//! 3. Otherwise none: the cell is a leaf.
//!
//! Rule 1 is decided exactly. Only choices between two right answers, the length of sides and the
//! distance to a median, are made on rounded numbers; they are the same on every machine.
//! Only pieces inside the cell count: cleaving one on the cell's border costs nothing, because it no longer divides any
//! cell.

use crate::ranks::{Piece, RankBox, Ranks};
use crate::region::{Rect, covers};

/// Factor by which a rounded share is increased: the sum of n positive products loses at most a share of about n *
/// 2^-53 to rounding, so with up to 2^22 pieces a share equal to the threshold always splits.
const TIES_SPLIT: f64 = 1.0 + 1.0 / (1u64 << 30) as f64;

/// A plane inside a cell.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    axis: usize,
    rank: u32,
    spanning: bool,
}

/// The plane that divides `cell` next, as axis and rank.
///
/// * `pieces`: everything inside the cell, clipped to it, pieces of one plane next to each other in
///   ascending order of planes, without overlap.
///
/// O(n) for n pieces, as a rule; O(n log n) in cells that are long for their number of pieces.
pub(crate) fn choose<const D: usize>(
    ranks: &Ranks<D>,
    cell: &RankBox<D>,
    pieces: &[Piece<D>],
    tau: f64,
) -> Option<(usize, u32)> {
    let candidates = candidates(ranks, cell, pieces, tau);
    let spanning: Vec<Candidate> = candidates.iter().copied().filter(|c| c.spanning).collect();
    if spanning.is_empty() { least_cleaving(ranks, cell, pieces, &candidates) } else { median(ranks, cell, &spanning) }
}

/// The spanning planes and those obscured enough, ascending.
fn candidates<const D: usize>(ranks: &Ranks<D>, cell: &RankBox<D>, pieces: &[Piece<D>], tau: f64) -> Vec<Candidate> {
    let mut out = Vec::new();
    for group in pieces.chunk_by(|a, b| a.plane() == b.plane()) {
        let (axis, rank) = (usize::from(group[0].axis), group[0].plane().1);
        let spanning = covers(Rect::across(cell, axis), group.iter().map(|p| Rect::across(&p.extent, axis)));
        if spanning || tau == 0.0 || obscured_enough(ranks, cell, group, tau) {
            out.push(Candidate { axis, rank, spanning });
        }
    }
    out
}

/// Whether a plane's pieces cover at least the share `tau` of the cell's cross-section; a tie counts as covered.
fn obscured_enough<const D: usize>(ranks: &Ranks<D>, cell: &RankBox<D>, group: &[Piece<D>], tau: f64) -> bool {
    let axis = usize::from(group[0].axis);
    let covered: f64 = group.iter().map(|p| ranks.measure_across(&p.extent, axis)).sum();
    covered * TIES_SPLIT >= tau * ranks.measure_across(cell, axis)
}

fn median<const D: usize>(ranks: &Ranks<D>, cell: &RankBox<D>, spanning: &[Candidate]) -> Option<(usize, u32)> {
    let side = |axis: usize| ranks.value(axis, cell.hi[axis]) - ranks.value(axis, cell.lo[axis]);
    // The first of equals wins, so only what is strictly better may replace it.
    let better = |a: &[Candidate], b: &[Candidate]| {
        a.len() > b.len() || (a.len() == b.len() && side(a[0].axis) > side(b[0].axis))
    };
    let axes = spanning.chunk_by(|a, b| a.axis == b.axis);
    let best = axes.reduce(|best, next| if better(next, best) { next } else { best })?;
    let chosen = best[(best.len() - 1) / 2];
    Some((chosen.axis, chosen.rank))
}

fn least_cleaving<const D: usize>(
    ranks: &Ranks<D>,
    cell: &RankBox<D>,
    pieces: &[Piece<D>],
    candidates: &[Candidate],
) -> Option<(usize, u32)> {
    let mut best: Option<(u32, f64, usize, u32)> = None;
    for group in candidates.chunk_by(|a, b| a.axis == b.axis) {
        let axis = group[0].axis;
        let centre = ranks.value(axis, group[(group.len() - 1) / 2].rank);
        let planes: Vec<u32> = group.iter().map(|c| c.rank).collect();
        for (&rank, n) in planes.iter().zip(n_cleaved(cell, pieces, axis, &planes)) {
            let off_centre = (ranks.value(axis, rank) - centre).abs();
            // Candidates come in the order of the last two ties.
            if best.is_none_or(|(least, nearest, ..)| n < least || (n == least && off_centre < nearest)) {
                best = Some((n, off_centre, axis, rank));
            }
        }
    }
    best.map(|(_, _, axis, rank)| (axis, rank))
}

/// How many pieces each of `planes`, ascending ranks of `axis`, cleaves.
fn n_cleaved<const D: usize>(cell: &RankBox<D>, pieces: &[Piece<D>], axis: usize, planes: &[u32]) -> Vec<u32> {
    let ends = pieces.iter().filter(|p| usize::from(p.axis) != axis).map(|p| (p.extent.lo[axis], p.extent.hi[axis]));
    let (first, n_ranks) = (cell.lo[axis], (cell.hi[axis] - cell.lo[axis]) as usize + 1);
    if n_ranks <= 8 * pieces.len() {
        let by_rank = n_around(n_ranks, ends.map(|(lo, hi)| (lo - first + 1, hi - first)));
        planes.iter().map(|&rank| by_rank[(rank - first) as usize]).collect()
    } else {
        let slot = |rank: u32| planes.partition_point(|&plane| plane < rank) as u32;
        n_around(planes.len(), ends.map(|(lo, hi)| (slot(lo + 1), slot(hi))))
    }
}

/// In how many of the half-open `spans` each of `0..n` is.
fn n_around(n: usize, spans: impl Iterator<Item = (u32, u32)>) -> Vec<u32> {
    let mut steps = vec![0u32; n + 1];
    for (start, end) in spans {
        // The spans of a count never end more often than they began: wrapping is undone in the sum.
        steps[start as usize] = steps[start as usize].wrapping_add(1);
        steps[end as usize] = steps[end as usize].wrapping_sub(1);
    }
    steps.truncate(n);
    let mut sum = 0u32;
    steps.iter_mut().for_each(|step| {
        sum = sum.wrapping_add(*step);
        *step = sum;
    });
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::face::AxialFace;
    use crate::region::unite;
    use sightlines_geometry::Aabb;

    /// What the rules choose among upright (`x`) and level (`y`) walls, as axis and coordinate.
    fn chosen(bounds: [f64; 2], upright: &[[f64; 3]], level: &[[f64; 3]], tau: f64) -> Option<(usize, f64)> {
        let bounds = Aabb { min: [0.0; 2], max: bounds };
        let xs = upright.iter().map(|w| AxialFace::new(0, [w[0], w[1]], [w[0], w[2]]));
        let ys = level.iter().map(|w| AxialFace::new(1, [w[1], w[0]], [w[2], w[0]]));
        let faces: Vec<AxialFace<2>> = xs.chain(ys).collect();
        let (ranks, [pieces]) = Ranks::compress([&faces], &bounds);
        let pieces = crate::build::united(pieces);
        choose(&ranks, &ranks.whole(), &pieces, tau).map(|(axis, rank)| (axis, ranks.value(axis, rank)))
    }

    #[test]
    fn spanning_planes_come_first_and_the_median_of_them() {
        let upright: Vec<[f64; 3]> = [1., 3., 4., 9.].map(|x| [x, 0., 4.]).to_vec();
        assert_eq!(chosen([10., 4.], &upright, &[[2., 4., 9.], [1., 4., 9.]], 0.0), Some((0, 3.0)));
        let most = [[1., 0., 9.], [2., 0., 9.], [3., 0., 9.], [4., 0., 9.], [5., 0., 9.]];
        assert_eq!(chosen([9., 6.], &[[4., 0., 6.]], &most, 0.0), Some((1, 3.0)), "the axis with most planes");
    }

    #[test]
    fn ties_of_spanning_planes() {
        // Two crossing walls, both all across: the longer side is cut first, then the lower axis.
        assert_eq!(chosen([4., 9.], &[[2., 0., 9.]], &[[5., 0., 4.]], 0.0), Some((1, 5.0)));
        assert_eq!(chosen([4., 4.], &[[2., 0., 4.]], &[[3., 0., 4.]], 0.0), Some((0, 2.0)));
    }

    #[test]
    fn a_union_spans() {
        let parts = [[3., 0., 2.], [3., 2., 3.], [3., 1., 4.]];
        assert_eq!(chosen([9., 4.], &parts, &[[2., 4., 9.]], 1.0), Some((0, 3.0)));
        let gap = [[3., 0., 2.], [3., 2.0f64.next_up(), 4.]];
        assert_eq!(chosen([9., 4.], &gap, &[[2., 0., 9.]], 1.0), Some((1, 2.0)), "a gap of one ulp does not span");
    }

    #[test]
    fn else_the_plane_that_cleaves_least() {
        // x = 2 cleaves both level walls, x = 5 one, y = 1 and y = 3 none; y = 1 is the lower median.
        let (upright, level) = ([[2., 3.5, 4.], [5., 3.5, 4.]], [[1., 1., 6.], [3., 1., 4.]]);
        assert_eq!(chosen([9., 4.], &upright, &level, 0.0), Some((1, 1.0)));
        // x = 5 is as cheap as y = 1 and y = 3 now, but further from the median of its axis.
        let upright = [[2., 3.5, 4.], [5., 0.5, 3.5]];
        assert_eq!(chosen([9., 4.], &upright, &level, 0.0), Some((1, 1.0)));
        // Without the end of y = 1 behind it, x = 5 cleaves nothing.
        assert_eq!(chosen([9., 4.], &upright, &[[1., 1., 4.5], [3., 1., 4.]], 0.0), Some((0, 5.0)));
    }

    #[test]
    fn the_threshold_is_met_by_ties() {
        // 0.1 + 0.2 of a cross-section of 0.6, and 3 of 30.
        assert_eq!(chosen([1., 0.6], &[[0.5, 0.0, 0.1], [0.5, 0.3, 0.5]], &[], 0.5), Some((0, 0.5)));
        assert_eq!(chosen([1., 30.], &[[0.5, 0.0, 3.0]], &[], 0.1), Some((0, 0.5)));
        assert_eq!(chosen([1., 30.], &[[0.5, 0.0, 3.0]], &[], 0.11), None);
        assert_eq!(chosen([1., 30.], &[], &[], 0.0), None);
    }

    #[test]
    fn both_ways_of_counting_agree() {
        let level: Vec<[f64; 3]> =
            (0..40).map(f64::from).map(|i| [i / 2. + 0.5, i % 7., i % 7. + i % 5. + 1.]).collect();
        let faces: Vec<AxialFace<2>> = level.iter().map(|w| AxialFace::new(1, [w[1], w[0]], [w[2], w[0]])).collect();
        let (ranks, [pieces]) = Ranks::compress([&faces], &Aabb { min: [0.0; 2], max: [99.0; 2] });
        let cell = ranks.whole();
        let planes: Vec<u32> = (1..cell.hi[0]).collect();
        let dense = n_cleaved(&cell, &pieces, 0, &planes);
        let plain = |rank: &u32| pieces.iter().filter(|p| p.extent.lo[0] < *rank && *rank < p.extent.hi[0]).count();
        assert_eq!(dense, planes.iter().map(|r| plain(r) as u32).collect::<Vec<_>>());
        // The same pieces in a cell so long that counting goes by planes.
        let long = RankBox { lo: cell.lo, hi: [9999, cell.hi[1]] };
        assert_eq!(n_cleaved(&long, &pieces, 0, &planes), dense);
        assert_eq!(unite(&[]), []);
    }
}
