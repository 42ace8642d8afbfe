//! Fields against exact integers, against samples, and against all triangles one by one.

use super::*;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use std::collections::BTreeSet;

type P = [i64; 3];
type Triangle = [P; 3];

fn real(p: P) -> Point3 {
    p.map(|x| x as f64)
}

fn features(triangles: &[Triangle]) -> Features {
    Features::new(triangles.iter().map(|t| t.map(real)))
}

fn sub(a: P, b: P) -> P {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: P, b: P) -> i64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// What a nearest point lies on: the places of the corners of a vertex or an edge, sorted, or the number of a face.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum On {
    Corners(Vec<P>),
    Face(usize),
}

/// Squared distance as a fraction, and what lies at it, for each triangle: the nearest point by barycentric coordinates,
/// minimized over all subsets of the corners, in integers.
fn exact(p: P, triangles: &[Triangle]) -> ((i64, i64), BTreeSet<On>) {
    let mut all: Vec<((i64, i64), On)> = Vec::new();
    for (i, t) in triangles.iter().enumerate() {
        for a in *t {
            all.push(((dot(sub(p, a), sub(p, a)), 1), On::Corners(vec![a])));
        }
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let (e, w) = (sub(b, a), sub(p, a));
            let (foot, length) = (dot(e, w), dot(e, e));
            if 0 < foot && foot < length {
                // |w|² - foot² / length
                all.push(((dot(w, w) * length - foot * foot, length), On::Corners(vec![a.min(b), a.max(b)])));
            }
        }
        // The normal equations of w = u e + v f, by Cramer's rule.
        let (e, f, w) = (sub(t[1], t[0]), sub(t[2], t[0]), sub(p, t[0]));
        let det = dot(e, e) * dot(f, f) - dot(e, f) * dot(e, f);
        let u = dot(w, e) * dot(f, f) - dot(w, f) * dot(e, f);
        let v = dot(w, f) * dot(e, e) - dot(w, e) * dot(e, f);
        if det > 0 && u > 0 && v > 0 && u + v < det {
            all.push(((dot(w, w) * det - u * dot(w, e) - v * dot(w, f), det), On::Face(i)));
        }
    }
    let least = all.iter().map(|x| x.0).min_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1))).expect("there is a triangle");
    let at = all.into_iter().filter(|((n, d), _)| n * least.1 == least.0 * d).map(|x| x.1).collect();
    (least, at)
}

/// What an id stands for, by places.
fn on(features: &Features, id: u32) -> On {
    let place = |v: u32| features.vertices[v as usize].map(|x| x as i64);
    match features.kind(id) {
        FeatureKind::Vertex => On::Corners(vec![place(id)]),
        FeatureKind::Edge => {
            let mut ends = features.edges[(id - features.first_edge()) as usize].map(place);
            ends.sort_unstable();
            On::Corners(ends.to_vec())
        }
        FeatureKind::Face => On::Face((id - features.first_face()) as usize),
    }
}

fn point() -> impl Strategy<Value = P> {
    prop::array::uniform3(-4i64..=4)
}

/// Few places, so that corners and edges are shared, triangles are flat, and much is equally far.
fn triangles() -> impl Strategy<Value = Vec<Triangle>> {
    prop::collection::vec(prop::array::uniform3(point()), 1..12)
}

/// Whether an answer is the exact one.
fn right(found: Nearest, features: &Features, p: P, triangles: &[Triangle]) -> bool {
    let ((n, d), at) = exact(p, triangles);
    let distance = (n as f64 / d as f64).sqrt();
    (found.distance - distance).abs() <= 1e-12 && at.contains(&on(features, found.feature))
}

proptest! {
    /// The nearest feature and its distance are those of exact arithmetic.
    #[test]
    fn nearest_is_the_exact_one(triangles in triangles(), p in point()) {
        let features = features(&triangles);
        let found = features.nearest(real(p)).unwrap();
        prop_assert!(right(found, &features, p, &triangles), "{found:?} {:?}", exact(p, &triangles));
    }

    /// The tree overlooks nothing: whole numbers give what all triangles one by one give, bit for bit; where
    /// distances are rounded, boxes may cut off what is nearer by that.
    #[test]
    fn the_tree_overlooks_nothing(triangles in triangles(), p in point(), by in 1i32..9) {
        let features = features(&triangles);
        let p = real(p).map(|x| x / f64::from(by));
        let all = (0..triangles.len() as u32).map(|i| features.of_face(p, i));
        let best = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).unwrap();
        let found = features.nearest(p).unwrap();
        if by == 1 {
            prop_assert_eq!(found, Nearest { feature: best.1, distance: best.0.sqrt() });
        } else {
            prop_assert!((found.distance - best.0.sqrt()).abs() <= 1e-12);
        }
    }

    /// No point of a triangle is nearer than the distance, and some point is hardly farther.
    #[test]
    fn distances_are_those_of_samples(triangles in triangles(), p in point()) {
        let found = features(&triangles).nearest(real(p)).unwrap().distance;
        let n = 24;
        let mut least = f64::INFINITY;
        for t in &triangles {
            for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
                let weights = [i, j, n - i - j].map(|w| f64::from(w) / f64::from(n));
                let q: Point3 = std::array::from_fn(|k| (0..3).map(|c| weights[c] * t[c][k] as f64).sum());
                least = least.min((0..3).map(|k| (q[k] - p[k] as f64).powi(2)).sum::<f64>().sqrt());
            }
        }
        // Longest edge: 8 sqrt(3); a sample is within a 24th of that.
        prop_assert!(found <= least + 1e-12 && least <= found + 8.0 * 3f64.sqrt() / f64::from(n), "{found} {least}");
    }
}

/// The impostor: answers that overlook a triangle, or name a neighbour, are noticed.
#[test]
fn wrong_answers_are_noticed() {
    let (mut n_cases, mut n_missed, mut n_renamed) = (0, 0, 0);
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for _ in 0..500 {
        let (all, p) = (triangles(), point()).new_tree(&mut runner).unwrap().current();
        if all.len() < 2 {
            continue;
        }
        n_cases += 1;
        let whole = features(&all);
        let fewer = features(&all[1..]).nearest(real(p)).unwrap();
        let distance_only = Nearest { feature: whole.nearest(real(p)).unwrap().feature, ..fewer };
        n_missed += u32::from(!right(distance_only, &whole, p, &all));
        let found = whole.nearest(real(p)).unwrap();
        let other = Nearest { feature: (found.feature + 1) % whole.len() as u32, ..found };
        n_renamed += u32::from(!right(other, &whole, p, &all));
    }
    assert!(n_cases > 300 && n_missed > 30 && n_renamed > 200, "{n_cases} {n_missed} {n_renamed}");
}

#[test]
fn shared_features_have_one_id() {
    // A square of two triangles, and a third triangle that touches one corner.
    let square = [[[0, 0, 0], [4, 0, 0], [4, 4, 0]], [[4, 4, 0], [0, 4, 0], [0, 0, 0]]];
    let features = features(&[square[0], square[1], [[4, 4, 0], [8, 4, 0], [8, 8, 0]]]);
    assert_eq!((features.first_edge(), features.first_face(), features.len()), (6, 6 + 8, 6 + 8 + 3));
    let nearest = |p: P| features.nearest(real(p)).unwrap();
    // On the diagonal: the edge between the two, not a face of either.
    let diagonal = nearest([2, 2, 3]);
    assert_eq!((features.kind(diagonal.feature), diagonal.distance), (FeatureKind::Edge, 3.0));
    assert_eq!(diagonal, Nearest { distance: 3.0, ..nearest([1, 1, 3]) });
    // Both sides of the border have faces of their own; the corner where all three meet is one vertex.
    assert_eq!(nearest([3, 1, 5]), Nearest { feature: 14, distance: 5.0 });
    assert_eq!(nearest([1, 3, -5]), Nearest { feature: 15, distance: 5.0 });
    assert_eq!(nearest([4, 4, 2]), Nearest { feature: 2, distance: 2.0 });
    assert_eq!(features.kind(2), FeatureKind::Vertex);
}

#[test]
fn zeros_of_both_signs_are_one_place() {
    let t = |zero: f64| [[zero, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 3.0, 1.0]];
    let features = Features::new([t(0.0), t(-0.0)]);
    assert_eq!((features.first_edge(), features.first_face(), features.len()), (3, 6, 8));
    // Of two faces at the same place, the first.
    assert_eq!(features.nearest([1.0, 1.0, 0.0]), Some(Nearest { feature: 6, distance: 1.0 }));
}

#[test]
fn fields_are_asked_at_the_centres_of_texels() {
    let plane = BufferPlane::new(2, true, 5.0, [0.0, 0.0], [4.0, 2.0], [4, 2]).unwrap();
    let features = features(&[[[0, 0, 2], [4, 0, 2], [0, 2, 2]]]);
    let field = NearestField::new(&features, &plane);
    assert_eq!(field.texels(), [4, 2]);
    let expected = |x: u32, y: u32| features.nearest([f64::from(x) + 0.5, f64::from(y) + 0.5, 5.0]);
    let all: Vec<_> = (0..2).flat_map(|y| (0..4).map(move |x| expected(x, y))).collect();
    assert_eq!(field.nearest(), all);
    let inside = field.nearest()[0].unwrap();
    assert_eq!((features.kind(inside.feature), inside.distance), (FeatureKind::Face, 3.0));
    let corner = field.nearest()[7].unwrap();
    assert!(features.kind(corner.feature) == FeatureKind::Edge && corner.distance == field.farthest());
    let nothing = NearestField::new(&Features::new([]), &plane);
    assert!(nothing.nearest().iter().all(Option::is_none) && nothing.farthest() == 0.0);
}

/// A curved surface of many triangles, with a thread for each row: the same bits again, and as if asked one by one.
#[test]
fn large_fields_can_be_repeated() {
    let height = |x: i64, y: i64| (x * x + 3 * y * y + x * y) % 17;
    let at = |x: i64, y: i64| [x, y, height(x, y)];
    let all: Vec<Triangle> = (0..40)
        .flat_map(|y| (0..40).map(move |x| (x, y)))
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect();
    let features = features(&all);
    assert_eq!((features.first_edge(), features.len() - features.first_face() as usize), (41 * 41, 3200));
    let plane = BufferPlane::new(2, true, 30.0, [-3.0, -3.0], [43.0, 43.0], [61, 47]).unwrap();
    let field = NearestField::new(&features, &plane);
    assert_eq!(field, NearestField::new(&features, &plane));
    for (i, nearest) in field.nearest().iter().enumerate().step_by(53) {
        let p = centre(&plane, i as u32 % 61, i as u32 / 61);
        let all = (0..all.len() as u32).map(|f| features.of_face(p, f));
        let best = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).unwrap();
        assert_eq!(nearest.unwrap().distance, best.0.sqrt(), "texel {i}");
    }
}
