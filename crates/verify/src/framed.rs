//! Tables with a frame: the scene along the axes of the table, and whether it keeps the premise.
//!
//! The scene is moved by the code that moved it for the bake. What that code promises is not taken on trust: how far each corner is from
//! where the file has it is measured here, in other arithmetic.

use crate::findings::{Findings, Violation};
use crate::options::VerifyOptions;
use crate::oracle::{RayOracle, SolidWorld};
use crate::rays;
use crate::sight::{SightSegment, Target};
use crate::truth::{Truth, VerifyError};
use num_rational::BigRational;
use num_traits::Signed;
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_frame::{MoveError, Moved};
use sightlines_geometry::vector::normal;
use sightlines_geometry::{Aabb, Point3};
use sightlines_pvs::{CellId, Frame, Table};
use std::collections::BTreeSet;

/// The table of a scene without its frame, and the scene along the axes of the table: what holds of the one is to hold of the other.
/// `None` for a table without a frame.
///
/// # Errors
/// [`VerifyError::Frame`] if a coordinate of the moved scene is not within the gap of that of the file, which is
/// decided exactly; [`VerifyError::Range`] if the scene cannot be taken along the frame at all.
pub fn along_frame(table: &Table, scene: &Scene) -> Result<Option<(Table, Scene)>, VerifyError> {
    let Some(frame) = table.frame() else { return Ok(None) };
    let moved = Moved::new(scene, frame).map_err(|error| match error {
        MoveError::Gap { object, vertex } => VerifyError::Frame { object, vertex },
        _ => VerifyError::Range,
    })?;
    check_moves(scene, &moved.scene, frame)?;
    // The digests are those of the scene as it was.
    let table = table.clone().with_frame(None).map_err(|_| VerifyError::Range)?.with_digest(None);
    Ok(Some((table, moved.scene)))
}

/// Adds what a table with a frame may hide by its premise alone: shoots the rays once more, in the scene as the file has it. What the segment of such a ray
/// joins in the moved scene too is a violation that the first rays did not find.
///
/// * `table`: without its frame
/// * `scenes`: as the file has it, and along the frame
///
/// # Errors
/// If the observer cancels, and [`VerifyError::Range`] if coordinates become too large.
pub(crate) fn add_remarks(
    table: &Table,
    [file, along]: [&Scene; 2],
    frame: &Frame,
    options: &VerifyOptions<'_>,
    findings: &mut Findings,
) -> Result<(), VerifyError> {
    let has_area = |t: [Point3; 3]| normal(t) != [0.0; 3];
    let triangles =
        |scene: &Scene| scene.objects().iter().flat_map(SceneObject::corners).map(has_area).collect::<Vec<_>>();
    let flattened = triangles(file).into_iter().zip(triangles(along)).filter(|areas| *areas == (true, false));
    findings.remarks.flattened = flattened.count() as u64;
    if findings.no_rays.is_some() {
        return Ok(());
    }
    let turned = turned(file, frame)?;
    let mut seen = Findings::default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads can be started");
    pool.install(|| rays::check(table, &Truth::Scene(&turned), false, options, &mut seen))?;
    let pair = |violation: &Violation| match *violation {
        Violation::HiddenCell { cells: [from, to], segment } => Some((from, Target::Cell(to), segment)),
        Violation::HiddenObject { cell, object, segment } => Some((cell, Target::Object(object), segment)),
        _ => None,
    };
    let known: BTreeSet<(CellId, Target)> =
        findings.violations.iter().filter_map(pair).map(|(from, target, _)| (from, target)).collect();
    let world = SolidWorld::new(table, along);
    for violation in seen.violations {
        let Some((from, target, segment)) = pair(&violation) else { continue };
        if known.contains(&(from, target)) {
            continue;
        }
        if world.proves(&SightSegment { from, target, segment }) {
            findings.add(violation);
        } else {
            findings.remarks.cracks += 1;
        }
    }
    Ok(())
}

/// The scene along the frame, and nothing else: every coordinate is off by its rounding alone.
fn turned(scene: &Scene, frame: &Frame) -> Result<Scene, VerifyError> {
    let object = |o: &SceneObject| SceneObject {
        vertices: o.vertices.iter().map(|&p| frame.to_frame(p)).collect(),
        ..o.clone()
    };
    let moving = |moving: &MovingObject| {
        let around = |b: Aabb<3>| {
            let (min, max) = frame.around(b.min, b.max);
            Aabb { min, max }
        };
        MovingObject { within: moving.within.map(|b| if b.is_empty() { b } else { around(b) }), ..*moving }
    };
    Scene::new(scene.objects().iter().map(object).collect())
        .and_then(|turned| turned.with_moving(scene.moving().iter().map(moving).collect()))
        .and_then(|turned| turned.with_see_through(scene.see_through().to_vec()))
        .and_then(|turned| turned.with_single_sided(scene.single_sided().to_vec()))
        .and_then(|turned| turned.with_front_occluders(scene.front_occluders().to_vec()))
        .map_err(|_| VerifyError::Range)
}

/// Whether every corner of `moved` is within the gap of where `frame` puts that of `scene`, and the scenes are the same otherwise. Exact.
pub(crate) fn check_moves(scene: &Scene, moved: &Scene, frame: &Frame) -> Result<(), VerifyError> {
    for (object, (from, to)) in scene.objects().iter().zip(moved.objects()).enumerate() {
        for (vertex, (&p, &q)) in from.vertices.iter().zip(&to.vertices).enumerate() {
            if !is_within(frame, p, q) {
                return Err(VerifyError::Frame { object, vertex });
            }
        }
        if from.vertices.len() != to.vertices.len() || from.triangles != to.triangles {
            return Err(VerifyError::Frame { object, vertex: 0 });
        }
    }
    let roles = |scene: &Scene| (scene.objects().len(), scene.see_through().to_vec(), scene.mirrors().to_vec());
    // Fewer objects with one side show more.
    let sides = moved.single_sided().iter().all(|object| scene.single_sided().binary_search(object).is_ok());
    // Fewer that hide show more.
    let fronts = moved.front_occluders().iter().all(|&object| scene.hides_from_front(object));
    let movers = |scene: &Scene| scene.moving().iter().map(|m| (m.object, m.within.is_some())).collect::<Vec<_>>();
    let is_same = roles(scene) == roles(moved) && sides && fronts && movers(scene) == movers(moved);
    if is_same { Ok(()) } else { Err(VerifyError::Range) }
}

/// Whether each coordinate of `q` is less than the gap from that of `p` along the frame.
fn is_within(frame: &Frame, p: Point3, q: Point3) -> bool {
    frame.axes().iter().zip(q).all(|(axis, q)| {
        // Fused operations round three times; 2^-50 of the sizes has room for eight.
        let off = axis[2].mul_add(-p[2], axis[1].mul_add(-p[1], axis[0].mul_add(-p[0], q))).abs();
        let size = q.abs() + (axis[0] * p[0]).abs() + (axis[1] * p[1]).abs() + (axis[2] * p[2]).abs();
        let doubt = size * (4.0 * f64::EPSILON) + f64::MIN_POSITIVE;
        off + doubt < frame.gap() * (1.0 - f64::EPSILON)
            || (off < 2.0 * frame.gap() && is_within_exactly(axis, p, q, frame.gap()))
    })
}

fn is_within_exactly(axis: &Point3, p: Point3, q: f64, gap: f64) -> bool {
    let exact = |x: f64| BigRational::from_float(x);
    let products = axis.iter().zip(p).map(|(a, x)| Some(exact(*a)? * exact(x)?));
    let at = products.collect::<Option<Vec<_>>>().map(|products| products.into_iter().sum::<BigRational>());
    match (at, exact(q), exact(gap)) {
        (Some(at), Some(q), Some(gap)) => (q - at).abs() < gap,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::SceneObject;

    fn frame(gap: f64) -> Frame {
        Frame::new([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]], gap).unwrap()
    }

    #[test]
    fn distances_are_exact() {
        // Exactly along z: the gap itself is not within it, the number before it is.
        let gap = 0.25;
        let at = |z: f64| is_within(&frame(gap), [0.0; 3], [0.0, 0.0, z]);
        assert!(at(0.25f64.next_down()) && !at(0.25) && at(-0.25f64.next_down()) && !at(-0.25));
        assert!(
            is_within(&frame(gap), [4.0, 3.0, 1.0], [5.2, -0.2, 1.0])
                && !is_within(&frame(gap), [4.0, 3.0, 1.0], [5.3, 0.0, 1.0])
        );
    }

    /// The impostor: a corner that was moved too far, a triangle that is another one, and an object that hides no more.
    #[test]
    fn what_was_moved_too_far_is_found() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let object = |vertices: Vec<Point3>, t| SceneObject { name: "t".into(), vertices, triangles: vec![t] };
        let scene = Scene::new(vec![object(corners.to_vec(), [0, 1, 2])]).unwrap();
        let frame = frame(1e-3);
        let turned = |off: f64| {
            let mut moved = corners.map(|p| frame.to_frame(p)).to_vec();
            moved[1][2] += off;
            moved
        };
        let found = |moved: Scene| check_moves(&scene, &moved, &frame);
        assert_eq!(found(Scene::new(vec![object(turned(9e-4), [0, 1, 2])]).unwrap()), Ok(()));
        let wrong = VerifyError::Frame { object: 0, vertex: 1 };
        assert_eq!(found(Scene::new(vec![object(turned(1.1e-3), [0, 1, 2])]).unwrap()), Err(wrong));
        assert!(found(Scene::new(vec![object(turned(0.0), [0, 2, 1])]).unwrap()).is_err());
        let glass = Scene::new(vec![object(turned(0.0), [0, 1, 2])]).unwrap().with_see_through(vec![0]).unwrap();
        assert_eq!(found(glass), Err(VerifyError::Range));
        // What had two sides has one; the other way round more is seen.
        let plain = Scene::new(vec![object(turned(0.0), [0, 1, 2])]).unwrap();
        let single = |scene: &Scene| scene.clone().with_single_sided(vec![0]).unwrap();
        assert_eq!(found(single(&plain)), Err(VerifyError::Range));
        assert_eq!(check_moves(&single(&scene), &plain, &frame), Ok(()));
        // What moved stands still.
        let moving = sightlines_cells::MovingObject { object: 0, within: None };
        let moving = scene.clone().with_moving(vec![moving]).unwrap();
        let still = plain.with_see_through(vec![0]).unwrap();
        assert_eq!(check_moves(&moving, &still, &frame), Err(VerifyError::Range));
    }
}
