//! What was drawn.

use crate::output::{JsonSchema, Serialize, count, percent, seconds_of, share};
use std::fmt;

/// A picture with the shadows of an area light.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene.
    pub(super) scene: String,
    /// Its faces.
    pub(super) n_faces: usize,
    /// Faces that the picture shows.
    pub(super) n_shown: usize,
    /// Lower and upper corner of the light.
    pub(super) light: [[f64; 3]; 2],
    /// The methods that found umbrae.
    pub(super) method: String,
    /// Pieces that the shown faces were divided into.
    pub(super) n_pieces: usize,
    /// Area proven to be in full umbra.
    pub(super) area_umbra: f64,
    /// Area proven to be fully lit.
    pub(super) area_lit: f64,
    /// The rest of the area: neither proven to be lit nor to be in umbra.
    pub(super) area_in_doubt: f64,
    /// Of the area in doubt, that of pieces with rays that arrive and rays that do not.
    pub(super) area_mixed: f64,
    /// Width and height in pixels.
    pub(super) size: [u32; 2],
    /// Pixels in full umbra.
    pub(super) pixels_umbra: u64,
    /// Pixels fully lit.
    pub(super) pixels_lit: u64,
    /// Pixels in doubt, for which rays were cast.
    pub(super) pixels_in_doubt: u64,
    /// Rays that were cast.
    pub(super) rays: u64,
    /// Rays that a picture without proven pieces takes.
    pub(super) rays_else: u64,
    /// Seconds to decide pieces.
    pub(super) decide_seconds: f64,
    /// Seconds to draw.
    pub(super) draw_seconds: f64,
    /// The picture that was written.
    pub(super) file: String,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        let n_faces = count(self.n_faces as u64, "face");
        writeln!(f, "{}: {} of {n_faces} seen, {width} x {height} pixels", self.scene, self.n_shown)?;
        let all = self.area_umbra + self.area_lit + self.area_in_doubt;
        let areas = [self.area_umbra, self.area_lit, self.area_in_doubt, self.area_mixed];
        let [umbra, lit, doubt, mixed] = areas.map(|x| percent(share(x, all)));
        let pieces = count(self.n_pieces as u64, "piece");
        writeln!(f, "area           {umbra} in umbra, {lit} lit, {doubt} in doubt, in {pieces}, by {}", self.method)?;
        writeln!(f, "of doubt       {mixed} of the area has rays that arrive and rays that do not, in each piece")?;
        let pixels = [self.pixels_umbra, self.pixels_lit, self.pixels_in_doubt];
        let n_pixels = pixels.iter().sum::<u64>() as f64;
        let [umbra, lit, doubt] = pixels.map(|n| percent(share(n as f64, n_pixels)));
        writeln!(f, "pixels         {umbra} in umbra, {lit} lit, {doubt} in doubt")?;
        let saved = percent(share(self.rays as f64, self.rays_else as f64));
        writeln!(f, "rays           {} of {}, {saved}", self.rays, self.rays_else)?;
        let [decide, draw] = [self.decide_seconds, self.draw_seconds].map(seconds_of);
        writeln!(f, "time           {decide} to decide, {draw} to draw")?;
        writeln!(f, "wrote          {}", self.file)
    }
}
