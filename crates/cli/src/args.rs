//! The arguments common to all commands.

use crate::commands::{
    build::BuildArgs,
    demo::DemoArgs,
    draw::DrawArgs,
    explain::ExplainArgs,
    export::ExportArgs,
    generate::GenerateArgs,
    info::InfoArgs,
    isovist::IsovistArgs,
    job::JobArgs,
    levels::LevelsArgs,
    light::LightArgs,
    multifocal::MultifocalArgs,
    pack::{PackArgs, UnpackArgs},
    plan::PlanCommandArgs,
    portals::PortalsArgs,
    query::QueryArgs,
    reject::RejectArgs,
    render::RenderArgs,
    simplify::SimplifyArgs,
    tiles::TilesArgs,
    verify::VerifyArgs,
    vga::VgaArgs,
    view::ViewArgs,
    vis::VisArgs,
    walk::WalkArgs,
};
use clap::{Parser, Subcommand};

/// Precomputes which parts of a scene can be seen from which others, exactly and conservatively
#[derive(Debug, Parser)]
#[command(name = "sightlines", version, long_about = None, disable_help_flag = true, disable_version_flag = true)]
#[command(after_help = "Exit codes: 0 success; 1 the answer is no (query, draw: a point outside every cell; explain: \
                        hidden; verify: a violation); 2 bad input or usage; 3 a job is not complete; 4 more memory was used than --memory allows; 130 interrupted.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print more: `build` all facts in place of a few lines, and on standard error what goes on; -vv prints even more
    #[arg(short, long, help_heading = "General", global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// Print no progress and no warnings
    #[arg(short, long, help_heading = "General", global = true)]
    pub(crate) quiet: bool,
    /// Print help; -h prints a summary
    #[arg(short, long, help_heading = "General", global = true, action = clap::ArgAction::Help)]
    help: Option<bool>,
    /// Print version
    #[arg(short = 'V', long, help_heading = "General", action = clap::ArgAction::Version)]
    version: Option<bool>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Build the visibility table of a floor plan, a Doom map, a scene in space, or a Quake map
    Build(Box<BuildArgs>),
    /// Write the REJECT lumps of a WAD, or of all WADs in a folder; all other lumps stay as they are
    Reject(RejectArgs),
    /// Write the visibility of a Quake or Quake II map; everything else stays as it is
    Vis(VisArgs),
    /// Write the portal file of a Quake map, made from its tree of planes
    Portals(PortalsArgs),
    /// Write a floor plan as GeoJSON: a scene in space cut at a height, a DXF drawing, or a Doom map
    Plan(PlanCommandArgs),
    /// Share a build among processes and machines: plan its shards, do one, merge them, or have all of it done
    Job(JobArgs),
    /// A world that is too large for one table: bake its tiles, look into it
    Tiles(TilesArgs),
    /// Check a table, or the visibility in a Quake or Doom map, against its scene; exit code 1 for a violation
    Verify(VerifyArgs),
    /// Write what is seen from points of a floor plan: polygons, measures, a picture
    Isovist(IsovistArgs),
    /// List the cells and objects visible from a point, or in a view from there
    Query(QueryArgs),
    /// Measure the eye-to-cell methods on a walk: what each leaves to draw, and its time
    Walk(WalkArgs),
    /// Compress a table into a file that can be read piece by piece
    Pack(PackArgs),
    /// Convert a packed table back to a plain one
    Unpack(UnpackArgs),
    /// Export a table as JSON
    Export(ExportArgs),
    /// Show a line of sight between two cells, or the reason why there is none
    Explain(ExplainArgs),
    /// Draw a table, and what is visible from a cell or a point, as a plan, a floor plan or an isometric view
    Draw(DrawArgs),
    /// Write one HTML file that shows a table in a browser: the map, the scene, what is seen from where, and why
    View(ViewArgs),
    /// Draw the multifocal buffer of a view volume on a plane: the heights below which everything is hidden
    Multifocal(MultifocalArgs),
    /// Draw the visible surfaces of a scene for one eye by a classical method, or compare all methods
    Render(RenderArgs),
    /// Write a scene with fewer triangles for eyes in a volume, without hidden triangles and, within a budget, without
    /// barely visible ones
    Simplify(SimplifyArgs),
    /// Analyse what the points of a floor plan see of each other: tables and pictures of the measures of space syntax
    Vga(VgaArgs),
    /// Draw the umbra, the lit parts and the parts in doubt under an area light
    Light(LightArgs),
    /// Write simplified variants of a scene for the cells of its table, within a memory budget
    Levels(LevelsArgs),
    /// Summarize a table, a WAD, a floor plan, a scene, a Quake map or a portal file
    Info(InfoArgs),
    /// Generate a scene of any size
    Generate(GenerateArgs),
    /// Generate an office floor or a small tower, build its table, summarize and draw it
    Demo(DemoArgs),
}
