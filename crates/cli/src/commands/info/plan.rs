//! What a GeoJSON plan holds.

use super::Error;
use serde::Serialize;
use sightlines::formats::geojson;
use std::fmt;
use std::path::Path;

/// The numbers of a plan.
#[derive(Debug, Serialize)]
pub(super) struct PlanInfo {
    file: String,
    kind: &'static str,
    n_walls: usize,
    /// Lines that do not block sight.
    n_transparent: usize,
    n_objects: usize,
    /// Null for a plan without lines.
    min: Option<[f64; 2]>,
    max: Option<[f64; 2]>,
    /// Whether every line is parallel to an axis.
    axial: bool,
}

impl PlanInfo {
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let plan = geojson::read_plan(path)?;
        let n_walls = plan.lines().iter().filter(|line| line.opaque).count();
        let bounds = Some(plan.bounds()).filter(|bounds| !bounds.is_empty());
        Ok(Self {
            file: path.display().to_string(),
            kind: "geojson",
            n_walls,
            n_transparent: plan.lines().len() - n_walls,
            n_objects: plan.objects().len(),
            min: bounds.map(|b| b.min),
            max: bounds.map(|b| b.max),
            axial: plan.is_axial(),
        })
    }
}

impl fmt::Display for PlanInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: GeoJSON plan", self.file)?;
        let axial = if self.axial { ", all parallel to an axis" } else { "" };
        writeln!(f, "walls          {}{axial}", self.n_walls)?;
        writeln!(f, "transparent    {}", self.n_transparent)?;
        writeln!(f, "objects        {}", self.n_objects)?;
        if let (Some([x0, y0]), Some([x1, y1])) = (self.min, self.max) {
            writeln!(f, "extent         ({x0}, {y0}) to ({x1}, {y1})")?;
        }
        Ok(())
    }
}
