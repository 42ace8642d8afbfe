//! What a simplified scene changes, measured by fresh rays.

use crate::estimate::Places;
use crate::rays::Traced;
use crate::simplified::Simplified;
use crate::simplify::{SimplifyError, in_threads};
use crate::vector::{dot, minus, normal};
use crate::views::Views;
use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_geometry::{Point3, Random, orient3d};
use sightlines_visible_surface::Faces;

/// How to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasureOptions {
    /// Eyes: half of them anywhere in the views by volume, the others in one box of them after the other.
    pub n_eyes: usize,
    /// Rays from each eye, anywhere on the sphere.
    pub n_rays: u64,
    /// Other seeds give other eyes and rays.
    pub seed: u64,
    /// Number of threads; 0 for one for each core.
    pub threads: usize,
}

impl Default for MeasureOptions {
    fn default() -> Self {
        Self { n_eyes: 100, n_rays: 10_000, seed: 1, threads: 0 }
    }
}

/// Shares of rays that are changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Rays whose first hit is on another surface: not on the same face, nor on one of the same object in the same plane, exactly. What
    /// is promised.
    pub changed: f64,
    /// The same, for the eye for which it is most.
    pub worst: f64,
    /// That eye.
    pub worst_eye: Point3,
    /// Rays that meet another object, or nothing in place of something, or the other way round.
    pub other_object: f64,
    /// Rays that meet another object or at a distance that differs by more than a hundredth: what is seen, where the surface is
    /// another one and looks the same.
    pub moved: f64,
    /// How many rays there were.
    pub n_rays: u64,
}

/// Changes seen from one eye.
#[derive(Debug, Clone, Copy, Default)]
struct Changes {
    changed: u64,
    other_object: u64,
    moved: u64,
}

/// Sends fresh rays through a scene before and after. A ray's first hit is the same if it is on the same
/// triangle, or on one of the same object in the same plane.
///
/// Deterministic for a seed. O(n log n) and two traced rays for each ray.
///
/// # Errors
/// [`SimplifyError::Faces`]
pub fn measure(
    scene: &Scene,
    simplified: &Simplified,
    views: &Views,
    options: &MeasureOptions,
) -> Result<Measured, SimplifyError> {
    let before = Faces::of_scene(scene)?;
    let after = Left::new(scene, simplified)?;
    in_threads(options.threads, || {
        let (old, new) = (Traced::new(&before), Traced::new(&after.faces));
        let places = Places::new(views);
        let look = |eye: usize| {
            let mut random = Random::new(options.seed ^ (eye as u64).wrapping_mul(0x2545_f491_4f6c_dd1d));
            // Every other eye is in one part after the other, so that flat parts get some as well.
            let part = views.parts()[eye / 2 % views.parts().len()].volume;
            let place = if eye.is_multiple_of(2) { places.any(&mut random) } else { random.point(part.bounds()) };
            let mut changes = Changes::default();
            let (mut old, mut new) = (old.rays(), new.rays());
            for _ in 0..options.n_rays {
                let way = random.direction();
                let (a, b) = (old.of(place, way), new.of(place, way));
                if a == b.and_then(|b| after.origin[b as usize]) && a.is_some() == b.is_some() {
                    continue;
                }
                if let (Some(a), Some(b)) = (a, b)
                    && before.object(a) == after.object[b as usize]
                    && in_one_plane(before.of(a), after.faces.of(b))
                {
                    continue;
                }
                changes.changed += 1;
                let objects = [a.map(|a| before.object(a)), b.map(|b| after.object[b as usize])];
                if objects[0] != objects[1] {
                    changes.other_object += 1;
                    changes.moved += 1;
                } else if let (Some(a), Some(b)) = (a, b) {
                    let [s, t] = [depth(before.of(a), place, way), depth(after.faces.of(b), place, way)];
                    changes.moved += u64::from((s - t).abs() > 0.01 * s.abs());
                }
            }
            (place, changes)
        };
        let found: Vec<(Point3, Changes)> = (0..options.n_eyes).into_par_iter().map(look).collect();
        let n_rays = options.n_rays * options.n_eyes as u64;
        let share = |n: u64| n as f64 / n_rays.max(1) as f64;
        let sum = |of: fn(&Changes) -> u64| share(found.iter().map(|(_, c)| of(c)).sum());
        // Of equals the first.
        let worst = found.iter().rev().max_by_key(|(_, c)| c.changed);
        Ok(Measured {
            changed: sum(|c| c.changed),
            worst: worst.map_or(0.0, |(_, c)| c.changed as f64 / options.n_rays.max(1) as f64),
            worst_eye: worst.map_or([0.0; 3], |w| w.0),
            other_object: sum(|c| c.other_object),
            moved: sum(|c| c.moved),
            n_rays,
        })
    })
}

/// What is left, with where it comes from.
struct Left {
    faces: Faces,
    object: Vec<u32>,
    /// The face of the whole scene that each one was.
    origin: Vec<Option<u32>>,
}

impl Left {
    fn new(scene: &Scene, simplified: &Simplified) -> Result<Self, SimplifyError> {
        let (mut corners, mut object, mut origin) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        let lists = simplified.triangles.iter().zip(&simplified.origin);
        for ((id, o), (triangles, origins)) in (0..).zip(scene.objects()).zip(lists) {
            for (triangle, of) in triangles.iter().zip(origins) {
                corners.push(triangle.map(|v| o.vertices[v as usize]));
                object.push(id);
                origin.push(of.map(|k| first + k));
            }
            first += o.triangles.len() as u32;
        }
        Ok(Self { faces: Faces::new(corners)?, object, origin })
    }
}

/// Whether two triangles lie in one plane, exactly.
fn in_one_plane([a, b, c]: &[Point3; 3], other: &[Point3; 3]) -> bool {
    other.iter().all(|p| orient3d(*a, *b, *c, *p) == 0.0)
}

/// How far along a ray the plane of a triangle is, rounded.
fn depth(t: &[Point3; 3], eye: Point3, way: Point3) -> f64 {
    let n = normal(t);
    dot(n, minus(t[0], eye)) / dot(n, way)
}
