//! Regions of a cross-section: unions of rectangles, in ranks.
//!
//! Both dimensions share this code. The cross-section of a planar scene is a line; its intervals are
//! rectangles whose second extent is `[0, 1]`.

use crate::face::across;
use crate::ranks::RankBox;

/// A rectangle in ranks, of positive extent along both directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rect {
    /// Along the lower of the axes across.
    pub(crate) u: [u32; 2],
    /// Along the other one.
    pub(crate) v: [u32; 2],
}

impl Rect {
    /// The extent of a box across `axis`.
    pub(crate) fn across<const D: usize>(extent: &RankBox<D>, axis: usize) -> Self {
        let mut spans = across::<D>(axis).map(|k| [extent.lo[k], extent.hi[k]]);
        Self { u: spans.next().unwrap_or([0, 1]), v: spans.next().unwrap_or([0, 1]) }
    }

    /// The box on the plane of `axis` at `rank` with this extent across: the reverse of [`Self::across`].
    pub(crate) fn on_plane<const D: usize>(self, axis: usize, rank: u32) -> RankBox<D> {
        let mut out = RankBox { lo: [rank; D], hi: [rank; D] };
        for (k, [lo, hi]) in across::<D>(axis).zip([self.u, self.v]) {
            (out.lo[k], out.hi[k]) = (lo, hi);
        }
        out
    }

    /// What two rectangles have in common, if that has positive measure.
    pub(crate) fn common(self, other: Self) -> Option<Self> {
        let span = |a: [u32; 2], b: [u32; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        let (u, v) = (span(self.u, other.u), span(self.v, other.v));
        (u[0] < u[1] && v[0] < v[1]).then_some(Self { u, v })
    }

    /// How many unit squares of ranks it has. Below 2^64, as ranks are below 2^32.
    pub(crate) fn n_squares(self) -> u64 {
        u64::from(self.u[1] - self.u[0]) * u64::from(self.v[1] - self.v[0])
    }
}

/// Whether rectangles inside `section` that do not overlap cover all of it. Exact: disjoint pieces
/// cover if and only if they have as many unit squares of ranks. O(n).
pub(crate) fn covers(section: Rect, disjoint: impl Iterator<Item = Rect>) -> bool {
    disjoint.map(Rect::n_squares).sum::<u64>() == section.n_squares()
}

/// The union of `rects` as disjoint rectangles: slabs along `u`, as long as the section of the union
/// stays the same. Depends on the set of points only, not on how it was given. In a planar scene: the
/// maximal intervals. At most O(n) slabs of O(n) pieces; O(n log n) where few rectangles share a `u`.
pub(crate) fn unite(rects: &[Rect]) -> Vec<Rect> {
    slabs(rects, |union| union)
}

/// The part of `within` that no rectangle covers, as [`unite`] would give it.
pub(crate) fn uncovered(within: Rect, rects: &[Rect]) -> Vec<Rect> {
    let mut inside: Vec<Rect> = rects.iter().filter_map(|r| r.common(within)).collect();
    // A strip without height covers nothing, but makes the sweep run from end to end of `within`.
    inside.push(Rect { u: within.u, v: [within.v[0]; 2] });
    slabs(&inside, |union| gaps(within.v, &union))
}

/// Sweeps along `u`. `section` turns the union's spans along `v` in a slab into the spans wanted.
fn slabs(rects: &[Rect], section: impl Fn(Vec<[u32; 2]>) -> Vec<[u32; 2]>) -> Vec<Rect> {
    let mut by_start = rects.to_vec();
    by_start.sort_unstable();
    let mut cuts: Vec<u32> = rects.iter().flat_map(|r| r.u).collect();
    cuts.sort_unstable();
    cuts.dedup();
    let (mut done, mut open, mut active) = (Vec::new(), Vec::<Rect>::new(), Vec::<Rect>::new());
    let mut coming = by_start.into_iter().peekable();
    for slab in cuts.windows(2) {
        let slab = [slab[0], slab[1]];
        active.retain(|r| r.u[1] > slab[0]);
        while let Some(rect) = coming.next_if(|r| r.u[0] <= slab[0]) {
            active.push(rect);
        }
        let spans = section(merged(active.iter().map(|r| r.v).collect()));
        open = continued(open, slab, &spans, &mut done);
    }
    done.append(&mut open);
    done.sort_unstable();
    done
}

/// Extends by a slab the open rectangles whose span is among `spans`, ends the others, opens the rest.
fn continued(open: Vec<Rect>, slab: [u32; 2], spans: &[[u32; 2]], done: &mut Vec<Rect>) -> Vec<Rect> {
    let (kept, ended): (Vec<Rect>, Vec<Rect>) = open.into_iter().partition(|r| spans.binary_search(&r.v).is_ok());
    done.extend(ended);
    let before = |v: &[u32; 2]| kept.binary_search_by_key(v, |r| r.v).map_or(slab[0], |i| kept[i].u[0]);
    spans.iter().map(|v| Rect { u: [before(v), slab[1]], v: *v }).collect()
}

/// The union of closed spans, ascending; spans without length vanish.
fn merged(mut spans: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    spans.retain(|s| s[0] < s[1]);
    spans.sort_unstable();
    let mut out: Vec<[u32; 2]> = Vec::with_capacity(spans.len());
    for span in spans {
        match out.last_mut() {
            Some(last) if span[0] <= last[1] => last[1] = last[1].max(span[1]),
            _ => out.push(span),
        }
    }
    out
}

/// What ascending disjoint spans leave of `within`.
fn gaps(within: [u32; 2], spans: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let starts = std::iter::once(within[0]).chain(spans.iter().map(|s| s[1]));
    let ends = spans.iter().map(|s| s[0]).chain([within[1]]);
    starts.zip(ends).map(|(a, b)| [a, b]).filter(|s| s[0] < s[1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rect() -> impl Strategy<Value = Rect> {
        let span = || (0u32..6, 1u32..4).prop_map(|(lo, n)| [lo, (lo + n).min(6)]);
        (span(), span()).prop_map(|(u, v)| Rect { u, v })
    }

    fn squares(rects: &[Rect]) -> Vec<usize> {
        let has = |r: &Rect, u, v| (r.u[0]..r.u[1]).contains(&u) && (r.v[0]..r.v[1]).contains(&v);
        (0..36).map(|i| rects.iter().filter(|r| has(r, i / 6, i % 6)).count()).collect()
    }

    proptest! {
        /// Invariant: the pieces cover what the rectangles cover, once.
        #[test]
        fn union_is_the_same_set_without_overlap(rects in prop::collection::vec(rect(), 0..8)) {
            let pieces = unite(&rects);
            let want: Vec<usize> = squares(&rects).into_iter().map(|n| n.min(1)).collect();
            prop_assert_eq!(squares(&pieces), want);
        }

        /// Invariant: how a set was given does not matter.
        #[test]
        fn union_is_canonical(rects in prop::collection::vec(rect(), 0..8)) {
            let units: Vec<Rect> = (0..36u32).filter(|&i| squares(&rects)[i as usize] > 0)
                .map(|i| Rect { u: [i / 6, i / 6 + 1], v: [i % 6, i % 6 + 1] }).collect();
            let pieces = unite(&rects);
            prop_assert_eq!(&unite(&units), &pieces);
            prop_assert_eq!(&unite(&pieces), &pieces);
        }

        /// Invariant: rectangles and what they leave tile the window.
        #[test]
        fn uncovered_is_the_complement(rects in prop::collection::vec(rect(), 0..8), within in rect()) {
            let free = uncovered(within, &rects);
            let (inside, covered, left) = (squares(&[within]), squares(&rects), squares(&free));
            for i in 0..36 {
                prop_assert_eq!(left[i], usize::from(inside[i] > 0 && covered[i] == 0));
            }
            prop_assert!(free.len() <= 4 * rects.len() + 1, "{} pieces", free.len());
            let clipped: Vec<Rect> = rects.iter().filter_map(|r| r.common(within)).collect();
            prop_assert_eq!(covers(within, unite(&clipped).into_iter()), free.is_empty());
        }
    }

    #[test]
    fn counting_squares_needs_disjoint_pieces() {
        // The impostor: without uniting first, a rectangle given twice would seem to cover both halves.
        let (half, whole) = (Rect { u: [0, 1], v: [0, 1] }, Rect { u: [0, 2], v: [0, 1] });
        assert!(covers(whole, [half, half].into_iter()));
        assert!(!covers(whole, unite(&[half, half]).into_iter()));
    }
}
