//! `simplify`: a scene with fewer triangles for eyes in a volume.

mod eyes;
pub(crate) mod outcome;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{Result, anyhow};
use crate::output;
use crate::progress::Bar;
use crate::simplification::{self, HowArgs, OutFormat, ReadScene, read, written};
use eyes::EyesArgs;
use outcome::Outcome;
use sightlines::multifocal::FromRegion;
use sightlines::simplify::report::RayReport;
use sightlines::simplify::{HiddenBy, MakeMethod, SimplifyError, SimplifyOptions, simplify};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Triangles that no eye in the boxes can see are always removed. The budget is a share of the sphere \
                  of directions: for every eye in the boxes, at most that share of the view shows another face than \
                  before. This bound is proven; with --backs culled of eyes that see the back of no single-sided face, as a table then \
                  takes backs to be unseen. Materials, textures, names and everything else in a glTF are kept; \
                  textures in separate files are embedded. GLB holds single precision: a GLB \
                  that is made of an OBJ has rounded coordinates, which moves surfaces beside what the bound allows; the output states \
                  by how much. A result with moved triangles is marked, and is refused \
                  wherever a scene is used as an occluder. With a table that has a frame, the bound is of the scene \
                  along the frame, and a result with merged triangles is marked too."
)]
pub(crate) struct SimplifyArgs {
    /// The scene: GLB or glTF; from an OBJ only triangles and names are kept
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    #[command(flatten)]
    eyes: EyesArgs,
    #[command(flatten)]
    how: HowArgs,
    /// Divide the view volumes into at least this many boxes; smaller boxes give better bounds
    #[arg(long, help_heading = "Viewer", value_name = "N", default_value_t = SimplifyOptions::default().n_parts as u32)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    parts: u32,
    /// The scene to write; may be the input. A GLB or, of an OBJ, an OBJ, which keeps coordinates exactly
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb|OUT.obj")]
    output: PathBuf,
    /// Also measure the change with fresh rays, over all eyes and for the worst one
    #[arg(long, help_heading = "Output")]
    report: bool,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &SimplifyArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let format = OutFormat::of(&args.output)?;
    output::check(&args.eyes.table.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &[&args.output])?;
    let table = args.eyes.table()?;
    // What was see-through for the table must not count as a wall here.
    let ReadScene { file, source } =
        read(&args.scene, &args.how.surfaces.options_with(table.as_ref().map_or(&[], |table| table.info())))?;
    format.check(&args.output, source.as_ref())?;
    let along = match (&table, &args.eyes.table) {
        (Some(table), Some(path)) => simplification::along([&args.scene, path], table, &file.scene)?,
        _ => None,
    };
    // A table with a frame is about the scene along its axes, and so are its cells.
    let (table, scene) = along.as_ref().map_or((table.as_ref(), &file.scene), |(table, scene)| (Some(table), scene));
    let views = args.eyes.views(table)?;
    let (method, factory) = args.how.prepare(&args.scene, scene)?;
    let make = || -> Box<dyn FromRegion + Send> { factory.as_ref().expect("only called if there is one").instance() };
    let make: MakeMethod<'_> = &make;
    let by = HiddenBy { method: factory.is_some().then_some(make), table };
    let options = args.how.options(args.parts as usize);
    let failed = |source| match (&source, &args.eyes.table) {
        (SimplifyError::OtherScene(_), Some(table)) => anyhow!("{}: {source}", table.display()),
        _ => anyhow!("{}: {source}", args.scene.display()),
    };
    let start = Instant::now();
    let bar = Bar::new("simplifying", show_progress);
    let simplified = simplify(scene, &views, &by, &options).map_err(failed)?;
    drop(bar);
    let time = start.elapsed();
    let file = written(&args.scene, &file.scene, source.as_ref(), &simplified, along.is_some(), format)?;
    let report = args.report.then(|| RayReport::new(scene, &views, &simplified, &options));
    let report = report.transpose().map_err(failed)?;
    let outcome = Outcome::new(args, method, (scene, &simplified), views.parts().len(), &file, report, time);
    output::save(&args.output, &file.bytes)?;
    Ok(Done::new(args.json, outcome))
}
