//! `build`: from a plan, a scene in space, a portal file or a Quake map to its table.

mod announce;
mod auto;
mod brief;
mod certify;
mod doors;
mod framed;
mod limit;
mod options;
mod packed;
pub(crate) mod plan;
mod portals;
mod quake;
pub(crate) mod region;
mod source;
pub(crate) mod space;
mod stab;
mod viewers;
mod worth;

pub(crate) use source::bake_visibly;

use crate::command::{Done, JsonArg, Verbosity};
use crate::doors::DoorArg;
use crate::error::{Result, anyhow, bail};
use crate::input::{self, refuse};
use crate::kept::{self, Keeping, Kept, ResumeArgs};
use crate::map_portals::{MADE, portal_file};
use crate::memory::MemoryArgs;
use crate::numbers::duration;
use crate::output::{self, JsonSchema, Serialize};
use crate::plans::{self, PlanArgs};
use crate::progress::Bar;
use crate::surfaces::{SeenSurfaces, SurfaceArgs, Surfaces};
use crate::tables::size_class;
use crate::up::UpArgs;
use options::BakeArgs;
use sightlines::bake::{BakeInput, BakeRequest, Bakeable, Baked, Recipe, Report, Runtime, SceneMethod};
use sightlines::checkpoint::{Identity, Inputs};
use sightlines::formats::{Input, InputKind, SceneFile};
use sightlines::packed::SizeClass;
use sightlines::progress::memory;
use source::{Source, bake_announced};
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    #[arg(value_name = "IN", help = crate::input::with_formats(
        "The input: a WAD, a floor plan as {plans}, a scene as {scenes}, a Quake map, or its portal file alone"
    ))]
    input: PathBuf,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Option<String>,
    /// Quake maps: the portal file that the compiler wrote [default: beside the map]
    #[arg(long, help_heading = "Input", value_name = "MAP.prt")]
    prt: Option<PathBuf>,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten)]
    up: UpArgs,
    #[command(flatten)]
    plans: PlanArgs,
    #[command(flatten)]
    pub(crate) bake: BakeArgs,
    #[command(flatten, next_help_heading = "Method")]
    region: region::RegionArgs,
    /// Scenes in space: decide for about this long, such as 90s, 10m or 2h; a plain number is in seconds. What is not decided by then
    /// counts as visible, so the table is right, and looser. Reading the file, cutting cells and preparing methods count, and are done in full, however
    /// long they take; so is what comes after, such as writing, which does not count. With a limit that is reached, the table depends on the machine and differs from run to run
    #[arg(long, help_heading = "Method", value_name = "DURATION", value_parser = duration, conflicts_with = "resume")]
    pub(crate) time_limit: Option<Duration>,
    /// A door as a box, in scene units. It is open in the table; a game, or `query --closed NAME`, shuts it, which closes the portals that lie
    /// wholly within the box; `export` lists the corners of all portals. In a plan NAME=X0,Y0,X1,Y1. Names may repeat; scenes may have doors of
    /// their own
    #[arg(long = "door", help_heading = "Input", value_name = "NAME=X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    doors: Vec<DoorArg>,
    #[command(flatten)]
    pub(crate) memory: MemoryArgs,
    #[command(flatten)]
    pub(crate) resume: ResumeArgs,
    /// The table to write; in packed form, as `pack` makes it, if the name ends in .pvz. More than 65,536 cells without portals, by one of the
    /// methods that look from whole cells, are then written row by row, without a square of them in memory
    #[arg(short, long, help_heading = "Output", value_name = "OUT.pvs")]
    pub(crate) output: PathBuf,
    /// Layout of a packed table: small keeps the places of all cells in memory, large reads them on demand [default: large above
    /// 65,536 cells]
    #[arg(long, help_heading = "Output", value_parser = size_class())]
    class: Option<SizeClass>,
    /// Store stab trees in the table: for each cell, the sequences of portals that sight lines pass. A tree is
    /// truncated after N nodes, which never hides anything; without N 65536 for plans, 16384 for scenes in space, 4096
    /// for Quake maps and portal files. May take much longer than the table and make it several times as large; the
    /// exact method finds the same cells without trees
    #[arg(long, help_heading = "Output", value_name = "N", num_args = 0..=1, require_equals = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    stab_trees: Option<Option<u32>>,
    #[command(flatten, next_help_heading = "Output")]
    certify: certify::CertifyArgs,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &BuildArgs, Verbosity { show_progress, verbose }: Verbosity) -> Result<Done> {
    // What is not decided in time is decided anew when there is more of it.
    let keeping = if args.time_limit.is_some() { Keeping::Nowhere } else { Keeping::File(&args.resume) };
    let built = make(args, keeping, show_progress, verbose)?;
    Ok(Done::new(args.json, built))
}

/// Reads, bakes and writes. Prints nothing but progress and warnings.
pub(crate) fn make(args: &BuildArgs, keeping: Keeping<'_>, show_progress: bool, verbose: bool) -> Result<Built> {
    let BuildArgs { input: path, output: out, .. } = args;
    crate::threads::use_only(args.bake.threads);
    let clock = limit::Clock::new(args.time_limit);
    if output::has_ending(out, "json") {
        bail!(
            "{}: `build` writes a table, which is not JSON: name it {}, and then: sightlines export {} -o {}",
            out.display(),
            out.with_extension("pvs").display(),
            out.with_extension("pvs").display(),
            out.display()
        );
    }
    if args.class.is_some() && !output::has_ending(out, packed::ENDING) {
        bail!("{}: --class is for packed tables, whose names end in .pvz", out.display());
    }
    args.memory.watch();
    output::check(&[path], &[out])?;
    args.certify.check(path, out)?;
    let reading = args.plans.options(path)?;
    // The portals of a Quake map are in a file of their own.
    let is_map = path.exists() && input::kind_of(path)? == Some(InputKind::Bsp);
    let portal_file = portal_file(path, args.prt.as_deref()).filter(|_| is_map);
    let inputs = if path.exists() {
        Some(path.as_path()).into_iter().chain(portal_file.as_deref()).collect()
    } else {
        Vec::new()
    };
    let inputs = kept::look(keeping, inputs)?;
    let mut input = input::read(path, args.map.as_deref(), &args.surfaces.options(), &reading)?;
    args.refuse_meaningless(&input)?;
    args.up.put_into(path, &mut input)?;
    let chosen = (args.map.as_deref(), args.prt.as_deref());
    let source = Source::new(path, input, chosen, out)?;
    doors::check(path, &source.content, &args.doors)?;
    let request = args.request()?;
    let runtime = Runtime {
        threads: args.bake.threads,
        budget: clock.budget(),
        warn: crate::buffers::warn,
        ..Runtime::default()
    };
    let choosing = Bar::new("choice of methods", show_progress);
    let prepared = request.prepare(&source.content, &Runtime { progress: Some(&choosing), ..runtime });
    choosing.finish();
    let prepared = prepared.map_err(|error| source.failed(path, error))?;
    certify::warn_of_large_cells(path, &request, prepared.input());
    let (recipe, decisions) = (prepared.recipe(), prepared.decisions());
    certify::warn_of_one_sided_walls(path, recipe, prepared.input());
    let auto = decisions.choice.clone().map(auto::Chosen::new);
    let is_chosen = request.method.is_none_or(|method| method == SceneMethod::Auto) && !request.for_proofs;
    let viewers = decisions.viewers.map(viewers::Viewers::from);
    let surroundings = source.names(&decisions.surroundings);
    let placed = framed::Placed::of(&prepared);
    args.refuse_for_regions(&source, recipe)?;
    let (class, threads) = args.fit(&source, recipe)?;
    let runtime = Runtime { threads, ..runtime };

    let proofs = args.certify.file(out);
    let outputs: Vec<&Path> = std::iter::once(out).chain(&proofs).map(PathBuf::as_path).collect();
    let kept = Kept::open(keeping, &inputs, &outputs, || args.identity(&inputs, &source, recipe))?;
    let made = || -> Result<_> {
        let runtime = Runtime { units: kept.units(), ..runtime };
        let plan = announce::Plan::new(&source.content, recipe, auto.as_ref(), args.time_limit);
        if let Some(file) = args.by_rows(&source, recipe, class) {
            let outcome =
                packed::write_rows(path, file, (&prepared, &runtime), plan, (out, show_progress, &clock), &kept)?;
            return Ok((Outcome::Rows(Box::new(outcome)), None, None, Vec::new(), None, None, memory::peak_bytes()));
        }
        let baked = bake_announced(path, &prepared, &runtime, plan, show_progress);
        let baked = baked.map_err(|error| source.failed(path, error))?;
        clock.warn_of(path, &baked.report);
        let (baked, stab) = stab::add(path, baked, args.stab_trees, threads, &kept, show_progress)?;
        let (baked, given_doors) = doors::add(path, baked, &args.doors);
        let baked = plans::state(baked, &reading);
        let bytes = packed::bytes_of(&baked.table, path, out, class)?;
        // Proofs that contradict the table leave an older one untouched.
        let proofs = args.certify.write(path, out, &baked, threads, &kept, show_progress)?;
        kept.before_writing()?;
        output::save(out, &bytes)?;
        let outcome = Outcome::new(out, &source, recipe, &baked, bytes.len(), verbose);
        let surfaces = match (&source.content, prepared.input()) {
            (Bakeable::Scene(file), BakeInput::Scene(scene, _)) => Some(Surfaces::new(file).seen(&baked.table, scene)),
            _ => None,
        };
        Ok((outcome, viewers, surfaces, given_doors, stab, proofs, memory::peak_bytes()))
    };
    let made = made();
    let (outcome, viewers, surfaces, given_doors, stab, proofs, peak_bytes) = kept.end(made)?;
    #[rustfmt::skip]
    let built = Built {
        auto, outcome, viewers, surroundings, placed, surfaces, given_doors, stab, proofs, peak_bytes, is_chosen, verbose,
    };
    Ok(built)
}

/// What to do where there is no room for a build.
const FEWER_CELLS: &str = "allow more, or take fewer cells";
const BY_ROWS: &str = "allow more, take fewer cells, or, by a method that looks from whole cells, name the output .pvz, which is written row by row";

impl BuildArgs {
    /// What to bake.
    ///
    /// # Errors
    /// Those of the file of view cells.
    fn request(&self) -> Result<BakeRequest> {
        let mut request = self.bake.request();
        self.region.put_into(&mut request)?;
        request.for_proofs = self.certify.is_given() || self.stab_trees.is_some();
        Ok(request)
    }

    /// What decides the results of units: the files, how they are read, and how they are baked; not the number of threads. A new argument does not
    /// compile until it is decided whether it is part of that.
    fn identity(&self, inputs: &Inputs, source: &Source, recipe: &Recipe) -> Identity {
        // What `bake` and `region` say is in the recipe, what `up` says is part of the scene's content, and doors are shut after the bake.
        #[rustfmt::skip]
        let Self {
            input: _, map, prt: _, surfaces, up: _, plans, bake: _, region: _, time_limit: _, doors: _, memory: _, resume: _, output: _,
            class: _, stab_trees, certify, json: _,
        } = self;
        let mut identity = kept::identity("build", inputs);
        source.identify(&mut identity);
        identity.debug("reading", &(map, surfaces, plans));
        identity.debug("recipe", &recipe.key());
        identity.debug("more", &(stab_trees, certify.is_given()));
        identity
    }

    /// Whether nothing but the table is made, so that rows need not be kept.
    fn is_alone(&self) -> bool {
        self.doors.is_empty() && !self.certify.is_given()
    }

    /// The scene, if its table is written row by row.
    fn by_rows<'s>(&self, source: &'s Source, recipe: &Recipe, class: Option<SizeClass>) -> Option<&'s SceneFile> {
        let out = (&*self.output, class);
        packed::of_rows(source, recipe, out).filter(|_| self.is_alone())
    }

    /// Chooses what fits into the memory that may be used: for a packed table the layout that is written row by row, and the number of threads.
    fn fit(&self, source: &Source, recipe: &Recipe) -> Result<(Option<SizeClass>, usize)> {
        let by_rows = |class| self.by_rows(source, recipe, class).is_some();
        let mut class = self.class;
        let all = source.content.needs(recipe, by_rows(class));
        if class.is_none() && !self.memory.has_room(all) && by_rows(Some(SizeClass::Large)) {
            class = Some(SizeClass::Large);
            tracing::warn!("{}: written row by row, as --class large does, for --memory", self.output.display());
        }
        let needs = source.content.needs(recipe, by_rows(class));
        let threads = self.memory.threads(self.bake.threads, needs).map_err(|source| {
            let advice = if output::has_ending(&self.output, packed::ENDING) { FEWER_CELLS } else { BY_ROWS };
            anyhow!("{}: {source}; {advice}", self.input.display())
        })?;
        Ok((class, threads))
    }

    fn refuse_meaningless(&self, input: &Input) -> Result<()> {
        if !matches!(input, Input::Bsp(_)) {
            refuse(&self.input, &[("--prt", self.prt.is_some())], "Quake maps", "none")?;
        }
        if !matches!(input, Input::Scene(_)) {
            refuse(&self.input, &self.surfaces.given(), "scenes in space", "none")?;
            let of_scenes = [("--time-limit", self.time_limit.is_some()), ("--cells", self.region.names_a_file())];
            refuse(&self.input, &of_scenes, "scenes in space", "none")?;
        }
        Ok(())
    }

    /// Refuses what tables by from-region queries cannot have.
    fn refuse_for_regions(&self, source: &Source, recipe: &Recipe) -> Result<()> {
        let is_scene = matches!(source.content, Bakeable::Scene(_));
        let has_boxes = is_scene && recipe.takes_regions() && recipe.has_given_cells();
        let of_trees = [("--stab-trees", has_boxes && self.stab_trees.is_some())];
        refuse(&self.input, &of_trees, "cells with portals", "to have boxes as cells")
    }
}

/// What was built, for each kind of input.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
enum Outcome {
    Plan(plan::Outcome),
    Scene(Box<space::Outcome>),
    Regions(Box<region::Outcome>),
    Portals(portals::Outcome),
    Map(quake::Outcome),
    Rows(Box<packed::Outcome>),
}

impl Outcome {
    fn new(out: &Path, source: &Source, recipe: &Recipe, baked: &Baked, n_bytes: usize, verbose: bool) -> Self {
        let (table, fast) = (&baked.table, recipe.fast);
        match (&source.content, &baked.report) {
            (Bakeable::Plan { map, .. }, Report::Plan(did)) => {
                Self::Plan(plan::Outcome::new(out, map.map(|name| name.to_string()), table, did))
            }
            (Bakeable::Scene(file), Report::Scene(did)) => {
                Self::Scene(Box::new(space::Outcome::new(out, file, table, did)))
            }
            (Bakeable::Scene(file), Report::Regions(did)) => {
                Self::Regions(Box::new(region::Outcome::new(out, file, recipe.has_given_cells(), table, did)))
            }
            (Bakeable::Portals(prt), Report::Clusters(did)) => {
                Self::Portals(portals::Outcome::new(out, prt, fast, did, n_bytes, verbose))
            }
            (Bakeable::Map(bsp, prt), Report::Map(did)) => {
                let format = if source.is_made { MADE } else { prt.dialect().name() };
                Self::Map(quake::Outcome::new(out, bsp, format, fast, did, n_bytes, verbose))
            }
            _ => unreachable!("the report of a bake is of the kind of its input"),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plan(outcome) => outcome.fmt(f),
            Self::Scene(outcome) => outcome.fmt(f),
            Self::Regions(outcome) => outcome.fmt(f),
            Self::Portals(outcome) => outcome.fmt(f),
            Self::Map(outcome) => outcome.fmt(f),
            Self::Rows(outcome) => outcome.fmt(f),
        }
    }
}

/// All of `build`: what is the same for every kind of input.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Built {
    /// What was chosen for the input: with `--method auto`, or without a method where more than sightlines was chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    auto: Option<auto::Chosen>,
    #[serde(flatten)]
    outcome: Outcome,
    /// Where viewers can be, if the file states it and the options do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    viewers: Option<viewers::Viewers>,
    /// Scenes: the names of the objects around everything else, such as skies, if there are any. Every cell sees them, and the rest is baked without them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    surroundings: Vec<String>,
    #[serde(flatten)]
    placed: framed::Placed,
    /// Of a scene in space.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    surfaces: Option<SeenSurfaces>,
    /// With `--door`: the doors that were given as boxes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    given_doors: Vec<doors::GivenDoor>,
    /// With `--stab-trees`: what was stored.
    #[serde(skip_serializing_if = "Option::is_none")]
    stab: Option<stab::Added>,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    proofs: Option<certify::Certified>,
    /// The most memory that was in use at once; null where the system does not report it.
    peak_bytes: Option<u64>,
    /// Whether the method was chosen for the input, rather than by the user.
    #[serde(skip)]
    is_chosen: bool,
    /// Whether people get all facts, rather than a few lines; programs always do.
    #[serde(skip)]
    verbose: bool,
}

impl fmt::Display for Built {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.verbose {
            return self.write_brief(f);
        }
        self.auto.iter().try_for_each(|auto| write!(f, "{auto}"))?;
        write!(f, "{}", self.outcome)?;
        self.worth().iter().try_for_each(|sentence| writeln!(f, "worth it       {sentence}"))?;
        self.viewers.iter().try_for_each(|viewers| write!(f, "{viewers}"))?;
        write!(f, "{}{}", viewers::Surroundings(&self.surroundings), self.placed)?;
        self.surfaces.iter().try_for_each(|surfaces| write!(f, "{surfaces}"))?;
        self.given_doors.iter().try_for_each(|door| write!(f, "{door}"))?;
        self.stab.iter().try_for_each(|stab| write!(f, "{stab}"))?;
        self.proofs.iter().try_for_each(|proofs| write!(f, "{proofs}"))
    }
}
