//! Any input to its table, in one call.

use crate::auto::choose_for;
use crate::baked::Baked;
use crate::error::BakeError;
use crate::framed::Framed;
use crate::input::BakeInput;
use crate::methods::{MethodError, OcclusionMethodFactory};
use crate::options::{BakeOptions, SceneMethod};
use crate::plan::{PlanBakeOptions, bake_plan};
use crate::quake::{PrtOptions, bake_map, bake_prt};
use crate::region::{PackRegionsError, RegionBakeOptions, bake_regions, pack_regions};
use crate::reports::RegionReport;
use crate::scene::{SceneBakeOptions, bake_scene};
use crate::threads;
use sightlines_cells::Scene;
use sightlines_formats::SceneInfo;
use sightlines_packed::PackReport;
use sightlines_progress::Allowance;
use sightlines_pvs::TableParts;
use sightlines_stabtree::ConvexOptions;
use std::io::Write;

/// Bakes an input: cuts it into cells where it has none, decides what they see, and makes the table.
///
/// Errs towards visible, and gives the same table, byte for byte, with any number of threads. The functions for one kind
/// of input ([`bake_plan`], [`bake_scene`], [`bake_regions`], [`bake_prt`], [`bake_map`]) document what each decides, and take
/// further arguments: the state of a search to resume, or any from-region method.
///
/// A scene whose walls lie at right angles to each other, but not along the axes of its file, is baked along axes of its own, which the
/// table states ([`Framed`], [`BakeOptions::gap`]).
///
/// [`SceneMethod::Auto`] measures the input first; [`choose_for`] returns what was chosen and why.
///
/// # Errors
/// [`BakeError`]
pub fn bake<'i>(input: impl Into<BakeInput<'i>>, options: &BakeOptions<'_>) -> Result<Baked, BakeError> {
    let input = input.into();
    threads::on(options.threads, || bake_here(input, options))
}

/// The same, on the threads that call it.
fn bake_here(input: BakeInput<'_>, options: &BakeOptions<'_>) -> Result<Baked, BakeError> {
    if let BakeInput::Scene(scene, file) = input
        && let Some(framed) = Framed::of(scene, file, options)?
    {
        return bake_here(framed.input(file), &framed.options(options));
    }
    if options.method == SceneMethod::Auto {
        return bake_here(input, &choose_for(&input, options).1);
    }
    let BakeOptions { threads, progress, units, .. } = *options;
    let search = ConvexOptions { fast: options.fast, threads };
    match input {
        BakeInput::Plan(plan) => {
            let BakeOptions { subdivide, chords, .. } = *options;
            let options = PlanBakeOptions { subdivide, tau: options.cut.tau, chords, threads, progress };
            Ok(bake_plan(plan, &options)?.into_any())
        }
        BakeInput::Scene(scene, file) => {
            let mut baked = if options.takes_regions() {
                by_regions(scene, options, file)?
            } else {
                let BakeOptions { cut, portals, budget, .. } = *options;
                let budget = Allowance::all(budget);
                bake_scene(scene, &SceneBakeOptions { cut, portals, threads, file, progress, budget, units })?
                    .into_any()
            };
            let digest = options.digest.or(baked.table.digest());
            baked.table = baked.table.with_frame(options.frame)?.with_digest(digest);
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

fn by_regions(scene: &Scene, options: &BakeOptions<'_>, file: Option<&SceneInfo>) -> Result<Baked, BakeError> {
    with_regions(scene, options, file, |regions| Ok(bake_regions(scene, regions)?.into_any()))
}

/// Calls `then` with the options of a bake by regions.
pub(crate) fn with_regions<T, E: From<BakeError>>(
    scene: &Scene,
    options: &BakeOptions<'_>,
    file: Option<&SceneInfo>,
    then: impl FnOnce(&RegionBakeOptions<'_>) -> Result<T, E>,
) -> Result<T, E> {
    let BakeOptions { method, buffers, split, cut, portals, threads, progress, budget, units, ref cells, .. } =
        *options;
    buffers.check().map_err(|error| BakeError::from(MethodError::from(error)))?;
    let prepare = |method| OcclusionMethodFactory::new(method, scene, &buffers);
    let factory = method.region_method().map(prepare).transpose().map_err(BakeError::from)?;
    let make = || factory.as_ref().expect("only called if there is one").instance();
    then(&RegionBakeOptions {
        cells,
        method: factory.is_some().then_some(&make),
        sightlines: method.by_sightlines(),
        split,
        cut,
        portals,
        threads,
        file,
        progress,
        budget: Allowance::all(budget),
        units,
    })
}

/// Bakes a scene that is along its axes already, and writes a packed table of the large class row by row: for more cells than a table in memory
/// has room for. See [`pack_regions`] for what can be written so.
///
/// # Errors
/// [`PackRegionsError`]
pub fn bake_packed<W: Write + Send>(
    scene: &Scene,
    file: Option<&SceneInfo>,
    options: &BakeOptions<'_>,
    out: W,
) -> Result<(W, RegionReport, PackReport), PackRegionsError> {
    let stated = |parts: &mut TableParts| {
        parts.frame = options.frame;
        parts.digest = options.digest.or(parts.digest);
    };
    with_regions(scene, options, file, |regions| pack_regions(scene, regions, &stated, out))
}
