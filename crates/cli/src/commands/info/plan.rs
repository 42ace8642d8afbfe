//! What a floor plan holds.

use crate::error::Result;
use crate::output::{JsonSchema, Serialize};
use crate::plans;
use sightlines::formats::input::FORMATS;
use sightlines::formats::{PlanReadOptions, detect_file};
use std::fmt;
use std::path::Path;

/// The numbers of a plan.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct PlanInfo {
    /// The file.
    file: String,
    /// `geojson` or `dxf`.
    kind: &'static str,
    /// Lines.
    n_walls: usize,
    /// Lines that do not block sight.
    n_transparent: usize,
    /// Objects.
    n_objects: usize,
    /// Lower corner of the plan; null without lines.
    min: Option<[f64; 2]>,
    /// Upper corner of the plan; null without lines.
    max: Option<[f64; 2]>,
    /// Whether every line is parallel to an axis.
    axial: bool,
    /// Lines of the file without length, which were dropped.
    n_without_length: usize,
    /// Lines of the file that repeat others, which were dropped.
    n_doubled: usize,
    /// Whether the file states a reference system (`crs`).
    has_crs: bool,
    /// DXF: the names of all layers.
    layers: Vec<String>,
}

impl PlanInfo {
    pub(super) fn read(path: &Path, options: &PlanReadOptions) -> Result<Self> {
        let file = plans::read(path, options)?;
        let plan = file.plan;
        let n_walls = plans::walls(&plan).len();
        let bounds = Some(plan.bounds()).filter(|bounds| !bounds.is_empty());
        Ok(Self {
            file: path.display().to_string(),
            kind: detect_file(path)?.map_or("geojson", |format| format.name),
            n_walls,
            n_transparent: plan.lines().len() - n_walls,
            n_objects: plan.objects().len(),
            min: bounds.map(|b| b.min),
            max: bounds.map(|b| b.max),
            axial: plan.is_axial(),
            n_without_length: file.dropped.n_without_length,
            n_doubled: file.dropped.n_doubled,
            has_crs: file.crs.is_some(),
            layers: file.layers,
        })
    }
}

/// What people call the format with that name.
fn title_of(name: &str) -> &'static str {
    FORMATS.iter().find(|format| format.name == name).map_or("GeoJSON", |format| format.titles[0])
}

impl fmt::Display for PlanInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} plan", self.file, title_of(self.kind))?;
        let axial = if self.axial { ", all parallel to an axis" } else { "" };
        writeln!(f, "walls          {}{axial}", self.n_walls)?;
        writeln!(f, "transparent    {}", self.n_transparent)?;
        writeln!(f, "objects        {}", self.n_objects)?;
        if self.n_without_length + self.n_doubled > 0 {
            writeln!(f, "dropped        {} without length, {} doubled", self.n_without_length, self.n_doubled)?;
        }
        if !self.layers.is_empty() {
            let layers: Vec<String> = self.layers.iter().map(|name| name.escape_debug().to_string()).collect();
            writeln!(f, "layers         {}", layers.join(", "))?;
        }
        if let (Some([x0, y0]), Some([x1, y1])) = (self.min, self.max) {
            writeln!(f, "extent         ({x0}, {y0}) to ({x1}, {y1})")?;
        }
        Ok(())
    }
}
