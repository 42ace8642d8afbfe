//! A ray tracer over the triangles of a scene: what a ray hits first.
//!
//! It knows no cells, portals or boxes of walls, so that nothing can be wrong in the same way here and
//! in the code that it judges; its vectors and its tests of boxes and triangles are its own on purpose. It computes in doubles: [`RayScene::first_hit`] is exact up to rounding,
//! and the samplers that use it leave out what a small shift would change.
//!
//! Source: Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
//! Techniques 2(1), 2013: no ray slips through an edge that two triangles share.

use crate::bvh::{Bvh, Ray};
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::{Aabb, orient3d};

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Id of the object.
    pub object: u32,
    /// Index of the triangle in the object.
    pub triangle: u32,
    /// Distance from the origin as a multiple of the direction; not negative.
    pub t: f64,
    /// Whether the ray comes from the side from which the corners run counter-clockwise.
    pub front_facing: bool,
}

#[derive(Debug)]
struct Triangle {
    corners: [Point3; 3],
    object: u32,
    index: u32,
}

/// A scene, ready for rays. Immutable, and can be shared by threads.
#[derive(Debug)]
pub struct RayScene {
    triangles: Vec<Triangle>,
    bvh: Bvh,
    bounds: Aabb<3>,
    /// Length of the diagonal of the scene's box.
    size: f64,
    /// Hits no farther apart than this count as one, in scene units.
    slack: f64,
}

impl RayScene {
    /// Copies the triangles; those without area are never hit.
    ///
    /// Cost: O(n log n).
    pub fn new(scene: &Scene) -> Self {
        let mut triangles = Vec::with_capacity(scene.n_triangles());
        for (object, o) in (0..).zip(scene.objects()) {
            triangles.extend((0..).zip(o.corners()).map(|(index, corners)| Triangle { corners, object, index }));
        }
        let bounds = Aabb::around(triangles.iter().flat_map(|t| t.corners));
        let size = if bounds.is_empty() { 0.0 } else { length(sub(bounds.max, bounds.min)) };
        let largest = bounds.min.iter().chain(&bounds.max).fold(size, |m, x| m.max(x.abs()));
        let slack = if triangles.is_empty() { 0.0 } else { largest / f64::from(1u32 << 20) / f64::from(1 << 20) };
        let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(t.corners)).collect();
        Self { bvh: Bvh::new(&boxes, slack), triangles, bounds, size, slack }
    }

    /// Smallest box around all triangles; empty if there are none.
    pub fn bounds(&self) -> Aabb<3> {
        self.bounds
    }

    /// Length of the diagonal of that box; 0 if there are no triangles.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// What the ray meets first: front or back of a triangle. A ray along a triangle's plane does not
    /// meet it.
    ///
    /// Several triangles can lie at the same distance (up to 2^-40 of the scene's largest coordinate).
    /// An object that shows both its front and its back there is a wall without thickness: its front is
    /// met. An object that shows its back alone is one that the ray comes out of, and that is the hit,
    /// even where the front of another solid touches it. Otherwise the lowest object counts, then its
    /// lowest triangle.
    ///
    /// * `direction`: of any length; a zero direction meets nothing.
    pub fn first_hit(&self, origin: Point3, direction: Point3) -> Option<Hit> {
        let shear = Shear::new(direction)?;
        let slack = self.slack / length(direction);
        let mut nearest = f64::INFINITY;
        let mut hits: Vec<Hit> = Vec::new();
        self.bvh.visit(&Ray::new(origin, direction), f64::INFINITY, |i| {
            let triangle = &self.triangles[i as usize];
            if let Some((t, front_facing)) = shear.meet(origin, &triangle.corners)
                && t <= nearest + slack
            {
                nearest = nearest.min(t);
                hits.push(Hit { object: triangle.object, triangle: triangle.index, t, front_facing });
            }
            nearest + slack
        });
        hits.retain(|h| h.t <= nearest + slack);
        let has_front = |object: u32| hits.iter().any(|h| h.object == object && h.front_facing);
        let rank = |h: &&Hit| (has_front(h.object), !h.front_facing, h.object, h.triangle);
        hits.iter().min_by_key(rank).copied()
    }

    /// Whether the segment between two points meets a triangle, whichever side of it, up to the distance behind
    /// its end that counts as the same. A segment along a triangle's plane does not meet it, and one without length
    /// meets nothing.
    pub fn is_blocked(&self, from: Point3, to: Point3) -> bool {
        let direction = sub(to, from);
        let Some(shear) = Shear::new(direction) else { return false };
        let limit = 1.0 + self.slack / length(direction);
        let mut blocked = false;
        self.bvh.visit(&Ray::new(from, direction), limit, |i| {
            let hit = shear.meet(from, &self.triangles[i as usize].corners);
            blocked |= hit.is_some_and(|(t, _)| t <= limit);
            // Nothing is nearer than that, so nothing more is visited.
            if blocked { f64::NEG_INFINITY } else { limit }
        });
        blocked
    }

    /// Whether the closed segment between two points certainly touches no triangle. Exact, so that a segment along an edge, which
    /// rounding takes past it, is told from one with room on all sides. A segment in a triangle's plane is never certain.
    pub fn is_clear(&self, from: Point3, to: Point3) -> bool {
        let mut clear = true;
        self.bvh.visit(&Ray::new(from, sub(to, from)), 1.0 + 1e-9, |i| {
            clear &= are_apart(from, to, &self.triangles[i as usize].corners);
            if clear { 1.0 + 1e-9 } else { f64::NEG_INFINITY }
        });
        clear
    }
}

/// Whether the closed segment `p q` certainly does not touch the triangle: both ends are on one side of it, or the line through them passes some edges on
/// one side and some on the other.
fn are_apart(p: Point3, q: Point3, &[a, b, c]: &[Point3; 3]) -> bool {
    let both = |signs: &[f64]| (signs.iter().any(|&s| s > 0.0), signs.iter().any(|&s| s < 0.0));
    let ends = [orient3d(a, b, c, p), orient3d(a, b, c, q)];
    let is_beside = ends.iter().all(|&s| s > 0.0) || ends.iter().all(|&s| s < 0.0);
    is_beside || both(&[orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)]) == (true, true)
}

/// A ray's direction, as the shear and the order of axes that turn it into the third axis.
struct Shear {
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Shear {
    /// `None` for a zero direction.
    fn new(d: Point3) -> Option<Self> {
        let z = (0..3).max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).expect("there are three axes");
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        // Swapped where the ray goes backwards, so that corners keep their sense of turning.
        let [x, y] = if d[z] < 0.0 { [y, x] } else { [x, y] };
        (d[z] != 0.0).then(|| Self { axes: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] })
    }

    /// Distance along the ray from `origin`, and whether the front is met.
    fn meet(&self, origin: Point3, corners: &[Point3; 3]) -> Option<(f64, bool)> {
        let [a, b, c] = corners.map(|p| {
            let p = sub(p, origin);
            let [x, y, z] = self.axes.map(|k| p[k]);
            [x - self.shear[0] * z, y - self.shear[1] * z, self.shear[2] * z]
        });
        // For the neighbour across an edge the same products are subtracted the other way round, so
        // signs agree even where they are rounded.
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let sum = u + v + w;
        if !inside || sum == 0.0 {
            return None;
        }
        let t = (u * a[2] + v * b[2] + w * c[2]) / sum;
        (t >= 0.0).then_some((t, sum > 0.0))
    }
}

pub(crate) fn sub(a: Point3, b: Point3) -> Point3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn length(a: Point3) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw;
    use proptest::prelude::*;
    use sightlines_cells::SceneObject;

    type P = [i64; 3];

    fn scene(objects: &[Vec<[P; 3]>]) -> Scene {
        let object = |triangles: &Vec<[P; 3]>| SceneObject {
            name: String::new(),
            vertices: triangles.iter().flatten().map(|p| p.map(|x| x as f64)).collect(),
            triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        };
        Scene::new(objects.iter().map(object).collect()).unwrap()
    }

    fn minus(a: P, b: P) -> P {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    fn triple(a: P, b: P, c: P) -> i64 {
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// The first hit in exact integers, over all triangles; `Err` if the ray touches an edge or starts
    /// on a triangle.
    fn brute_force(objects: &[Vec<[P; 3]>], o: P, d: P) -> Result<Option<(usize, usize, bool)>, ()> {
        // Numerator and denominator of the distance, object, triangle, whether it is a front.
        let mut hits: Vec<(i64, i64, usize, usize, bool)> = Vec::new();
        for (i, object) in objects.iter().enumerate() {
            for (j, t) in object.iter().enumerate() {
                let [a, b, c] = t.map(|p| minus(p, o));
                let sides = [triple(d, b, c), triple(d, c, a), triple(d, a, b)];
                if !(sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0)) {
                    continue;
                }
                let across: i64 = sides.iter().sum();
                let n = triple(a, b, c) * across.signum();
                if across != 0 && n < 0 {
                    continue;
                }
                if sides.contains(&0) || n == 0 {
                    return Err(());
                }
                hits.push((n, across.abs(), i, j, across < 0));
            }
        }
        let Some(&(n, m, ..)) = hits.iter().min_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1))) else { return Ok(None) };
        hits.retain(|h| h.0 * m == n * h.1);
        // Backs first, of objects that show no front; then fronts.
        let alone = |i: usize| hits.iter().filter(|h| h.2 == i).all(|h| !h.4);
        let back = hits.iter().find(|h| alone(h.2));
        let hit = back.or_else(|| hits.iter().find(|h| h.4)).ok_or(())?;
        Ok(Some((hit.2, hit.3, hit.4)))
    }

    type Case = (Vec<Vec<[P; 3]>>, P, P);

    fn case() -> impl Strategy<Value = Case> {
        let point = || prop::array::uniform3(0i64..=6);
        let triangle = prop_oneof![
            prop::array::uniform3(point()),
            // Axial ones, so that some are coplanar or coincide.
            (prop::array::uniform3(point()), 0usize..3, 0i64..=6).prop_map(|(mut t, axis, at)| {
                t.iter_mut().for_each(|p| p[axis] = at);
                t
            }),
        ];
        let objects = prop::collection::vec(prop::collection::vec(triangle, 1..8), 1..6);
        (objects, point(), prop::array::uniform3(-6i64..=6))
    }

    fn traced((objects, o, d): &Case) -> Option<(usize, usize, bool)> {
        let [origin, direction] = [o, d].map(|p| p.map(|x| x as f64));
        let hit = RayScene::new(&scene(objects)).first_hit(origin, direction);
        hit.map(|h| (h.object as usize, h.triangle as usize, h.front_facing))
    }

    proptest! {
        /// The same first hit as exact arithmetic over all triangles finds.
        #[test]
        fn rays_first_hit_is_the_exact_one(case in case()) {
            let exact = brute_force(&case.0, case.1, case.2);
            prop_assume!(exact.is_ok());
            prop_assert_eq!(traced(&case), exact.unwrap());
        }
    }

    /// The impostor: a tracer that overlooks the last object is found out.
    #[test]
    fn rays_that_overlook_something_are_noticed() {
        let judged = |(objects, o, d): &Case| {
            let exact = brute_force(objects, *o, *d).ok()?;
            let fewer = objects[..objects.len() - 1].to_vec();
            Some((exact.is_some(), traced(&(fewer, *o, *d)) != exact))
        };
        let judged: Vec<(bool, bool)> = draw(&case(), 2000).iter().filter_map(judged).collect();
        let (n_hit, n_wrong) = (judged.iter().filter(|j| j.0).count(), judged.iter().filter(|j| j.1).count());
        assert!(judged.len() > 500 && n_hit > 200 && n_wrong > 50, "{} {n_hit} {n_wrong}", judged.len());
    }

    #[test]
    fn rays_tell_thin_walls_from_solids_that_touch() {
        let front = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
        let back = [front[0], front[2], front[1]];
        let s = RayScene::new(&scene(&[vec![back, front]]));
        let hit = s.first_hit([1., 1., 3.], [0., 0., -2.]).unwrap();
        assert_eq!(hit, Hit { object: 0, triangle: 1, t: 1.5, front_facing: true });
        let hit = s.first_hit([1., 1., -3.], [0., 0., 1.]).unwrap();
        assert_eq!((hit.triangle, hit.front_facing), (0, true));
        let touching = RayScene::new(&scene(&[vec![front], vec![back]]));
        let hit = touching.first_hit([1., 1., 3.], [0., 0., -2.]).unwrap();
        assert_eq!((hit.object, hit.front_facing), (1, false));
        // Along the plane, away from it, beside it, without a direction.
        assert_eq!(s.first_hit([-1., 1., 0.], [1., 0., 0.]), None);
        assert_eq!(s.first_hit([1., 1., 3.], [0., 0., 1.]), None);
        assert_eq!(s.first_hit([3., 3., 3.], [0., 0., -1.]), None);
        assert_eq!(s.first_hit([1., 1., 3.], [0.; 3]), None);
        assert_eq!(RayScene::new(&Scene::default()).first_hit([0.; 3], [1., 0., 0.]), None);
    }

    /// No ray slips between triangles that share edges, even at the edges and corners.
    #[test]
    fn rays_do_not_slip_through_edges() {
        let n = 12;
        let wall: Vec<[P; 3]> = (0..n * n)
            .flat_map(|i| {
                let at = |dx, dy| [i % n + dx, i / n + dy, (i * 7) % 3];
                // Heights differ by column and row, so corners are taken from one function.
                let p = |dx: i64, dy: i64| [at(dx, dy)[0], at(dx, dy)[1], (3 * (i % n + dx) + 5 * (i / n + dy)) % 4];
                [[p(0, 0), p(1, 0), p(1, 1)], [p(0, 0), p(1, 1), p(0, 1)]]
            })
            .collect();
        let s = RayScene::new(&scene(&[wall]));
        for i in 1..n * 7 {
            for j in 1..n * 7 {
                let through = [i as f64 / 7.0, j as f64 / 7.0, 2.0];
                let origin = [5.3, 6.1, 40.0];
                let inner = |x: f64| (1.0..11.0).contains(&x);
                if inner(through[0]) && inner(through[1]) {
                    assert!(s.first_hit(origin, sub(through, origin)).is_some(), "towards {through:?}");
                }
            }
        }
    }

    /// A segment that passes an edge exactly, which rounding takes to the open side; a bit to either side is told for certain.
    #[test]
    fn rays_segments_along_an_edge_are_not_clear() {
        let s = RayScene::new(&scene(&[vec![[[0, 0, 0], [2, -1, 7], [6, 0, -5]]]]));
        let (from, to) = ([5.0, -2.0, -2.0], [4.0, 1.3001109505282598, 1.0]);
        let by = |x: f64| [to[0] + x, to[1], to[2]];
        assert!(!s.is_blocked(from, to) && !s.is_clear(from, to));
        assert!(!s.is_clear(from, by(-1e-14)) && s.is_clear(from, by(1e-14)));
        assert!(s.is_clear(from, [5.0, -3.0, -2.0]) && !s.is_clear([8.0, -1.0, 2.0], [-4.0, 0.5, -1.0]));
    }
}
