//! What was drawn.

use crate::error::Result;
use crate::output::{count, percent};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use sightlines::geometry::Aabb;
use sightlines::multifocal::Plane;
use sightlines::multifocal_cpu::fields::{Features, Field};
use std::fmt;

/// What was drawn, for people and as JSON.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) scene: String,
    pub(super) n_triangles: usize,
    pub(super) n_occluders: usize,
    pub(super) volume: Aabb<3>,
    pub(super) plane: Plane,
    pub(super) measure: &'static str,
    /// Who filled the buffer.
    pub(super) backend: &'static str,
    /// Scene units in one unit of the values.
    pub(super) unit: f64,
    pub(super) n_blocked: usize,
    /// What is drawn white, in these units.
    pub(super) white: u32,
    pub(super) fields: Option<FieldInfo>,
    pub(super) files: Vec<String>,
}

/// What the fields are of.
#[derive(Debug, Serialize)]
pub(super) struct FieldInfo {
    n_vertices: u32,
    n_edges: u32,
    n_faces: u32,
    /// The largest distance, which is drawn white.
    farthest: f64,
}

impl FieldInfo {
    pub(super) fn new(features: &Features, field: &Field) -> Self {
        let (edges, faces) = (features.first_edge(), features.first_face());
        let n_faces = u32::try_from(features.len()).expect("fewer features than 2^32") - faces;
        Self { n_vertices: edges, n_edges: faces - edges, n_faces, farthest: field.farthest() }
    }
}

impl Outcome {
    fn n_texels(&self) -> u64 {
        self.plane.texels().map(u64::from).iter().product()
    }

    fn white(&self) -> f64 {
        f64::from(self.white) * self.unit
    }
}

impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut s = serializer.serialize_struct("Outcome", 16)?;
        s.serialize_field("scene", &self.scene)?;
        s.serialize_field("n_triangles", &self.n_triangles)?;
        s.serialize_field("n_occluders", &self.n_occluders)?;
        s.serialize_field("volume", &[self.volume.min, self.volume.max])?;
        s.serialize_field("axis", &self.plane.axis())?;
        s.serialize_field("at", &self.plane.at())?;
        s.serialize_field("window", &[self.plane.origin(), self.plane.end()])?;
        s.serialize_field("texels", &self.plane.texels())?;
        s.serialize_field("measure", self.measure)?;
        s.serialize_field("backend", self.backend)?;
        s.serialize_field("unit", &self.unit)?;
        s.serialize_field("n_texels", &self.n_texels())?;
        s.serialize_field("n_blocked", &self.n_blocked)?;
        s.serialize_field("white", &self.white())?;
        s.serialize_field("fields", &self.fields)?;
        s.serialize_field("files", &self.files)?;
        s.end()
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let triangles = count(self.n_triangles as u64, "triangle");
        writeln!(f, "{}: {triangles}, {}", self.scene, count(self.n_occluders as u64, "occluder"))?;
        let ([u0, v0], [u1, v1]) = (self.plane.origin().map(short), self.plane.end().map(short));
        let [w, h] = self.plane.texels();
        let axis = ["x", "y", "z"][self.plane.axis()];
        writeln!(
            f,
            "plane          {axis} = {}, from ({u0}, {v0}) to ({u1}, {v1}), {w} x {h} texels",
            self.plane.at()
        )?;
        let share = self.n_blocked as f64 / self.n_texels() as f64;
        writeln!(f, "blocked        {} of {} texels, {}", self.n_blocked, self.n_texels(), percent(share))?;
        writeln!(f, "white          {} units ({}, by {})", short(self.white()), self.measure, self.backend)?;
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
