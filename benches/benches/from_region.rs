//! From-region methods on scenes: what each calls visible, for each object that rays reach, and what it costs.
//!
//! Real scenes are those of the folder that `SIGHTLINES_DATA` names; a generated city and a tower come first. Ends with 1 if an
//! object that a ray reaches is called hidden.

use clap::Parser;
use sightlines::cells::Scene;
use sightlines::formats::scene::BackFaces;
use sightlines::from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines::geometry::{Aabb, Point3};
use sightlines::line_space::{Effort, LineSpace, Surface};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches_of};
use sightlines::multifocal::{
    FromRegion, Layout, Measure, Multifocal, Occludees, OccluderSelection, RaySampler, Split, UnionMethod, Volume,
    adaptive,
};
use sightlines::multifocal_cpu::Fast;
use sightlines::scenes::{CityOptions, TowerOptions};
use sightlines_benches::program::{Common, exit};
use sightlines_benches::targets::Targets;
use sightlines_benches::viewed::{ViewedScene, evenly, welded};
use sightlines_benches::witness::met;
use sightlines_testkit::{Random, RayScene};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Over-estimation of from-region methods on scenes.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Real scenes, and for each the file of its cells.
    #[arg(long, value_delimiter = ',', default_values_t = [
        "delft:cells_street", "sponza:cells_walk", "pandora:cells_walk", "whale_large:cells_walk", "duplex:cells_rooms", "office_a:cells_rooms",
    ].map(str::to_owned))]
    scenes: Vec<String>,
    /// Cells of each scene.
    #[arg(long, default_value_t = 16)]
    cells: usize,
    /// Rays of each cell.
    #[arg(long, default_value_t = 200_000)]
    rays: u64,
    /// Numbers of planes on each side.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 4, 9, 17])]
    planes: Vec<u32>,
    /// Only methods whose name contains it.
    #[arg(long, default_value = "")]
    method: String,
}

/// A scene, and where it is looked from.
struct Case {
    name: String,
    scene: Scene,
    cells: Vec<Aabb<3>>,
    /// For each cell objects that millions of rays reached, if a file beside the scene has them.
    dense: Vec<Vec<u32>>,
}

/// Objects that an independent program reached by rays, by the name of the cell.
fn read_dense(path: &Path, cells: &str) -> BTreeMap<String, Vec<u32>> {
    let Ok(text) = std::fs::read(path) else { return BTreeMap::new() };
    let all: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    if all["cells"] != format!("{cells}.json") {
        return BTreeMap::new();
    }
    let ids = |list: &serde_json::Value| -> Vec<u32> {
        list.as_array().into_iter().flatten().filter_map(|id| id.as_u64()).map(|id| id as u32).collect()
    };
    let entry = |of: &serde_json::Value| Some((of["id"].as_str()?.to_owned(), ids(&of["objects"])));
    all["seen"].as_array().into_iter().flatten().filter_map(entry).collect()
}

/// What one method says about a scene.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    reported: usize,
    /// Reached by a ray, and called hidden.
    wrong: usize,
    make: Duration,
    ask: Duration,
}

/// A scene with at most `n` of its boxes, and what is known to be seen from them.
fn case(viewed: ViewedScene, n: usize, mut dense: BTreeMap<String, Vec<u32>>) -> Case {
    let ViewedScene { name, scene, cells, .. } = viewed;
    let cells = evenly(cells, n);
    let dense = cells.iter().map(|cell| dense.remove(&cell.id).unwrap_or_default()).collect();
    Case { name, scene, cells: cells.into_iter().map(|cell| cell.bounds).collect(), dense }
}

/// A real scene, `SCENE:CELLS`.
fn real(named: &str, n: usize) -> Result<Option<Case>, Box<dyn Error>> {
    let Some(mut viewed) = ViewedScene::real(named, BackFaces::default())? else { return Ok(None) };
    let cells = named.split_once(':').map_or("", |(_, cells)| cells);
    let file = viewed.folder.as_ref().map(|folder| folder.join("seen_dense.json"));
    let dense = file.map(|file| read_dense(&file, cells)).unwrap_or_default();
    // Cells that were looked at closely are the ones to be judged by.
    if !dense.is_empty() {
        viewed.cells.retain(|cell| dense.contains_key(&cell.id));
    }
    Ok(Some(case(viewed, n, dense)))
}

fn cases(args: &Args) -> Result<Vec<Case>, Box<dyn Error>> {
    let blocks = if args.common.test { 3 } else { 6 };
    let city = ViewedScene::city(CityOptions { blocks_x: blocks, blocks_z: blocks, ..CityOptions::default() })?;
    let mut cases = vec![case(city, args.cells, BTreeMap::new())];
    if !args.common.test {
        let tower = ViewedScene::tower(TowerOptions { floors: 2, ..TowerOptions::default() })?;
        cases.push(case(ViewedScene { name: "tower:2".to_owned(), ..tower }, args.cells, BTreeMap::new()));
        for named in &args.scenes {
            cases.extend(real(named, args.cells)?);
        }
    }
    Ok(cases)
}

/// Makes a method for a scene.
type Make = Box<dyn Fn(&Case) -> Box<dyn FromRegion>>;

/// A method's name, how it is made, and how often cells are cut.
struct Contender {
    name: String,
    make: Make,
    depth: u32,
}

fn buffers(case: &Case, layout: Layout) -> Multifocal<Fast> {
    let ends = case.cells.iter().flat_map(|b| [b.min, b.max]);
    let around = Aabb::around(ends.chain([case.scene.bounds().min, case.scene.bounds().max]));
    let chosen = Arc::new(OccluderSelection::new(patches_of(&welded(&case.scene), &PatchOptions::default()), 500));
    Multifocal::new(Fast::new(), chosen, around, layout)
}

fn shipped(case: &Case) -> Box<dyn FromRegion> {
    let sheets = SheetMethod::shared(Arc::new(Sheets::of(welded(&case.scene))));
    Box::new(UnionMethod::new(vec![Box::new(buffers(case, Layout::default())), Box::new(sheets)]))
}

fn contenders(args: &Args) -> Vec<Contender> {
    let mut contenders = Vec::new();
    let mut add = |name: String, depth: u32, make: Make| {
        contenders.push(Contender { name, make, depth });
    };
    for &planes in &args.planes {
        for measure in [Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight] {
            for carry in [false, true] {
                if carry && (planes == 1 || measure != Measure::SectionHeight) {
                    continue;
                }
                let layout = Layout { planes, measure, carry, ..Layout::default() };
                let carried = if carry { ", carried" } else { "" };
                let name = format!("{}, {planes} planes{carried}", measure.name());
                add(name, 0, Box::new(move |case| Box::new(buffers(case, layout))));
            }
        }
    }
    add(
        "sheets".to_owned(),
        0,
        Box::new(|case| Box::new(SheetMethod::shared(Arc::new(Sheets::of(welded(&case.scene)))))),
    );
    add("default: height, carried, and sheets".to_owned(), 0, Box::new(shipped));
    add("the same, cells cut up to 2 times".to_owned(), 2, Box::new(shipped));
    for (box_cells, triangle_cells) in [(32, 100), (32, 400)] {
        let effort = Effort { box_cells, triangle_cells, ..Effort::default() };
        let lines = move |case: &Case| LineSpace::shared(Arc::new(Surface::of(welded(&case.scene))), effort);
        let name = format!("line space, {box_cells} and {triangle_cells} cells");
        add(name, 0, Box::new(move |case| Box::new(lines(case))));
    }
    let cut = |case: &Case| ViewShafts::new(patches_of(&welded(&case.scene), &PatchOptions::default()));
    add("shafts".to_owned(), 0, Box::new(move |case| Box::new(cut(case))));
    let voxels = |case: &Case| Voxels::new(&case.scene, VoxelOptions::default()).expect("few voxels");
    add("voxels, closed".to_owned(), 0, Box::new(move |case| Box::new(voxels(case))));
    contenders.retain(|contender| contender.name.contains(&args.method));
    contenders
}

/// Asks one method about all cells of a scene.
fn ask(case: &Case, seen: &[Vec<bool>], contender: &Contender) -> Found {
    let mut found = Found::default();
    let start = Instant::now();
    let mut method = (contender.make)(case);
    found.make = start.elapsed();
    let objects: Vec<Vec<[Point3; 3]>> = case.scene.objects().iter().map(|o| o.corners().collect()).collect();
    let is_single_sided = |object: u32| case.scene.is_single_sided(object);
    let none: &[[Point3; 3]] = &[];
    let stops = |object: u32| case.scene.is_opaque(object) || case.scene.hides_from_front(object);
    let witness = RaySampler::new((0..).zip(&objects).map(|(object, o)| if stops(object) { &o[..] } else { none }))
        .with_single_sided(is_single_sided)
        .with_front_occluders(|object| case.scene.hides_from_front(object));
    let occludees = Occludees::new(objects).with_single_sided(is_single_sided);
    for (cell, seen) in case.cells.iter().zip(seen) {
        let volume = Volume::new(*cell).expect("cells are boxes");
        let mut visible = vec![true; occludees.len()];
        let split = Split { depth: contender.depth, ..Split::default() };
        let start = Instant::now();
        adaptive::see(&mut *method, &occludees, &witness, &volume, &split, &mut visible, &mut |_| ())
            .expect("the CPU does not fail");
        found.ask += start.elapsed();
        found.reported += visible.iter().filter(|v| **v).count();
        found.wrong += visible.iter().zip(seen).filter(|(visible, seen)| **seen && !**visible).count();
    }
    found
}

/// How many objects are seen from a cell, from their fronts, past backs or of backs: those that are known, and what rays meet that aim at the others.
fn reached(case: &Case, rays: &RayScene, targets: &Targets<'_>, cell: &Aabb<3>, seen: &[bool], n_rays: u64) -> usize {
    let mut seen = seen.to_vec();
    let unseen: Vec<u32> = (0u32..).zip(&seen).filter(|(_, seen)| !**seen).map(|(object, _)| object).collect();
    let is_any = !case.scene.front_occluders().is_empty() && !unseen.is_empty();
    for ray in 0..if is_any { n_rays } else { 0 } {
        let mut random = Random::new(11, ray);
        let eye = random.point(cell);
        let Some(at) = targets.on(unseen[(ray % unseen.len() as u64) as usize], &mut random) else { continue };
        met(rays, &case.scene, eye, std::array::from_fn(|k| at[k] - eye[k]))
            .into_iter()
            .for_each(|o| seen[o as usize] = true);
    }
    seen.into_iter().filter(|s| *s).count()
}

/// Prints the table; how many objects were wrongly called hidden.
fn table(args: &Args, cases: &[Case]) -> usize {
    println!(
        "| scene | triangles | cells | objects | seen | method | reported | reported / seen | s to prepare | ms a cell |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | --- | ---: | ---: | ---: | ---: |");
    let mut n_wrong = 0;
    for case in cases {
        let rays = RayScene::new(&case.scene);
        let seen_from = |cell: &Aabb<3>| {
            let mut seen = vec![false; case.scene.objects().len()];
            rays.witness_objects(*cell, 9, args.rays).into_iter().for_each(|o| seen[o as usize] = true);
            seen
        };
        let mut seen: Vec<Vec<bool>> = case.cells.iter().map(seen_from).collect();
        for (seen, dense) in seen.iter_mut().zip(&case.dense) {
            dense.iter().for_each(|&o| seen[o as usize] = true);
        }
        let targets = Targets::new(&case.scene);
        let n_seen: usize = case
            .cells
            .iter()
            .zip(&seen)
            .map(|(cell, seen)| reached(case, &rays, &targets, cell, seen, args.rays))
            .sum();
        let n_pairs = case.cells.len() * case.scene.objects().len();
        for contender in contenders(args) {
            let found = ask(case, &seen, &contender);
            n_wrong += found.wrong;
            println!(
                "| {} | {} | {} | {} | {:.1} % | {} | {:.1} % | {:.2} | {:.2} | {:.0} |",
                case.name,
                case.scene.n_triangles(),
                case.cells.len(),
                case.scene.objects().len(),
                100.0 * n_seen as f64 / n_pairs as f64,
                contender.name,
                100.0 * found.reported as f64 / n_pairs as f64,
                found.reported as f64 / n_seen as f64,
                found.make.as_secs_f64(),
                found.ask.as_secs_f64() * 1e3 / case.cells.len() as f64,
            );
        }
    }
    n_wrong
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("from_region") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        args = Args { cells: 2, rays: 5000, planes: vec![1], ..args };
    }
    let cases = match cases(&args) {
        Ok(cases) => cases,
        Err(error) => return exit(Err(error)),
    };
    match table(&args, &cases) {
        0 => ExitCode::SUCCESS,
        n => {
            eprintln!("{n} objects that rays reach are called hidden");
            ExitCode::FAILURE
        }
    }
}
