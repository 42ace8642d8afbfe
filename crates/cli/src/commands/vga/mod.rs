//! `vga`: visibility graph analysis of a floor plan.

pub(crate) mod outcome;
mod points;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::input;
use crate::kept::{self, Keeping, Kept, ResumeArgs};
use crate::memory::MemoryArgs;
use crate::named::one_of;
use crate::output;
use crate::output_kind::OutputKind as Kind;
use crate::place::Point;
use crate::plans::{GapArg, PlanArgs, walls};
use crate::progress::Bar;
use outcome::{Outcome, Range};
use sightlines::bake::Bakeable;
use sightlines::cells::Plan;
use sightlines::checkpoint::{Identity, Inputs};
use sightlines::formats::InputKind;
use sightlines::formats::scene::SceneReadOptions;
use sightlines::geometry::Point2;
use sightlines::isovist::{Touch, WallMesh};
use sightlines::progress::memory::{self, Needs};
use sightlines::report::{Field, MAX_SIZE, MIN_SIZE, PointColumn, field_png, field_svg, points_csv, points_geojson};
use sightlines::visibility_graph::{
    Analysis, AnalysisOptions, Group, Measure, MeasureSet, Points, Turns, UNDEFINED, VisibilityGraph, WorkOptions,
};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Points are the centres of a grid, at multiples of the spacing: those that steps between neighbours reach from the \
                  seeds without touching a wall. Without a seed the grid fills all areas that walls enclose, also the insides of \
                  pillars; if an outer door is open, so that the largest area is not enclosed, it fills only that area. Measures are those of depthmapX; -1 in a CSV file, null in GeoJSON, and no \
                  square in a picture mean that a point has no value. Metric and angular measures take minutes for some thousand \
                  points."
)]
pub(crate) struct VgaArgs {
    #[arg(value_name = "PLAN", help = crate::input::with_formats(
        "The plan: {plans}, or a map of a WAD"
    ))]
    plan: PathBuf,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Option<String>,
    #[command(flatten)]
    plans: PlanArgs,
    #[command(flatten)]
    gap: GapArg,
    /// Distance of neighbouring points along an axis, in scene units; of points of a file the side of their squares in pictures
    #[arg(long, help_heading = "Points", value_name = "LENGTH", required_unless_present = "points")]
    spacing: Option<f64>,
    /// Fill the grid from this point; repeatable
    #[arg(long, help_heading = "Points", value_name = "X,Y", allow_hyphen_values = true, conflicts_with = "points")]
    seed: Vec<Point>,
    /// Take the points of this file in place of a grid: CSV with `x,y` on each line, or GeoJSON
    #[arg(long, help_heading = "Points", value_name = "FILE")]
    points: Option<PathBuf>,
    /// What is measured, separated by commas: local, global, metric, angular, all, or names of measures
    #[arg(
        long,
        help_heading = "Method",
        value_name = "NAME[,NAME...]",
        value_delimiter = ',',
        value_parser = one_of(&MeasureSet::all(), MeasureSet::name, about)
    )]
    measures: Vec<MeasureSet>,
    /// The most steps that count in global measures [default: any number]
    #[arg(long, help_heading = "Method", value_name = "N")]
    radius: Option<u32>,
    /// The longest paths that count in metric measures, in scene units [default: any]
    #[arg(long, help_heading = "Method", value_name = "LENGTH", value_parser = positive, allow_negative_numbers = true)]
    metric_radius: Option<f64>,
    /// The largest depth that counts in angular measures, in right angles [default: any]
    #[arg(long, help_heading = "Method", value_name = "ANGLE", value_parser = positive, allow_negative_numbers = true)]
    angular_radius: Option<f64>,
    /// Where metric and angular paths may turn
    #[arg(long, help_heading = "Method", value_name = "WHERE", default_value = "near-walls")]
    #[arg(value_parser = one_of(&Turns::ALL, Turns::name, turns_about))]
    turns: Turns,
    /// Whether a line of sight that touches a wall without crossing it is blocked
    #[arg(long, help_heading = "Method", value_name = "HOW", default_value = "blocks")]
    #[arg(value_parser = one_of(&Touch::ALL, Touch::name, touch_about))]
    touch: Touch,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    threads: usize,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    resume: ResumeArgs,
    /// The measure that a picture shows [default: the first of --measures, else connectivity]
    #[arg(long, help_heading = "Output", value_name = "NAME")]
    #[arg(value_parser = one_of(&Measure::ALL, Measure::name, Measure::title))]
    measure: Option<Measure>,
    /// Pixels of the longer side of the plan in a picture
    #[arg(long, help_heading = "Output", value_name = "PIXELS", default_value_t = 1200)]
    #[arg(value_parser = clap::value_parser!(u32).range(i64::from(MIN_SIZE)..=i64::from(MAX_SIZE)))]
    size: u32,
    /// What to write, by the ending of its name: .csv, .geojson, or a picture as .svg or .png
    #[arg(short, long, help_heading = "Output", value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

/// What the entries of `--measures` are.
const fn about(measures: MeasureSet) -> &'static str {
    match measures {
        MeasureSet::All => "All measures",
        MeasureSet::Group(Group::Local) => "What a point sees, and what sees that: as set if nothing is named",
        MeasureSet::Group(Group::Global) => "How many steps all others are away",
        MeasureSet::Group(Group::Metric) => "How long the shortest paths to all others are",
        MeasureSet::Group(Group::Angular) => "How much paths to all others turn",
        MeasureSet::One(measure) => measure.title(),
    }
}

const fn turns_about(turns: Turns) -> &'static str {
    match turns {
        Turns::NearWalls => "At points next to a wall, as in depthmapX",
        Turns::Anywhere => "At any point: slower, and sometimes a little shorter",
    }
}

const fn touch_about(touch: Touch) -> &'static str {
    match touch {
        Touch::Blocks => "It is, as in depthmapX",
        Touch::Passes => "It is not, unless walls touch it from both sides",
    }
}

pub(crate) fn run(args: &VgaArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    args.memory.watch();
    let kind = Kind::of(&args.output, "output ends in .csv, .geojson, .svg or .png")?;
    let inputs: Vec<&Path> = std::iter::once(&args.plan).chain(&args.points).map(PathBuf::as_path).collect();
    output::check(&inputs, &[&args.output])?;
    if kind.is_picture() && args.spacing.is_none() {
        return Err(needs_spacing(args));
    }
    if args.measure.is_some() && !kind.is_picture() {
        bail!("{}: --measure is for pictures, and this is a table of all --measures", args.output.display());
    }
    let keeping = Keeping::File(&args.resume);
    let looked = kept::look(keeping, inputs)?;
    let plan = plan_of(args)?;
    let (points, grid) = match (&args.points, args.spacing) {
        (None, Some(spacing)) => {
            let (points, size) = points::of_grid(&args.plan, &plan, spacing, &seeds(args)?)?;
            (points, Some(size))
        }
        (Some(path), _) => (points::of_file(path)?, None),
        (None, None) => return Err(needs_spacing(args)),
    };
    let measures = measures(args, kind);
    let drawn = kind.is_picture().then(|| shown(args, &measures));

    // Paths keep a length, a node and an entry of a heap for each point; a column has a number, and a value that may be missing.
    let n = points.len() as u64;
    let needs = Needs { shared: 24 * n * measures.len() as u64, per_thread: (4 << 20) + 48 * n };
    let too_large = |source| anyhow!("{}: {source}; allow more, or take fewer points", args.plan.display());
    let threads = args.memory.threads(args.threads, needs).map_err(too_large)?;
    let kept = Kept::open(keeping, &looked, &[&args.output], || args.identity(&looked))?;
    let analysed = analyse(args, &plan, &points, &measures, (&kept, threads, show_progress));
    let written = analysed.and_then(|analysed| {
        let columns = columns_of(&analysed.analysis, &measures);
        output::save(&args.output, &written(args, kind, &plan, &points, &columns, drawn)?)?;
        Ok((analysed, columns))
    });
    // Results are of use until the output is written.
    let (Analysed { graph, graph_seconds, measure_seconds, .. }, columns) = kept.end(written)?;
    let outcome = Outcome {
        plan: args.plan.display().to_string(),
        n_walls: walls(&plan).len(),
        spacing: grid.and(args.spacing),
        grid,
        n_points: points.len(),
        n_visible_pairs: (0..points.len() as u32).map(|p| u64::from(graph.n_seen(p))).sum::<u64>() / 2,
        n_runs: graph.n_runs(),
        n_graph_bytes: graph.n_bytes(),
        measures: columns.iter().map(|(measure, values)| Range::of(*measure, values)).collect(),
        graph_seconds,
        measure_seconds,
        drawn: drawn.map(Measure::name),
        file: args.output.display().to_string(),
        peak_bytes: memory::peak_bytes(),
    };
    Ok(Done::new(args.json, outcome))
}

fn columns_of(analysis: &Analysis, measures: &[Measure]) -> Vec<(Measure, Vec<f64>)> {
    measures.iter().map(|&measure| (measure, analysis.values(measure).unwrap_or_default())).collect()
}

/// What was found.
struct Analysed {
    graph: VisibilityGraph,
    analysis: Analysis,
    graph_seconds: f64,
    measure_seconds: f64,
}

fn analyse(
    args: &VgaArgs,
    plan: &Plan,
    points: &Points,
    measures: &[Measure],
    (kept, threads, show_progress): (&Kept<'_>, usize, bool),
) -> Result<Analysed> {
    let bar = Bar::new("visibility graph", show_progress);
    let units = kept.units();
    let effort = WorkOptions { threads, observer: Some(&bar), units };
    let start = Instant::now();
    let graph = graph(args, plan, points, &effort)?;
    let graph_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let options = AnalysisOptions {
        radius: args.radius,
        metric_radius: args.metric_radius,
        angular_radius: args.angular_radius,
        turns: args.turns,
    };
    let analysis = Analysis::of(&graph, points, measures, &options, &effort).in_file(&args.plan)?;
    Ok(Analysed { graph, analysis, graph_seconds, measure_seconds: start.elapsed().as_secs_f64() })
}

impl VgaArgs {
    /// What decides the results of units: the files, how they are read, and what is measured; not the number of threads. A new argument does not compile until
    /// it is decided whether it is part of that.
    fn identity(&self, inputs: &Inputs) -> Identity {
        #[rustfmt::skip]
        let Self {
            plan: _, map, plans, gap, spacing, seed, points: _, measures, radius, metric_radius, angular_radius, turns, touch,
            threads: _, memory: _, resume: _, measure, size: _, output: _, json: _,
        } = self;
        let mut identity = kept::identity("vga", inputs);
        identity.debug("points", &(map, plans, gap, spacing, seed));
        identity.debug("measures", &(measures, measure, radius, metric_radius, angular_radius, turns, touch));
        identity
    }
}

fn needs_spacing(args: &VgaArgs) -> anyhow::Error {
    anyhow!("{}: a picture of points needs --spacing, the side of the square around each", args.output.display())
}

fn plan_of(args: &VgaArgs) -> Result<Plan> {
    let (path, map) = (&args.plan, args.map.as_deref());
    let options = args.plans.options(path)?;
    let kind = input::kind_of(path)?;
    if kind == Some(InputKind::Scene) {
        let (scene, plan) = (path.display(), path.with_extension("geojson"));
        bail!(
            "{scene}: is a scene in space, not a plan: cut one first: sightlines plan {scene} --height H -o {}",
            plan.display()
        );
    }
    if matches!(kind, Some(InputKind::Plan | InputKind::Wad)) {
        let read = input::read(path, map, &SceneReadOptions::default(), &options)?;
        if let Bakeable::Plan { plan, .. } = input::bakeable(path, read, map, None)? {
            return args.gap.join(path, plan);
        }
    }
    Err(input::neither(path, "a plan nor a WAD"))
}

fn seeds(args: &VgaArgs) -> Result<Vec<Point2>> {
    args.seed.iter().map(|seed| seed.planar(&args.plan).about("--seed")).collect()
}

/// What is computed: what is named; else the measure of a picture, and of tables local measures.
fn measures(args: &VgaArgs, kind: Kind) -> Vec<Measure> {
    let mut named = args.measures.clone();
    if named.is_empty() && !(kind.is_picture() && args.measure.is_some()) {
        named.push(MeasureSet::Group(Group::Local));
    }
    named.extend(args.measure.map(MeasureSet::One));
    Measure::ALL.into_iter().filter(|&measure| named.iter().any(|choice| choice.has(measure))).collect()
}

fn positive(text: &str) -> Result<f64, String> {
    let x: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if x.is_finite() && x > 0.0 { Ok(x) } else { Err("not a positive number".to_owned()) }
}

fn shown(args: &VgaArgs, measures: &[Measure]) -> Measure {
    args.measure.or(measures.first().copied()).unwrap_or(Measure::Connectivity)
}

fn graph(args: &VgaArgs, plan: &Plan, points: &Points, effort: &WorkOptions<'_>) -> Result<VisibilityGraph> {
    let at = points.coordinates();
    let mesh = WallMesh::around(plan, at.iter().copied()).in_file(&args.plan)?;
    let from = args.points.as_ref().unwrap_or(&args.plan);
    let index = mesh.index(at).in_file(from)?;
    let seen = |eye: u32, list: &mut Vec<u32>| mesh.points_seen(eye, &index, args.touch, list);
    let built = VisibilityGraph::build(at.len() as u32, seen, effort);
    built.in_file(&args.plan)
}

fn written(
    args: &VgaArgs,
    kind: Kind,
    plan: &Plan,
    points: &Points,
    columns: &[(Measure, Vec<f64>)],
    drawn: Option<Measure>,
) -> Result<Vec<u8>> {
    let known: Vec<(Measure, Vec<Option<f64>>)> = columns
        .iter()
        .map(|(measure, values)| (*measure, values.iter().map(|&x| (x != UNDEFINED).then_some(x)).collect()))
        .collect();
    let Some(drawn) = drawn else {
        let table: Vec<PointColumn<'_>> =
            known.iter().map(|(measure, values)| PointColumn { name: measure.name(), values }).collect();
        let text = match kind {
            Kind::GeoJson => points_geojson(points.coordinates(), &table),
            _ => points_csv(points.coordinates(), &table),
        };
        return Ok(text.into_bytes());
    };
    let values = known.iter().find(|(measure, _)| *measure == drawn).map_or(&[][..], |(_, values)| values);
    let walls = walls(plan);
    let field = Field {
        title: drawn.title(),
        unit: drawn.unit(),
        points: points.coordinates(),
        side: args.spacing.unwrap_or_default(),
        values,
        walls: &walls,
        size: args.size,
    };
    if kind == Kind::Svg {
        return Ok(field_svg(&field).into_bytes());
    }
    field_png(&field).in_file(&args.output)
}
