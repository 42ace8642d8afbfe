//! What was drawn.

use crate::error::Result;
use crate::output::{count, percent, seconds};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use sightlines::area_light::{LightPicture, LightingAreas};
use sightlines::geometry::Aabb;
use std::fmt;
use std::time::Duration;

/// What was drawn, for people and as JSON.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) scene: String,
    pub(super) n_faces: usize,
    /// Faces that the picture shows.
    pub(super) n_shown: usize,
    pub(super) light: Aabb<3>,
    pub(super) method: String,
    pub(super) n_pieces: usize,
    pub(super) areas: LightingAreas,
    pub(super) size: [u32; 2],
    /// Pixels in umbra, lit, traced.
    pub(super) pixels: [u64; 3],
    /// Rays that were cast, and those that a picture without proofs takes.
    pub(super) rays: [u64; 2],
    pub(super) decided: Duration,
    pub(super) drawn: Duration,
    pub(super) file: String,
}

impl Outcome {
    /// What a picture has.
    pub(super) fn counts(picture: &LightPicture) -> ([u64; 3], [u64; 2]) {
        (picture.counts(), [picture.n_rays, picture.n_rays_else])
    }
}

/// A part of a whole; 0 of nothing.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut s = serializer.serialize_struct("Outcome", 19)?;
        s.serialize_field("scene", &self.scene)?;
        s.serialize_field("n_faces", &self.n_faces)?;
        s.serialize_field("n_shown", &self.n_shown)?;
        s.serialize_field("light", &[self.light.min, self.light.max])?;
        s.serialize_field("method", &self.method)?;
        s.serialize_field("n_pieces", &self.n_pieces)?;
        s.serialize_field("area_umbra", &self.areas.umbra)?;
        s.serialize_field("area_lit", &self.areas.lit)?;
        s.serialize_field("area_in_doubt", &self.areas.in_doubt)?;
        s.serialize_field("area_mixed", &self.areas.mixed)?;
        s.serialize_field("size", &self.size)?;
        s.serialize_field("pixels_umbra", &self.pixels[0])?;
        s.serialize_field("pixels_lit", &self.pixels[1])?;
        s.serialize_field("pixels_in_doubt", &self.pixels[2])?;
        s.serialize_field("rays", &self.rays[0])?;
        s.serialize_field("rays_else", &self.rays[1])?;
        s.serialize_field("decide_seconds", &self.decided.as_secs_f64())?;
        s.serialize_field("draw_seconds", &self.drawn.as_secs_f64())?;
        s.serialize_field("file", &self.file)?;
        s.end()
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        let n_faces = count(self.n_faces as u64, "face");
        writeln!(f, "{}: {} of {n_faces} seen, {width} x {height} pixels", self.scene, self.n_shown)?;
        let a = &self.areas;
        let [umbra, lit, doubt, mixed] = [a.umbra, a.lit, a.in_doubt, a.mixed].map(|x| percent(share(x, a.total())));
        let pieces = count(self.n_pieces as u64, "piece");
        writeln!(f, "area           {umbra} in umbra, {lit} lit, {doubt} in doubt, in {pieces}, by {}", self.method)?;
        writeln!(f, "of doubt       {mixed} of the area has rays that arrive and rays that do not, in each piece")?;
        let n_pixels = self.pixels.iter().sum::<u64>() as f64;
        let [umbra, lit, doubt] = self.pixels.map(|n| percent(share(n as f64, n_pixels)));
        writeln!(f, "pixels         {umbra} in umbra, {lit} lit, {doubt} in doubt")?;
        let [rays, all] = self.rays;
        writeln!(f, "rays           {rays} of {all}, {}", percent(share(rays as f64, all as f64)))?;
        writeln!(f, "time           {} to decide, {} to draw", seconds(self.decided), seconds(self.drawn))?;
        writeln!(f, "wrote          {}", self.file)
    }
}
