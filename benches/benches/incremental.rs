//! Tables of towers that change: time of an update against that of a rebuild, for doors and walls.
//!
//! Measuring and drawing are two steps: `--csv` keeps what was measured, `--draw` makes table and chart of such a file,
//! always the same ones.

use clap::Parser;
use sightlines::bake::{LiveScene, LiveUpdate, SceneBakeOptions, bake_scene};
use sightlines::cells::{CellGraph, CellId, PortalId, Scene, SceneObject};
use sightlines::geometry::Aabb;
use sightlines::kdtree::{SceneOptions, subdivide_scene};
use sightlines::scenes::{TowerOptions, tower};
use sightlines::stabtree::{AxialVisibility, SearchOptions, axial_visibility};
use sightlines_benches::chart::{Panel, Series, svg};
use sightlines_benches::measure::median;
use sightlines_benches::program::{Common, Files, exit, read_rows, save};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Height of a storey.
const STOREY: f64 = 3.0;
/// By how much walls are moved: their thickness.
const STEP: f64 = 0.25;

/// Doors and walls of towers: updates against rebuilds.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Floors of the towers.
    #[arg(long, value_delimiter = ',', default_values_t = [4, 16])]
    floors: Vec<u32>,
    /// Threads, one run for each.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2])]
    threads: Vec<usize>,
    /// Doors and walls of each tower, spread over its middle floor.
    #[arg(long, default_value_t = 4)]
    edits: usize,
    /// How often each is done and undone; the quickest time counts.
    #[arg(long, default_value_t = 2)]
    rounds: usize,
    #[command(flatten)]
    files: Files,
    /// Writes the table for people.
    #[arg(long)]
    md: Option<PathBuf>,
}

/// Kinds of edits, in the order of the file.
const KINDS: [&str; 6] =
    ["door closed", "door opened", "wall moved", "wall moved back", "portal closed", "portal opened"];

/// The columns of the file: those after the kind are medians over the edits, but for the last, the least of them.
const HEAD: &str = "floors,threads,cells,kind,edits,cut_s,see_s,table_s,update_s,rebuild_s,times_faster,least";

/// What was measured of one kind of edit of one tower.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    floors: u32,
    threads: usize,
    cells: usize,
    kind: usize,
    edits: usize,
    /// Seconds: to cut, to see, to tabulate, together, and of a rebuild; then how many times faster, and the least of
    /// that.
    numbers: [f64; 7],
}

const UPDATE: usize = 3;
const REBUILD: usize = 4;
const FASTER: usize = 5;
const LEAST: usize = 6;

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("bake/incremental") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.floors, args.threads, args.edits, args.rounds) = (vec![1, 2], vec![1, 2], 2, 1);
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let rows = args.files.rows(read, || measure(args))?;
    if args.common.test {
        check(&rows)?;
    }
    save(args.md.as_deref(), || for_people(&rows))?;
    args.files.save_chart(|| chart(&rows))?;
    print!("{}", table(&rows));
    Ok(())
}

/// An edit: the scene that it leads to.
struct Edit {
    kinds: [usize; 2],
    scene: Scene,
}

fn measure(args: &Args) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for &floors in &args.floors {
        let small = if args.common.test { (2, 1, 1) } else { (6, 4, 2) };
        let (rooms_x, rooms_y, furniture) = small;
        let scene = tower(TowerOptions { floors, rooms_x, rooms_y, furniture, ..TowerOptions::default() })?;
        let edits = edits(&scene, floors / 2, args.edits)?;
        for &threads in &args.threads {
            rows.extend(measure_tower(&scene, &edits, floors, threads, args)?);
            args.files.save_rows(|| write(&rows))?;
        }
    }
    Ok(rows)
}

fn measure_tower(
    scene: &Scene,
    edits: &[Edit],
    floors: u32,
    threads: usize,
    args: &Args,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let options = SceneBakeOptions { threads, ..SceneBakeOptions::default() };
    let mut live = LiveScene::new(scene.clone(), &options)?;
    let cells = live.table().n_cells();
    let mut measured: Vec<Vec<[f64; 5]>> = vec![Vec::new(); KINDS.len()];
    for edit in edits {
        for (kind, after) in edit.kinds.into_iter().zip([&edit.scene, scene]) {
            // Rebuilds and updates take turns, so that what else the machine does meets both.
            let mut best = [f64::INFINITY; 5];
            for _ in 0..args.rounds {
                let before = if kind == edit.kinds[0] { scene } else { &edit.scene };
                live.update(before.clone())?;
                let next = after.clone();
                let start = Instant::now();
                let update = live.update(next)?;
                keep(&mut best, &update, start.elapsed().as_secs_f64());
                let start = Instant::now();
                let rebuilt = bake_scene(after, &options)?;
                best[REBUILD] = best[REBUILD].min(start.elapsed().as_secs_f64());
                assert!(rebuilt.table.to_bytes() == live.table().to_bytes(), "{} on {floors} floors", KINDS[kind]);
                assert_eq!(rebuilt.report.n_assumed, 0, "nothing is given up");
            }
            measured[kind].push(best);
        }
    }
    live.update(scene.clone())?;
    let open = live.table().to_bytes();
    for portal in doors_of_floor(&live, floors / 2, args.edits) {
        let mut best = [[f64::INFINITY; 5]; 2];
        for _ in 0..args.rounds {
            let start = Instant::now();
            let update = live.close(&[portal])?;
            keep(&mut best[0], &update, start.elapsed().as_secs_f64());
            let start = Instant::now();
            let rebuilt = see_closed(&live, threads)?;
            best[0][REBUILD] = best[0][REBUILD].min(start.elapsed().as_secs_f64());
            assert!(says(&live, &rebuilt), "portal {portal:?} of {floors} floors");
            let start = Instant::now();
            let update = live.open(&[portal])?;
            keep(&mut best[1], &update, start.elapsed().as_secs_f64());
            assert!(open == live.table().to_bytes(), "portal {portal:?} of {floors} floors");
            best[1][REBUILD] = best[0][REBUILD];
        }
        measured[4].push(best[0]);
        measured[5].push(best[1]);
    }
    let row = |(kind, measured): (usize, Vec<[f64; 5]>)| {
        let column = |of: &dyn Fn(&[f64; 5]) -> f64| measured.iter().map(of).collect::<Vec<f64>>();
        let times = |m: &[f64; 5]| m[REBUILD] / m[UPDATE];
        let mut numbers = [0.0; 7];
        (0..5).for_each(|k| numbers[k] = median(column(&|m| m[k])));
        numbers[FASTER] = median(column(&times));
        numbers[LEAST] = column(&times).into_iter().fold(f64::INFINITY, f64::min);
        eprintln!("{floors} floors, {threads} threads, {}: {:.1} times", KINDS[kind], numbers[FASTER]);
        Row { floors, threads, cells, kind, edits: measured.len(), numbers }
    };
    Ok(measured.into_iter().enumerate().filter(|(_, m)| !m.is_empty()).map(row).collect())
}

/// Keeps the quickest update.
fn keep(best: &mut [f64; 5], update: &LiveUpdate, seconds: f64) {
    if seconds < best[UPDATE] {
        let parts = [update.cut_time, update.see_time, update.table_time].map(|t| t.as_secs_f64());
        best[..3].copy_from_slice(&parts);
        best[UPDATE] = seconds;
    }
}

/// The visibility of a live scene, computed from scratch with closed portals as walls.
fn see_closed(live: &LiveScene, threads: usize) -> Result<AxialVisibility, Box<dyn Error>> {
    let cut = subdivide_scene(live.scene(), &SceneOptions::default())?;
    let closed = live.closed_portals();
    let open = (0u32..).zip(cut.graph.portals()).filter(|(id, _)| !closed.contains(&PortalId(*id)));
    let graph = CellGraph::new(cut.graph.cells().to_vec(), open.map(|(_, portal)| portal.clone()).collect());
    let boxes = live.scene().objects().iter().map(|o| Aabb::around(o.corners().flatten()));
    let boxes: Vec<Aabb<3>> = boxes.collect();
    let search = SearchOptions { threads, ..SearchOptions::default() };
    Ok(axial_visibility(&graph, &cut.left_out(), &[], &boxes, &search).expect("nobody cancels"))
}

/// Whether a table says what was found.
fn says(live: &LiveScene, seen: &AxialVisibility) -> bool {
    let cells = (0..live.table().n_cells() as u32).map(CellId);
    cells.into_iter().all(|cell| {
        live.table().visible(cell).map(|c| c.idx()).eq(seen.cells.iter_ones(cell.idx()))
            && live.table().visible_objects(cell).iter().map(|o| o.idx()).eq(seen.objects.iter_ones(cell.idx()))
    })
}

/// Doors that are closed by a box in the opening, and walls that are moved by their thickness: of each kind `n`, spread
/// over a floor.
fn edits(scene: &Scene, floor: u32, n: usize) -> Result<Vec<Edit>, Box<dyn Error>> {
    let on_floor = |kind: &str| -> Vec<&SceneObject> {
        let start = format!("floor{floor}/{kind}_");
        scene.objects().iter().filter(|o| o.name.starts_with(&start)).collect()
    };
    let mut edits = Vec::new();
    let bottom = f64::from(floor) * STOREY;
    let sills: Vec<Aabb<3>> = on_floor("sill").iter().map(|o| o.bounds()).collect();
    // Lintels are above windows, too; these have a sill.
    let is_door = |b: &Aabb<3>| sills.iter().all(|s| (s.min[0], s.min[2]) != (b.min[0], b.min[2]));
    let doors: Vec<Aabb<3>> = on_floor("lintel").iter().map(|o| o.bounds()).filter(is_door).collect();
    for lintel in spread(&doors, n) {
        let (min, mut max) = ([lintel.min[0], bottom, lintel.min[2]], lintel.max);
        max[1] = lintel.min[1];
        let mut objects = scene.objects().to_vec();
        objects.push(block("door", &Aabb { min, max }));
        edits.push(Edit { kinds: [0, 1], scene: Scene::new(objects)? });
    }
    let long = |o: &&&SceneObject| {
        let b = o.bounds();
        (b.max[0] - b.min[0]).max(b.max[2] - b.min[2]) > 1.0
    };
    let walls: Vec<&str> = on_floor("wall").iter().filter(long).map(|o| o.name.as_str()).collect();
    for name in spread(&walls, n) {
        let mut objects = scene.objects().to_vec();
        for object in objects.iter_mut().filter(|o| o.name == *name) {
            let b = object.bounds();
            let axis = if b.max[0] - b.min[0] < b.max[2] - b.min[2] { 0 } else { 2 };
            object.vertices.iter_mut().for_each(|p| p[axis] += STEP);
        }
        edits.push(Edit { kinds: [2, 3], scene: Scene::new(objects)? });
    }
    Ok(edits)
}

/// Some of many, at even distances.
fn spread<T>(all: &[T], n: usize) -> impl Iterator<Item = &T> {
    let step = (all.len() / n.max(1)).max(1);
    all.iter().skip(step / 2).step_by(step).take(n)
}

/// A closed box that faces outwards.
fn block(name: &str, b: &Aabb<3>) -> SceneObject {
    let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

/// Upright portals of a floor that are as high as doors.
fn doors_of_floor(live: &LiveScene, floor: u32, n: usize) -> Vec<PortalId> {
    let bottom = f64::from(floor) * STOREY;
    let is_door = |b: &Aabb<3>| b.min[1] == bottom && b.max[1] < bottom + 2.5 && b.max[1] > bottom + 2.0;
    let portals = (0u32..).map(PortalId).zip(live.graph().portals());
    let doors: Vec<PortalId> = portals.filter(|(_, p)| is_door(&p.shape.extent)).map(|(id, _)| id).collect();
    spread(&doors, n).copied().collect()
}

fn write(rows: &[Row]) -> String {
    let line = |row: &Row| {
        let numbers: Vec<String> = row.numbers.iter().map(f64::to_string).collect();
        let Row { floors, threads, cells, kind, edits, .. } = row;
        format!("{floors},{threads},{cells},{},{edits},{}\n", KINDS[*kind], numbers.join(","))
    };
    format!("{HEAD}\n{}", rows.iter().map(line).collect::<String>())
}

fn read(text: &str) -> Result<Vec<Row>, String> {
    read_rows(text, HEAD, row_of)
}

fn row_of(line: &str) -> Option<Row> {
    let parts: Vec<&str> = line.split(',').collect();
    let [floors, threads, cells, kind, edits, numbers @ ..] = &parts[..] else { return None };
    let numbers: Result<Vec<f64>, _> = numbers.iter().map(|x| x.parse()).collect();
    Some(Row {
        floors: floors.parse().ok()?,
        threads: threads.parse().ok()?,
        cells: cells.parse().ok()?,
        kind: KINDS.iter().position(|k| k == kind)?,
        edits: edits.parse().ok()?,
        numbers: numbers.ok()?.try_into().ok()?,
    })
}

fn table(rows: &[Row]) -> String {
    let head = "| floors | threads | cells | edit | edits | cut, ms | see, ms | table, ms | update, ms | rebuild, ms \
                | times faster | least |\n| --: | --: | --: | --- | --: | --: | --: | --: | --: | --: | --: | --: |\n";
    let line = |row: &Row| {
        let [cut, see, table, update, rebuild] = [0, 1, 2, UPDATE, REBUILD].map(|k| 1e3 * row.numbers[k]);
        let [faster, least] = [FASTER, LEAST].map(|k| row.numbers[k]);
        let Row { floors, threads, cells, kind, edits, .. } = row;
        format!(
            "| {floors} | {threads} | {cells} | {} | {edits} | {cut:.1} | {see:.1} | {table:.1} | {update:.1} \
             | {rebuild:.0} | {faster:.1} | {least:.1} |\n",
            KINDS[*kind]
        )
    };
    head.to_owned() + &rows.iter().map(line).collect::<String>()
}

fn for_people(rows: &[Row]) -> String {
    let about = "# Tables of towers that change

A *door* is closed by a box in the opening, and opened by taking the box away; a *wall* is moved by its thickness, and
back. Both are other scenes: they are cut anew, and the table is brought up to date. A *portal* is closed and opened by its
id, and nothing is cut. *Rebuild* is `bake_scene` of the same scene (for portals: cutting it and computing its visibility without
them, and no table), in the same run, right after the update. Every table is compared with the rebuilt one, byte for byte. Times are
medians over the edits of the quickest of some rounds; *least* is the edit that gains least, mostly a wall of the facade: moved, it stands out of
the box around the scene, and all rooms of that side look out into a new layer of air. Only the ratios of one run say something. All columns:
[incremental.csv](incremental.csv). Made by `cargo bench -p sightlines-benches --bench incremental -- --edits 3 --csv $PWD/docs/charts/incremental.csv`, then `--draw` of that file with `--md` and `--svg`.

";
    about.to_owned() + &table(rows)
}

fn chart(rows: &[Row]) -> String {
    let mut panels = Vec::new();
    let mut threads: Vec<usize> = rows.iter().map(|r| r.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let series = |threads: usize, kind: usize, column: usize, name: &str| {
        let wanted = rows.iter().filter(move |r| (r.threads, r.kind) == (threads, kind));
        Series::line(name, wanted.map(|r| [f64::from(r.floors), r.numbers[column]]).collect())
    };
    for &n in &threads {
        let mut times: Vec<Series> = vec![series(n, 0, REBUILD, "rebuild")];
        times.extend([0, 1, 2, 4, 5].map(|kind| series(n, kind, UPDATE, KINDS[kind])));
        let title = format!("seconds, threads: {n}");
        panels.push(Panel::of_lines(title, "floors", times));
    }
    for &n in &threads {
        let faster = (0..KINDS.len()).map(|kind| series(n, kind, FASTER, KINDS[kind])).collect();
        let title = format!("times faster, threads: {n}");
        panels.push(Panel::of_lines(title, "floors", faster));
    }
    svg("Towers that change: updates against rebuilds", &panels)
}

/// What must hold of small towers, whatever the machine.
fn check(rows: &[Row]) -> Result<(), Box<dyn Error>> {
    for (kind, name) in KINDS.iter().enumerate() {
        assert!(rows.iter().any(|r| r.kind == kind && r.edits > 0), "{name} was measured");
    }
    let text = write(rows);
    assert_eq!(read(&text)?, rows, "what was measured is read back");
    assert_eq!(chart(&read(&text)?), chart(rows), "the same numbers make the same chart");
    for broken in [text.replace("cells", "c"), text.replacen("\n1,", "\n", 1), text.replacen("\n1,", "\nx,", 1)] {
        assert!(read(&broken).is_err(), "{broken}");
    }
    Ok(())
}
