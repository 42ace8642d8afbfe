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

/// Shares of changed rays. A ray meets the same if that is on the same face, or on one of the same object exactly in the same plane: the share of others is
/// what the guarantee bounds. Where another surface may look the same, the visible change is in depth and objects.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Measured {
    /// Rays.
    pub n_rays: u64,
    /// Share of the rays that meet another face first, of all eyes.
    pub changed: f64,
    /// The same for the worst eye.
    pub worst: f64,
    /// This eye.
    pub worst_eye: Point3,
    /// Share of the rays that meet another object.
    pub other_object: f64,
    /// Share of the rays that meet a place whose depth differs by more than a hundredth.
    pub moved: f64,
}

/// Changes seen from one eye.
#[derive(Debug, Clone, Copy, Default)]
struct Changes {
    changed: u64,
    other_object: u64,
    moved: u64,
}

/// Sends fresh rays through a scene before and after. A ray's first hit is the same if it is on the same
/// triangle, or on one of the same object in the same plane. Where there is something see-through, the first hit behind all of
/// it has to be the same too.
///
/// Deterministic for a seed. O(n log n) and two or four traced rays for each ray.
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
            let mut rays: Vec<_> = traced.iter().map(|both| both.each_ref().map(Traced::rays)).collect();
            for _ in 0..options.n_rays {
                if let Some(change) = compared.look_through(&mut rays, place, random.direction(), |_| true) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::HitEstimate;
    use crate::simplified::Counts;
    use sightlines_cells::SceneObject;
    use sightlines_geometry::Aabb;
    use sightlines_multifocal::Volume;
    use sightlines_visible_surface::Faces;

    /// A pane before a wall, as seen from the origin along x.
    fn pane_and_wall() -> Scene {
        let square = |x: f64| SceneObject {
            name: String::new(),
            vertices: vec![[x, -9.0, -9.0], [x, 9.0, -9.0], [x, 9.0, 9.0], [x, -9.0, 9.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        Scene::new(vec![square(1.0), square(2.0)]).unwrap()
    }

    #[test]
    fn rays_pass_what_is_see_through() {
        let opaque = pane_and_wall();
        let glass = opaque.clone().with_see_through(vec![0]).unwrap();
        let views = Views::new([Volume::new(Aabb { min: [0.0; 3], max: [0.1; 3] }).unwrap()]).unwrap();
        // Without the wall.
        let simplified = Simplified {
            triangles: vec![vec![[0, 1, 2], [0, 2, 3]], Vec::new()],
            origin: vec![vec![Some(0), Some(1)], Vec::new()],
            hidden: vec![Vec::new(), vec![0, 1]],
            bound: 0.0,
            deviation: 0.0,
            shift: 0.0,
            counts: Counts::default(),
        };
        let options = MeasureOptions { n_eyes: 4, n_rays: 500, threads: 1, ..MeasureOptions::default() };
        let changed = |scene: &Scene| {
            let aimed = crate::measure_aimed(scene, &simplified, &views, &options).unwrap();
            (measure(scene, &simplified, &views, &options).unwrap().changed, aimed.changed)
        };
        let (seen, aimed) = changed(&glass);
        assert!((0.3..0.5).contains(&seen) && (0.3..0.5).contains(&aimed), "{seen} {aimed}");
        // The twin: behind a pane that hides, nothing changes but past its rim.
        let (seen, aimed) = changed(&opaque);
        assert!(seen < 0.02 && aimed < 0.02, "{seen} {aimed}");
        let hits = |scene: &Scene| {
            let estimate = HitEstimate::through(scene, &Faces::of_scene(scene).unwrap(), &views, 4000);
            [0..2, 2..4].map(|faces| faces.map(|face| estimate.hits(face)).sum::<u64>())
        };
        let ([pane, wall], [before, behind]) = (hits(&glass), hits(&opaque));
        assert!(pane == before && wall > 1000 && behind < 100, "{pane} {wall} {behind}");
    }
}
