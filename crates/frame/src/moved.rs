//! A scene along the axes of a frame.

use crate::snap::Snaps;
use sightlines_cells::{MovingObject, Scene, SceneError, SceneObject};
use sightlines_geometry::vector::{dot, normal};
use sightlines_geometry::{Aabb, Point2, Point3, orient2d};
use sightlines_pvs::Frame;

/// A scene along the axes of a frame, with coordinates that differ by less than the gap made equal.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// The same objects, with the same names, triangles and roles.
    pub scene: Scene,
    /// Which coordinates became which.
    pub snaps: Snaps,
    /// Number of corners.
    pub n_corners: usize,
    /// How many of them have a coordinate that was made equal to another.
    pub n_snapped: usize,
    /// Bound on the distance of any coordinate from its true one, along the axes of the frame, in scene units; less than the gap.
    pub most: f64,
}

/// Why a scene cannot be taken into a frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MoveError {
    /// The gap of the frame is within the rounding of doubles.
    Gap {
        /// Index of the object.
        object: usize,
        /// Index of the vertex in it.
        vertex: usize,
    },
    /// A coordinate along the axes of the frame cannot be used.
    Scene(SceneError),
}

impl std::fmt::Display for MoveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Gap { object, vertex } => {
                write!(f, "object {object}, vertex {vertex}: the gap of the frame is within the rounding of doubles")
            }
            Self::Scene(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MoveError {}

impl Moved {
    /// Takes a scene into a frame.
    ///
    /// Every coordinate is within [`Frame::gap`] of the true one. That is proven for each corner with the bound of its
    /// rounding; a coordinate that would be farther off is left where rounding puts it. Boxes that moving objects do not leave are widened to
    /// hold everything within the gap. O(n log n) for n triangles.
    ///
    /// # Errors
    /// [`MoveError::Gap`] if the rounding of a corner alone is not below the gap, [`MoveError::Scene`] if a coordinate becomes larger than
    /// scenes may have.
    pub fn new(scene: &Scene, frame: &Frame) -> Result<Self, MoveError> {
        let turned: Vec<Vec<Point3>> =
            scene.objects().iter().map(|o| o.vertices.iter().map(|&p| frame.to_frame(p)).collect()).collect();
        let triangles = scene.occluders().chain(scene.fronts()).flat_map(|(object, o)| {
            let corners = &turned[object as usize];
            o.triangles.iter().map(|t| t.map(|i| corners[i as usize]))
        });
        let snaps = Snaps::of(triangles, frame.gap());
        let (mut n_snapped, mut most) = (0, 0.0f64);
        let mut objects = Vec::with_capacity(turned.len());
        for (object, (o, turned)) in scene.objects().iter().zip(turned).enumerate() {
            let mut vertices = turned;
            for (vertex, (place, &p)) in vertices.iter_mut().zip(&o.vertices).enumerate() {
                let (at, rounding) = (*place, frame.rounding(p));
                for k in 0..3 {
                    let to = snaps.snap(k, at[k]);
                    let off = distance(at[k], to, rounding[k]);
                    let (to, off) =
                        if off < frame.gap() { (to, off) } else { (at[k], distance(at[k], at[k], rounding[k])) };
                    if off >= frame.gap() {
                        return Err(MoveError::Gap { object, vertex });
                    }
                    place[k] = to;
                    most = most.max(off);
                }
                n_snapped += usize::from(*place != at);
            }
            objects.push(SceneObject { name: o.name.clone(), vertices, triangles: o.triangles.clone() });
        }
        let keeps = |object: u32, and_lines: bool| {
            keeps_fronts(frame, &scene.objects()[object as usize], &objects[object as usize], and_lines)
        };
        let single_sided = scene.single_sided().iter().copied().filter(|&object| keeps(object, false)).collect();
        // What became a line hides nothing.
        let front_occluders = scene.front_occluders().iter().copied().filter(|&object| keeps(object, true)).collect();
        let n_corners = objects.iter().map(|o| o.vertices.len()).sum();
        let moving = |moving: &MovingObject| {
            let within = moving.within.map(|b| if b.is_empty() { b } else { around(frame, &b) });
            MovingObject { within, ..*moving }
        };
        let moved = Scene::new(objects)
            .and_then(|moved| moved.with_mirrors(scene.mirrors().to_vec()))
            .and_then(|moved| moved.with_moving(scene.moving().iter().map(moving).collect()))
            .and_then(|moved| moved.with_see_through(scene.see_through().to_vec()))
            .and_then(|moved| moved.with_single_sided(single_sided))
            .and_then(|moved| moved.with_front_occluders(front_occluders))
            .and_then(|moved| moved.with_doors(scene.doors().to_vec()))
            .and_then(|moved| moved.with_sources(scene.sources().to_vec()));
        Ok(Self { scene: moved.map_err(MoveError::Scene)?, snaps, n_corners, n_snapped, most })
    }

    /// The box of the frame around a box of the scene whose edges are along `axes`, unit vectors of the scene; `bounds` are its bounds
    /// along them. Sides of the box go with the planes that they are near, as corners of the scene do.
    ///
    /// Where the axes are those of the frame within the gap that is the box itself; else it is larger.
    pub fn box_around(&self, frame: &Frame, bounds: &Aabb<3>, axes: &[Point3; 3]) -> Aabb<3> {
        let corner = |along: Point3| {
            let p = std::array::from_fn(|k| axes[0][k] * along[0] + axes[1][k] * along[1] + axes[2][k] * along[2]);
            frame.to_frame(p)
        };
        let turned = Aabb::around(bounds.corners().map(corner));
        let snap = |p: Point3| std::array::from_fn(|k| self.snaps.snap(k, p[k]));
        Aabb { min: snap(turned.min), max: snap(turned.max) }
    }
}

/// The box of the frame that holds everything within the gap of a box of the scene.
fn around(frame: &Frame, b: &Aabb<3>) -> Aabb<3> {
    let (min, max) = frame.around(b.min, b.max);
    Aabb { min, max }
}

/// Bound on the distance of `to` from what `at` is rounded from: the difference and the sum round by a unit each.
fn distance(at: f64, to: f64, rounding: f64) -> f64 {
    ((to - at).abs() + rounding) * (1.0 + 4.0 * f64::EPSILON)
}

/// Whether every triangle of an object looks the same way after its corners were moved, or `and_lines` it became a line; one that became flat or
/// turned over has no front any more.
fn keeps_fronts(frame: &Frame, object: &SceneObject, moved: &SceneObject, and_lines: bool) -> bool {
    let fronts = |(t, m): ([Point3; 3], [Point3; 3])| {
        dot(normal(t.map(|p| frame.to_frame(p))), normal(m)) > 0.0 || and_lines && are_collinear(m)
    };
    object.corners().zip(moved.corners()).all(fronts)
}

/// Whether a triangle has no area. Exact.
fn are_collinear([a, b, c]: [Point3; 3]) -> bool {
    let seen_along = |axis: usize| {
        let [a, b, c] = [a, b, c].map(|p| Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]));
        orient2d(a, b, c) == 0.0
    };
    (0..3).all(seen_along)
}
