//! How floor plans are read: arguments, warnings, and what a table states of it.

use crate::error::{ErrorAbout, Result};
use crate::numbers::size;
use crate::refuse::refuse;
use sightlines::bake::{Baked, Gap};
use sightlines::cells::Plan;
use sightlines::formats::input::read_plan_file;
use sightlines::formats::{PlanFile, PlanReadOptions, detect_file};
use sightlines::geometry::Segment2;
use sightlines::pvs::Table;
use std::path::Path;

pub(crate) fn walls(plan: &Plan) -> Vec<Segment2> {
    plan.lines().iter().filter(|line| line.opaque).map(|line| Segment2::new(line.a, line.b)).collect()
}

/// How precise the coordinates of a plan are, as an argument.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct GapArg {
    /// Plans: how precise coordinates are, in units of the plan: ends of walls that miss others by no more than WIDTH are joined to them, so openings
    /// up to WIDTH may count as closed. 0 takes every coordinate as it is [default: what the digits of the file explain]
    #[arg(long, help_heading = "Method", value_name = "WIDTH", value_parser = size, allow_hyphen_values = true)]
    gap: Option<f64>,
}

impl GapArg {
    /// The option, if it was given.
    pub(crate) fn given(self) -> [(&'static str, bool); 1] {
        [("--gap", self.gap.is_some())]
    }

    pub(crate) fn join(self, path: &Path, plan: Plan) -> Result<Plan> {
        let joined = self.gap.map_or(Gap::OfFile, Gap::Width).join(&plan).in_file(path)?;
        Ok(joined.unwrap_or(plan))
    }
}

/// The key of a table's information for the layers, and that for the deviation of curves.
const KEYS: [&str; 2] = ["layers", "curve-deviation"];

/// How a plan is read, as arguments.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct PlanArgs {
    /// DXF: the layers to read, even if they are frozen or off [default: all that are neither]
    #[arg(long, help_heading = "Input", value_name = "LAYER,...", value_delimiter = ',')]
    layers: Vec<String>,
    /// DXF: how far the straight pieces of a curve may be from it, in units of the drawing [default: a ten-thousandth of the plan's
    /// longer side]
    #[arg(long, help_heading = "Input", value_name = "D")]
    curve_deviation: Option<f64>,
}

impl PlanArgs {
    /// These arguments as options of readers. Refuses them for anything but DXF.
    pub(crate) fn options(&self, path: &Path) -> Result<PlanReadOptions> {
        if detect_file(path)?.is_none_or(|format| format.name != "dxf") {
            let given = [("--layers", !self.layers.is_empty()), ("--curve-deviation", self.curve_deviation.is_some())];
            refuse(path, &given, "DXF", "none")?;
        }
        let layers = Some(self.layers.clone()).filter(|layers| !layers.is_empty());
        Ok(PlanReadOptions { layers, deviation: self.curve_deviation })
    }

    /// The same, and what the plan of a table was read with, by the information of that table, where nothing else is said.
    pub(crate) fn options_with(&self, path: &Path, table: &Table) -> Result<PlanReadOptions> {
        let PlanReadOptions { layers, deviation } = self.options(path)?;
        let [stated_layers, stated_deviation] = KEYS.map(|key| table.info_value(key));
        Ok(PlanReadOptions {
            layers: layers.or_else(|| Some(stated_layers?.lines().map(str::to_owned).collect())),
            deviation: deviation.or_else(|| stated_deviation?.parse().ok()),
        })
    }
}

/// Reads a plan, and says on standard error what a user should hear of its file.
pub(crate) fn read(path: &Path, options: &PlanReadOptions) -> Result<PlanFile> {
    let file = read_plan_file(path, options)?;
    for warning in &file.warnings {
        tracing::warn!("{}: {warning}", path.display());
    }
    Ok(file)
}

/// The same, with a table that states how its plan was read.
pub(crate) fn state(baked: Baked, options: &PlanReadOptions) -> Baked {
    let values = [options.layers.as_ref().map(|layers| layers.join("\n")), options.deviation.map(|d| d.to_string())];
    if values.iter().all(Option::is_none) {
        return baked;
    }
    let Baked { graph, table, report } = baked;
    let mut parts = table.into_parts();
    parts.info.extend(KEYS.iter().zip(values).filter_map(|(key, value)| Some(((*key).to_owned(), value?))));
    parts.info.sort();
    let table = Table::new(parts).expect("the keys ascend, and none of them is another's");
    Baked { graph, table, report }
}
