//! Which plane cuts a set of fragments, and the cut.

use super::{BspOptions, Heuristic};
use crate::faces::Faces;
use crate::fragment::{Fragment, Relation};
use crate::plane::InputPlane;
use sightlines_geometry::Random;

/// What a plane makes of a set of fragments; each part keeps their order.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// On the positive side.
    pub(crate) front: Vec<Fragment>,
    /// On the negative side.
    pub(crate) behind: Vec<Fragment>,
    /// In the plane.
    pub(crate) within: Vec<Fragment>,
    /// How many were split.
    pub(crate) splits: u64,
}

impl Parts {
    /// Cuts a set.
    pub(crate) fn of(faces: &Faces, fragments: &[Fragment], plane: &InputPlane) -> Self {
        let mut parts = Self::default();
        for fragment in fragments {
            match fragment.split(faces, plane) {
                (Relation::Front, _) => parts.front.push(fragment.clone()),
                (Relation::Behind, _) => parts.behind.push(fragment.clone()),
                (Relation::In, _) => parts.within.push(fragment.clone()),
                (Relation::Across, pieces) => {
                    let [front, behind] = pieces.expect("what lies across a plane is split by it");
                    parts.front.push(front);
                    parts.behind.push(behind);
                    parts.splits += 1;
                }
            }
        }
        parts
    }

    /// Whether both sides have less than there was. The plane of a fragment always does that, as it keeps the fragment.
    fn is_progress(&self, n: usize) -> bool {
        self.front.len() < n && self.behind.len() < n
    }
}

/// How a plane would cut a set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Fragments on both sides.
    pub(crate) splits: usize,
    /// On the positive side alone.
    pub(crate) front: usize,
    /// On the negative side alone.
    pub(crate) behind: usize,
}

impl Tally {
    /// Counts how a plane lies to fragments.
    pub(crate) fn of<'a>(faces: &Faces, fragments: impl IntoIterator<Item = &'a Fragment>, plane: &InputPlane) -> Self {
        let mut tally = Self::default();
        for fragment in fragments {
            match fragment.relation(faces, plane) {
                Relation::Front => tally.front += 1,
                Relation::Behind => tally.behind += 1,
                Relation::Across => tally.splits += 1,
                Relation::In => {}
            }
        }
        tally
    }

    /// The lower the better.
    pub(crate) fn cost(&self, splits: f64, balance: f64) -> f64 {
        self.splits as f64 * splits + self.front.abs_diff(self.behind) as f64 * balance
    }
}

/// Weights of splits and of balance where nothing else was asked for. Of four buildings of 25,000 to 66,000 triangles, 16 made fewer fragments
/// than 8 by 1 to 6 %, in trees at most a sixth deeper; of the one where it was tried, 64 made 2 % fewer still. Of random triangles 8
/// makes 1 % fewer.
pub(crate) const WEIGHTS: [f64; 2] = [16.0, 1.0];
/// At most so many fragments say how good a candidate is.
const SAMPLE: usize = 256;
/// So many places across each axis are tried.
const PLACES: usize = 5;

/// Chooses a plane for a set that is not empty, and cuts it. `salt` varies what chance decides, always in the same way.
pub(crate) fn cut(faces: &Faces, fragments: &[Fragment], options: &BspOptions, salt: u64) -> (InputPlane, Parts) {
    if fragments.len() > options.axis_above
        && let Some(plane) = across_axis(faces, fragments, options)
    {
        let parts = Parts::of(faces, fragments, &plane);
        if parts.is_progress(fragments.len()) {
            return (plane, parts);
        }
    }
    let plane = of_face(faces, fragments, options, salt);
    (plane, Parts::of(faces, fragments, &plane))
}

/// The plane of one of the fragments.
fn of_face(faces: &Faces, fragments: &[Fragment], options: &BspOptions, salt: u64) -> InputPlane {
    let n = fragments.len();
    let plane = |k: usize| InputPlane::of(faces, fragments[k].face());
    let [splits, balance] = match options.heuristic {
        Heuristic::FirstFace => return plane(0),
        Heuristic::Random { seed } => {
            return plane((Random::new(seed ^ Random::new(salt).bits()).bits() % n as u64) as usize);
        }
        // One split more outweighs any balance: both count fragments.
        Heuristic::FewestSplits => [n as f64 + 1.0, 1.0],
        Heuristic::Balanced => [1.0, n as f64 + 1.0],
        Heuristic::Weighted { splits, balance } => [splits, balance],
    };
    let n_tried = options.candidates.clamp(1, n);
    let offset = (Random::new(salt).bits() % n as u64) as usize;
    let tried: Vec<usize> = (0..n_tried).map(|i| (offset + i * n / n_tried) % n).collect();
    best(faces, fragments, tried.into_iter().map(plane), [splits, balance]).map_or_else(|| plane(0), |(plane, _)| plane)
}

/// A plane across an axis at a corner of a face; none if none of those tried seems to part the set.
fn across_axis(faces: &Faces, fragments: &[Fragment], options: &BspOptions) -> Option<InputPlane> {
    let weights = match options.heuristic {
        Heuristic::Weighted { splits, balance } => [splits, balance],
        _ => WEIGHTS,
    };
    let mut planes = Vec::with_capacity(3 * PLACES);
    for axis in 0..3 {
        let mut at: Vec<f64> = sample(fragments, SAMPLE).flat_map(|f| faces.of(f.face()).map(|p| p[axis])).collect();
        at.sort_unstable_by(f64::total_cmp);
        // From a quarter of the way to three quarters.
        let places = (0..PLACES).map(|i| at[at.len() / 4 + i * (at.len() / 2) / (PLACES - 1).max(1)]);
        let mut last = None;
        for at in places {
            if last != Some(at) {
                planes.push(InputPlane::Axis(axis as u8, at));
            }
            last = Some(at);
        }
    }
    let (plane, tally) = best(faces, fragments, planes, weights)?;
    let n = sample(fragments, SAMPLE).count();
    // If nearly all of them end up on one side, nothing is won.
    (tally.splits + tally.front.max(tally.behind) <= n - n / 8).then_some(plane)
}

/// The first of the cheapest.
fn best(
    faces: &Faces,
    fragments: &[Fragment],
    planes: impl IntoIterator<Item = InputPlane>,
    [splits, balance]: [f64; 2],
) -> Option<(InputPlane, Tally)> {
    let mut best: Option<(InputPlane, Tally, f64)> = None;
    for plane in planes {
        let tally = Tally::of(faces, sample(fragments, SAMPLE), &plane);
        let cost = tally.cost(splits, balance);
        if best.is_none_or(|(_, _, least)| cost < least) {
            best = Some((plane, tally, cost));
        }
    }
    best.map(|(plane, tally, _)| (plane, tally))
}

/// At most `n` of the fragments, evenly.
fn sample(fragments: &[Fragment], n: usize) -> impl Iterator<Item = &Fragment> {
    fragments.iter().step_by(fragments.len().div_ceil(n).max(1))
}
