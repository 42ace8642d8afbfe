//! What was drawn.

use crate::output::{JsonSchema, Serialize, count, percent};
use sightlines::multifocal_cpu::fields::{Features, NearestField};
use std::fmt;

/// A multifocal buffer.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene.
    pub(super) scene: String,
    /// Its triangles.
    pub(super) n_triangles: usize,
    /// Occluders that were drawn.
    pub(super) n_occluders: usize,
    /// Lower and upper corner of the view volume.
    pub(super) volume: [[f64; 3]; 2],
    /// The axis that the plane is perpendicular to: 0, 1 or 2 for x, y or z.
    pub(super) axis: usize,
    /// Where the plane crosses this axis.
    pub(super) at: f64,
    /// Lower and upper corner of the window on the plane, two coordinates each, along the two axes that follow.
    pub(super) window: [[f64; 2]; 2],
    /// Texels along both axes.
    pub(super) texels: [u32; 2],
    /// The measure that the buffer stores.
    pub(super) measure: &'static str,
    /// The backend that filled the buffer.
    pub(super) backend: &'static str,
    /// Scene units for each unit of the buffer's values.
    pub(super) unit: f64,
    /// Texels.
    pub(super) n_texels: u64,
    /// Blocked texels.
    pub(super) n_blocked: usize,
    /// The value that is drawn white, in scene units.
    pub(super) white: f64,
    /// With `--voronoi` or `--distance`: what these are made of; null without.
    pub(super) fields: Option<FieldInfo>,
    /// The pictures that were written.
    pub(super) files: Vec<String>,
}

/// Features that fields are of.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FieldInfo {
    /// Vertices.
    n_vertices: u32,
    /// Edges.
    n_edges: u32,
    /// Faces.
    n_faces: u32,
    /// The largest distance, which is drawn white.
    farthest: f64,
}

impl FieldInfo {
    pub(super) fn new(features: &Features, field: &NearestField) -> Self {
        let (edges, faces) = (features.first_edge(), features.first_face());
        let n_faces = u32::try_from(features.len()).expect("fewer features than 2^32") - faces;
        Self { n_vertices: edges, n_edges: faces - edges, n_faces, farthest: field.farthest() }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let triangles = count(self.n_triangles as u64, "triangle");
        writeln!(f, "{}: {triangles}, {}", self.scene, count(self.n_occluders as u64, "occluder"))?;
        let [[u0, v0], [u1, v1]] = self.window.map(|corner| corner.map(short));
        let [w, h] = self.texels;
        let axis = ["x", "y", "z"][self.axis];
        writeln!(f, "plane          {axis} = {}, from ({u0}, {v0}) to ({u1}, {v1}), {w} x {h} texels", self.at)?;
        let share = self.n_blocked as f64 / self.n_texels as f64;
        writeln!(f, "blocked        {} of {} texels, {}", self.n_blocked, self.n_texels, percent(share))?;
        writeln!(f, "white          {} units ({}, by {})", short(self.white), self.measure, self.backend)?;
        if let Some(FieldInfo { n_vertices, n_edges, n_faces, farthest }) = &self.fields {
            let [corners, edges, faces] =
                [count(*n_vertices, "corner"), count(*n_edges, "edge"), count(*n_faces, "face")];
            writeln!(f, "nearest        of {corners}, {edges}, {faces}; at most {} units away", short(*farthest))?;
        }
        writeln!(f, "wrote          {}", self.files.join(", "))
    }
}

/// A number for the eye: to a millionth of a unit.
fn short(x: f64) -> f64 {
    let millionths = x * 1e6;
    // Beyond that there are no millionths.
    if millionths.abs() < 1e15 { millionths.round() / 1e6 } else { x }
}
