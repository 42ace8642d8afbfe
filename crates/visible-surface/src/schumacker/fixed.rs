//! The order of faces in a cluster that holds for every eye, or why there is none.

use super::Copy;
use crate::faces::Faces;
use crate::fragment::{Fragment, Relation};
use crate::plane::InputPlane;
use sightlines_geometry::{Adaptive, Orient2d, Point2, Point3};

/// Convex clusters of more faces are cut like others: seeing that they are compares all pairs.
const MAX_CONVEX: usize = 2048;

/// What was found.
pub(super) enum Fixed {
    /// An order, farthest first: every face has all others on one side, or in its plane.
    Convex(Vec<Copy>),
    /// An order, farthest first.
    Order(Vec<Copy>),
    /// The planes of faces that can hide each other in a circle.
    Cycle(Vec<InputPlane>),
    /// Not sought: there are too many faces.
    TooLarge,
}

/// Seeks the order of a cluster. Cost: pairs of fragments.
pub(super) fn order(faces: &Faces, cluster: &[Fragment], max_faces: usize) -> Fixed {
    if let Some(copies) = convex(faces, cluster) {
        return Fixed::Convex(copies);
    }
    if cluster.len() > max_faces.max(1) {
        return Fixed::TooLarge;
    }
    match sorted(&hides(faces, cluster)) {
        Ok(order) => Fixed::Order(order.into_iter().map(copy).collect()),
        Err(cycle) => {
            let mut fragments: Vec<usize> = cycle.into_iter().map(|c| c / 2).collect();
            fragments.sort_unstable();
            fragments.dedup();
            Fixed::Cycle(fragments.into_iter().map(|k| InputPlane::of(faces, cluster[k].face())).collect())
        }
    }
}

/// Copy 2k is the front of fragment k, copy 2k + 1 its back.
fn copy(index: usize) -> Copy {
    Copy { fragment: (index / 2) as u32, is_front: index.is_multiple_of(2) }
}

/// If every face has all others on one side, or in its plane: sides turned to the others, which hide none of the sides turned
/// away, and after them those, which hide none of each other.
fn convex(faces: &Faces, cluster: &[Fragment]) -> Option<Vec<Copy>> {
    if cluster.len() > MAX_CONVEX {
        return None;
    }
    let mut out = Vec::with_capacity(cluster.len());
    for fragment in cluster {
        let plane = InputPlane::of(faces, fragment.face());
        let mut side = Relation::In;
        for other in cluster {
            match (other.relation(faces, &plane), side) {
                (Relation::In, _) => {}
                (relation @ (Relation::Front | Relation::Behind), Relation::In) => side = relation,
                (relation, _) if relation == side => {}
                _ => return None,
            }
        }
        if side == Relation::In {
            return Some(flat(cluster.len()));
        }
        out.push(side == Relation::Front);
    }
    let side = |turned_away: bool| {
        let out = out.iter().enumerate().rev();
        // The positive side is turned to the others where they are in front. Higher ids first.
        out.map(move |(k, &in_front)| Copy { fragment: k as u32, is_front: in_front != turned_away })
    };
    Some(side(false).chain(side(true)).collect())
}

/// If all lie in one plane, nothing hides anything, but of faces that overlap the lower id is seen.
fn flat(n: usize) -> Vec<Copy> {
    (0..n as u32).rev().flat_map(|k| [true, false].map(|is_front| Copy { fragment: k, is_front })).collect()
}

/// For each copy those that it can hide while both face the eye.
fn hides(faces: &Faces, cluster: &[Fragment]) -> Vec<Vec<usize>> {
    let n = cluster.len();
    let planes: Vec<InputPlane> = cluster.iter().map(|f| InputPlane::of(faces, f.face())).collect();
    let relations: Vec<Relation> =
        cluster.iter().flat_map(|f| planes.iter().map(|plane| f.relation(faces, plane))).collect();
    // Whether a point of fragment i is on a side of the plane of k.
    let has = |i: usize, k: usize, positive: bool| match relations[i * n + k] {
        Relation::Front => positive,
        Relation::Behind => !positive,
        Relation::Across => true,
        Relation::In => false,
    };
    let mut out = vec![Vec::new(); 2 * n];
    for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
        if cluster[i].face() == cluster[k].face() {
            continue;
        }
        for (back_i, back_k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if has(i, k, back_k == 0) && has(k, i, back_i == 1) {
                out[2 * i + back_i].push(2 * k + back_k);
            }
        }
        // In one plane, of faces that overlap the lower id is seen.
        if relations[i * n + k] == Relation::In
            && cluster[i].face() < cluster[k].face()
            && let Some(is_same) = overlap(faces.of(cluster[i].face()), faces.of(cluster[k].face()))
        {
            // Planes across axes are turned alike whatever the faces.
            let is_same = is_same || matches!(planes[i], InputPlane::Axis(..));
            for back in [0, 1] {
                out[2 * i + back].push(2 * k + if is_same { back } else { 1 - back });
            }
        }
    }
    out
}

/// Of two triangles in one plane with an area each: nothing if their insides are apart; else whether they go round in the same sense.
fn overlap(a: &[Point3; 3], b: &[Point3; 3]) -> Option<bool> {
    let flat = |t: &[Point3; 3], (i, j): (usize, usize)| t.map(|p| Point2::new(p[i], p[j]));
    let turn = |t: &[Point2; 3]| Adaptive.orient(t[0], t[1], t[2]);
    // Seen along an axis that is not in the plane.
    let axes = [(0, 1), (1, 2), (2, 0)].into_iter().find(|&axes| turn(&flat(a, axes)) != 0.0)?;
    let (a, b) = (flat(a, axes), flat(b, axes));
    let is_same = (turn(&a) > 0.0) == (turn(&b) > 0.0);
    // Convex insides are apart if an edge has one of them on each side.
    let parts = |t: &[Point2; 3], other: &[Point2; 3]| {
        let sense = turn(t) > 0.0;
        let outside = |p: Point2, q: Point2, r: Point2| {
            let side = Adaptive.orient(p, q, r);
            side == 0.0 || (side > 0.0) != sense
        };
        (0..3).any(|k| other.iter().all(|&r| outside(t[k], t[(k + 1) % 3], r)))
    };
    (!parts(&a, &b) && !parts(&b, &a)).then_some(is_same)
}

/// Puts what hides after what it hides, ties by index; else the indices of a cycle.
fn sorted(hides: &[Vec<usize>]) -> Result<Vec<usize>, Vec<usize>> {
    let n = hides.len();
    let mut hidden_by = vec![Vec::new(); n];
    for (i, hidden) in hides.iter().enumerate() {
        hidden.iter().for_each(|&k| hidden_by[k].push(i));
    }
    // How many each one hides that are not placed yet.
    let mut left: Vec<usize> = hides.iter().map(Vec::len).collect();
    let mut order: Vec<usize> = (0..n).filter(|&i| left[i] == 0).collect();
    let mut at = 0;
    while let Some(&k) = order.get(at) {
        at += 1;
        for &i in &hidden_by[k] {
            left[i] -= 1;
            if left[i] == 0 {
                order.push(i);
            }
        }
    }
    if order.len() == n {
        return Ok(order);
    }
    // Each that is left hides another that is left; following that leads into a cycle.
    let mut way = Vec::new();
    let mut place = vec![usize::MAX; n];
    let mut i = left.iter().position(|&l| l > 0).expect("not all are placed");
    while place[i] == usize::MAX {
        place[i] = way.len();
        way.push(i);
        i = *hides[i].iter().find(|&&k| left[k] > 0).expect("hides one that is left");
    }
    Err(way.split_off(place[i]))
}
