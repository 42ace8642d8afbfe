//! Scenes that were turned, scaled and moved, and rounded to single precision as in a file: what their tables hide of what is seen, and how
//! much they show beside the upright scene.
//!
//! Real scenes are those of the folder that `SIGHTLINES_DATA` names; a generated city and a tower come first. Cells are turned along: as boxes with
//! axes of single precision. Ends with 1 if anything is called hidden that a ray reaches in the changed scene, or that an
//! independent program reached in the given one.

use clap::Parser;
use sightlines::bake::{BakeInput, BakeRequest, Baked, CellsFrom, Runtime, SceneMethod};
use sightlines::cells::{Point3, Scene, SceneObject};
use sightlines::formats::scene::{BackFaces, parse_glb, write_glb};
use sightlines::formats::{SceneInfo, ViewCell, ViewCells};
use sightlines::geometry::Aabb;
use sightlines::pvs::{CellId, ObjectId};
use sightlines::scenes::{CityOptions, TowerOptions};
use sightlines_benches::measure::{CpuClock, Work};
use sightlines_benches::program::{Common, exit};
use sightlines_benches::targets::Targets;
use sightlines_benches::viewed::{ViewedScene, evenly};
use sightlines_testkit::{Random, RayScene};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

/// Turned, scaled and moved scenes against rays, and against the scenes as they were.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Real scenes, and for each the file of its cells.
    #[arg(long, value_delimiter = ',', default_values_t = [
        "delft:cells_street", "sponza:cells_walk", "pandora:cells_walk", "duplex:cells_rooms", "office_a:cells_rooms", "castle:cells_walk",
    ].map(str::to_owned))]
    scenes: Vec<String>,
    /// Only changes whose name contains one of these.
    #[arg(long, value_delimiter = ',')]
    changes: Vec<String>,
    /// No generated scenes.
    #[arg(long)]
    real: bool,
    /// Cells of each scene.
    #[arg(long, default_value_t = 6)]
    cells: usize,
    /// Rays of each cell and change, half of them anywhere and half towards what the table hides.
    #[arg(long, default_value_t = 20_000)]
    rays: u64,
    /// What engines do with the backs of single-sided faces of real scenes.
    #[arg(long, default_value = BackFaces::Either.name())]
    backs: BackFaces,
    /// What decides.
    #[arg(long, default_value_t = SceneMethod::Auto)]
    method: SceneMethod,
    /// Number of threads; 0 for one for each core.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Tables that hide all that touches no cell: that this bench can fail.
    #[arg(skip)]
    impostor: bool,
}

/// A scene, where it is looked from, and what is known to be seen from there.
struct Case {
    name: String,
    scene: Scene,
    cells: Vec<ViewCell>,
    /// For each cell objects whose fronts an independent program reached by robust lines.
    seen: Vec<Vec<u32>>,
}

/// What an independent program reached from the cells of a file, by the name of the cell: the most thorough of the files beside a scene.
fn read_seen(folder: &Path, cells: &str) -> BTreeMap<String, Vec<u32>> {
    for name in ["seen_dense.json", "seen_rooms.json", "seen_walk.json", "seen_street.json"] {
        let Ok(text) = std::fs::read(folder.join(name)) else { continue };
        let all: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
        if all["cells"] != format!("{cells}.json") {
            continue;
        }
        let ids = |list: &serde_json::Value| -> Vec<u32> {
            list.as_array().into_iter().flatten().filter_map(|id| id.as_u64()).map(|id| id as u32).collect()
        };
        let entry = |of: &serde_json::Value| Some((of["id"].as_str()?.to_owned(), ids(&of["objects"])));
        return all["seen"].as_array().into_iter().flatten().filter_map(entry).collect();
    }
    BTreeMap::new()
}

fn case(viewed: ViewedScene, n: usize, mut seen: BTreeMap<String, Vec<u32>>) -> Case {
    let ViewedScene { name, scene, mut cells, .. } = viewed;
    // Cells that were looked at closely are the ones to be judged by.
    if !seen.is_empty() {
        cells.retain(|cell| seen.contains_key(&cell.id));
    }
    let cells = evenly(cells, n);
    let seen = cells.iter().map(|cell| seen.remove(&cell.id).unwrap_or_default()).collect();
    Case { name, scene, cells, seen }
}

fn cases(args: &Args) -> Result<Vec<Case>, Box<dyn Error>> {
    let (blocks, n) = if args.common.test { (2, 2) } else { (6, args.cells) };
    let city = ViewedScene::city(CityOptions { blocks_x: blocks, blocks_z: blocks, ..CityOptions::default() })?;
    let tower = ViewedScene::tower(TowerOptions { floors: 1, ..TowerOptions::default() })?;
    let mut cases: Vec<Case> = [city, tower].map(|viewed| case(viewed, n, BTreeMap::new())).into();
    if args.real {
        cases.clear();
    }
    if !args.common.test {
        for named in &args.scenes {
            let Some(viewed) = ViewedScene::real(named, args.backs)? else { continue };
            let file = named.split_once(':').map_or("", |(_, cells)| cells);
            let seen = viewed.folder.as_ref().map(|folder| read_seen(folder, file)).unwrap_or_default();
            cases.push(case(viewed, n, seen));
        }
    }
    Ok(cases)
}

/// What is done to a scene: turned, then scaled, then moved.
#[derive(Debug, Clone)]
struct Change {
    name: String,
    rows: [Point3; 3],
    scale: f64,
    by: f64,
    /// Whether coordinates are rounded to single precision.
    is_single: bool,
}

const PLAIN: [Point3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Change {
    /// All changes; the first one changes nothing.
    fn all() -> Vec<Self> {
        let plain = |name: &str| Self { name: name.to_owned(), rows: PLAIN, scale: 1.0, by: 0.0, is_single: true };
        let mut all = vec![plain("as it stands")];
        for (axis, letter) in (0..3).zip(["x", "y", "z"]) {
            for degrees in [1e-6, 0.01, 17.0, 45.0, 90.0] {
                all.push(Self { rows: rotation(axis, degrees), ..plain(&format!("{degrees}° about {letter}")) });
            }
        }
        all.push(Self { scale: 1e-3, ..plain("times 0.001") });
        all.push(Self { scale: 1e3, ..plain("times 1000") });
        all.push(Self { by: 1e6, ..plain("moved by 1000000") });
        // What of a loss there is that of single precision.
        all.push(Self { by: 1e6, is_single: false, ..plain("moved by 1000000, in doubles") });
        all
    }

    /// Whether what is seen is what was seen: but for rounding, which a far move makes coarse.
    fn keeps_views(&self) -> bool {
        self.by == 0.0
    }

    fn point(&self, p: Point3) -> Point3 {
        self.rows.map(|row| (row[0] * p[0] + row[1] * p[1] + row[2] * p[2]) * self.scale + self.by)
    }

    /// As a file has it whose program computed in doubles and rounded to single precision once.
    fn scene(&self, scene: &Scene) -> Scene {
        let round = |p: &Point3| self.point(*p).map(|x| if self.is_single { f64::from(x as f32) } else { x });
        let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(round).collect(), ..o.clone() };
        Scene::new(scene.objects().iter().map(object).collect())
            .and_then(|changed| changed.with_see_through(scene.see_through().to_vec()))
            .and_then(|changed| changed.with_single_sided(scene.single_sided().to_vec()))
            .and_then(|changed| changed.with_front_occluders(scene.front_occluders().to_vec()))
            .expect("coordinates stay in range")
    }

    /// The cells, along axes that are rounded to single precision; and their places, as the file of cells gives them.
    fn cells(&self, cells: &[ViewCell]) -> ViewCells {
        let bounds = |b: &Aabb<3>| {
            let [min, max] = [b.min, b.max].map(|p| p.map(|x| x * self.scale + self.by));
            Aabb { min, max }
        };
        let moved = cells.iter().map(|cell| ViewCell { id: cell.id.clone(), bounds: bounds(&cell.bounds) }).collect();
        let axes = [0, 1, 2].map(|k| self.rows.map(|row| f64::from(row[k] as f32)));
        ViewCells { cells: moved, axes: (self.rows != PLAIN).then_some(axes) }
    }
}

/// About an axis of the scene.
fn rotation(axis: usize, degrees: f64) -> [Point3; 3] {
    let (s, c) = if degrees == 90.0 { (1.0, 0.0) } else { degrees.to_radians().sin_cos() };
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut rows = PLAIN;
    (rows[i][i], rows[i][j], rows[j][i], rows[j][j]) = (c, -s, s, c);
    rows
}

/// What files of single precision state.
fn info() -> SceneInfo {
    let corner = SceneObject {
        name: "corner".to_owned(),
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
    };
    let scene = Scene::new(vec![corner]).expect("a scene");
    parse_glb(&write_glb(&scene).expect("in single precision"), None).expect("a scene").info
}

/// A point of a cell in the scene.
fn place(cells: &ViewCells, cell: usize, random: &mut Random) -> Point3 {
    let p = random.point(&cells.cells[cell].bounds);
    let axes = cells.axes.unwrap_or(PLAIN);
    std::array::from_fn(|k| axes[0][k] * p[0] + axes[1][k] * p[1] + axes[2][k] * p[2])
}

/// What rays from a cell were seen to reach: robustly, and by any line.
fn reached(
    rays: &RayScene,
    targets: &Targets<'_>,
    cells: &ViewCells,
    cell: usize,
    hidden: &[u32],
    n: u64,
) -> [BTreeSet<u32>; 2] {
    let mut found: [BTreeSet<u32>; 2] = Default::default();
    for ray in 0..n {
        let mut random = Random::new(7 + cell as u64, ray);
        let eye = place(cells, cell, &mut random);
        let aim = if ray % 2 == 1 && !hidden.is_empty() {
            targets.on(hidden[random.below(hidden.len())], &mut random)
        } else {
            None
        };
        let way = aim.map_or_else(|| random.direction(), |at| std::array::from_fn(|k| at[k] - eye[k]));
        // Whoever is in matter sees nothing that matters.
        let Some(line) = rays.clear_line(eye, way) else { continue };
        found[0].extend(line.ends.iter().flatten());
        let ends = [1.0, -1.0].map(|sign| rays.first_hit(eye, way.map(|x| sign * x)));
        found[1].extend(ends.iter().flatten().filter(|hit| hit.front_facing).map(|hit| hit.object));
    }
    found
}

/// A row of the table.
struct Row {
    pairs: usize,
    seconds: f64,
    gap: f64,
    /// What an independent program reached in the given scene, and what of that is hidden.
    known: usize,
    missing_known: usize,
    /// What rays reached robustly in the changed scene, and what of that is hidden; and what is hidden that only rays
    /// reached which a small shift loses, through cracks and past edges.
    reached: usize,
    missing: [usize; 2],
}

fn row(case: &Case, change: &Change, args: &Args, info: &SceneInfo) -> Result<Row, Box<dyn Error>> {
    let (scene, cells) = (change.scene(&case.scene), change.cells(&case.cells));
    let request = BakeRequest {
        method: Some(args.method),
        cells: Some(CellsFrom::Boxes(cells.clone())),
        ..BakeRequest::default()
    };
    let runtime = Runtime { threads: args.threads, ..Runtime::default() };
    let clock = CpuClock::start(Work::Process);
    let Baked { table, .. } = runtime.bake(BakeInput::Scene(&scene, Some(info)), &request)?;
    let seconds = clock.elapsed().as_secs_f64();
    let (rays, targets) = (RayScene::new(&scene), Targets::new(&scene));
    let gap = table.frame().map_or(0.0, |frame| frame.gap());
    let mut row = Row { pairs: 0, seconds, gap, known: 0, missing_known: 0, reached: 0, missing: [0; 2] };
    for cell in 0..cells.cells.len() {
        let id = CellId(cell as u32);
        let shown: BTreeSet<u32> = if args.impostor {
            table.objects_of(id).iter().map(|o| o.0).collect()
        } else {
            table.visible_objects(id).iter().map(|o: &ObjectId| o.0).collect()
        };
        let hidden: Vec<u32> = (0..scene.objects().len() as u32).filter(|o| !shown.contains(o)).collect();
        row.pairs += shown.len();
        let n_hidden = |of: &mut dyn Iterator<Item = &u32>| of.filter(|o| !shown.contains(o)).count();
        row.known += case.seen[cell].len();
        row.missing_known += n_hidden(&mut case.seen[cell].iter());
        let [robust, any] = reached(&rays, &targets, &cells, cell, &hidden, args.rays);
        row.reached += robust.len();
        row.missing[0] += n_hidden(&mut robust.iter());
        row.missing[1] += n_hidden(&mut any.difference(&robust));
    }
    Ok(row)
}

/// Prints the table; the number of pairs that are called hidden wrongly.
fn table(args: &Args) -> Result<usize, Box<dyn Error>> {
    let info = info();
    println!(
        "| scene | change | gap | pairs | of those as it stands | s | time | known | of them hidden | reached | of them hidden | hidden, and reached by thin lines alone |"
    );
    println!("| --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    let is_wanted =
        |change: &&Change| args.changes.is_empty() || args.changes.iter().any(|part| change.name.contains(part));
    let mut n_wrong = 0;
    for case in cases(args)? {
        let mut first: Option<(usize, f64)> = None;
        let all = Change::all();
        for change in all.iter().take(1).chain(all[1..].iter().filter(is_wanted)) {
            let found = row(&case, change, args, &info)?;
            let (pairs, seconds) = *first.get_or_insert((found.pairs, found.seconds));
            let wrong = found.missing[0] + if change.keeps_views() { found.missing_known } else { 0 };
            n_wrong += wrong;
            println!(
                "| {} | {} | {:.1e} | {} | {:.3} | {:.2} | {:.2} | {} | {} | {} | {} | {} |",
                case.name,
                change.name,
                found.gap,
                found.pairs,
                found.pairs as f64 / pairs.max(1) as f64,
                found.seconds,
                found.seconds / seconds.max(0.01),
                found.known,
                found.missing_known,
                found.reached,
                found.missing[0],
                found.missing[1],
            );
        }
    }
    Ok(n_wrong)
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("turned") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        args = Args {
            rays: 2000,
            changes: ["0.01° about x", "17° about y", "times", "moved"].map(str::to_owned).to_vec(),
            ..args
        };
    }
    let impostor = Args { impostor: true, changes: vec!["none".to_owned()], ..args.clone() };
    match table(&args).and_then(|n| Ok((n, args.common.test && table(&impostor)? == 0))) {
        Ok((0, false)) => ExitCode::SUCCESS,
        Ok((0, true)) => {
            eprintln!("tables that hide nearly everything are not noticed");
            ExitCode::FAILURE
        }
        Ok((n, _)) => {
            eprintln!("{n} objects that rays reach are called hidden");
            ExitCode::FAILURE
        }
        Err(error) => exit(Err(error)),
    }
}
