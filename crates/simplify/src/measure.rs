//! The change between a scene and its simplification, measured with fresh rays.

use crate::compared::{Compared, Eyes};
use crate::rays::Traced;
use crate::simplified::Simplified;
use crate::simplify::{SimplifyError, in_threads};
use crate::views::Views;
use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_geometry::Point3;

/// Options for [`measure`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasureOptions {
    /// Number of eyes: half of them anywhere in the views by volume, the others in each box in turn.
    pub n_eyes: usize,
    /// Number of rays from each eye, anywhere on the sphere.
    pub n_rays: u64,
    /// Other seeds give other eyes and rays.
    pub seed: u64,
    /// Number of threads; 0 for one per core.
    pub threads: usize,
}

impl Default for MeasureOptions {
    fn default() -> Self {
        Self { n_eyes: 100, n_rays: 10_000, seed: 1, threads: 0 }
    }
}

/// Shares of changed rays.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Rays whose first hit is on another surface: not on the same face, nor on one of the same object exactly in the
    /// same plane. This is the share that the guarantee bounds.
    pub changed: f64,
    /// The same, for the worst eye.
    pub worst: f64,
    /// The worst eye.
    pub worst_eye: Point3,
    /// Rays that hit another object, or nothing in place of something, or the other way round.
    pub other_object: f64,
    /// Rays that hit another object or at a distance that differs by more than a hundredth: the visible change, where
    /// another surface may look the same.
    pub moved: f64,
    /// Number of rays.
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
    let compared = Compared::new(scene, simplified)?;
    in_threads(options.threads, || {
        let traced = compared.traced();
        let eyes = Eyes::new(views, options.seed);
        let look = |eye: usize| {
            let (place, mut random) = eyes.place(eye);
            let mut changes = Changes::default();
            let mut rays = traced.each_ref().map(Traced::rays);
            for _ in 0..options.n_rays {
                if let Some(change) = compared.look(&mut rays, place, random.direction()) {
                    changes.changed += 1;
                    changes.other_object += u64::from(change.is_other_object);
                    changes.moved += u64::from(change.has_moved);
                }
            }
            (place, changes)
        };
        let found: Vec<(Point3, Changes)> = (0..options.n_eyes).into_par_iter().map(look).collect();
        let n_rays = options.n_rays * options.n_eyes as u64;
        let share = |n: u64| n as f64 / n_rays.max(1) as f64;
        let sum = |of: fn(&Changes) -> u64| share(found.iter().map(|(_, c)| of(c)).sum());
        // The first of equals.
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
