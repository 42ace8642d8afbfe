//! Any input to its table, in one call.

use crate::baked::Baked;
use crate::error::BakeError;
use crate::input::BakeInput;
use crate::limit::{LimitReport, state_limit};
use crate::methods::{BufferOptions, MethodError, OcclusionMethodFactory};
use crate::object_parts::with_parts;
use crate::options::Recipe;
use crate::plan::{PlanBakeOptions, bake_plan};
use crate::quake::{PrtOptions, bake_map, bake_prt};
use crate::region::{PackRegionsError, RegionBakeOptions, bake_regions, pack_regions_around};
use crate::reports::{RegionReport, Report};
use crate::request::{BakeRequest, Runtime, refuse_parts};
use crate::scene::{PortalMode, SceneBakeOptions, bake_scene};
use crate::stated::TIME_LIMIT;
use crate::stopwatch::Stopwatch;
use crate::surroundings::{self, seen_around};
use sightlines_cells::Scene;
use sightlines_formats::SceneInfo;
use sightlines_packed::PackReport;
use sightlines_progress::Allowance;
use sightlines_pvs::{BitMatrix, Table, TableParts};
use sightlines_stabtree::ConvexOptions;
use std::io::Write;

/// Bakes an input as a request says: cuts it into cells where it has none, decides what they see, and makes the table.
///
/// Errs towards visible, and gives the same table, byte for byte, with any number of threads. [`BakeRequest::prepare`] and
/// [`PreparedBake::run`](crate::PreparedBake::run) are its two halves, for those who want to see what was decided, to name the number of threads, to
/// hear of the progress, or to go on after a stop. The functions for one kind
/// of input ([`bake_plan`], [`bake_scene`], [`bake_regions`], [`bake_prt`], [`bake_map`]) document what each decides, and take
/// further arguments: the state of a search to resume, or any from-region method.
///
/// A scene whose walls lie at right angles to each other, but not along the axes of its file, is baked along axes of its own, which the
/// table states ([`Framed`](crate::Framed), [`BakeRequest::gap`]).
///
/// # Errors
/// [`BakeError`]
pub fn bake<'i>(input: impl Into<BakeInput<'i>>, request: &BakeRequest) -> Result<Baked, BakeError> {
    Runtime::default().bake(input, request)
}

/// Makes the table of an input that is along its axes, on the threads that call it.
pub(crate) fn bake_here(input: BakeInput<'_>, recipe: &Recipe, runtime: &Runtime<'_>) -> Result<Baked, BakeError> {
    let Runtime { threads, progress, units, budget, .. } = *runtime;
    let search = ConvexOptions { fast: recipe.fast, threads };
    match input {
        BakeInput::Plan(plan) => {
            let (subdivide, tau) = (recipe.subdivide, recipe.cut.tau);
            let options = PlanBakeOptions { subdivide, tau, threads, progress, ..PlanBakeOptions::default() };
            Ok(bake_plan(plan, &options)?.into_any())
        }
        BakeInput::Scene(scene, file) => {
            let mut baked = if recipe.takes_regions() {
                with_regions(scene, recipe, runtime, file, |regions| {
                    let of_objects = RegionBakeOptions { budget: of_objects(recipe, regions.budget), ..*regions };
                    let baked = bake_regions(scene, &of_objects)?.into_any();
                    cut_into_parts(baked, scene, recipe, regions)
                })?
            } else {
                let (cut, portals, budget) = (recipe.cut, PortalMode::default(), Allowance::all(budget));
                let of_objects = of_objects(recipe, budget);
                let how = SceneBakeOptions { cut, portals, threads, file, progress, budget: of_objects, units };
                let baked = bake_scene(scene, &how)?;
                let regions = RegionBakeOptions {
                    threads,
                    file,
                    progress,
                    budget,
                    units,
                    ..RegionBakeOptions::new(&recipe.cells)
                };
                cut_into_parts(baked.into_any(), scene, recipe, &regions)?
            };
            let digest = recipe.digest.or(baked.table.digest());
            let n_seen = baked.table.n_cells() as u64 * recipe.surroundings.len() as u64;
            let table = seen_around(baked.table, &recipe.surroundings)?;
            baked.table = table.with_frame(recipe.frame)?.with_digest(digest);
            match &mut baked.report {
                Report::Scene(report) => report.n_objects_seen += n_seen,
                Report::Regions(report) => report.n_objects_seen += n_seen,
                _ => {}
            }
            Ok(baked)
        }
        BakeInput::Portals(prt) => {
            Ok(bake_prt(prt, PrtOptions { search, progress, units, ..PrtOptions::default() })?.into_any())
        }
        BakeInput::Map(bsp, prt) => {
            Ok(bake_map(bsp, prt, PrtOptions { search, progress, units, ..PrtOptions::default() })?.into_any())
        }
    }
}

/// What of an allowance is for whole objects: half of it, if there are parts as well.
fn of_objects<'a>(recipe: &Recipe, all: Allowance<'a>) -> Allowance<'a> {
    if recipe.parts.is_some() { all.part(0.5) } else { all }
}

/// What was baked, with parts of objects if they are asked for.
fn cut_into_parts(
    baked: Baked,
    scene: &Scene,
    recipe: &Recipe,
    options: &RegionBakeOptions<'_>,
) -> Result<Baked, BakeError> {
    let Some(most) = recipe.parts else { return Ok(baked) };
    let begin = Stopwatch::start();
    let Baked { graph, table, mut report } = baked;
    let (mut table, n_undecided) = with_parts(table, scene, most, options)?;
    let took = begin.elapsed();
    let n_seen = table.parts().objects_seen.as_ref().map_or(0, BitMatrix::count_ones);
    let limit = match &mut report {
        Report::Scene(report) => {
            report.n_objects_seen = n_seen;
            report.see_time += took;
            &mut report.limit
        }
        Report::Regions(report) => {
            report.n_objects_seen = n_seen;
            report.time += took;
            &mut report.limit
        }
        _ => return Ok(Baked { graph, table, report }),
    };
    if n_undecided > 0 {
        let limit = limit.get_or_insert_with(LimitReport::default).with_parts(table.n_cells(), n_undecided);
        let mut parts = table.into_parts();
        parts.info.retain(|(key, _)| key != TIME_LIMIT);
        state_limit(&mut parts, limit);
        table = Table::new(parts)?;
    }
    Ok(Baked { graph, table, report })
}

/// Calls `then` with the options of a bake by regions.
pub(crate) fn with_regions<T, E: From<BakeError>>(
    scene: &Scene,
    recipe: &Recipe,
    runtime: &Runtime<'_>,
    file: Option<&SceneInfo>,
    then: impl FnOnce(&RegionBakeOptions<'_>) -> Result<T, E>,
) -> Result<T, E> {
    let Runtime { threads, progress, budget, units, warn } = *runtime;
    let Recipe { method, split, cut, ref cells, .. } = *recipe;
    let buffers = BufferOptions { warn, ..recipe.buffers };
    buffers.check().map_err(|error| BakeError::from(MethodError::from(error)))?;
    let prepare = |method| OcclusionMethodFactory::new(method, scene, &buffers);
    let factory = method.region_method().map(prepare).transpose().map_err(BakeError::from)?;
    let surface = factory.as_ref().and_then(OcclusionMethodFactory::surface);
    let make = || factory.as_ref().expect("only called if there is one").instance();
    then(&RegionBakeOptions {
        cells,
        method: factory.is_some().then_some(&make),
        surface: surface.as_ref(),
        sightlines: method.by_sightlines(),
        split,
        cut,
        portals: PortalMode::default(),
        threads,
        file,
        progress,
        budget: Allowance::all(budget),
        units,
    })
}

/// Bakes a scene that is along its axes, and writes a packed table row by row.
pub(crate) fn bake_packed<W: Write + Send>(
    scene: &Scene,
    file: Option<&SceneInfo>,
    recipe: &Recipe,
    runtime: &Runtime<'_>,
    out: W,
) -> Result<(W, RegionReport, PackReport), PackRegionsError> {
    let stated = |parts: &mut TableParts| {
        parts.frame = recipe.frame;
        parts.digest = recipe.digest.or(parts.digest);
        surroundings::state(parts, &recipe.surroundings);
    };
    refuse_parts(recipe.parts, "a table that is written row by row").map_err(BakeError::from)?;
    let around: Vec<u32> = recipe.surroundings.iter().map(|of| of.object).collect();
    with_regions(scene, recipe, runtime, file, |regions| pack_regions_around(scene, regions, &around, &stated, out))
}
