//! The arguments common to all commands.

use crate::command::commands;
use crate::commands::*;
use clap::Parser;

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

commands! {
    enum Command:
    /// Build the visibility table of a floor plan, a Doom map, a scene in space, or a Quake map
    Build(Box<build::BuildArgs>) => build::run,
    /// Write the REJECT lumps of a WAD, or of all WADs in a folder; all other lumps stay as they are
    Reject(reject::RejectArgs) => reject::run,
    /// Write the visibility of a Quake or Quake II map; everything else stays as it is
    Vis(vis::VisArgs) => vis::run,
    /// Write the portal file of a Quake map, made from its tree of planes
    Portals(portals::PortalsArgs) => portals::run,
    /// Write a floor plan as GeoJSON: a scene in space cut at a height, a DXF drawing, or a Doom map
    Plan(plan::PlanCommandArgs) => plan::run,
    /// Share a build among processes and machines: plan its shards, do one, merge them, or have all of it done
    Job(job::JobArgs) => job::run,
    /// A world that is too large for one table: bake its tiles, look into it
    Tiles(tiles::TilesArgs) => tiles::run,
    /// Check a table, or the visibility in a Quake or Doom map, against its scene; exit code 1 for a violation
    Verify(verify::VerifyArgs) => verify::run,
    /// Write what is seen from points of a floor plan: polygons, measures, a picture
    Isovist(isovist::IsovistArgs) => isovist::run,
    /// List the cells and objects that may be visible from anywhere in the cell of a point; with a method or a view, from the point alone
    Query(query::QueryArgs) => query::run,
    /// Measure the eye-to-cell methods on a walk: what each leaves to draw, and its time
    Walk(walk::WalkArgs) => walk::run,
    /// Find from which reach on bodies in two cells may see each other, for servers that hide players
    Relevance(relevance::RelevanceArgs) => relevance::run,
    /// Compress a table into a file that can be read piece by piece
    Pack(pack::PackArgs) => pack::pack,
    /// Convert a packed table back to a plain one
    Unpack(pack::UnpackArgs) => pack::unpack,
    /// Export a table as JSON
    Export(export::ExportArgs) => export::run,
    /// Show a line of sight between two cells, or the reason why there is none
    Explain(explain::ExplainArgs) => explain::run,
    /// Draw a table, and what is visible from a cell or a point, as a plan, a floor plan or an isometric view
    Draw(draw::DrawArgs) => draw::run,
    /// Write one HTML file that shows a table in a browser: the map, the scene, what is seen from where, and why
    View(view::ViewArgs) => view::run,
    /// Draw the multifocal buffer of a view volume on a plane: the heights below which everything is hidden
    Multifocal(multifocal::MultifocalArgs) => multifocal::run,
    /// Draw the visible surfaces of a scene for one eye by a classical method, or compare all methods
    Render(render::RenderArgs) => render::run,
    /// Write a scene with fewer triangles for eyes in a volume, without hidden triangles and, within a budget, without
    /// barely visible ones
    Simplify(simplify::SimplifyArgs) => simplify::run,
    /// Write a scene without the objects or triangles that nobody can see, from outside or from given places; all else stays as it is
    Strip(strip::StripArgs) => strip::run,
    /// Analyse what the points of a floor plan see of each other: tables and pictures of the measures of space syntax
    Vga(vga::VgaArgs) => vga::run,
    /// Draw the umbra, the lit parts and the parts in doubt under an area light
    Light(light::LightArgs) => light::run,
    /// Write simplified variants of a scene for the cells of its table, within a memory budget
    Levels(levels::LevelsArgs) => levels::run,
    /// Summarize a table, a WAD, a floor plan, a scene, a Quake map or a portal file
    Info(info::InfoArgs) => info::run,
    /// Generate a scene of any size
    Generate(generate::GenerateArgs) => generate::run,
    /// Generate an office floor or a small tower, build its table, summarize and draw it
    Demo(demo::DemoArgs) => demo::run,
}
