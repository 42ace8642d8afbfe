//! Which closed surfaces a point is inside of, by exact parity.

use crate::overlap::may_meet;
use crate::surface::Chain;
use sightlines_geometry::{Aabb, BoxTree, Point2, Point3, orient2d, orient3d};

/// The triangles of all closed chains, prepared for parity tests.
#[derive(Debug, Clone)]
pub(crate) struct Parity {
    /// Corners, and the chain that they belong to.
    triangles: Vec<([Point3; 3], u32)>,
    tree: BoxTree<3>,
}

impl Parity {
    /// Copies the triangles, those that close holes included.
    pub(crate) fn new(chains: &[Chain]) -> Self {
        let of = |(i, chain): (u32, &Chain)| {
            chain.triangles.iter().chain(&chain.caps).map(move |&t| (t, i)).collect::<Vec<_>>()
        };
        let triangles: Vec<_> = (0..).zip(chains).flat_map(of).collect();
        let boxes: Vec<_> = triangles.iter().map(|(t, _)| Aabb::around(*t)).collect();
        Self { triangles, tree: BoxTree::build(&boxes, 4) }
    }

    /// The chains that `p` is inside of, ascending: those that a ray from it crosses an odd number of times. Exact for chains that `p` does not
    /// lie on; of others it may say either.
    pub(crate) fn odd_at(&self, p: Point3) -> Vec<u32> {
        let mut crossed = Vec::new();
        let ahead = |b: &Aabb<3>| b.max[0] >= p[0] && (1..3).all(|k| b.min[k] <= p[k] && p[k] <= b.max[k]);
        self.tree.visit(ahead, |i| {
            let (triangle, chain) = &self.triangles[i as usize];
            if crosses(triangle, p) {
                crossed.push(*chain);
            }
        });
        crossed.sort_unstable();
        let runs = crossed.chunk_by(|a, b| a == b);
        runs.filter(|run| run.len() % 2 == 1).map(|run| run[0]).collect()
    }

    /// The chains that may meet a box, ascending. None that does is left out.
    pub(crate) fn meeting(&self, b: &Aabb<3>) -> Vec<u32> {
        self.meeting_if(b, |triangle| may_meet(triangle, b))
    }

    /// The same of a triangle.
    pub(crate) fn meeting_triangle(&self, t: &[Point3; 3]) -> Vec<u32> {
        let b = Aabb::around(*t);
        self.meeting_if(&b, |other| {
            may_meet(other, &b) && may_meet(t, &Aabb::around(*other)) && !is_beside(t, other) && !is_beside(other, t)
        })
    }

    fn meeting_if(&self, b: &Aabb<3>, may_meet: impl Fn(&[Point3; 3]) -> bool) -> Vec<u32> {
        let mut met = Vec::new();
        let touches = |c: &Aabb<3>| (0..3).all(|k| c.min[k] <= b.max[k] && b.min[k] <= c.max[k]);
        self.tree.visit(touches, |i| {
            let (triangle, chain) = &self.triangles[i as usize];
            if may_meet(triangle) {
                met.push(*chain);
            }
        });
        met.sort_unstable();
        met.dedup();
        met
    }
}

/// Whether a triangle is certainly on one side of the plane of another. Exact.
fn is_beside(t: &[Point3; 3], &[a, b, c]: &[Point3; 3]) -> bool {
    let sides = t.map(|p| orient3d(a, b, c, p));
    sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
}

/// Whether the ray from `p` along the first axis crosses a triangle that `p` does not lie on.
///
/// The ray is thought to be moved sideways by less than any number, along the second axis by `d` and along the
/// third by `e`, `e` much smaller than `d`. Then it meets no edge, and each edge answers alike to all triangles that share
/// it, so that the parity over a closed surface is that of a nearby ray in general position.
fn crosses(triangle: &[Point3; 3], p: Point3) -> bool {
    let flat = |p: Point3| Point2::new(p[1], p[2]);
    let [a, b, c] = triangle.map(flat);
    let q = flat(p);
    if !(right_of(a, b, q) ^ right_of(b, c, q) ^ right_of(c, a, q)) {
        return false;
    }
    // The triangle is ahead if `p` is on that side of its plane which the ray leaves. It has area here.
    let [u, v, w] = *triangle;
    (orient3d(u, v, w, p) < 0.0) == (orient2d(a, b, c) > 0.0)
}

/// Whether an edge is crossed by the line from `q` along the first axis of the plane, `q` moved as said above.
fn right_of(a: Point2, b: Point2, q: Point2) -> bool {
    // From the lower to the upper end, so that both directions of the edge ask the same question.
    let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
    a.y <= q.y && q.y < b.y && orient2d(a, b, q) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type P = [i64; 3];

    /// On which side of three points a fourth lies, in whole numbers.
    fn side([a, b, c]: [P; 3], d: P) -> i64 {
        let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let minor = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
        (minor(1, 2) * w[0] + minor(2, 0) * w[1] + minor(0, 1) * w[2]).signum()
    }

    /// A tetrahedron as triangles, each opposite of the corner with its number.
    fn faces([a, b, c, d]: [P; 4]) -> [[P; 3]; 4] {
        [[b, c, d], [a, d, c], [a, b, d], [a, c, b]]
    }

    fn chain(t: [P; 4]) -> Chain {
        let triangles = faces(t).map(|f| f.map(|p| p.map(|x| x as f64))).to_vec();
        Chain { triangles, caps: Vec::new(), holes: Vec::new() }
    }

    /// The oracle: a point is inside a tetrahedron if it is on the inner side of all faces; none if on one's plane.
    fn inside(t: [P; 4], p: P) -> Option<bool> {
        let sides = [0, 1, 2, 3].map(|k| side(faces(t)[k], p) * side(faces(t)[k], t[k]));
        let touches = sides.contains(&0) && sides.iter().all(|&s| s >= 0);
        (!touches).then(|| sides.iter().all(|&s| s > 0))
    }

    fn point() -> impl Strategy<Value = P> {
        prop::array::uniform3(0i64..5)
    }

    type Case = (Vec<[P; 4]>, Vec<P>);

    fn case() -> impl Strategy<Value = Case> {
        let solid = prop::array::uniform4(point()).prop_filter("no volume", |&[a, b, c, d]| side([a, b, c], d) != 0);
        (prop::collection::vec(solid, 1..4), prop::collection::vec(point(), 30))
    }

    /// For each solid and point not on it: the answer, and the truth. Rays run along edges and through corners all the
    /// time on so small a grid.
    fn judged((solids, points): &Case) -> Vec<(bool, bool)> {
        let chains: Vec<_> = solids.iter().copied().map(chain).collect();
        let parity = Parity::new(&chains);
        let mut all = Vec::new();
        for &p in points {
            let odd = parity.odd_at(p.map(|x| x as f64));
            for (i, &t) in (0u32..).zip(solids) {
                all.extend(inside(t, p).map(|truth| (odd.contains(&i), truth)));
            }
        }
        all
    }

    proptest! {
        /// Invariant: inside by parity is inside by sides.
        #[test]
        fn parity_is_exact(case in case()) {
            prop_assert!(judged(&case).iter().all(|(said, truth)| said == truth), "{:?}", judged(&case));
        }
    }

    /// The property saw points inside; and a surface with a face missing is distinguished from a whole one.
    #[test]
    fn impostor_a_surface_that_is_not_closed_is_wrong_somewhere() {
        let cases = sightlines_testkit::draw(&case(), 300);
        let n_inside: usize = cases.iter().map(|c| judged(c).iter().filter(|(_, truth)| *truth).count()).sum();
        assert!(n_inside > 100, "{n_inside}");
        let wrong = |(solids, points): &Case| {
            let mut open = chain(solids[0]);
            open.triangles.pop();
            let parity = Parity::new(&[open]);
            points.iter().any(|&p| {
                inside(solids[0], p).is_some_and(|truth| parity.odd_at(p.map(|x| x as f64)).contains(&0) != truth)
            })
        };
        assert!(cases.iter().any(wrong));
    }

    #[test]
    fn chains_that_meet_a_box_are_found() {
        let chains =
            [chain([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]), chain([[5, 5, 5], [9, 5, 5], [5, 9, 5], [5, 5, 9]])];
        let parity = Parity::new(&chains);
        let at = |x: f64, size: f64| parity.meeting(&Aabb { min: [x; 3], max: [x + size; 3] });
        assert_eq!(at(0.5, 0.25), [0u32; 0]);
        assert_eq!((at(1.0, 1.0), at(5.0, 0.0), at(1.0, 5.0)), (vec![0], vec![1], vec![0, 1]));
    }
}
