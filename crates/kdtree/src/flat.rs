//! Unions of rectangles of a plane, in scene units.

use crate::coplanar::FlatRect;
use crate::region::{Rect, covers, uncovered, unite};
use crate::union_find::UnionFind;

/// The coordinates of some rectangles of a plane, ascending and different.
struct FlatRanks {
    u: Vec<f64>,
    v: Vec<f64>,
}

impl FlatRanks {
    fn of(rects: &[FlatRect]) -> Self {
        let sorted = |mut all: Vec<f64>| {
            all.sort_unstable_by(f64::total_cmp);
            all.dedup();
            all
        };
        let u = sorted(rects.iter().flat_map(|r| r.u).collect());
        Self { u, v: sorted(rects.iter().flat_map(|r| r.v).collect()) }
    }

    fn rect(&self, r: &FlatRect) -> Rect {
        let rank = |all: &[f64], x: f64| all.partition_point(|&y| y < x) as u32;
        Rect { u: r.u.map(|x| rank(&self.u, x)), v: r.v.map(|x| rank(&self.v, x)) }
    }

    fn flat(&self, r: &Rect) -> FlatRect {
        FlatRect { u: r.u.map(|i| self.u[i as usize]), v: r.v.map(|i| self.v[i as usize]) }
    }
}

/// The union as disjoint rectangles; depends on the set of points alone.
pub(crate) fn united(rects: &[FlatRect]) -> Vec<FlatRect> {
    let ranks = FlatRanks::of(rects);
    let in_ranks: Vec<Rect> = rects.iter().map(|r| ranks.rect(r)).collect();
    unite(&in_ranks).iter().map(|r| ranks.flat(r)).collect()
}

/// What two unions have in common, as [`united`] would give it.
pub(crate) fn common(a: &[FlatRect], b: &[FlatRect]) -> Vec<FlatRect> {
    if a.is_empty() || b.is_empty() { Vec::new() } else { without(a, &without(a, b)) }
}

/// What one union has beyond the other, as [`united`] would give it.
pub(crate) fn without(a: &[FlatRect], b: &[FlatRect]) -> Vec<FlatRect> {
    if a.is_empty() || b.is_empty() {
        return united(a);
    }
    let ranks = FlatRanks::of(&[a, b].concat());
    let all = |ranks: &[f64]| [0, ranks.len() as u32 - 1];
    let within = Rect { u: all(&ranks.u), v: all(&ranks.v) };
    let in_ranks = |rects: &[FlatRect]| rects.iter().map(|r| ranks.rect(r)).collect::<Vec<_>>();
    let covered = [uncovered(within, &in_ranks(a)), in_ranks(b)].concat();
    uncovered(within, &covered).iter().map(|r| ranks.flat(r)).collect()
}

/// Whether the union of `rects` contains `section`. Exact.
pub(crate) fn covered_by(section: &FlatRect, rects: impl Iterator<Item = FlatRect>) -> bool {
    let clip = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
    let clipped = rects.map(|r| FlatRect { u: clip(r.u, section.u), v: clip(r.v, section.v) });
    let mut inside: Vec<FlatRect> = clipped.filter(|r| r.u[0] < r.u[1] && r.v[0] < r.v[1]).collect();
    inside.push(*section);
    let ranks = FlatRanks::of(&inside);
    let in_ranks: Vec<Rect> = inside.iter().map(|r| ranks.rect(r)).collect();
    let (whole, parts) = in_ranks.split_last().expect("the section itself");
    covers(*whole, unite(parts).into_iter())
}

/// The union without its small regions, and how many of them there were: connected regions whose box is
/// smaller than `size` along both directions. Regions that meet in a point only are two.
pub(crate) fn large_regions(rects: Vec<FlatRect>, size: f64) -> (Vec<FlatRect>, usize) {
    let large = |r: &FlatRect| r.u[1] - r.u[0] >= size || r.v[1] - r.v[0] >= size;
    if rects.iter().all(large) {
        return (rects, 0);
    }
    let ranks = FlatRanks::of(&rects);
    let in_ranks: Vec<Rect> = rects.iter().map(|r| ranks.rect(r)).collect();
    let parts = unite(&in_ranks);
    let mut regions = connected(&parts);
    let roots: Vec<usize> = (0..parts.len() as u32).map(|i| regions.root(i) as usize).collect();
    let mut boxes: Vec<Option<FlatRect>> = vec![None; parts.len()];
    let wider = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    for (part, &root) in parts.iter().map(|r| ranks.flat(r)).zip(&roots) {
        let around = boxes[root].map_or(part, |b| FlatRect { u: wider(b.u, part.u), v: wider(b.v, part.v) });
        boxes[root] = Some(around);
    }
    let is_large = |root: usize| boxes[root].as_ref().is_some_and(large);
    let kept = parts.iter().zip(&roots).filter(|(_, root)| is_large(**root)).map(|(r, _)| ranks.flat(r));
    (kept.collect(), boxes.iter().flatten().filter(|b| !large(b)).count())
}

/// Joins the parts of a union that share a border of positive length. As `unite` gives them, that is
/// where one part ends along `u` and another begins.
fn connected(parts: &[Rect]) -> UnionFind {
    let mut regions = UnionFind::new(parts.len());
    let mut by_end: Vec<u32> = (0..parts.len() as u32).collect();
    by_end.sort_unstable_by_key(|&i| (parts[i as usize].u[1], parts[i as usize].v));
    for ends in by_end.chunk_by(|&i, &j| parts[i as usize].u[1] == parts[j as usize].u[1]) {
        let at = parts[ends[0] as usize].u[1];
        let (mut begin, stop) = (parts.partition_point(|r| r.u[0] < at), parts.partition_point(|r| r.u[0] <= at));
        let mut ends = ends.iter().copied().peekable();
        while let Some(&i) = ends.peek().filter(|_| begin < stop) {
            let (a, b) = (parts[i as usize].v, parts[begin].v);
            if a[0].max(b[0]) < a[1].min(b[1]) {
                regions.join(i, begin as u32);
            }
            if a[1] < b[1] {
                ends.next();
            } else {
                begin += 1;
            }
        }
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(u: [f64; 2], v: [f64; 2]) -> FlatRect {
        FlatRect { u, v }
    }

    #[test]
    fn small_regions_are_left_out_as_a_whole() {
        // An L of three small rectangles, a small one that touches its corner, and a small one apart.
        let l = [rect([0., 1.], [0., 1.]), rect([1., 2.], [0., 1.]), rect([1., 2.], [1., 2.])];
        let others = [rect([2., 3.], [2., 3.]), rect([5., 6.], [0., 1.])];
        let all: Vec<FlatRect> = l.into_iter().chain(others).collect();
        let (kept, n_small) = large_regions(all.clone(), 2.0);
        assert_eq!((kept, n_small), (vec![rect([0., 1.], [0., 1.]), rect([1., 2.], [0., 2.])], 2));
        assert_eq!(large_regions(all.clone(), 1.0), (all.clone(), 0));
        assert_eq!(large_regions(all, 3.0), (vec![], 3));
    }

    #[test]
    fn sets_are_cut_from_each_other() {
        // A cross of two bars, and the same in pieces.
        let (wide, high) = (rect([0., 3.], [1., 2.]), rect([1., 2.], [0., 3.]));
        let middle = rect([1., 2.], [1., 2.]);
        assert_eq!(common(&[wide], &[high]), [middle]);
        assert_eq!(without(&[wide], &[high]), [rect([0., 1.], [1., 2.]), rect([2., 3.], [1., 2.])]);
        let pieces = [rect([0., 1.5], [1., 2.]), rect([1., 3.], [1., 2.])];
        assert_eq!((common(&pieces, &[high]), without(&[middle], &pieces)), (vec![middle], vec![]));
        assert_eq!((common(&[wide], &[]), without(&pieces, &[])), (vec![], vec![wide]));
    }

    #[test]
    fn coverage_is_decided() {
        let section = rect([0., 4.], [0., 2.]);
        let halves = [rect([-1., 2.], [0., 2.]), rect([2., 5.], [0., 2.])];
        assert!(covered_by(&section, halves.into_iter()));
        assert!(!covered_by(&section, halves.into_iter().take(1)));
        let gap = [halves[0], rect([2f64.next_up(), 4.], [0., 2.])];
        assert!(!covered_by(&section, gap.into_iter()));
        assert!(!covered_by(&section, std::iter::empty()));
    }
}
