//! Closed things: what hides from both sides though only its fronts are drawn.
//!
//! A line between two points outside of a closed surface crosses it as often inwards as outwards. So each of the two sees
//! a front on the line, and neither sees the other; and what is inside is behind fronts. A single wall that is drawn from
//! one side hides nothing from who stands behind it.
//!
//! That holds where the surface does not cross itself. Its triangles hang together by edges, each with matter on the side of its back, so all
//! of its fronts are then before one winding number and all backs before the next; far away it is 0, and of a positive volume inside 1. Where it crosses itself, a part may be inside out: from
//! outside its backs are seen, which are not drawn.

use crate::{Point3, Scene, SceneError, SceneObject};
use sightlines_geometry::{Aabb, BoxTree, Point2, orient2d, orient3d};
use std::collections::BTreeMap;

/// Whether every piece of an object is closed, with its fronts outwards: each edge is passed as often in one direction as in
/// the other, the volume inside is certainly positive, and no two triangles of the piece meet but in the corners and edges that they
/// share. Pairs of triangles that lie on each other, one the other way round, do not count. Triangles that share an edge are of one piece, if matter is between their backs there; two pieces may touch or cross each other.
///
/// Corners at one place are one. Exact but for the volume; errs towards "no". O(n log n) where few of the boxes around triangles meet.
pub fn is_closed_outwards(object: &SceneObject) -> bool {
    let mut places: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut place = |p: Point3| {
        let next = places.len();
        // Negative zero is zero.
        *places.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
    };
    let triangles: Vec<[usize; 3]> = object.corners().map(|t| t.map(&mut place)).collect();
    // Two triangles that lie on each other, one the other way round, are the border of nothing.
    let mut on_each_other: BTreeMap<[usize; 3], [Vec<usize>; 2]> = BTreeMap::new();
    for (triangle, of) in triangles.iter().enumerate() {
        let mut sorted = *of;
        sorted.sort_unstable();
        let first = of.iter().position(|place| *place == sorted[0]).unwrap_or(0);
        on_each_other.entry(sorted).or_default()[usize::from(of[(first + 1) % 3] == sorted[1])].push(triangle);
    }
    let mut is_border = vec![true; triangles.len()];
    for [back, forth] in on_each_other.values() {
        back.iter().zip(forth).flat_map(|(a, b)| [*a, *b]).for_each(|k| is_border[k] = false);
    }
    // For each edge the triangles that pass it, and whether upwards.
    let mut edges: BTreeMap<[usize; 2], Vec<Passing>> = BTreeMap::new();
    let corners: Vec<[Point3; 3]> = object.corners().collect();
    for (triangle, (of, at)) in triangles.iter().zip(&corners).enumerate().filter(|(k, _)| is_border[*k]) {
        for k in 0..3 {
            let (from, to) = (of[k], of[(k + 1) % 3]);
            let up = from < to;
            let [a, b, third] = [at[k], at[(k + 1) % 3], at[(k + 2) % 3]];
            let ends = if up { [a, b] } else { [b, a] };
            edges.entry([from.min(to), from.max(to)]).or_default().push(Passing { triangle, up, ends, third });
        }
    }
    // Pieces hang together by edges. Two of them may touch at a corner or along an edge, with the one inside out.
    let mut pieces: Vec<usize> = (0..triangles.len()).collect();
    fn root(pieces: &mut [usize], mut k: usize) -> usize {
        while pieces[k] != k {
            pieces[k] = pieces[pieces[k]];
            k = pieces[k];
        }
        k
    }
    for passing in edges.into_values() {
        let Some(pairs) = pairs_around(passing) else { return false };
        for pair in pairs {
            let [x, y] = pair.map(|k| root(&mut pieces, k));
            pieces[x] = y;
        }
    }
    let mut volumes: BTreeMap<usize, Volume> = BTreeMap::new();
    for (k, &[p, q, r]) in corners.iter().enumerate().filter(|(k, _)| is_border[*k]) {
        let volume =
            volumes.entry(root(&mut pieces, k)).or_insert(Volume { origin: p, sum: 0.0, magnitude: 0.0, n: 0 });
        volume.add([p, q, r]);
    }
    if volumes.is_empty() || !volumes.values().all(Volume::is_positive) {
        return false;
    }
    // What is no border is a piece of its own.
    let piece_of: Vec<usize> = (0..triangles.len()).map(|k| root(&mut pieces, k)).collect();
    !meets_itself(&corners, &triangles, &piece_of)
}

impl Scene {
    /// The same scene, in which engines draw the fronts of these objects only: they are [seen from there only](Self::with_single_sided), and those
    /// that hide and are not [closed](is_closed_outwards) [hide from there only](Self::with_front_occluders). What moves, and what is
    /// see-through, hides nothing as before.
    ///
    /// # Errors
    /// [`SceneError::SingleSided`] for an object that does not exist.
    pub fn with_backs_culled(self, objects: Vec<u32>) -> Result<Self, SceneError> {
        let scene = self.with_single_sided(objects)?;
        let is_open = |object: &u32| {
            let of = &scene.objects()[*object as usize];
            scene.is_opaque(*object) && !of.triangles.is_empty() && !is_closed_outwards(of)
        };
        let fronts = scene.single_sided().iter().copied().filter(is_open).collect();
        scene.with_front_occluders(fronts)
    }
}

/// A triangle that passes an edge.
struct Passing {
    triangle: usize,
    /// Whether from the first end to the second.
    up: bool,
    ends: [Point3; 2],
    third: Point3,
}

/// The triangles around an edge in pairs, each with matter between its backs; `None` if the edge is not passed as often in one direction as in the
/// other.
///
/// Around the edge, counter-clockwise as seen against its direction, matter begins at a triangle that passes it downwards and ends at one that passes
/// it upwards, like brackets. Exact.
fn pairs_around(mut around: Vec<Passing>) -> Option<Vec<[usize; 2]>> {
    if let [one, other] = &around[..] {
        return (one.up != other.up).then(|| vec![[one.triangle, other.triangle]]);
    }
    let ([a, b], first) = (around[0].ends, around[0].third);
    let axis = (0..3).find(|&k| orient2d(seen_along(a, k), seen_along(b, k), seen_along(first, k)) != 0.0)?;
    let side = |p: Point3| orient2d(seen_along(a, axis), seen_along(b, axis), seen_along(p, axis));
    // Whether it is at least half a turn away from the first.
    let is_far = |p: Point3| match orient3d(a, b, first, p) {
        0.0 => !are_equal_signs(side(first), side(p)),
        turn => turn < 0.0,
    };
    let turn = |p: &Passing, q: &Passing| {
        let turned = 0.0f64.total_cmp(&(orient3d(a, b, p.third, q.third) + 0.0));
        // Of two that lie on each other, matter ends at one before it begins at the other.
        is_far(p.third).cmp(&is_far(q.third)).then(turned).then(q.up.cmp(&p.up))
    };
    around.sort_by(turn);
    // Brackets match from behind the place where most of them have been closed.
    let (mut depth, mut least, mut start) = (0i32, 0, 0);
    for (k, passing) in around.iter().enumerate() {
        depth += if passing.up { -1 } else { 1 };
        if depth < least {
            (least, start) = (depth, k + 1);
        }
    }
    let n = around.len().max(1);
    around.rotate_left(start % n);
    let (mut open, mut pairs) = (Vec::new(), Vec::new());
    for passing in &around {
        if passing.up {
            pairs.push([open.pop()?, passing.triangle]);
        } else {
            open.push(passing.triangle);
        }
    }
    open.is_empty().then_some(pairs)
}

/// Whether two triangles of one piece have a point in common that is neither a corner nor on an edge of both. Exact.
///
/// * `places`: the corners of each triangle, by their places
fn meets_itself(triangles: &[[Point3; 3]], places: &[[usize; 3]], piece_of: &[usize]) -> bool {
    let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
    let tree = BoxTree::build(&boxes, 4);
    (0..triangles.len()).any(|i| {
        let meets = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= boxes[i].max[k] && boxes[i].min[k] <= b.max[k]);
        let mut found = false;
        tree.visit(
            |b| meets(b),
            |j| {
                let j = j as usize;
                if !found && i < j && piece_of[i] == piece_of[j] && meets(&boxes[j]) {
                    found = meet_apart([&triangles[i], &triangles[j]], [&places[i], &places[j]]);
                }
            },
        );
        found
    })
}

/// Whether two triangles meet elsewhere than in what they share of their corners and edges.
fn meet_apart([t, u]: [&[Point3; 3]; 2], [of_t, of_u]: [&[usize; 3]; 2]) -> bool {
    let own =
        |of: &[usize; 3], other: &[usize; 3]| -> Vec<usize> { (0..3).filter(|&k| !other.contains(&of[k])).collect() };
    match (&own(of_t, of_u)[..], &own(of_u, of_t)[..]) {
        // With an edge in common they meet in more of a plane only if both are on one side of it.
        (&[k], &[l]) => {
            let (a, b, c, d) = (t[(k + 1) % 3], t[(k + 2) % 3], t[k], u[l]);
            orient3d(a, b, c, d) == 0.0
                && (0..3).all(|axis| {
                    let [a, b, c, d] = [a, b, c, d].map(|p| seen_along(p, axis));
                    one_sided([orient2d(a, b, c), orient2d(a, b, d), 0.0])
                })
        }
        // What enters the other triangle at a corner that both have leaves it by the side across, or ends in it.
        (&[k, l], &[m, n]) => reaches([t[k], t[l]], u) || reaches([u[m], u[n]], t),
        (&[_, _, _], &[_, _, _]) => {
            let sides = |t: &[Point3; 3]| [0, 1, 2].map(|k| [t[k], t[(k + 1) % 3]]);
            sides(t).into_iter().any(|side| reaches(side, u)) || sides(u).into_iter().any(|side| reaches(side, t))
        }
        // One on the other, or a corner twice.
        _ => true,
    }
}

/// Whether a segment has a point in common with a triangle, its border included.
fn reaches([p, q]: [Point3; 2], t: &[Point3; 3]) -> bool {
    let [a, b, c] = *t;
    let [from, to] = [p, q].map(|p| orient3d(a, b, c, p));
    if (from > 0.0 && to > 0.0) || (from < 0.0 && to < 0.0) {
        return false;
    }
    if from == 0.0 && to == 0.0 {
        // In one plane: seen along an axis along which the triangle has an area. One without area meets all.
        let flat =
            (0..3).map(|axis| t.map(|p| seen_along(p, axis)).into_iter().chain([p, q].map(|p| seen_along(p, axis))));
        let flat = flat.map(|points| points.collect::<Vec<Point2>>()).find(|f| orient2d(f[0], f[1], f[2]) != 0.0);
        return flat.is_none_or(|f| reaches_flat([f[3], f[4]], [f[0], f[1], f[2]]));
    }
    one_sided([[a, b], [b, c], [c, a]].map(|[a, b]| orient3d(p, q, a, b)))
}

fn reaches_flat([p, q]: [Point2; 2], t: [Point2; 3]) -> bool {
    let sides = [0, 1, 2].map(|k| [t[k], t[(k + 1) % 3]]);
    let is_inside = |p| one_sided(sides.map(|[a, b]| orient2d(a, b, p)));
    let are_apart = |a: f64, b: f64, c: f64, d: f64| a.max(b) < c.min(d) || c.max(d) < a.min(b);
    let crosses = |[a, b]: [Point2; 2]| {
        !are_apart(a.x, b.x, p.x, q.x)
            && !are_apart(a.y, b.y, p.y, q.y)
            && !are_equal_signs(orient2d(a, b, p), orient2d(a, b, q))
            && !are_equal_signs(orient2d(p, q, a), orient2d(p, q, b))
    };
    is_inside(p) || is_inside(q) || sides.into_iter().any(crosses)
}

fn are_equal_signs(a: f64, b: f64) -> bool {
    (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
}

/// Whether no two of three numbers have different signs.
fn one_sided(of: [f64; 3]) -> bool {
    of.iter().all(|x| *x >= 0.0) || of.iter().all(|x| *x <= 0.0)
}

/// A point as it is seen along an axis.
fn seen_along(p: Point3, axis: usize) -> Point2 {
    Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])
}

/// Six times the volume that triangles enclose, and how far rounding can be off.
struct Volume {
    origin: Point3,
    sum: f64,
    /// The sum of the magnitudes of all products.
    magnitude: f64,
    n: usize,
}

impl Volume {
    fn add(&mut self, corners: [Point3; 3]) {
        let [p, q, r] = corners.map(|v| -> Point3 { std::array::from_fn(|k| v[k] - self.origin[k]) });
        for (k, x) in p.into_iter().enumerate() {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let (ahead, back) = (q[a] * r[b], q[b] * r[a]);
            self.sum += x * (ahead - back);
            self.magnitude += x.abs() * (ahead.abs() + back.abs());
        }
        self.n += 1;
    }

    /// Whether it is certainly above zero.
    ///
    /// A product is of three differences, each rounded once, and rounded itself in two steps; the difference in it is rounded
    /// once, the sum at most 3 n times. So a product is off by a share of at most 6 + 3 n units of 2^-53, up to terms of
    /// second order, which the doubled bound covers for all n that a file can have.
    fn is_positive(&self) -> bool {
        self.sum > self.magnitude * (12.0 + 6.0 * self.n as f64) * (0.5 * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> SceneObject {
        let vertices = vec![[5., 0., 0.], [6., 0., 0.], [5., 1., 0.], [5., 0., 1.]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        SceneObject { name: String::new(), vertices, triangles }
    }

    /// A box, outwards or not.
    fn block(o: &mut SceneObject, min: Point3, max: Point3, inwards: bool) {
        let first = o.vertices.len() as u32;
        o.vertices.extend(
            (0..8).map(|i| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }) }),
        );
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let turned = triangles.map(|[a, b, c]| if inwards { [a, c, b] } else { [a, b, c] });
        o.triangles.extend(turned.map(|t: [u32; 3]| t.map(|i| i + first)));
    }

    /// Triangles that nearly cancel, against whole numbers: what is said to be above zero is. The impostor without a margin says it wrongly.
    #[test]
    fn volumes_are_certain_only_where_whole_numbers_agree() {
        let mut random = sightlines_geometry::Random::new(1);
        let (mut n_certain, mut n_wrong) = (0, 0);
        for case in 0..3000 {
            let mut whole = || [0; 3].map(|_| (random.bits() >> 23) as i128 - (1 << 40));
            let mut triangles: Vec<[[i128; 3]; 3]> = Vec::new();
            for _ in 0..3 {
                let [a, b, c] = [whole(), whole(), whole()];
                // The same the other way round, in every second case with a corner that is moved a little.
                let moved = c.map(|x| x + (case % 2) * (whole()[0].rem_euclid(3) - 1));
                triangles.extend([[a, b, c], [b, a, moved]]);
            }
            let mut volume = Volume { origin: [0.0; 3], sum: 0.0, magnitude: 0.0, n: 0 };
            triangles.iter().for_each(|t| volume.add(t.map(|p| p.map(|x| x as f64))));
            let det = |[p, q, r]: &[[i128; 3]; 3]| -> i128 {
                (0..3).map(|k| p[k] * (q[(k + 1) % 3] * r[(k + 2) % 3] - q[(k + 2) % 3] * r[(k + 1) % 3])).sum()
            };
            let exact: i128 = triangles.iter().map(det).sum();
            assert!(!volume.is_positive() || exact > 0, "{triangles:?}");
            n_certain += usize::from(volume.is_positive());
            n_wrong += usize::from(volume.sum > 0.0 && exact <= 0);
        }
        assert!(n_wrong > 5, "{n_wrong}");
        // Not all is in doubt.
        let mut volume = Volume { origin: [0.0; 3], sum: 0.0, magnitude: 0.0, n: 0 };
        volume.add([[5.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 5.0]]);
        assert!(volume.is_positive() && n_certain < 3000);
    }

    /// Blocks that touch along an edge are as closed as blocks apart, wherever the others stand around the edge, and whichever comes first; one of
    /// them inside out is noticed, and so is a sheet beside them. Blocks with a side in common lie on each other there.
    #[test]
    fn blocks_that_touch_along_an_edge_are_closed() {
        let at = |x: f64, y: f64| ([x, y, 0.0], [x + 1.0, y + 1.0, 1.0]);
        let around = [at(0.0, 0.0), at(-1.0, 0.0), at(-1.0, -1.0), at(0.0, -1.0)];
        let closed = |which: &[usize], inside_out: Option<usize>, has_sheet: bool| {
            let mut o = SceneObject { name: String::new(), vertices: Vec::new(), triangles: Vec::new() };
            which.iter().for_each(|&k| block(&mut o, around[k].0, around[k].1, inside_out == Some(k)));
            if has_sheet {
                let first = o.vertices.len() as u32;
                o.vertices.extend([[0.0; 3], [0.0, 0.0, 1.0], [0.5, -0.5, 0.0]]);
                o.triangles.push([first, first + 1, first + 2]);
            }
            is_closed_outwards(&o)
        };
        for (a, b) in [(0, 2), (2, 0), (1, 3), (3, 1)] {
            assert!(closed(&[a, b], None, false), "{a} {b}");
            assert!(!closed(&[a, b], Some(a), false) && !closed(&[a, b], Some(b), false), "{a} {b}");
            assert!(!closed(&[a, b], None, true), "{a} {b}");
        }
        // One stands on a part of a side of the other.
        let mut o = SceneObject { name: String::new(), vertices: Vec::new(), triangles: Vec::new() };
        block(&mut o, [0.0; 3], [1.0; 3], false);
        block(&mut o, [-1.0, 0.0, 0.0], [0.0, 0.5, 1.0], false);
        assert!(is_closed_outwards(&o));
        // A side in common is the border of nothing.
        assert!(closed(&[0, 1], None, false) && closed(&[0, 3], None, false));
        let mut crossing = SceneObject { name: String::new(), vertices: Vec::new(), triangles: Vec::new() };
        [0, 1].iter().for_each(|&k: &usize| block(&mut crossing, around[k].0, around[k].1, false));
        assert!(is_closed_outwards(&crossing));
        crossing.triangles.truncate(22);
        crossing.triangles.extend([[1, 3, 5], [3, 7, 5]].map(|t: [u32; 3]| t.map(|i| i + 8)));
        assert!(is_closed_outwards(&crossing), "two blocks, whatever their sides are cut into");
        // A spike that hangs in the corner of a block, inside it, along an edge of both: matter twice, or none there.
        let nested = |inwards: bool| {
            let mut o = SceneObject { name: String::new(), vertices: Vec::new(), triangles: Vec::new() };
            block(&mut o, [0.0; 3], [4.0, 4.0, 1.0], false);
            let spike = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [2.0, 1.0, 0.5], [1.0, 2.0, 0.5]];
            let first = o.vertices.len() as u32;
            o.vertices.extend(spike);
            let sides = [[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]];
            o.triangles.extend(sides.map(|[a, b, c]| if inwards { [a, c, b] } else { [a, b, c] }.map(|i| i + first)));
            is_closed_outwards(&o)
        };
        assert_eq!([nested(false), nested(true)], [true; 2], "the second one is a notch that touches the edge");
    }

    #[test]
    fn only_whole_things_with_fronts_outwards_are_closed() {
        let whole = tetrahedron();
        assert!(is_closed_outwards(&whole));
        let changed = |change: &dyn Fn(&mut SceneObject)| {
            let mut object = tetrahedron();
            change(&mut object);
            is_closed_outwards(&object)
        };
        assert!(!changed(&|o| _ = o.triangles.pop()));
        assert!(!changed(&|o| o.triangles[0].swap(0, 1)));
        assert!(!changed(&|o| o.triangles.iter_mut().for_each(|t| t.swap(0, 1))));
        assert!(!changed(&|o| o.triangles.clear()));
        assert!(!changed(&|o| o.triangles.push([0, 1, 2])));
        // Two of them, one of which is a hollow; corners that are repeated.
        let twice = |turned: bool| {
            changed(&|o| {
                let more: Vec<Point3> = o.vertices.iter().map(|p| p.map(|x| x * 8.0)).collect();
                o.vertices.extend(more);
                let more = o.triangles.clone().into_iter().map(|[a, b, c]| if turned { [a, c, b] } else { [a, b, c] });
                let more: Vec<[u32; 3]> = more.map(|t| t.map(|i| i + 4)).collect();
                o.triangles.extend(more);
            })
        };
        assert!(twice(false) && !twice(true));
        // A small one inside out that hangs at a corner of a large one; the right way round it is closed.
        let hanging = |inside_out: bool| {
            changed(&|o| {
                o.vertices.extend([[5.0, 0.0, -0.1], [5.1, 0.0, 0.0], [5.0, -0.1, 0.0]]);
                let small = [[0, 4, 6], [0, 5, 4], [0, 6, 5], [4, 5, 6]];
                let small = small.map(|[a, b, c]| if inside_out { [a, c, b] } else { [a, b, c] });
                o.triangles.extend(small);
            })
        };
        assert!(hanging(false) && !hanging(true));
        // A sheet of two sides has no inside, wherever it is.
        let sheet = |at: f64| {
            changed(&|o| {
                o.vertices = vec![[at, 0.1, 0.7], [at + 0.3, 1.1, 0.2], [at, 0.9, 1.3]];
                o.triangles = vec![[0, 1, 2], [0, 2, 1]];
            })
        };
        assert!(!sheet(0.1) && !sheet(1e6 / 3.0));
        assert!(changed(&|o| {
            o.vertices.push(o.vertices[3]);
            o.triangles[1] = [0, 1, 4];
        }));
    }

    /// The walls over an outline of four corners, and its floor and ceiling cut along a diagonal.
    fn prism(outline: [[i32; 2]; 4], from: usize) -> SceneObject {
        let at = |[x, y]: [i32; 2], z: f64| [f64::from(x), f64::from(y), z];
        let vertices = outline.iter().map(|&p| at(p, 0.0)).chain(outline.iter().map(|&p| at(p, 3.0))).collect();
        let (a, b, c, d) = (from, from + 1, from + 2, (from + 3) % 4);
        let flat = [[a, b, c], [a, c, d]];
        let walls = (0..4).flat_map(|i| [[i, (i + 1) % 4, (i + 1) % 4 + 4], [i, (i + 1) % 4 + 4, i + 4]]);
        let all = flat.iter().map(|&[a, b, c]| [a, c, b]).chain(flat.iter().map(|t| t.map(|i| i + 4))).chain(walls);
        let triangles = all.map(|t| t.map(|i| i as u32)).collect();
        SceneObject { name: String::new(), vertices, triangles }
    }

    fn turn([a, b, c]: [[i32; 2]; 3]) -> i32 {
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum()
    }

    /// Whether two segments have a point in common. In integers.
    fn touch([a, b]: [[i32; 2]; 2], [c, d]: [[i32; 2]; 2]) -> bool {
        let apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
        !apart(0) && !apart(1) && turn([a, b, c]) * turn([a, b, d]) <= 0 && turn([c, d, a]) * turn([c, d, b]) <= 0
    }

    /// All outlines of four corners on a small grid: a prism is closed exactly if its outline, in integers, does not meet itself. What is told
    /// apart are mostly prisms whose lobes differ in size, so that the volume is positive and one lobe is inside out.
    #[test]
    fn what_crosses_itself_is_not_closed() {
        let grid: Vec<[i32; 2]> = (0..4).flat_map(|x| (0..3).map(move |y| [x, y])).collect();
        let n = grid.len();
        let (mut n_closed, mut n_crossed, mut n_missed) = (0, 0, 0);
        for code in 0..n.pow(4) {
            let o: [[i32; 2]; 4] = std::array::from_fn(|k| grid[code / n.pow(k as u32) % n]);
            let doubled: i32 = (0..4).map(|k| o[k][0] * o[(k + 1) % 4][1] - o[k][1] * o[(k + 1) % 4][0]).sum();
            let flat = |from: usize| {
                [turn([o[from], o[from + 1], o[from + 2]]), turn([o[from], o[from + 2], o[(from + 3) % 4]])]
            };
            // Three corners on a line leave triangles without area, which readers leave out.
            if doubled <= 0 || (0..4).any(|k| turn([o[k], o[(k + 1) % 4], o[(k + 2) % 4]]) == 0) {
                continue;
            }
            let is_simple = !touch([o[0], o[1]], [o[2], o[3]]) && !touch([o[1], o[2]], [o[3], o[0]]);
            let from = (0..2).find(|&from| flat(from) == [1, 1]);
            if is_simple {
                let from = from.expect("an outline of four corners has a diagonal inside");
                assert!(is_closed_outwards(&prism(o, from)), "{o:?}");
                n_closed += 1;
            } else {
                for from in 0..2 {
                    let object = prism(o, from);
                    assert!(!is_closed_outwards(&object), "{o:?}");
                    n_crossed += 1;
                    // The impostor: edges and volume alone do not tell.
                    let volume = object.corners().fold(
                        Volume { origin: [0.0; 3], sum: 0.0, magnitude: 0.0, n: 0 },
                        |mut v, t| {
                            v.add(t);
                            v
                        },
                    );
                    n_missed += u32::from(volume.is_positive());
                }
            }
        }
        assert!(n_closed > 1000 && n_crossed > 500 && n_missed == n_crossed, "{n_closed} {n_crossed} {n_missed}");
    }

    /// Two of its triangles that only touch elsewhere than in shared corners are enough, and so are folds.
    #[test]
    fn triangles_meet_only_in_what_they_share() {
        let t = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let meet = |u: [Point3; 3]| {
            let all: Vec<Point3> = t.iter().chain(&u).copied().collect();
            let places = |t: &[Point3; 3]| t.map(|p| all.iter().position(|q| *q == p).expect("one of the corners"));
            let both =
                [meet_apart([&t, &u], [&places(&t), &places(&u)]), meet_apart([&u, &t], [&places(&u), &places(&t)])];
            assert_eq!(both[0], both[1], "{u:?}");
            both[0]
        };
        let apart = [
            [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]],
            [[4.0, 4.0, 0.0], [4.0, 4.0, 2.0], [6.0, 4.0, 0.0]],
            [[5.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 4.0, 0.0]],
            [[0.0, 0.0, 0.0], [0.0, 0.0, 3.0], [3.0, 3.0, 3.0]],
            [[0.0, 0.0, 0.0], [-4.0, 0.0, 0.0], [0.0, -4.0, 0.0]],
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, -4.0, 0.0]],
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 1.0]],
        ];
        assert!(!apart.into_iter().any(meet));
        let meeting = [
            [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [5.0, 5.0, 0.5]],
            [[1.0, 1.0, 0.0], [1.0, 1.0, 3.0], [2.0, 1.0, 3.0]],
            [[2.0, 2.0, 0.0], [3.0, 3.0, 1.0], [3.0, 3.0, 2.0]],
            [[2.0, 0.0, 0.0], [2.0, -1.0, 1.0], [2.0, -1.0, 2.0]],
            [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]],
            [[-1.0, -1.0, 0.0], [9.0, -1.0, 0.0], [-1.0, 9.0, 0.0]],
            [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 3.0]],
            [[0.0, 0.0, 0.0], [6.0, 6.0, 1.0], [6.0, 6.0, -1.0]],
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
            t,
        ];
        assert!(meeting.into_iter().all(meet));
    }
}
