//! The change between a scene and its simplification, measured with rays towards the changed triangles.

use crate::compared::{Cause, Compared, Eyes};
use crate::measure::MeasureOptions;
use crate::rays::Traced;
use crate::simplified::Simplified;
use crate::simplify::{SimplifyError, in_threads};
use crate::views::Views;
use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_geometry::vector::{dot, length, normal, sub};
use sightlines_geometry::{Point3, Random};

/// The share of changed directions, measured with aimed rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aimed {
    /// The mean over all eyes.
    pub changed: f64,
    /// For the worst eye.
    pub worst: f64,
    /// The standard error of `worst`.
    pub worst_error: f64,
    /// The worst eye.
    pub worst_eye: Point3,
}

/// Measures as [`measure`](crate::measure) does, with rays towards the triangles that were removed or added: only those
/// can have changed, so small shares are found with few rays.
///
/// For each eye, half of the rays go to points of triangles that are reported hidden, half to those of the others, to
/// each about in proportion to its share of the view. A changed ray counts for the triangle that it was aimed at if
/// that triangle caused the change, weighted by the reciprocal of its probability. The mean is the share that changes;
/// eyes within a triangle's plane do not count it.
///
/// Deterministic for a seed. O(n log n), and for each eye O(m) for m such triangles and two or four traced rays for each ray.
///
/// # Errors
/// [`SimplifyError::Faces`]
pub fn measure_aimed(
    scene: &Scene,
    simplified: &Simplified,
    views: &Views,
    options: &MeasureOptions,
) -> Result<Aimed, SimplifyError> {
    let compared = Compared::new(scene, simplified)?;
    in_threads(options.threads, || {
        let causes = compared.causes();
        let traced = compared.traced();
        let eyes = Eyes::new(views, options.seed);
        let look = |eye: usize| {
            let (place, mut random) = eyes.place(eye);
            let mut rays: Vec<_> = traced.iter().map(|both| both.each_ref().map(Traced::rays)).collect();
            // Means add up, and so do the squares of their errors.
            let (mut mean, mut error) = (0.0, 0.0);
            for causes in &causes {
                let targets = Targets::new(&compared, causes, place);
                let (mut sum, mut squares) = (0.0, 0.0);
                for _ in 0..options.n_rays / 2 {
                    let Some(shot) = targets.any(&compared, &mut random) else { break };
                    let hit = compared.look_through(&mut rays, place, shot.way, |d| d.cause == shot.cause).is_some();
                    let value = if hit { shot.weight } else { 0.0 };
                    sum += value;
                    squares += value * value;
                }
                let n = (options.n_rays / 2).max(1) as f64;
                mean += sum / n;
                error += (squares / n - (sum / n) * (sum / n)).max(0.0) / n;
            }
            (place, mean, error.sqrt())
        };
        let found: Vec<(Point3, f64, f64)> = (0..options.n_eyes).into_par_iter().map(look).collect();
        let changed = found.iter().map(|f| f.1).sum::<f64>() / options.n_eyes.max(1) as f64;
        // The first of equals.
        let worst = found.iter().rev().max_by(|a, b| a.1.total_cmp(&b.1)).copied();
        let (worst_eye, worst, worst_error) = worst.unwrap_or(([0.0; 3], 0.0, 0.0));
        Ok(Aimed { changed, worst, worst_error, worst_eye })
    })
}

/// Triangles to aim at from an eye.
struct Targets<'a> {
    causes: &'a [Cause],
    eye: Point3,
    /// Cumulative approximate shares of the view.
    sums: Vec<f64>,
}

/// A ray.
struct AimedRay {
    way: Point3,
    cause: Cause,
    /// The weight of a change along it.
    weight: f64,
}

impl<'a> Targets<'a> {
    fn new(compared: &Compared, causes: &'a [Cause], eye: Point3) -> Self {
        let mut sum = 0.0;
        let add = |&cause: &Cause| {
            let t = compared.corners(cause);
            let middle = [0, 1, 2].map(|k| t.iter().map(|p| p[k] / 3.0).sum::<f64>());
            // Never zero: triangles whose middle is seen edge-on get rays too.
            let (area, square) = (length(normal(*t)) / 2.0, dot(sub(middle, eye), sub(middle, eye)));
            sum += share(t, sub(middle, eye)).min(0.5) + 0.01 * area / (area + square);
            sum
        };
        Self { sums: causes.iter().map(add).collect(), causes, eye }
    }

    fn any(&self, compared: &Compared, random: &mut Random) -> Option<AimedRay> {
        let all = self.sums.last().copied().filter(|sum| *sum > 0.0)?;
        let at = random.unit() * all;
        let k = self.sums.partition_point(|&s| s <= at).min(self.sums.len() - 1);
        let chance = (self.sums[k] - if k == 0 { 0.0 } else { self.sums[k - 1] }) / all;
        let cause = self.causes[k];
        let t = compared.corners(cause);
        let (s, u) = (random.unit(), random.unit());
        let (s, u) = if s + u > 1.0 { (1.0 - s, 1.0 - u) } else { (s, u) };
        let way = [0, 1, 2].map(|k| t[0][k] + s * (t[1][k] - t[0][k]) + u * (t[2][k] - t[0][k]) - self.eye[k]);
        Some(AimedRay { way, cause, weight: share(t, way) / chance })
    }
}

/// The share of the sphere that a triangle takes up, if all of it appeared as its point at `way` from the eye does.
fn share(t: &[Point3; 3], way: Point3) -> f64 {
    let cube = dot(way, way) * length(way);
    let share = dot(normal(*t), way).abs() / 2.0 / cube / (4.0 * std::f64::consts::PI);
    if share.is_finite() { share } else { 0.0 }
}
