//! The floor plan of a scene: what a horizontal plane cuts.

use crate::gap::Gap;
use num_traits::ToPrimitive;
use sightlines_cells::{LineId, Plan, PlanError, PlanLine, Scene};
use sightlines_exact::rational;
use sightlines_formats::SceneFile;
use sightlines_geometry::{CoordinateError, Point2, Point3, check_coordinate, orient2d};
use sightlines_pvs::Axis;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// The plan at a height of a scene, and what was done for it.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorCut {
    /// The plan. It has no objects.
    pub plan: Plan,
    /// Triangles that the plane meets in a segment.
    pub n_cut: usize,
    /// Triangles that lie in the plane, which are left out: what bounds them is the edge of others.
    pub n_flat: usize,
    /// Segments that were dropped because another is the same.
    pub n_doubled: usize,
    /// Segments shorter than their coordinates can tell, which were dropped.
    pub n_without_length: usize,
    /// Pairs of segments that were joined to one.
    pub n_joined: usize,
}

/// Why there is no plan at a height.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FloorCutError {
    /// The height is no coordinate.
    #[error("the height: {0}")]
    Height(#[from] CoordinateError),
    /// Nothing that hides or is see-through is cut.
    #[error("nothing is cut at the height {height}: {}", reach(*.extent))]
    Nothing {
        /// The height.
        height: f64,
        /// The lowest and the highest corner of the scene; `None` if it has none.
        extent: Option<[f64; 2]>,
    },
    /// The segments do not make a plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

fn reach(extent: Option<[f64; 2]>) -> String {
    extent.map_or("the scene has no triangles".to_owned(), |[low, high]| format!("the scene is from {low} to {high}"))
}

/// What a segment is, beside its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Sight {
    is_opaque: bool,
    is_mirror: bool,
}

/// Cuts the triangles of a scene with the horizontal plane at a height.
///
/// Triangles of objects that hide give lines that block sight, mirrors among them if the object is one; those of see-through objects
/// give lines that do not. What moves, and doors, are left out: they are not where they stand, and are taken to be open. Single-sided
/// walls block from both sides, as they do in the scene.
///
/// Lengths stay what they are. The plan is right-handed seen from above: with y up, its x is the scene's x, and its y is the scene's
/// −z; with z up its x and y are those of the scene; with x up they are y and z.
///
/// Whether a triangle is cut is exact, by the sides of the plane on which its corners are. A triangle that only touches the plane
/// with an edge gives that edge, one that touches it with a corner gives nothing, and one that lies in it gives nothing. So a plane
/// through the very top of a door's opening closes the door; take a height between those of corners. Points where edges cross the plane
/// are computed exactly and rounded once to the nearest doubles, so neighbours stay joined; walls are moved by at most half a unit in
/// the last place, to either side. Segments with the same ends are kept once. Two that meet where no other ends, on one straight line,
/// are joined; that is decided exactly, so only where rounding kept them in line.
///
/// O(n log n) for n triangles.
///
/// # Errors
/// [`FloorCutError`]
pub fn floor_cut(scene: &Scene, up: Axis, height: f64) -> Result<FloorCut, FloorCutError> {
    let height = check_coordinate(height)?;
    let mut cut = Segments::default();
    for (object, o) in (0u32..).zip(scene.objects()) {
        let is_moving = scene.moving().binary_search_by_key(&object, |moving| moving.object).is_ok();
        if is_moving || scene.doors().binary_search(&object).is_ok() {
            continue;
        }
        // A plan shows walls, not from which side they hide.
        let is_opaque = scene.is_opaque(object) || scene.hides_from_front(object);
        let is_mirror = is_opaque && scene.mirrors().binary_search(&object).is_ok();
        for corners in o.corners() {
            cut.add(corners.map(|p| upright(p, up)), height, Sight { is_opaque, is_mirror });
        }
    }
    if cut.segments.is_empty() {
        let heights: Vec<f64> =
            scene.objects().iter().flat_map(|o| o.corners().flatten()).map(|p| upright(p, up)[2]).collect();
        let lowest = heights.iter().copied().reduce(f64::min);
        let extent = lowest.zip(heights.iter().copied().reduce(f64::max)).map(|(low, high)| [low, high]);
        return Err(FloorCutError::Nothing { height, extent });
    }
    let n_joined = cut.join();
    let Segments { segments, n_cut, n_flat, n_doubled, n_without_length, .. } = cut;
    let (mut lines, mut mirrors) = (Vec::new(), Vec::new());
    for Segment { a, b, sight } in segments.into_iter().flatten() {
        mirrors.extend(u32::try_from(lines.len()).ok().filter(|_| sight.is_mirror).map(LineId));
        lines.push(PlanLine { opaque: sight.is_opaque, ..PlanLine::wall(a, b) });
    }
    let plan = Plan::new(lines, Vec::new())?.with_mirrors(mirrors)?;
    Ok(FloorCut { plan, n_cut, n_flat, n_doubled, n_without_length, n_joined })
}

impl FloorCut {
    /// The [cut](floor_cut) of a scene from a file, by the axis that points up there. The plan states the precision of the file
    /// ([`Gap::of_file`]), if it has one.
    ///
    /// # Errors
    /// [`FloorCutError`]
    pub fn of_file(file: &SceneFile, height: f64) -> Result<Self, FloorCutError> {
        let cut = floor_cut(&file.scene, file.info.up, height)?;
        let precision = Some(Gap::of_file(&file.scene, &file.info)).filter(|precision| *precision > 0.0);
        Ok(Self { plan: cut.plan.with_precision(precision), ..cut })
    }
}

/// Coordinates with z up, right-handed.
fn upright([x, y, z]: Point3, up: Axis) -> Point3 {
    match up {
        Axis::X => [y, z, x],
        // No negative zeros.
        Axis::Y => [x, 0.0 - z, y],
        Axis::Z => [x, y, z],
    }
}

/// A segment of the cut.
#[derive(Debug, Clone, Copy)]
struct Segment {
    a: Point2,
    b: Point2,
    sight: Sight,
}

/// A point in the order of its coordinates' bits.
type Key = [u64; 2];

fn key(p: Point2) -> Key {
    [p.x.to_bits(), p.y.to_bits()]
}

#[derive(Debug, Default)]
struct Segments {
    /// In the order of the triangles; `None` for one that was joined to another.
    segments: Vec<Option<Segment>>,
    seen: BTreeSet<(Key, Key, Sight)>,
    n_cut: usize,
    n_flat: usize,
    n_doubled: usize,
    n_without_length: usize,
}

impl Segments {
    /// Adds what the plane cuts of a triangle with z up.
    fn add(&mut self, corners: [Point3; 3], height: f64, sight: Sight) {
        let side = |p: &Point3| p[2].partial_cmp(&height).unwrap_or(Ordering::Equal);
        let sides = corners.each_ref().map(side);
        if sides == [Ordering::Equal; 3] {
            self.n_flat += 1;
            return;
        }
        let touching = (0..3).filter(|&k| sides[k].is_eq()).map(|k| Point2::new(corners[k][0], corners[k][1]));
        let crossing = (0..3).map(|k| (k, (k + 1) % 3)).filter(|&(i, j)| {
            let is_across = |a: Ordering, b: Ordering| a.is_lt() && b.is_gt();
            is_across(sides[i], sides[j]) || is_across(sides[j], sides[i])
        });
        let crossed = crossing.map(|(i, j)| cross(corners[i], corners[j], height));
        let ends: Vec<Point2> = touching.chain(crossed).collect();
        // One point, or none: the triangle touches the plane with a corner, or not at all.
        if let [a, b] = ends[..] {
            self.n_cut += 1;
            self.push(Segment { a, b, sight });
        }
    }

    fn push(&mut self, segment: Segment) {
        if segment.a == segment.b {
            self.n_without_length += 1;
        } else if self.seen.insert(identity(&segment)) {
            self.segments.push(Some(segment));
        } else {
            self.n_doubled += 1;
        }
    }

    /// Joins segments that are one but for a point between them; returns how often.
    fn join(&mut self) -> usize {
        let mut ends: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        for (idx, segment) in self.segments.iter().enumerate() {
            for p in segment.iter().flat_map(|segment| [segment.a, segment.b]) {
                ends.entry(key(p)).or_default().push(idx);
            }
        }
        let mut n_joined = 0;
        let points: Vec<Key> = ends.keys().copied().collect();
        for at in points {
            let [first, second] = ends[&at][..] else { continue };
            let (Some(one), Some(two)) = (self.segments[first], self.segments[second]) else { continue };
            let far = |segment: Segment| if key(segment.a) == at { segment.b } else { segment.a };
            let middle = if key(one.a) == at { one.a } else { one.b };
            let (a, b) = (far(one), far(two));
            let joined = Segment { a, b, sight: one.sight };
            if one.sight != two.sight || !is_between(a, middle, b) || !self.seen.insert(identity(&joined)) {
                continue;
            }
            // The one that came first stays in its place.
            let (keep, drop) = (first.min(second), first.max(second));
            (self.segments[keep], self.segments[drop]) = (Some(joined), None);
            for p in [a, b] {
                ends.entry(key(p)).or_default().iter_mut().filter(|idx| **idx == drop).for_each(|idx| *idx = keep);
            }
            n_joined += 1;
        }
        n_joined
    }
}

/// The ends in order, and what it is.
fn identity(segment: &Segment) -> (Key, Key, Sight) {
    let (a, b) = (key(segment.a), key(segment.b));
    (a.min(b), a.max(b), segment.sight)
}

/// Whether `p` is on the segment from `a` to `b`, and none of its ends. Exact.
fn is_between(a: Point2, p: Point2, b: Point2) -> bool {
    let within = |a: f64, p: f64, b: f64| a.min(b) <= p && p <= a.max(b);
    a != b && orient2d(a, p, b) == 0.0 && within(a.x, p.x, b.x) && within(a.y, p.y, b.y)
}

/// Where the edge between two corners, one above the plane and one below, crosses it; rounded once, and the same for both directions.
fn cross(p: Point3, q: Point3, height: f64) -> Point2 {
    let [low, high] = [p[2], q[2]].map(rational);
    let share = (rational(height) - &low) / (high - &low);
    let at = |k: usize| {
        let (from, to) = (rational(p[k]), rational(q[k]));
        let x = (&to - &from) * &share + from;
        // Between two coordinates, so in range; what is too close to zero to be one becomes zero.
        check_coordinate(x.to_f64().unwrap_or(0.0)).unwrap_or(0.0)
    };
    Point2::new(at(0), at(1))
}
