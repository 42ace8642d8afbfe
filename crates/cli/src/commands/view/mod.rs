//! `view`: a table as one HTML file.

mod scene;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow};
use crate::output::{self, JsonSchema, Serialize, bytes, count};
use crate::plans::PlanArgs;
use crate::reasons::reasons;
use crate::surfaces::SurfaceArgs;
use crate::{tables, walk_path};
use sightlines::viewer::{Page, WalkerPose};
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[derive(Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// The table, plain or packed
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    #[arg(long, help_heading = "Input", value_name = "SCENE", help = crate::input::with_formats(
        "What it was built from: a WAD, a {plans} floor plan, a scene as {scenes}, or a Quake map [default: the page shows \
         cells and boxes of objects]"
    ))]
    scene: Option<PathBuf>,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME", requires = "scene")]
    map: Option<String>,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten)]
    plans: PlanArgs,
    /// Another table of the same cells: the page shows which pairs became visible and which hidden since
    #[arg(long, help_heading = "Input", value_name = "OLD.pvs")]
    against: Option<PathBuf>,
    /// A walk to replay, as `walk --path` takes it
    #[arg(long, help_heading = "Input", value_name = "FILE.json")]
    walk: Option<PathBuf>,
    /// The most lines of sight on the page, for `Why?`; each stands for all pairs of cells that it passes. 0 for none
    #[arg(long, help_heading = "Output", value_name = "N", default_value_t = 20_000)]
    lines: u32,
    /// The heading [default: the name of the table's file]
    #[arg(long, help_heading = "Output", value_name = "TEXT")]
    title: Option<String>,
    /// The most megabytes of the page; above it the smallest triangles are left out, with a notice
    #[arg(long, help_heading = "Output", value_name = "MB", default_value_t = (Page::MAX_BYTES / 1_000_000) as u32)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=4_000))]
    max_mb: u32,
    /// Also open it in the browser
    #[arg(long, help_heading = "Output")]
    open: bool,
    /// The page to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.html")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &ViewArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let others = [&args.scene, &args.against, &args.walk];
    let inputs: Vec<&Path> =
        std::iter::once(args.table.as_path()).chain(others.into_iter().filter_map(Option::as_deref)).collect();
    output::check(&inputs, &[&args.output])?;
    let table = tables::read(&args.table)?;
    let figure = args.scene.as_ref().map(|path| scene::figure(path, args, &table)).transpose()?;
    let against = args.against.as_deref().map(tables::read).transpose()?;
    let name = args.table.file_name().unwrap_or_default().to_string_lossy();
    let reasons = reasons(&table, args.lines as usize, show_progress);
    let page = Page {
        figure: figure.as_ref(),
        reasons: reasons.as_ref(),
        against: against.as_ref(),
        walk: args.walk.as_ref().map_or(Ok(Vec::new()), |path| frames(path, table.dimension()))?,
        max_bytes: args.max_mb as usize * 1_000_000,
        ..Page::new(args.title.as_deref().unwrap_or(&name), &name, &table)
    };
    let written = page.html().in_file(&args.table)?;
    output::save(&args.output, written.html.as_bytes())?;
    let outcome = Outcome {
        out: args.output.display().to_string(),
        n_bytes: written.html.len() as u64,
        n_triangles: figure.as_ref().map_or(0, |figure| figure.n_triangles() - written.n_left_out),
        n_left_out: written.n_left_out,
        n_lines: written.n_lines,
        n_pairs: reasons.as_ref().map_or(0, |reasons| reasons.n_pairs),
        n_joined: reasons.as_ref().map_or(0, |reasons| reasons.n_joined),
    };
    let done = Done::new(args.json, outcome);
    if !args.open {
        return Ok(done);
    }
    let page = args.output.clone();
    let show = move || {
        open(&page)
            .map_err(|error| anyhow!("{}: was written, but no browser could be started: {error}", page.display()))
    };
    Ok(done.then(show))
}

fn frames(path: &Path, dimension: u8) -> Result<Vec<WalkerPose>> {
    let poses = walk_path::read(path, dimension)?;
    Ok(poses.into_iter().map(|pose| WalkerPose { eye: pose.eye, dir: pose.dir }).collect())
}

/// Lets the system show a file, and does not wait for it.
fn open(path: &Path) -> std::io::Result<()> {
    let path = path.canonicalize()?;
    let (program, first): (_, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(first).arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().map(drop)
}

/// The page that was written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The page that was written.
    out: String,
    /// Its bytes.
    n_bytes: u64,
    /// Triangles on it.
    n_triangles: usize,
    /// Triangles of the scene that are left out, to stay below `--max-mb`.
    n_left_out: usize,
    /// Lines of sight on it; 0 too if they do not fit below `--max-mb`.
    n_lines: usize,
    /// Visible pairs of two cells; 0 if no lines were looked for, or the table has no portals.
    n_pairs: usize,
    /// Of these pairs (`n_pairs`), those that a line was found for.
    n_joined: usize,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}: open it in a browser", self.out, bytes(self.n_bytes))?;
        if self.n_left_out > 0 {
            let all = self.n_left_out + self.n_triangles;
            writeln!(f, "the {} smallest of {all} triangles are left out: see --max-mb", self.n_left_out)?;
        }
        if self.n_pairs > 0 && self.n_lines == 0 {
            writeln!(f, "lines of sight are left out: see --max-mb")?;
        } else if self.n_pairs > 0 {
            let (lines, joined) = (count(self.n_lines as u64, "line"), self.n_joined);
            writeln!(f, "{lines} of sight for {joined} of {} visible pairs of cells", self.n_pairs)?;
        }
        Ok(())
    }
}
