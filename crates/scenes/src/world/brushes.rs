//! Worlds made from brushes: convex pieces that are added or cut away, one after the other, as in level editors.

use super::build::{Builder, Decision, EPSILON};
use super::plane::WorldPlane;
use super::polytope::Polytope;
use super::{World, build};
use sightlines_geometry::Point3;

/// A convex piece that is solid or empty; a later brush overrides it.
#[derive(Debug, Clone, PartialEq)]
pub struct Brush {
    /// The planes around it; they face outwards.
    pub planes: Vec<WorldPlane>,
    /// Whether it adds or cuts away.
    pub is_solid: bool,
}

impl Brush {
    /// A solid box with integer corners, of which `min` is the low one on every axis.
    pub fn solid(min: [i32; 3], max: [i32; 3]) -> Self {
        let lows = (0..3).map(|k| WorldPlane::axial(k, f64::from(min[k])).flipped());
        let highs = (0..3).map(|k| WorldPlane::axial(k, f64::from(max[k])));
        Self { planes: lows.chain(highs).collect(), is_solid: true }
    }

    /// An empty box.
    pub fn empty(min: [i32; 3], max: [i32; 3]) -> Self {
        Self { is_solid: false, ..Self::solid(min, max) }
    }

    /// The same without the part in front of the plane through a point.
    #[must_use]
    pub fn cut(mut self, normal: [i32; 3], through: [i32; 3]) -> Self {
        let offset = (0..3).map(|k| f64::from(normal[k]) * f64::from(through[k])).sum();
        self.planes.push(WorldPlane { normal, offset });
        self
    }
}

/// A brush inside the region, with its corners.
struct Placed {
    planes: Vec<WorldPlane>,
    corners: Vec<Point3>,
    is_solid: bool,
}

/// The position of a piece of the world relative to a brush.
enum Place {
    Outside,
    Inside,
    Across,
}

/// Most candidates for the best plane of a cut; otherwise cuts near the root would take all the time.
const MAX_CANDIDATES: usize = 40;

/// A box full of brushes, in which everything is solid unless a brush empties it. Pieces are cut along the planes of
/// brushes until none is partly solid.
pub fn world_of_brushes(min: [i32; 3], max: [i32; 3], brushes: &[Brush]) -> World {
    let [min, max] = [min, max].map(|corner| corner.map(f64::from));
    let region = Polytope::cuboid(min, max);
    let placed: Vec<Placed> = brushes.iter().filter_map(|brush| place(&region, brush)).collect();
    Builder::grow(region, (0..placed.len()).collect(), |piece, near: Vec<usize>| decide(piece, &near, &placed))
}

/// The brush inside the region; `None` if it is outside.
fn place(region: &Polytope, brush: &Brush) -> Option<Placed> {
    let mut inside = region.clone();
    for plane in &brush.planes {
        let [low, high] = inside.range(plane);
        if low >= -EPSILON {
            return None;
        }
        if high > EPSILON {
            let [_, behind] = inside.split(plane, EPSILON)?;
            inside = behind;
        }
    }
    let corners = inside.corners().collect();
    Some(Placed { planes: brush.planes.clone(), corners, is_solid: brush.is_solid })
}

fn lie(piece: &Polytope, brush: &Placed) -> Place {
    let mut place = Place::Inside;
    for plane in &brush.planes {
        let [low, high] = piece.range(plane);
        if low >= -EPSILON {
            return Place::Outside;
        }
        if high > EPSILON {
            place = Place::Across;
        }
    }
    let beyond = |plane: &WorldPlane| brush.corners.iter().all(|&p| plane.distance(p) >= -EPSILON);
    if piece.faces.iter().any(|(plane, _)| beyond(plane)) { Place::Outside } else { place }
}

fn decide(piece: &Polytope, near: &[usize], placed: &[Placed]) -> Decision<Vec<usize>> {
    // From the last brush, which takes precedence, to the first that contains the piece.
    let mut across = Vec::new();
    let mut is_solid = true;
    let mut base = None;
    for &brush in near.iter().rev() {
        match lie(piece, &placed[brush]) {
            Place::Outside => {}
            Place::Across => across.push(brush),
            Place::Inside => {
                is_solid = placed[brush].is_solid;
                base = Some(brush);
                break;
            }
        }
    }
    // A brush of the same kind as the next one below it has no effect.
    while across.last().is_some_and(|&b| placed[b].is_solid == is_solid) {
        across.pop();
    }
    let Some((plane, halves)) = best_cut(piece, &across, placed) else { return Decision::Leaf { is_solid } };
    let relevant: Vec<usize> = base.into_iter().chain(across.into_iter().rev()).collect();
    Decision::Cut { plane, halves, data: [relevant.clone(), relevant] }
}

/// The plane that cuts few brushes and leaves as many on either side, axial if possible.
fn best_cut(piece: &Polytope, across: &[usize], placed: &[Placed]) -> Option<(WorldPlane, [Polytope; 2])> {
    let mut candidates: Vec<WorldPlane> = Vec::new();
    let all: Vec<&WorldPlane> = across.iter().flat_map(|&b| &placed[b].planes).collect();
    let stride = all.len().div_ceil(MAX_CANDIDATES).max(1);
    for start in 0..stride {
        for plane in all.iter().skip(start).step_by(stride) {
            let [low, high] = piece.range(plane);
            if low < -EPSILON && high > EPSILON && !candidates.contains(plane) {
                candidates.push(**plane);
            }
        }
        if !candidates.is_empty() {
            break;
        }
    }
    let mut scored: Vec<(i64, usize)> = candidates.iter().map(|plane| score(plane, across, placed)).zip(0..).collect();
    scored.sort_unstable();
    scored.into_iter().find_map(|(_, k)| {
        let plane = candidates[k];
        Some((plane, piece.split(&plane, build::EPSILON)?))
    })
}

/// Smaller is better.
fn score(plane: &WorldPlane, across: &[usize], placed: &[Placed]) -> i64 {
    let (mut front, mut back, mut both) = (0i64, 0i64, 0i64);
    for &brush in across {
        let distances = placed[brush].corners.iter().map(|&p| plane.distance(p));
        let (low, high) = distances.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        front += i64::from(low >= -EPSILON);
        back += i64::from(high <= EPSILON);
        both += i64::from(low < -EPSILON && high > EPSILON);
    }
    4 * both + (front - back).abs() + if plane.axis().is_none() { 5 } else { 0 }
}
