//! The schemas of what commands print with `--json`, made from the types of the results and the comments on their fields.

use crate::commands::{
    build, demo, explain, generate, info, isovist, job, levels, light, multifocal, pack, plan, portals, query, reject,
    relevance, render, simplify, strip, tiles, vga, view, vis,
};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::Value;
use sightlines::bake::explain::json::Explained;
use sightlines::checkpoint::report;
use sightlines::report::WalkReport;
use sightlines::verify::report::VerifyReport;

/// Each type of results: the titles of its variants, or the one that it has, and its schema.
pub(crate) fn schemas() -> Vec<(&'static [&'static str], Value)> {
    vec![
        of::<build::Built>(&[
            "`build` of a plan",
            "`build` of a scene",
            "`build` of a scene by regions",
            "`build` of a portal file",
            "`build` of a Quake map",
            "`build` of a scene row by row",
        ]),
        of::<reject::outcome::Outcome>(&["`reject`", "`reject` of a folder"]),
        of::<vis::outcome::Outcome>(&["`vis`"]),
        of::<portals::Outcome>(&["`portals`"]),
        of::<plan::Outcome>(&["`plan`"]),
        of::<isovist::Outcome>(&["`isovist` of a plan"]),
        of::<isovist::space::Outcome>(&["`isovist` of a scene"]),
        of::<VerifyReport>(&["`verify`"]),
        of::<query::Found>(&["`query` of a point"]),
        of::<query::sight::Seen>(&["`query` of a view"]),
        of::<WalkReport>(&["`walk`"]),
        of::<view::Outcome>(&["`view`"]),
        of::<relevance::Outcome>(&["`relevance`"]),
        of::<pack::Outcome>(&["`pack`"]),
        of::<pack::Unpacked>(&["`unpack`"]),
        of::<explain::report::Outside>(&["`explain` outside every cell"]),
        of::<Explained>(&[
            "`explain` in a plan",
            "`explain` in a scene",
            "`explain` of cells without portals",
            "`explain` of clusters",
        ]),
        of::<multifocal::outcome::Outcome>(&["`multifocal`"]),
        of::<render::outcome::Outcome>(&["`render`"]),
        of::<light::outcome::Outcome>(&["`light`"]),
        of::<vga::outcome::Outcome>(&["`vga`"]),
        of::<simplify::outcome::Outcome>(&["`simplify`"]),
        of::<strip::outcome::Outcome>(&["`strip`"]),
        of::<levels::outcome::Outcome>(&["`levels`"]),
        of::<info::TableInfo>(&["`info` of a table"]),
        of::<info::packed::PackedInfo>(&["`info` of a packed table"]),
        of::<info::plan::PlanInfo>(&["`info` of a plan"]),
        of::<info::scene::SceneInfo>(&["`info` of a scene"]),
        of::<info::wad::WadInfo>(&["`info` of a WAD"]),
        of::<info::quake::PrtInfo>(&["`info` of a portal file"]),
        of::<info::quake::BspInfo>(&["`info` of a Quake map"]),
        of::<generate::Outcome>(&["`generate tower`"]),
        of::<generate::GearboxOutcome>(&["`generate gearbox`"]),
        of::<generate::WorldOutcome>(&["`generate world`"]),
        of::<tiles::outcome::Outcome>(&["`tiles build`"]),
        of::<tiles::query::Found>(&["`tiles query`"]),
        of::<tiles::check::Checked>(&["`tiles check`"]),
        of::<demo::office::Demo>(&["`demo` of the office"]),
        of::<demo::tower::Demo>(&["`demo tower`"]),
        of::<report::Planned>(&["`job plan`"]),
        of::<report::ShardsDone>(&["`job shard`"]),
        of::<report::Merged>(&["`job work`", "`job merge`", "`job submit`"]),
        of::<job::submit::Submitted>(&["`job submit --dry-run`"]),
        of::<report::Status>(&["`job status`"]),
    ]
}

fn of<T: JsonSchema>(titles: &'static [&'static str]) -> (&'static [&'static str], Value) {
    let generator = SchemaSettings::default().for_serialize().into_generator();
    (titles, generator.into_root_schema_for::<T>().to_value())
}
