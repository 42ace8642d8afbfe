//! Isovists against a sweep of all directions in fractions.
//!
//! Another method: all directions to ends and crossings of walls are sorted around the eye. Between two neighbours one wall is
//! nearest all the way, so a ray in the middle finds it. Corners are fractions, rounded when they are compared.

use crate::{Walls, plan, point, walls};
use proptest::prelude::*;
use sightlines_cells::LineId;
use sightlines_exact::{BigInt, BigRational};
use sightlines_isovist::{Boundary, Isovist, WallMesh};
use std::cmp::Ordering;
use std::sync::atomic::{AtomicUsize, Ordering as Atomic};

type Vector = [BigRational; 2];

fn number(x: i64) -> BigRational {
    BigRational::from_integer(BigInt::from(x))
}

fn vector(p: [i64; 2]) -> Vector {
    p.map(number)
}

fn minus(p: &Vector, q: &Vector) -> Vector {
    [&p[0] - &q[0], &p[1] - &q[1]]
}

fn cross(p: &Vector, q: &Vector) -> BigRational {
    &p[0] * &q[1] - &p[1] * &q[0]
}

fn sign(x: &BigRational) -> i32 {
    x.cmp(&number(0)) as i32
}

/// Order of directions, counter-clockwise from the axis of x.
fn order(p: &Vector, q: &Vector) -> Ordering {
    let half = |v: &Vector| sign(&v[1]) < 0 || (sign(&v[1]) == 0 && sign(&v[0]) < 0);
    half(p).cmp(&half(q)).then_with(|| number(0).cmp(&cross(p, q)))
}

/// Walls and the four sides of the frame, relative to the eye.
struct Sweep {
    segments: Vec<(Vector, Vector, Boundary)>,
}

impl Sweep {
    fn new(walls: &Walls, frame: [[i64; 2]; 2], eye: [i64; 2]) -> Self {
        let eye = vector(eye);
        let [[x0, y0], [x1, y1]] = frame;
        let sides = [[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]];
        let walls = walls.iter().zip(0u32..).map(|(w, i)| (w, Boundary::Wall(LineId(i))));
        let all = walls.chain(sides.iter().map(|s| (s, Boundary::Frame)));
        let segment = |(w, kind): (&[i64; 4], Boundary)| {
            (minus(&vector([w[0], w[1]]), &eye), minus(&vector([w[2], w[3]]), &eye), kind)
        };
        Self { segments: all.map(segment).collect() }
    }

    /// How far along a direction a wall is met, as a multiple of it; `None` if it is not, or only along the ray.
    fn meets(&self, segment: usize, d: &Vector) -> Option<BigRational> {
        let (a, b, _) = &self.segments[segment];
        let (s, t) = (sign(&cross(d, a)), sign(&cross(d, b)));
        if s * t > 0 || (s == 0 && t == 0) {
            return None;
        }
        let step = minus(b, a);
        let far = cross(a, &step) / cross(d, &step);
        (sign(&far) > 0).then_some(far)
    }

    /// Ends and crossings of walls.
    fn corners(&self) -> Vec<Vector> {
        let mut corners: Vec<Vector> = self.segments.iter().flat_map(|(a, b, _)| [a.clone(), b.clone()]).collect();
        for (i, (a, b, _)) in self.segments.iter().enumerate() {
            for (c, d, _) in &self.segments[i + 1..] {
                let (u, v) = (minus(b, a), minus(d, c));
                let parallel = cross(&u, &v);
                if sign(&parallel) != 0 {
                    let t = cross(&minus(c, a), &v) / parallel;
                    corners.push([&a[0] + &u[0] * &t, &a[1] + &u[1] * &t]);
                }
            }
        }
        corners.retain(|c| sign(&c[0]) != 0 || sign(&c[1]) != 0);
        corners.sort_by(order);
        corners.dedup_by(|p, q| order(p, q).is_eq());
        corners
    }

    /// The outline: start, end and kind of each part that is not along a ray.
    fn outline(&self) -> Vec<(Vector, Vector, Boundary)> {
        let directions = self.corners();
        let mut parts: Vec<(Vector, Vector, Boundary)> = Vec::new();
        for (i, from) in directions.iter().enumerate() {
            let to = &directions[(i + 1) % directions.len()];
            // Neighbours are less than half a turn apart: the frame has four corners.
            let middle = [&from[0] + &to[0], &from[1] + &to[1]];
            let nearest = (0..self.segments.len())
                .filter_map(|s| self.meets(s, &middle).map(|far| (far, s)))
                .min_by(|p, q| p.0.cmp(&q.0).then(p.1.cmp(&q.1)));
            let (_, segment) = nearest.expect("the frame is around the eye");
            let (a, b, kind) = &self.segments[segment];
            let step = minus(b, a);
            let at = |d: &Vector| {
                let far = cross(a, &step) / cross(d, &step);
                [&d[0] * &far, &d[1] * &far]
            };
            parts.push((at(from), at(to), *kind));
        }
        parts
    }
}

/// Vertices and kinds of edges as doubles, with parts of one wall joined, from the least vertex on.
fn canonical(parts: &[(Vector, Vector, Boundary)], eye: [i64; 2]) -> Vec<([f64; 2], Boundary)> {
    use num_traits::ToPrimitive;
    let eye = vector(eye);
    let double = |v: &Vector| [0, 1].map(|k| (&v[k] + &eye[k]).to_f64().unwrap() + 0.0);
    let n = parts.len();
    let mut edges = Vec::new();
    for i in 0..n {
        let (a, b, kind) = &parts[i];
        let before = &parts[(i + n - 1) % n];
        let goes_on =
            before.2 == *kind && before.1 == *a && sign(&cross(&minus(b, a), &minus(&before.1, &before.0))) == 0;
        if !goes_on {
            edges.push((double(a), *kind));
        }
        if parts[(i + 1) % n].0 != *b {
            edges.push((double(b), Boundary::Occluding));
        }
    }
    rotated(edges)
}

fn rotated(mut edges: Vec<([f64; 2], Boundary)>) -> Vec<([f64; 2], Boundary)> {
    let key = |e: &([f64; 2], Boundary)| (e.0, format!("{:?}", e.1));
    if let Some(least) = (0..edges.len()).min_by(|&i, &j| key(&edges[i]).partial_cmp(&key(&edges[j])).unwrap()) {
        edges.rotate_left(least);
    }
    edges
}

fn of(isovist: &Isovist) -> Vec<([f64; 2], Boundary)> {
    rotated(isovist.edges().map(|(a, _, kind)| ([a.x, a.y], kind)).collect())
}

fn check(walls: &Walls, eye: [i64; 2], n_constructed: &AtomicUsize) -> Result<(), TestCaseError> {
    let frame = [[-3, -3], [63, 63]];
    let bounds = sightlines_geometry::Aabb { min: [-3.0, -3.0], max: [63.0, 63.0] };
    let mesh = WallMesh::with_frame(&plan(walls), bounds).unwrap();
    let isovist = mesh.isovist(point(eye)).unwrap();
    let truth = canonical(&Sweep::new(walls, frame, eye).outline(), eye);
    prop_assert_eq!(of(&isovist), truth, "from {:?}", eye);
    let constructed = isovist.vertices().iter().filter(|v| v.x.fract() != 0.0 || v.y.fract() != 0.0).count();
    n_constructed.fetch_add(constructed, Atomic::Relaxed);
    Ok(())
}

proptest! {
    /// Invariant: isovists equal the sweep's, vertex by vertex and bit by bit, with the wall of each edge: from anywhere on the
    /// grid, so from walls and corners too.
    #[test]
    fn isovists_equal_a_sweep_in_fractions(walls in walls(8, 13), eye in prop::array::uniform2(0i64..61)) {
        static CONSTRUCTED: AtomicUsize = AtomicUsize::new(0);
        let large: Walls = walls.iter().map(|w| w.map(|x| 5 * x)).collect();
        check(&large, eye, &CONSTRUCTED)?;
        // From a wall's end, from the middle of a wall if that is on the grid, and from where many walls meet.
        let w = large[0];
        check(&large, [w[0], w[1]], &CONSTRUCTED)?;
        if (w[0] + w[2]) % 2 == 0 && (w[1] + w[3]) % 2 == 0 {
            check(&large, [(w[0] + w[2]) / 2, (w[1] + w[3]) / 2], &CONSTRUCTED)?;
        }
    }

    /// The same on a grid so small that walls overlap, touch and share ends most of the time.
    #[test]
    fn isovists_equal_a_sweep_where_walls_touch(walls in walls(12, 4), eye in prop::array::uniform2(0i64..61)) {
        static CONSTRUCTED: AtomicUsize = AtomicUsize::new(0);
        let large: Walls = walls.iter().map(|w| w.map(|x| 20 * x)).collect();
        check(&large, eye, &CONSTRUCTED)?;
        check(&large, eye.map(|x| x / 20 * 20), &CONSTRUCTED)?;
    }
}

/// Extents at the limits of coordinates, and plans of one wall, have a frame.
#[test]
fn extreme_plans_have_a_mesh() {
    let wall = |a: [f64; 2], b: [f64; 2]| sightlines_cells::Plan::from_walls([(a.into(), b.into())]).unwrap();
    let (tiny, huge) = (2f64.powi(-100), 2f64.powi(200));
    for (a, b) in [
        ([tiny, 0.0], [5.0 * tiny, 0.0]),
        ([-huge, -huge], [huge, huge]),
        ([0.0, 0.0], [1.0, 0.0]),
        ([500_000.0, 5_400_000.0], [500_000.001, 5_400_000.0]),
    ] {
        let mesh = WallMesh::new(&wall(a, b)).unwrap();
        let eye = sightlines_geometry::Point2::new(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
        assert!(mesh.isovist(eye).unwrap().vertices().len() >= 3, "{a:?}");
    }
    let none = sightlines_cells::Plan::default();
    assert!(WallMesh::new(&none).is_err());
    let open = WallMesh::around(&none, [point([0, 0]), point([4, 4])]).unwrap();
    assert!(open.sees(point([0, 0]), point([4, 4]), sightlines_isovist::Touch::Blocks).unwrap());
}

/// The impostor: with one wall less, the sweep finds another outline.
#[test]
fn a_missing_wall_is_found_out() {
    let walls: Walls = vec![[10, 10, 50, 10], [20, 20, 40, 22], [30, 5, 30, 30]];
    let n = AtomicUsize::new(0);
    check(&walls, [25, 40], &n).unwrap();
    assert!(n.load(Atomic::Relaxed) > 0, "no vertex was constructed");
    let mesh =
        WallMesh::with_frame(&plan(&walls), sightlines_geometry::Aabb { min: [-3.0; 2], max: [63.0; 2] }).unwrap();
    let other = canonical(&Sweep::new(&walls[1..].to_vec(), [[-3, -3], [63, 63]], [25, 40]).outline(), [25, 40]);
    assert_ne!(of(&mesh.isovist(point([25, 40])).unwrap()), other);
}
