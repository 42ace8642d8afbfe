//! Rectangles inside the union of coplanar triangles.
//!
//! Each triangle is turned counter-clockwise. The edges of all triangles together wind around a point as often as
//! triangles cover it. Two edges that run back and forth between the same two corners
//! cancel, so what is left is the outline of the mesh, with the same winding. Slab by slab between its
//! corners, the winding is bounded from below: an edge that adds to it counts where it has been passed
//! all across the slab, one that takes away counts wherever it may have been passed. Where the bound is
//! positive, the triangles cover everything, and the rectangles lie there.
//!
//! Every coordinate of a rectangle is one of an end of an axis-parallel edge of the outline; the exact predicate
//! decides whether a slanted edge has been passed. So no rectangle sticks out, not by one unit in the last place, and
//! an outline without slanted edges is filled completely. Ends of slanted edges give no coordinates: a round outline
//! would fall into as many splinters as it has corners, each of which would hide next to nothing and cost a piece of a
//! portal.

use crate::union_find::UnionFind;
use sightlines_geometry::{Point2, orient2d};

/// A rectangle of a plane, of positive extent along both directions, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FlatRect {
    /// Along the lower of the axes across the plane's.
    pub(crate) u: [f64; 2],
    /// Along the other one.
    pub(crate) v: [f64; 2],
}

/// Rectangles that the union of `triangles` covers completely. Triangles without area are ignored.
///
/// Complete for meshes whose outline is axis-parallel. Else errs by covering less: near slanted parts of
/// an outline, and along a slanted edge that one of its two neighbours divides further.
///
/// O(n log n) to find outlines; then, for each mesh, its slabs times the edges that cross a slab.
pub(crate) fn inner_rectangles(triangles: &[[Point2; 3]]) -> Vec<FlatRect> {
    let mut out = Vec::new();
    for mesh in outlines(triangles).chunk_by(|a, b| a.mesh == b.mesh) {
        fill(mesh, &mut out);
    }
    out
}

/// A piece of an outline, from left (`a`) to right (`b`); if upright, from low to high.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// The mesh it belongs to: the least of its corners.
    mesh: u32,
    a: Point2,
    b: Point2,
    /// By how much the winding grows across it, upwards.
    step: i32,
}

/// The outlines of all meshes, mesh by mesh. A mesh consists of triangles connected by their corners; each is treated
/// alone, so that a distant mesh does not cut another into slabs.
fn outlines(triangles: &[[Point2; 3]]) -> Vec<Edge> {
    let turned: Vec<[Point2; 3]> = triangles.iter().filter_map(|t| counter_clockwise(*t)).collect();
    let (corners, ids) = welded(&turned);
    let mut meshes = UnionFind::new(corners.len());
    for [a, b, c] in &ids {
        meshes.join(*a, *b);
        meshes.join(*a, *c);
    }
    // Corners are numbered from left to right, then upwards.
    let sides = ids.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut sides: Vec<(u32, u32, i32)> = sides.map(|(a, b)| if a < b { (a, b, 1) } else { (b, a, -1) }).collect();
    sides.sort_unstable();
    let sums = sides.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)).filter_map(|same| {
        let (a, b) = (corners[same[0].0 as usize], corners[same[0].1 as usize]);
        let step = same.iter().map(|s| s.2).sum();
        (step != 0).then_some((same[0].0, Edge { mesh: 0, a, b, step }))
    });
    let mut edges: Vec<Edge> = sums.map(|(corner, e)| Edge { mesh: meshes.root(corner), ..e }).collect();
    edges.sort_by_key(|e| e.mesh);
    edges
}

fn counter_clockwise([a, b, c]: [Point2; 3]) -> Option<[Point2; 3]> {
    match orient2d(a, b, c) {
        turn if turn > 0.0 => Some([a, b, c]),
        turn if turn < 0.0 => Some([a, c, b]),
        _ => None,
    }
}

/// All different corners, from left to right, then upwards; and the triangles as their numbers.
fn welded(triangles: &[[Point2; 3]]) -> (Vec<Point2>, Vec<[u32; 3]>) {
    let order = |p: &Point2, q: &Point2| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y));
    let mut corners: Vec<Point2> = triangles.iter().flatten().copied().collect();
    corners.sort_unstable_by(order);
    corners.dedup();
    let number = |p: Point2| corners.partition_point(|q| order(q, &p).is_lt()) as u32;
    let ids = triangles.iter().map(|t| t.map(number)).collect();
    (corners, ids)
}

fn sorted(coordinates: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = coordinates.collect();
    all.sort_unstable_by(f64::total_cmp);
    all.dedup();
    all
}

/// Fills one outline, from left to right. Between the ends of axis-parallel edges there may be ends of
/// slanted ones: a rectangle is what is covered all along.
fn fill(outline: &[Edge], out: &mut Vec<FlatRect>) {
    let axial = || outline.iter().filter(|e| e.a.x == e.b.x || e.a.y == e.b.y).flat_map(|e| [e.a, e.b]);
    let stops = sorted(axial().map(|p| p.x));
    let levels = sorted(axial().map(|p| p.y));
    let mut sweep = Sweep::new(outline, &stops);
    let mut open = Vec::new();
    for slab in stops.windows(2) {
        let slab = [slab[0], slab[1]];
        let spans = sweep.covered_up_to(slab[1], slab[0], &levels);
        let spans: Vec<[f64; 2]> = spans.into_iter().map(|s| s.map(|level| levels[level])).collect();
        open = prolonged(open, slab, &spans, out);
    }
    out.append(&mut open);
}

/// A sweep over an outline, from left to right, by the ends of all of its edges.
struct Sweep<'a> {
    cuts: Vec<f64>,
    /// The slab that is next, from one cut to the following.
    next: usize,
    /// Edges to come, by their left ends.
    coming: std::iter::Peekable<std::vec::IntoIter<&'a Edge>>,
    /// The edges that cross the last slab.
    active: Vec<&'a Edge>,
}

impl<'a> Sweep<'a> {
    /// Stops at every level where a call of [`Self::covered_up_to`] ends.
    fn new(outline: &'a [Edge], stops: &[f64]) -> Self {
        let mut edges: Vec<&Edge> = outline.iter().filter(|e| e.a.x < e.b.x).collect();
        edges.sort_by(|e, f| e.a.x.total_cmp(&f.a.x));
        let cuts = sorted(edges.iter().flat_map(|e| [e.a.x, e.b.x]).chain(stops.iter().copied()));
        Self { cuts, next: 0, coming: edges.into_iter().peekable(), active: Vec::new() }
    }

    /// Where the winding is positive all along from `from` to `to`: ascending disjoint spans of levels.
    /// Each call continues where the last one ended.
    fn covered_up_to(&mut self, to: f64, from: f64, levels: &[f64]) -> Vec<[usize; 2]> {
        let mut along: Option<Vec<[usize; 2]>> = None;
        while let Some(&[left, right]) = self.cuts.get(self.next..self.next + 2).filter(|slab| slab[0] < to) {
            self.next += 1;
            self.active.retain(|e| e.b.x > left);
            while let Some(edge) = self.coming.next_if(|e| e.a.x <= left) {
                self.active.push(edge);
            }
            if left >= from && along.as_ref().is_none_or(|spans| !spans.is_empty()) {
                let here = covered(&self.active, [left, right], levels);
                along = Some(along.map_or_else(|| here.clone(), |before| common(&before, &here)));
            }
        }
        along.unwrap_or_default()
    }
}

/// What two lists of ascending disjoint spans have in common, where it has a length.
fn common(a: &[[usize; 2]], b: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let (mut i, mut j, mut out) = (0, 0, Vec::new());
    while i < a.len() && j < b.len() {
        let span = [a[i][0].max(b[j][0]), a[i][1].min(b[j][1])];
        if span[0] < span[1] {
            out.push(span);
        }
        if a[i][1] < b[j][1] { i += 1 } else { j += 1 }
    }
    out
}

/// Where the winding is positive all across a slab: ascending disjoint spans of levels.
fn covered(active: &[&Edge], slab: [f64; 2], levels: &[f64]) -> Vec<[usize; 2]> {
    let steps = active.iter().map(|e| (e.level(slab, levels), e.step));
    // An edge that adds, but not below the last level, counts nowhere.
    let mut steps: Vec<(usize, i32)> = steps.filter(|s| s.0 < levels.len()).collect();
    steps.sort_unstable();
    let (mut winding, mut from, mut spans) = (0, None, Vec::new());
    for same in steps.chunk_by(|s, t| s.0 == t.0) {
        winding += same.iter().map(|s| s.1).sum::<i32>();
        match from {
            None if winding > 0 => from = Some(same[0].0),
            Some(start) if winding <= 0 => {
                spans.push([start, same[0].0]);
                from = None;
            }
            _ => {}
        }
    }
    spans
}

impl Edge {
    /// The level from which on the edge counts in a slab that it crosses: the lowest one that is nowhere
    /// below the edge if it adds, the number of levels if there is none; the highest one that is nowhere
    /// above it if it takes away, the lowest of all if there is none.
    fn level(&self, [left, right]: [f64; 2], levels: &[f64]) -> usize {
        let rising = self.b.y > self.a.y;
        let side = |x: f64, y: f64| orient2d(self.a, self.b, Point2::new(x, y));
        if self.a.y == self.b.y {
            levels.partition_point(|&y| y < self.a.y)
        } else if self.step > 0 {
            levels.partition_point(|&y| side(if rising { right } else { left }, y) < 0.0)
        } else {
            levels.partition_point(|&y| side(if rising { left } else { right }, y) <= 0.0).saturating_sub(1)
        }
    }
}

/// Extends by a slab the open rectangles whose span is among `spans`, ends the others, opens the rest.
fn prolonged(open: Vec<FlatRect>, slab: [f64; 2], spans: &[[f64; 2]], done: &mut Vec<FlatRect>) -> Vec<FlatRect> {
    let (mut next, mut old) = (Vec::with_capacity(spans.len()), open.into_iter().peekable());
    for &v in spans {
        // Both lists ascend; spans of one slab do not overlap, so the lower end identifies them.
        while let Some(ended) = old.next_if(|r| r.v[0] < v[0]) {
            done.push(ended);
        }
        let same = old.next_if(|r| r.v == v);
        next.push(FlatRect { u: [same.map_or(slab[0], |r| r.u[0]), slab[1]], v });
    }
    done.extend(old);
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> Point2 {
        Point2::new(x, y)
    }

    fn rect(u: [f64; 2], v: [f64; 2]) -> FlatRect {
        FlatRect { u, v }
    }

    #[test]
    fn two_triangles_are_a_rectangle() {
        let corners = [p(0., 0.), p(4., 0.), p(4., 3.), p(0., 3.)];
        let pick = |i: [usize; 3]| i.map(|k| corners[k]);
        let whole = [rect([0., 4.], [0., 3.])];
        assert_eq!(inner_rectangles(&[pick([0, 1, 2]), pick([0, 2, 3])]), whole);
        assert_eq!(inner_rectangles(&[pick([1, 0, 2]), pick([3, 2, 0])]), whole, "winding does not matter");
        assert_eq!(inner_rectangles(&[pick([0, 1, 3]), pick([1, 2, 3])]), whole, "the other diagonal");
        assert_eq!(inner_rectangles(&[pick([0, 1, 2]); 3]), [], "half of it holds no rectangle of its corners");
        assert_eq!(inner_rectangles(&[pick([0, 1, 1]), [p(0., 0.), p(1., 1.), p(2., 2.)]]), [], "no area");
    }

    #[test]
    fn slanted_parts_are_left_out() {
        // A house: the walls up to the eaves.
        let house = [p(0., 0.), p(4., 0.), p(4., 3.), p(2., 5.), p(0., 3.)];
        let fan: Vec<[Point2; 3]> = (1..4).map(|i| [house[0], house[i], house[i + 1]]).collect();
        assert_eq!(inner_rectangles(&fan), [rect([0., 4.], [0., 3.])]);
    }

    #[test]
    fn round_outlines_do_not_splinter() {
        // A polygon of 34 corners, with axis-parallel edges on its left and right only, around a square
        // opening.
        let bow = |x: i32| f64::from(10 + x) * f64::from(16 - x) / 8.0;
        let top = |s: f64| move |x: i32| p(f64::from(x), s * bow(x));
        let strip = |x: i32, s: f64| {
            let (near, far) = (top(s)(x), top(s)(x + 1));
            let (low, high) = (p(near.x, s), p(far.x, s));
            [[low, high, near], [high, far, near]]
        };
        let caps = (-6..12).flat_map(|x| [1.0, -1.0].map(|s| strip(x, s))).flatten();
        let beside = |x0: f64, x1: f64| [[p(x0, -1.), p(x1, -1.), p(x0, 1.)], [p(x1, -1.), p(x1, 1.), p(x0, 1.)]];
        let all: Vec<[Point2; 3]> = caps.chain([beside(-6., 2.), beside(4., 12.)].into_iter().flatten()).collect();
        let [low, high] = [bow(-6), bow(12)].map(|y| y.min(bow(-6)));
        let found = inner_rectangles(&all);
        let want = [
            rect([-6., 2.], [-low, low]),
            rect([2., 4.], [-low, -1.]),
            rect([2., 4.], [1., low]),
            rect([4., 12.], [-high, high]),
        ];
        assert_eq!(found.len(), want.len(), "{found:?}");
        assert!(want.iter().all(|r| found.contains(r)), "{found:?}");
    }

    #[test]
    fn a_corner_on_an_edge_inside_is_no_border() {
        // A rectangle from (0, -1) to (2, 3), in it an upright seam at x = 1 that only one side divides.
        let quad = |a, b, c, d| [[a, b, c], [a, c, d]];
        let left = quad(p(0., 0.), p(1., 0.), p(1., 2.), p(0., 2.));
        let right =
            [quad(p(1., 0.), p(2., 0.), p(2., 1.), p(1., 1.)), quad(p(1., 1.), p(2., 1.), p(2., 2.), p(1., 2.))];
        let cap = |y: f64, far: f64| {
            let corner = p(2., far);
            [[p(0., y), p(1., y), corner], [p(1., y), p(2., y), corner], [p(0., y), corner, p(0., far)]]
        };
        let mut all = [left, right[0], right[1]].concat();
        all.extend([cap(0., -1.), cap(2., 3.)].concat());
        assert_eq!(inner_rectangles(&all), [rect([0., 2.], [-1., 3.])]);
    }

    #[test]
    fn edges_that_cross_cover_no_more_than_both() {
        // Two triangles that overlap and share no corner: what each covers alone.
        let a = [p(0., 0.), p(6., 0.), p(0., 6.)];
        let b = [p(6., 5.), p(6., -1.), p(0., 5.)];
        assert_eq!(inner_rectangles(&[a, b]), []);
    }

    #[test]
    fn slanted_edges_are_decided_to_the_last_bit() {
        // The edge from (0, 0) to (3, 3 ulps less) leaves (1, 1) outside of the triangle below it.
        let low = 3.0f64.next_down();
        let notch = |top: f64| [[p(0., 0.), p(3., 0.), p(3., top)], [p(3., 0.), p(1., 0.), p(1., 1.)]];
        let with = |top| inner_rectangles(&notch(top));
        assert!(with(3.0).contains(&rect([1., 3.], [0., 1.])), "{:?}", with(3.0));
        assert!(!with(low).contains(&rect([1., 3.], [0., 1.])), "{:?}", with(low));
    }
}
