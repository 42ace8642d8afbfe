//! `simplify`: a scene with fewer triangles for eyes in a volume.

mod eyes;
mod outcome;
mod write;

pub(crate) use write::{ReadScene, read, written};

use crate::Answer;
use crate::error::CliError;
use crate::hiding::{BufferArgs, Hiding, Maker};
use crate::output;
use crate::progress::Bar;
use eyes::EyesArgs;
use outcome::{Outcome, Report};
use sightlines::cells::Scene;
use sightlines::multifocal::FromRegion;
use sightlines::simplify::{HiddenBy, MakeMethod, MeasureOptions, SimplifyError, SimplifyOptions, measure, simplify};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `simplify`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "What no eye in the boxes can see goes, whatever the budget. The budget is a share of the sphere of \
                  directions: from every place in the boxes, at most so much of the view shows another face than \
                  before, which is proven. Materials, textures, names and all else of a glTF survive; pictures in files \
                  beside it go into the result. A result of which triangles were moved may hide what can be seen, says \
                  so, and is refused where a scene has to hide something."
)]
pub(crate) struct SimplifyArgs {
    /// The scene: GLB, glTF, or OBJ, of which only triangles and names are kept
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    #[command(flatten)]
    eyes: EyesArgs,
    #[command(flatten)]
    how: HowArgs,
    /// At least so many boxes are made of those where eyes are, as small boxes give better bounds
    #[arg(long, help_heading = "Viewer", value_name = "N", default_value_t = SimplifyOptions::default().n_parts as u32)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    parts: u32,
    /// The scene to write; it may be the one that is read
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb")]
    output: PathBuf,
    /// Also count by fresh rays what has changed, over all eyes and for the worst one
    #[arg(long, help_heading = "Output")]
    report: bool,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

/// How to simplify, as arguments.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct HowArgs {
    /// The share of the sphere of directions in which another face may be seen, 0 to 1; 0 takes away only what is hidden
    #[arg(long, help_heading = "Method", value_name = "SHARE", default_value_t = 0.0, value_parser = share, allow_hyphen_values = true)]
    budget: f64,
    /// The share of the budget that is kept for moving corners instead of leaving triangles out, 0 to 1
    #[arg(long, help_heading = "Method", value_name = "SHARE", default_value_t = SimplifyOptions::default().collapse)]
    #[arg(value_parser = share, allow_hyphen_values = true)]
    collapse: f64,
    /// Also merge triangles of an object that lie in one plane, exactly: no surface changes; what is interpolated over triangles, such as texture
    /// coordinates, stays the same only where it is linear
    #[arg(long, help_heading = "Method")]
    flat: bool,
    /// Take scenes with mirrors as if there were none; else they are refused, as mirrors show what is hidden
    #[arg(long, help_heading = "Method")]
    ignore_mirrors: bool,
    /// What proves triangles hidden, besides a table
    #[arg(long, help_heading = "Method", value_name = "HOW", value_enum, default_value_t = Method::Multifocal)]
    method: Method,
    #[command(flatten)]
    buffers: BufferArgs,
    /// Number of threads; 0 for one for each core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::args::threads)]
    threads: usize,
}

/// Who says what is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Any surfaces, by buffers and sheets
    Multifocal,
    /// One flat piece that cuts the whole shaft between the eyes and a triangle
    Shafts,
    /// Voxels inside of closed surfaces, extended to blockers
    Voxels,
    /// Nobody but the table
    None,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("not a number from 0 to 1".to_owned()),
    }
}

impl HowArgs {
    /// The share that is allowed.
    pub(crate) fn budget(&self) -> f64 {
        self.budget
    }

    /// The name of the method, and what it is asked with, for a scene that came from `path`.
    pub(crate) fn maker(&self, path: &Path, scene: &Scene) -> Result<(&'static str, Option<Maker>), CliError> {
        self.buffers.check_memory(path)?;
        let (name, hiding) = match self.method {
            Method::Multifocal => ("multifocal", Some(Hiding::Buffers)),
            Method::Shafts => ("shafts", Some(Hiding::Shafts)),
            Method::Voxels => ("voxels", Some(Hiding::Voxels)),
            Method::None => ("none", None),
        };
        Ok((name, hiding.map(|hiding| Maker::new(hiding, scene, &self.buffers))))
    }

    /// The options, for views in at least so many parts.
    pub(crate) fn options(&self, n_parts: usize) -> SimplifyOptions {
        let standard = SimplifyOptions::default();
        let Self { budget, collapse, flat, ignore_mirrors, threads, .. } = *self;
        SimplifyOptions { budget, collapse, flat, ignore_mirrors, threads, n_parts, ..standard }
    }
}

pub(crate) fn run(args: &SimplifyArgs, show_progress: bool) -> Result<Answer, CliError> {
    if !args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        return Err(CliError::NotGlb { path: args.output.clone() });
    }
    output::check(&args.eyes.table.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &[&args.output])?;
    let ReadScene { file, source } = read(&args.scene)?;
    let scene = &file.scene;
    let (table, views) = args.eyes.read()?;
    let (method, maker) = args.how.maker(&args.scene, scene)?;
    let make = || -> Box<dyn FromRegion + Send> { maker.as_ref().expect("only called if there is one").make() };
    let make: MakeMethod<'_> = &make;
    let by = HiddenBy { method: maker.is_some().then_some(make), table: table.as_ref() };
    let options = args.how.options(args.parts as usize);
    let failed = |source| match (&source, &args.eyes.table) {
        (SimplifyError::OtherScene(_), Some(table)) => CliError::Simplify { path: table.clone(), source },
        _ => CliError::Simplify { path: args.scene.clone(), source },
    };
    let start = Instant::now();
    let bar = Bar::new("simplifying", show_progress);
    let simplified = simplify(scene, &views, &by, &options).map_err(failed)?;
    drop(bar);
    let time = start.elapsed();
    let bytes = written(&args.scene, scene, source.as_ref(), &simplified)?;
    let report = if args.report {
        let rays = MeasureOptions { threads: args.how.threads, ..MeasureOptions::default() };
        let measured = measure(scene, &simplified, &views, &rays).map_err(failed)?;
        Some(Report::new(scene, &views, &simplified, &measured, &options).map_err(failed)?)
    } else {
        None
    };
    let outcome = Outcome::new(args, method, &simplified, views.parts().len(), bytes.len(), report, time);
    output::save(&args.output, &bytes)?;
    output::print(args.json, &outcome)?;
    Ok(Answer::Yes)
}
