//! `levels`: simplified variants of a scene for the cells of its table.

pub(crate) mod outcome;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{Result, anyhow};
use crate::input;
use crate::kept::{self, Keeping, Kept, ResumeArgs};
use crate::memory::MemoryArgs;
use crate::progress::Bar;
use crate::simplification::{self, HowArgs, OutFormat, ReadScene, read, written};
use outcome::Outcome;
use sightlines::cells::Scene;
use sightlines::checkpoint::{Identity, Inputs};
use sightlines::formats::levels::{INDEX_NAME, LevelFile, LevelsIndex, write_levels_index};
use sightlines::formats::{FolderError, GltfSource, NewFolder, SceneFile};
use sightlines::multifocal::FromRegion;
use sightlines::progress::memory::{MemorySize, Needs};
use sightlines::simplify::{
    HiddenBy, LevelOptions, Levels, MakeMethod, SimplifyError, SimplifyOptions, WorkOptions, levels_with,
};
use std::path::PathBuf;
use std::time::Instant;

/// Rays that weigh faces for each level: they only choose what is collapsed first, and there are many levels.
const N_RAYS: u64 = 1 << 12;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The folder gets level_0.glb, level_1.glb and so on, and index.json, which assigns a level to each \
                  cell of the table. A level contains what the eyes in its cells can see, within the budget. Cells \
                  with similar visible sets share a level. `sightlines walk --levels` counts the triangles drawn with \
                  them."
)]
pub(crate) struct LevelsArgs {
    /// The scene: GLB or glTF; from an OBJ only triangles and names are kept
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// The table of the scene; its cells must be boxes
    #[arg(long, help_heading = "Input", value_name = "FILE.pvs")]
    table: PathBuf,
    #[command(flatten)]
    how: HowArgs,
    /// Maximum size of the triangles of all levels together, in bytes, without textures
    #[arg(long, help_heading = "Method", value_name = "BYTES", default_value_t = LevelOptions::default().memory)]
    memory: u64,
    /// Memory that the program may use, such as 2GiB or 800MB, as --memory of `build`: --memory is about levels here
    #[arg(long, help_heading = "Method", value_name = "SIZE")]
    work_memory: Option<MemorySize>,
    #[command(flatten)]
    resume: ResumeArgs,
    /// The folder to write: a new one, or one that contains only levels, which are replaced
    #[arg(short, long, help_heading = "Output", value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

/// Whether a file in a folder of levels is one that this command writes.
fn is_ours(name: &str) -> bool {
    let number = name.strip_prefix("level_").and_then(|rest| rest.strip_suffix(".glb"));
    name == INDEX_NAME || number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

pub(crate) fn run(args: &LevelsArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let work_memory = MemoryArgs::of(args.work_memory);
    work_memory.watch();
    // Outputs that cannot be written are reported before the work is done.
    let folder = NewFolder::new(&args.output, is_ours).map_err(|error| match error {
        FolderError::Other { .. } => {
            anyhow!("{error}, which is no level: name a new folder, or one that only holds levels")
        }
        error => error.into(),
    })?;
    let keeping = Keeping::File(&args.resume);
    let is_there = args.table.exists() && args.scene.exists();
    let inputs = [&args.scene, &args.table].map(PathBuf::as_path);
    let inputs = kept::look(keeping, inputs.into_iter().filter(|_| is_there))?;
    let table = input::table(&args.table)?;
    // What was see-through for the table must not count as a wall here.
    let ReadScene { file, source } = read(&args.scene, &args.how.surfaces.options_with(table.info()))?;
    let along = simplification::along([&args.scene, &args.table], &table, &file.scene)?;
    // A table with a frame is about the scene along its axes.
    let is_framed = along.is_some();
    let (table, scene) = along.as_ref().map_or((&table, &file.scene), |(table, scene)| (table, scene));
    let (method, factory) = args.how.prepare(&args.scene, scene)?;
    let make = || -> Box<dyn FromRegion + Send> { factory.as_ref().expect("only called if there is one").instance() };
    let make: MakeMethod<'_> = &make;
    let by = HiddenBy { method: factory.is_some().then_some(make), table: None };
    let standard = LevelOptions::default();
    let simplify = args.how.options(standard.simplify.n_parts);
    let options =
        LevelOptions { simplify: SimplifyOptions { n_rays: N_RAYS, ..simplify }, memory: args.memory, ..standard };
    // What each cell sees, in bytes and in bits, and what is left of it.
    let seen = table.n_cells() as u64 * scene.n_triangles() as u64;
    let needs = Needs { shared: seen + seen / 4, per_thread: (4 << 20) + 64 * scene.n_triangles() as u64 };
    let too_large = |source| anyhow!("{}: {source}; allow more", args.scene.display());
    let threads = work_memory.threads(options.simplify.threads, needs).map_err(too_large)?;
    let options = LevelOptions { simplify: SimplifyOptions { threads, ..options.simplify }, ..options };
    let start = Instant::now();
    let kept = Kept::open(keeping, &inputs, &[&args.output], || args.identity(&inputs, &options, &file))?;
    let bar = Bar::new("levels", show_progress);
    let effort = WorkOptions { observer: Some(&bar), units: kept.units() };
    let made = levels_with(scene, table, &by, &options, &effort).map_err(|source| {
        let of_table = matches!(source, SimplifyError::OtherScene(_) | SimplifyError::Views(_));
        let path = if of_table { &args.table } else { &args.scene };
        anyhow!("{}: {source}", path.display())
    });
    drop(bar);
    let made =
        made.and_then(|made| write(args, (scene, method), (&file, source.as_ref()), (&made, is_framed), folder, start));
    Ok(Done::new(args.json, kept.end(made)?))
}

impl LevelsArgs {
    /// What decides the results of units. A new argument does not compile until it is decided whether it is part of that.
    fn identity(&self, inputs: &Inputs, options: &LevelOptions, file: &SceneFile) -> Identity {
        #[rustfmt::skip]
        let Self { scene: _, table: _, how, memory: _, work_memory: _, resume: _, output: _, json: _ } = self;
        let LevelOptions { simplify, memory, bytes_per_triangle } = *options;
        let simplify = SimplifyOptions { threads: 0, ..simplify };
        let mut identity = kept::identity("levels", inputs);
        // Files that a scene names are part of it.
        identity.debug("content", &file.scene.checksum());
        identity.debug("how", &how.for_any_threads());
        identity.debug("options", &(simplify, memory, bytes_per_triangle));
        identity
    }
}

fn write(
    args: &LevelsArgs,
    (scene, method): (&Scene, &'static str),
    (file, source): (&SceneFile, Option<&GltfSource>),
    (made, is_framed): (&Levels, bool),
    folder: NewFolder,
    start: Instant,
) -> Result<Outcome> {
    let mut index = LevelsIndex {
        n_triangles: scene.n_triangles() as u64,
        budget: args.how.budget(),
        levels: Vec::new(),
        cells: made.of_cell.iter().map(|&level| Some(level)).collect(),
    };
    let (mut n_bytes, mut roundings) = (0, Vec::new());
    for (k, level) in made.levels.iter().enumerate() {
        let written = written(&args.scene, &file.scene, source, &level.simplified, is_framed, OutFormat::Glb)?;
        let file = format!("level_{k}.glb");
        folder.save(&file, &written.bytes)?;
        n_bytes += written.bytes.len() as u64;
        roundings.push(written.rounding);
        index.levels.push(LevelFile {
            file,
            n_triangles: level.simplified.counts.left as u64,
            n_bytes: level.n_bytes,
            bound: level.simplified.bound,
            occluder: written.occluder,
        });
    }
    folder.save(INDEX_NAME, write_levels_index(&index).as_bytes())?;
    let outcome = Outcome::new(args, (scene, method), &index, (n_bytes, roundings), start.elapsed());
    if let Some((old, error)) = folder.finish()? {
        tracing::warn!("{}: what the folder was before cannot be removed: {error}", old.display());
    }
    Ok(outcome)
}
