//! The arguments common to all commands.

use crate::commands::{
    build::BuildArgs,
    demo::DemoArgs,
    draw::DrawArgs,
    explain::ExplainArgs,
    export::ExportArgs,
    generate::GenerateArgs,
    info::InfoArgs,
    levels::LevelsArgs,
    light::LightArgs,
    multifocal::MultifocalArgs,
    pack::{PackArgs, UnpackArgs},
    query::QueryArgs,
    reject::RejectArgs,
    render::RenderArgs,
    simplify::SimplifyArgs,
    verify::VerifyArgs,
    vis::VisArgs,
    walk::WalkArgs,
};
use clap::{Parser, Subcommand};

/// Exact, conservative visibility: which cells of a scene can see each other.
#[derive(Debug, Parser)]
#[command(name = "sightlines", version, long_about = None, disable_help_flag = true, disable_version_flag = true)]
#[command(after_help = "Exit codes: 0 done; 1 the answer is no (query, draw: a point outside every cell; \
                        explain: hidden; verify: a violation); 2 bad input or usage.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Say more on standard error (twice: still more)
    #[arg(short, long, help_heading = "General", global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// Show no progress and no warnings
    #[arg(short, long, help_heading = "General", global = true)]
    pub(crate) quiet: bool,
    /// Print help; with -h in short
    #[arg(short, long, help_heading = "General", global = true, action = clap::ArgAction::Help)]
    help: Option<bool>,
    /// Print version
    #[arg(short = 'V', long, help_heading = "General", action = clap::ArgAction::Version)]
    version: Option<bool>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Build a visibility table: of a Doom map in a WAD, a GeoJSON floor plan, a scene in space (GLB, glTF, OBJ), or a
    /// portal file of a Quake map (PRT)
    Build(BuildArgs),
    /// Write the REJECT lumps of the maps of a WAD, and leave all else as it is
    Reject(RejectArgs),
    /// Write the visibility of a map of Quake or Quake II, and leave all else as it is
    Vis(VisArgs),
    /// Check a table against the scene that it was built from, or what a map of Quake or Doom itself says of who sees whom: structure,
    /// and rays against the real geometry; exit code 1 if anything is not as is said
    Verify(VerifyArgs),
    /// Say which cells and objects may be seen from a point, or from there in a direction
    Query(QueryArgs),
    /// Follow a viewer through a scene, and measure what each method to find what he sees leaves to draw, and costs
    Walk(WalkArgs),
    /// Make a table small, for programs that read it piece by piece
    Pack(PackArgs),
    /// Make a packed table a plain one again
    Unpack(UnpackArgs),
    /// Write a table as JSON
    Export(ExportArgs),
    /// Show the line of sight between two cells of a plan, or say why there is none
    Explain(ExplainArgs),
    /// Draw a table and what is seen from somewhere, as SVG or PNG: plans, floor plans, isometric views
    Draw(DrawArgs),
    /// Draw what is surely blocked from a volume of eyes on a plane behind a scene in space, and what is nearest to it
    Multifocal(MultifocalArgs),
    /// Draw what one eye sees of a scene in space by one of the methods of visible-surface determination, or by all, side by
    /// side, with what differs
    Render(RenderArgs),
    /// Write a scene with fewer triangles for eyes in a volume: without what is hidden from there, and within a budget without
    /// what can hardly be seen
    Simplify(SimplifyArgs),
    /// Draw which surfaces an area light reaches not at all, wholly, or in part, as one eye sees them
    Light(LightArgs),
    /// Write simplified variants of a scene for the cells of its table, within a memory
    Levels(LevelsArgs),
    /// Sum up a table, a WAD, a GeoJSON plan, a scene in space, a Quake map or a portal file
    Info(InfoArgs),
    /// Write a generated scene of any size
    Generate(GenerateArgs),
    /// Generate an office floor or a small tower, build its table, sum it up and draw it
    Demo(DemoArgs),
}
