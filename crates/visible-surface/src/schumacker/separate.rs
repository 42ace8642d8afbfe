//! Planes between clusters.

use super::Region;
use crate::bsp::{Parts, Tally, WEIGHTS};
use crate::faces::Faces;
use crate::fragment::{Fragment, Relation};
use crate::plane::InputPlane;

/// Among more clusters than this, a plane across an axis must leave a part of them on each side, or sorting all of them for each plane
/// would take the square of their number.
const FEW: usize = 256;
/// The part: one in so many.
const PART: usize = 64;
/// So many fragments are compared with planes of faces, for each choice; about.
const EFFORT: usize = 1 << 16;
/// So many candidates in a cycle.
const CYCLE: usize = 16;

/// A plane that parts several clusters: one across an axis that cuts none, else one of a face that cuts none, else the
/// cheapest of those that cut some. None if only the plane of a face would do, whichever.
pub(super) fn plane(faces: &Faces, clusters: &[Vec<Fragment>], region: &Region) -> Option<InputPlane> {
    let n = clusters.len();
    let boxes: Vec<Region> = clusters.iter().map(|c| bounds(faces, c, region)).collect();
    let places = (0..3).flat_map(|axis| across(&boxes, axis));
    let places = places.filter(|(_, tally)| n <= FEW || tally.front.min(tally.behind) >= n / PART);
    let places: Vec<(InputPlane, Tally)> = places.collect();
    let clean = places.iter().filter(|(_, tally)| tally.splits == 0);
    if let Some((plane, _)) = clean.min_by_key(|(_, tally)| tally.front.abs_diff(tally.behind)) {
        return Some(*plane);
    }
    if let Some(plane) = of_face(faces, clusters) {
        return Some(plane);
    }
    let cost = |tally: &Tally| tally.cost(WEIGHTS[0], WEIGHTS[1]);
    places.iter().min_by(|a, b| cost(&a.1).total_cmp(&cost(&b.1))).map(|(plane, _)| *plane)
}

/// The box of a cluster, within the region that it has been cut to.
fn bounds(faces: &Faces, cluster: &[Fragment], region: &Region) -> Region {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for p in cluster.iter().flat_map(|f| faces.of(f.face())) {
        for (of, &x) in bounds.iter_mut().zip(p) {
            *of = [of[0].min(x), of[1].max(x)];
        }
    }
    for (of, region) in bounds.iter_mut().zip(region) {
        *of = of.map(|x| x.clamp(region[0], region[1]));
    }
    bounds
}

/// Planes across an axis that leave a box on each side: where boxes begin or end, with how many they cut.
fn across(boxes: &[Region], axis: usize) -> Vec<(InputPlane, Tally)> {
    let sorted = |side: usize| {
        let mut all: Vec<f64> = boxes.iter().map(|b| b[axis][side]).collect();
        all.sort_unstable_by(f64::total_cmp);
        all
    };
    let (begins, ends) = (sorted(0), sorted(1));
    let mut flat: Vec<f64> = boxes.iter().map(|b| b[axis]).filter(|b| b[0] == b[1]).map(|b| b[0]).collect();
    flat.sort_unstable_by(f64::total_cmp);
    let mut places: Vec<f64> = begins.iter().chain(&ends).copied().collect();
    places.sort_unstable_by(f64::total_cmp);
    places.dedup();
    let below = |all: &[f64], at: f64| all.partition_point(|&x| x < at);
    let up_to = |all: &[f64], at: f64| all.partition_point(|&x| x <= at);
    let tally = |at: f64| {
        let flat = up_to(&flat, at) - below(&flat, at);
        let behind = up_to(&ends, at) - flat;
        let front = boxes.len() - below(&begins, at) - flat;
        Tally { splits: boxes.len() - front - behind - flat, front, behind }
    };
    let all = places.into_iter().map(|at| (InputPlane::Axis(axis as u8, at), tally(at)));
    all.filter(|(_, tally)| tally.front > 0 && tally.behind > 0).collect()
}

/// The most balanced plane of a face that cuts no cluster and has some on both sides, if one is found.
fn of_face(faces: &Faces, clusters: &[Vec<Fragment>]) -> Option<InputPlane> {
    let n: usize = clusters.iter().map(Vec::len).sum();
    let n_tried = n.min(EFFORT / n.max(1));
    if n_tried == 0 {
        return None;
    }
    let candidates = clusters.iter().flatten().step_by(n.div_ceil(n_tried)).map(|f| InputPlane::of(faces, f.face()));
    let tallies = candidates.filter_map(|plane| Some((plane, clean(faces, clusters, &plane)?)));
    let parting = tallies.filter(|(_, tally)| tally.front > 0 && tally.behind > 0);
    parting.min_by_key(|(_, tally)| tally.front.abs_diff(tally.behind)).map(|(plane, _)| plane)
}

/// How many clusters lie on each side of a plane; none if it cuts one.
fn clean(faces: &Faces, clusters: &[Vec<Fragment>], plane: &InputPlane) -> Option<Tally> {
    let mut tally = Tally::default();
    for cluster in clusters {
        let (mut front, mut behind) = (false, false);
        for fragment in cluster {
            match fragment.relation(faces, plane) {
                Relation::Front => front = true,
                Relation::Behind => behind = true,
                Relation::Across => return None,
                Relation::In => {}
            }
            if front && behind {
                return None;
            }
        }
        tally.front += usize::from(front);
        tally.behind += usize::from(behind);
    }
    Some(tally)
}

/// Cuts a cluster by the cheapest of some planes of faces in it, of which there is at least one.
pub(super) fn cheapest(faces: &Faces, cluster: &[Fragment], planes: &[InputPlane]) -> (InputPlane, Parts) {
    let tried = planes.iter().step_by(planes.len().div_ceil(CYCLE));
    let cost = |plane: &InputPlane| Tally::of(faces, cluster, plane).cost(WEIGHTS[0], WEIGHTS[1]);
    let costs = tried.map(|plane| (plane, cost(plane)));
    let (plane, _) = costs.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a cycle has faces");
    (*plane, Parts::of(faces, cluster, plane))
}
