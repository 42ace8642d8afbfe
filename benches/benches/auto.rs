//! What `--method auto` chooses for each scene, against every fixed choice: time, and pairs of a cell and an object that are reported.
//!
//! Real scenes are those of the folder that `SIGHTLINES_DATA` names, seen from some of their own view cells. Ends with 1 if the choice
//! reports a pair more than the default. Times are of one thread, preparations included.

use clap::Parser;
use sightlines::bake::auto::choose;
use sightlines::bake::{CellsFrom, RegionBakeOptions, bake_regions};
use sightlines::cells::Scene;
use sightlines::formats::ViewCells;
use sightlines::formats::scene::BackFaces;
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches_of};
use sightlines::multifocal::{FromRegion, Layout, Multifocal, OccluderSelection, UnionMethod};
use sightlines::multifocal_cpu::Fast;
use sightlines::scenes::{CityOptions, TowerOptions};
use sightlines_benches::program::{Common, exit};
use sightlines_benches::viewed::{ViewedScene, evenly, welded};
use std::error::Error;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is chosen for a scene, against every fixed choice.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Real scenes, and for each the file of its cells.
    #[arg(long, value_delimiter = ',', default_values_t = [
        "duplex:cells_rooms", "office_a:cells_rooms", "whale_large:cells_walk", "whale_tall:cells_rooms", "delft:cells_street",
        "sponza:cells_walk", "pandora:cells_walk", "castle:cells_walk",
    ].map(str::to_owned))]
    scenes: Vec<String>,
    /// Cells of each scene, at most.
    #[arg(long, default_value_t = 24)]
    cells: usize,
    /// The cells of a k-d tree instead. Fixed choices with buffers, which take longer than auto's in any case, are left out.
    #[arg(long)]
    kd: bool,
}

struct Case {
    name: String,
    scene: Scene,
    cells: CellsFrom,
}

impl Case {
    fn is_given(&self) -> bool {
        matches!(self.cells, CellsFrom::Boxes(_))
    }
}

/// A scene with at most `n` of its boxes, or with the cells of a k-d tree.
fn case(viewed: ViewedScene, n: usize, kd: bool) -> Case {
    let ViewedScene { name, scene, cells, .. } = viewed;
    let boxes = CellsFrom::Boxes(ViewCells { cells: evenly(cells, n), axes: None });
    Case { name, scene, cells: if kd { CellsFrom::KdTree } else { boxes } }
}

fn scenes(args: &Args) -> Result<Vec<ViewedScene>, Box<dyn Error>> {
    let test = args.common.test;
    let blocks = if test { 3 } else { 6 };
    let mut scenes = vec![
        ViewedScene::city(CityOptions { blocks_x: blocks, blocks_z: blocks, ..CityOptions::default() })?,
        ViewedScene::tower(TowerOptions { floors: if test { 1 } else { 2 }, ..TowerOptions::default() })?,
    ];
    for named in args.scenes.iter().filter(|_| !test) {
        scenes.extend(ViewedScene::real(named, BackFaces::default())?);
    }
    Ok(scenes)
}

/// Planes and texels of buffers, if any; and whether sheets.
type BufferSettings = Option<(u32, u32, bool)>;

struct Found {
    name: String,
    n_cells: usize,
    reported: u64,
    time: Duration,
}

fn bake(case: &Case, name: &str, sightlines: bool, method: BufferSettings, start: Instant) -> Found {
    let shared = method.map(|(planes, texels, sheets)| {
        let mesh = welded(&case.scene);
        let occluders = if planes > 0 { patches_of(&mesh, &PatchOptions::default()) } else { Vec::new() };
        let layout = Layout { planes, texels, ..Layout::default() };
        (Arc::new(OccluderSelection::new(occluders, 500)), layout, sheets.then(|| Arc::new(Sheets::of(mesh))))
    });
    let bounds = case.scene.bounds();
    let make = || -> Box<dyn FromRegion + Send> {
        let (chosen, layout, sheets) = shared.as_ref().expect("only asked if there is a method");
        let mut methods: Vec<Box<dyn FromRegion + Send>> = Vec::new();
        if layout.planes > 0 {
            methods.push(Box::new(Multifocal::new(Fast::new(), Arc::clone(chosen), bounds, *layout)));
        }
        methods.extend(
            sheets.iter().map(|s| -> Box<dyn FromRegion + Send> { Box::new(SheetMethod::shared(Arc::clone(s))) }),
        );
        Box::new(UnionMethod::new(methods))
    };
    let options = RegionBakeOptions {
        method: shared.is_some().then_some(&make),
        sightlines,
        threads: 1,
        ..RegionBakeOptions::new(&case.cells)
    };
    let baked = bake_regions(&case.scene, &options).expect("the scene can be baked");
    let n_cells = baked.table.n_cells();
    Found { name: name.to_owned(), n_cells, reported: baked.report.n_objects_seen, time: start.elapsed() }
}

/// Prints the rows of a case; whether the choice is no looser than the default.
fn rows(case: &Case) -> bool {
    let standard = Layout::default();
    let full = Some((standard.planes, standard.texels, true));
    let sheets = Some((0, standard.texels, true));
    let mut fixed: Vec<(&str, bool, BufferSettings)> =
        vec![("sightlines (default)", true, None), ("sheets", false, sheets), ("sightlines and sheets", true, sheets)];
    if case.is_given() {
        fixed.extend([("multifocal", false, full), ("both", true, full)]);
    }
    let fixed: Vec<Found> = fixed
        .into_iter()
        .map(|(name, sightlines, method)| bake(case, name, sightlines, method, Instant::now()))
        .collect();
    let start = Instant::now();
    let (facts, choice) = choose(&case.scene);
    let method = choice.uses_region_method().then_some((choice.planes, choice.texels, choice.sheets));
    let auto = bake(case, &format!("auto: {choice}"), true, method, start);
    let as_tight = fixed.iter().filter(|f| f.reported <= auto.reported).map(|f| f.time).min();
    let all = (auto.n_cells * case.scene.objects().len()) as f64;
    let measured = |fact: Option<f64>| fact.map_or_else(|| "-".to_owned(), |x| format!("{x:.2}"));
    for found in fixed.iter().chain([&auto]) {
        let against = match as_tight {
            Some(best) if found.name == auto.name => format!("{:.2}", auto.time.as_secs_f64() / best.as_secs_f64()),
            None if found.name == auto.name => "none is as tight".to_owned(),
            _ => String::new(),
        };
        println!(
            "| {} | {} | {} | {:.2} | {} | {} | {} | {} | {:.1} % | {:.3} | {against} |",
            case.name,
            case.scene.n_triangles(),
            auto.n_cells,
            facts.axial,
            measured(facts.loose),
            measured(facts.openness),
            found.name,
            found.reported,
            100.0 * found.reported as f64 / all,
            found.time.as_secs_f64(),
        );
    }
    auto.reported <= fixed[0].reported
}

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("auto") {
        return ExitCode::SUCCESS;
    }
    let n = if args.common.test { 3 } else { args.cells };
    let cases: Vec<Case> = match scenes(&args) {
        Ok(scenes) => scenes.into_iter().map(|viewed| case(viewed, n, args.kd)).collect(),
        Err(error) => return exit(Err(error)),
    };
    println!(
        "| scene | triangles | cells | axial | loose | open | method | pairs | reported | s | against the fastest fixed one as tight |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: | ---: | ---: |");
    let looser: Vec<&str> = cases.iter().filter(|case| !rows(case)).map(|case| &*case.name).collect();
    if looser.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("looser than the default: {}", looser.join(", "));
    ExitCode::FAILURE
}
