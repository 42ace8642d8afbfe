//! `demo`: all steps on a generated scene.

pub(crate) mod office;
pub(crate) mod tower;

use crate::command::{Done, JsonArg, Verbosity};
use crate::commands::build::bake_visibly;
use crate::error::{ErrorAbout, Result};
use crate::output::{self, JsonSchema, Serialize, bytes, cannot_be_made};
use crate::reasons::reasons;
use sightlines::bake::{BakeInput, BakeRequest, Baked};
use sightlines::progress::memory;
use sightlines::viewer::{Figure, Page};
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub(crate) struct DemoArgs {
    /// The scene: an office floor in the plane, or a small furnished tower in space
    #[arg(value_name = "SCENE", value_enum, default_value_t = Example::Office)]
    example: Example,
    /// Seed of the generator
    #[arg(long, help_heading = "Input", value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the scene, the table and the pictures; existing files of the same names are replaced
    #[arg(long, help_heading = "Output", value_name = "FOLDER", default_value = "sightlines-demo")]
    out: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

/// The scenes that can be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Example {
    Office,
    Tower,
}

pub(crate) fn run(args: &DemoArgs, verbosity: Verbosity) -> Result<Done> {
    let folder = &args.out;
    std::fs::create_dir_all(folder).map_err(|error| cannot_be_made(folder, error))?;
    match args.example {
        Example::Office => office::run(args, verbosity),
        Example::Tower => tower::run(args, verbosity),
    }
}

/// The most lines of sight on the page.
const MAX_LINES: usize = 20_000;

/// Bakes what was read from a file of the demo, and writes the table and its page; returns the names of these three in the folder of the demo.
fn bake<'i>(
    args: &DemoArgs,
    [title, source, table]: [&str; 3],
    (input, figure): (impl Into<BakeInput<'i>>, &Figure),
    show_progress: bool,
) -> Result<(Baked, Vec<String>)> {
    let path = args.out.join(source);
    let baked = bake_visibly(&path, input, &BakeRequest::default(), show_progress).in_file(&path)?;
    let (path, name) = (args.out.join(table), "view.html".to_owned());
    output::save(&path, &baked.table.to_bytes())?;
    let reasons = reasons(&baked.table, MAX_LINES, false);
    let page = Page { figure: Some(figure), reasons: reasons.as_ref(), ..Page::new(title, table, &baked.table) };
    output::save(&args.out.join(&name), page.html().in_file(path)?.html.as_bytes())?;
    Ok((baked, vec![name, source.to_owned(), table.to_owned()]))
}

/// What all demos did: where their files are, and what they took.
#[derive(Debug, Serialize, JsonSchema)]
struct Made {
    /// The folder of the files.
    folder: String,
    /// Seed of the generator.
    seed: u64,
    /// Seconds in all.
    seconds: f64,
    /// The largest memory in use; null if the system does not report it.
    peak_bytes: Option<u64>,
    /// The files that were written, by their names in the folder.
    files: Vec<String>,
}

impl Made {
    fn new(args: &DemoArgs, start: Instant, files: Vec<String>) -> Self {
        Self {
            folder: args.out.display().to_string(),
            seed: args.seed,
            seconds: start.elapsed().as_secs_f64(),
            peak_bytes: memory::peak_bytes(),
            files,
        }
    }

    /// The line about memory, if the system reports it.
    fn memory(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.peak_bytes.map_or(Ok(()), |peak| writeln!(f, "memory         {} at most", bytes(peak)))
    }

    fn list_files(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Open the first of these in a browser; pictures and table are there too, in {}:", self.folder)?;
        self.files.iter().try_for_each(|file| writeln!(f, "  {}", Path::new(&self.folder).join(file).display()))
    }
}
