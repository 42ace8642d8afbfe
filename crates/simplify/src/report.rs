//! What rays find of a simplification, as fields for programs and as lines for people.

use crate::estimate::{HitEstimate, interval};
use crate::measure::{MeasureOptions, Measured, measure};
use crate::options::SimplifyOptions;
use crate::simplified::Simplified;
use crate::simplify::SimplifyError;
use crate::views::Views;
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use sightlines_cells::Scene;
use sightlines_progress::words::parts;
use sightlines_visible_surface::Faces;
use std::fmt;

/// What rays say.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct RayReport {
    #[serde(flatten)]
    measured: Measured,
    /// Share of other rays that met, before, what was removed or merged.
    estimate: f64,
    /// An interval that contains the true share with a probability of 99 %.
    estimate_interval: [f64; 2],
    /// Rays of this estimate.
    n_estimate_rays: u64,
    #[serde(skip)]
    has_merged: bool,
}

impl RayReport {
    /// Sends rays through a scene before and after, and others before, as many as `options` has.
    ///
    /// # Errors
    /// Those of [`measure`].
    pub fn new(
        scene: &Scene,
        views: &Views,
        simplified: &Simplified,
        options: &SimplifyOptions,
    ) -> Result<Self, SimplifyError> {
        let rays = MeasureOptions { threads: options.threads, ..MeasureOptions::default() };
        let measured = measure(scene, simplified, views, &rays)?;
        let faces = Faces::of_scene(scene)?;
        let estimate = HitEstimate::new(&faces, views, options.n_rays);
        let (mut first, mut hits) = (0, 0);
        for (o, origin) in scene.objects().iter().zip(&simplified.origin) {
            let mut kept = vec![false; o.triangles.len()];
            origin.iter().flatten().for_each(|&k| kept[k as usize] = true);
            let gone = (first..).zip(&kept).filter(|(_, kept)| !**kept);
            hits += gone.map(|(face, _)| estimate.hits(face)).sum::<u64>();
            first += o.triangles.len() as u32;
        }
        let found = interval(hits, estimate.n_rays(), 0.99);
        Ok(Self {
            measured,
            estimate: found.share,
            estimate_interval: found.ends,
            n_estimate_rays: estimate.n_rays(),
            has_merged: simplified.counts.merged > 0,
        })
    }
}

impl fmt::Display for RayReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Measured { n_rays, changed, worst, worst_eye: [x, y, z], other_object, moved } = self.measured;
        writeln!(f, "measured       {} of {n_rays} rays meet another face", parts(changed))?;
        writeln!(f, "               {} at the worst eye, {x},{y},{z}", parts(worst))?;
        let [object, moved] = [other_object, moved].map(parts);
        writeln!(f, "               {object} another object, {moved} another object or depth")?;
        let ([low, high], share) = (self.estimate_interval.map(parts), parts(self.estimate));
        let (merged, n) = (if self.has_merged { " or merged" } else { "" }, self.n_estimate_rays);
        writeln!(f, "estimate       {share} was seen of what is gone{merged}, from {low} to {high} (99 %), by {n} rays")
    }
}
