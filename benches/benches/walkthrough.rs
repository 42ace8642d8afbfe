//! A walk through a furnished tower with a z-buffer: what a frame costs with all triangles and with those
//! that the table shows from the eye's cells, the same with what is outside the view left out, and with what each
//! eye-to-cell method leaves.
//!
//! All pictures of a frame must be the same, pixel by pixel: the table and the methods err towards visible. Ends with 1
//! if one differs.

use clap::Parser;
use sightlines::bake::{PortalMode, SceneBakeOptions, bake_scene};
use sightlines::cells::{CellId, Scene};
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, VisibleSet, VisibleSubgraph};
use sightlines::geometry::Aabb;
use sightlines::kdtree::SceneOptions;
use sightlines::pvs::{ObjectId, Table};
use sightlines::scenes::{TowerOptions, tower};
use sightlines_benches::child::portals_of;
use sightlines_benches::path::{CameraPose, walk};
use sightlines_benches::program::{Common, save};
use sightlines_benches::raster::{Camera, Drawn, Picture};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The ways in which each frame is drawn.
const WAYS: [&str; N_WAYS] = [
    "all",
    "table",
    "all, by view",
    "table, by view",
    "disjoint cell",
    "connected component",
    "incident portals",
    "exact",
];
const N_WAYS: usize = 8;
/// The methods of the ways behind the fourth; these leave out by box what is outside the view as well.
const METHODS: [Method; 4] = [Method::DisjointCell, Method::ConnectedComponent, Method::IncidentPortals, Method::Exact];

/// A walkthrough with and without the table.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Floors of the tower.
    #[arg(long, default_value_t = 16)]
    floors: u32,
    /// Frames of the walk.
    #[arg(long, default_value_t = 300)]
    frames: usize,
    /// Width and height of pictures.
    #[arg(long, value_delimiter = ',', num_args = 1, default_values_t = [640, 480])]
    size: Vec<usize>,
    /// Obscuration threshold.
    #[arg(long, default_value_t = 0.0)]
    tau: f64,
    /// Portal mode: bounding, exact.
    #[arg(long, default_value = "exact", value_parser = portals_of)]
    portals: PortalMode,
    /// Reads the table from this file if it exists, or else bakes it and writes it there. It must be one of
    /// the same tower.
    #[arg(long)]
    table: Option<PathBuf>,
    /// Writes the times of each frame.
    #[arg(long)]
    csv: Option<PathBuf>,
}

/// One way of drawing one frame.
#[derive(Debug, Clone, Copy, Default)]
struct Frame {
    time: Duration,
    drawn: Drawn,
    /// Pixels that are not as with all triangles.
    n_wrong: usize,
}

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("bake/walkthrough") {
        return ExitCode::SUCCESS;
    }
    match run(&args) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(n_wrong) => {
            eprintln!("{n_wrong} pixels differ");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// Returns how many pixels differ.
fn run(args: &Args) -> Result<usize, Box<dyn Error>> {
    let mut options = TowerOptions { floors: args.floors, ..TowerOptions::default() };
    let (mut n_frames, mut size) = (args.frames, args.size.clone());
    if args.common.test {
        options = TowerOptions { floors: 2, rooms_x: 2, rooms_y: 2, ..options };
        (n_frames, size) = (40, vec![96, 72]);
    }
    let &[width, height] = &size[..] else { return Err("--size takes two numbers".into()) };
    let scene = tower(options)?;
    let table = table(args, &scene)?;
    let poses = walk(&scene, options, n_frames)?;
    let mut show = Show::new(&scene, &table, [width, height]);
    let frames: Vec<[Frame; N_WAYS]> = poses.iter().map(|pose| show.frame(pose)).collect();
    for (k, frame) in frames.iter().enumerate() {
        for (way, f) in WAYS.iter().zip(frame).filter(|(_, f)| f.n_wrong > 0) {
            eprintln!("WRONG frame {k}, {way}: {} pixels differ, at {:?}", f.n_wrong, poses[k]);
        }
    }
    save(args.csv.as_deref(), || csv(&frames))?;
    report(&scene, &frames, [width, height]);
    if args.common.test {
        check(&scene, &table, &poses, &frames);
    }
    Ok(frames.iter().flatten().map(|f| f.n_wrong).sum())
}

fn table(args: &Args, scene: &Scene) -> Result<Table, Box<dyn Error>> {
    if let Some(path) = args.table.as_ref().filter(|p| p.is_file()) {
        let table = Table::from_bytes(&std::fs::read(path)?).map_err(|e| format!("{}: {e}", path.display()))?;
        let same = table.objects().iter().map(|o| &o.name).eq(scene.objects().iter().map(|o| &o.name));
        return if same { Ok(table) } else { Err(format!("{}: not of this tower", path.display()).into()) };
    }
    let cut = SceneOptions { tau: args.tau, ..SceneOptions::default() };
    let baked = bake_scene(scene, &SceneBakeOptions { cut, portals: args.portals, ..SceneBakeOptions::default() })?;
    if let Some(path) = &args.table {
        std::fs::write(path, baked.table.to_bytes()).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(baked.table)
}

/// What is shown, and two pictures to compare.
struct Show<'a> {
    scene: &'a Scene,
    table: &'a Table,
    first: Vec<u32>,
    boxes: Vec<Aabb<3>>,
    whole: Picture,
    other: Picture,
    cells: TableCells<&'a Table>,
    /// Of the cells that were visited; made before the time is taken, as a run-time would.
    subgraphs: BTreeMap<CellId, VisibleSubgraph>,
    scratch: Scratch,
    seen: VisibleSet,
}

impl<'a> Show<'a> {
    fn new(scene: &'a Scene, table: &'a Table, [width, height]: [usize; 2]) -> Self {
        let mut next = 0;
        let count = |o: &sightlines::cells::SceneObject| {
            let first = next;
            next += o.triangles.len() as u32;
            first
        };
        let first = scene.objects().iter().map(count).collect();
        let boxes = scene.objects().iter().map(|o| o.bounds()).collect();
        let picture = Picture::new(width, height);
        Self {
            scene,
            table,
            first,
            boxes,
            whole: picture.clone(),
            other: picture,
            cells: TableCells::new(table),
            subgraphs: BTreeMap::new(),
            scratch: Scratch::new(),
            seen: VisibleSet::new(),
        }
    }

    /// Draws one frame in every way. Lookups in the table count towards the time.
    fn frame(&mut self, pose: &CameraPose) -> [Frame; N_WAYS] {
        let camera = Camera::new(pose.eye, pose.ahead);
        let n = self.scene.objects().len() as u32;
        for cell in self.table.in_dimension().expect("it is of space").at(pose.eye).cells().iter().copied() {
            let prepare = || VisibleSubgraph::prepare(&self.cells, cell).unwrap_or_else(|never| match never {});
            self.subgraphs.entry(cell).or_insert_with(prepare);
        }
        let view = camera.view(self.whole.aspect());
        std::array::from_fn(|way| {
            let boxes = (way >= 2).then_some(&self.boxes[..]);
            let picture = if way == 0 { &mut self.whole } else { &mut self.other };
            let start = Instant::now();
            let drawn = if let Some(method) = way.checked_sub(4).map(|k| METHODS[k]) {
                self.seen.clear(self.table.n_cells(), n as usize);
                for cell in self.table.in_dimension().expect("it is of space").at(pose.eye).cells() {
                    let subgraph = &self.subgraphs[cell];
                    method.look(subgraph, &view, &Doors::all_open(), &mut self.scratch, &mut self.seen);
                }
                self.seen.sort();
                picture.draw(self.scene, &self.first, self.seen.objects().iter().map(|o| o.0), boxes, &camera)
            } else if way % 2 == 0 {
                picture.draw(self.scene, &self.first, 0..n, boxes, &camera)
            } else {
                let objects = self
                    .table
                    .in_dimension()
                    .expect("it is of space")
                    .at(pose.eye)
                    .inside()
                    .map_or(Vec::new(), |at| at.visible_objects().iter().map(|o| o.0).collect::<Vec<_>>());
                picture.draw(self.scene, &self.first, objects, boxes, &camera)
            };
            let time = start.elapsed();
            let differ = |pair: &(&u32, &u32)| pair.0 != pair.1;
            let n_wrong =
                if way == 0 { 0 } else { self.whole.faces.iter().zip(&self.other.faces).filter(differ).count() };
            Frame { time, drawn, n_wrong }
        })
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

fn csv(frames: &[[Frame; N_WAYS]]) -> String {
    let short = ["all", "table", "all_view", "table_view", "disjoint", "component", "incident", "exact"];
    let times = short.map(|way| format!("{way}_ms")).join(",");
    let mut text = format!("frame,{times},{}\n", short.join(","));
    for (k, frame) in frames.iter().enumerate() {
        let times = frame.map(|f| format!("{:.4}", milliseconds(f.time))).join(",");
        let drawn = frame.map(|f| f.drawn.n_triangles.to_string()).join(",");
        text += &format!("{k},{times},{drawn}\n");
    }
    text
}

fn report(scene: &Scene, frames: &[[Frame; N_WAYS]], [width, height]: [usize; 2]) {
    let n = frames.len().max(1) as f64;
    let mean = |way: usize, of: &dyn Fn(&Frame) -> f64| frames.iter().map(|f| of(&f[way])).sum::<f64>() / n;
    let ms = |way: usize| mean(way, &|f| milliseconds(f.time));
    let triangles = |way: usize| mean(way, &|f| f.drawn.n_triangles as f64);
    let all = scene.n_triangles();
    println!("bake/walkthrough: {} frames of {width} x {height}, {all} triangles", frames.len());
    println!("| drawn | mean, ms | median, ms | worst, ms | triangles | of all | faster than all |");
    println!("| --- | --: | --: | --: | --: | --: | --: |");
    for (way, name) in WAYS.iter().enumerate() {
        let mut times: Vec<f64> = frames.iter().map(|f| milliseconds(f[way].time)).collect();
        times.sort_unstable_by(f64::total_cmp);
        let at = |k: usize| times.get(k).copied().unwrap_or(0.0);
        println!(
            "| {name} | {:.2} | {:.2} | {:.2} | {:.0} | {:.2} % | {:.1} |",
            ms(way),
            at(times.len() / 2),
            at(times.len().saturating_sub(1)),
            triangles(way),
            100.0 * triangles(way) / all as f64,
            ms(0) / ms(way),
        );
    }
    println!("with what is outside the view left out, the table makes frames {:.1} times faster", ms(2) / ms(3));
    let n_wrong: usize = frames.iter().flatten().map(|f| f.n_wrong).sum();
    let n_same = frames.iter().filter(|f| f.iter().all(|f| f.n_wrong == 0)).count();
    println!("pictures are the same in {n_same} of {} frames; {n_wrong} pixels differ", frames.len());
}

/// Pictures are alike, less is drawn, and a table that lacks something is found out.
fn check(scene: &Scene, table: &Table, poses: &[CameraPose], frames: &[[Frame; N_WAYS]]) {
    assert!(frames.len() >= 30 && frames.iter().flatten().all(|f| f.n_wrong == 0), "the pictures are the same");
    let drawn = |way: usize| frames.iter().map(|f| f[way].drawn.n_triangles).sum::<u64>();
    assert!(drawn(1) < drawn(0) && drawn(2) < drawn(0) && drawn(3) < drawn(1).min(drawn(2)), "less is drawn");
    assert!((3..N_WAYS - 1).all(|way| drawn(way + 1) <= drawn(way)) && drawn(N_WAYS - 1) < drawn(3), "still less");
    let mut parts = table.clone().into_parts();
    let seen = parts.objects_seen.as_mut().expect("tables of scenes say which objects are seen");
    for (cell, own) in parts.cell_objects.iter().enumerate() {
        (0..parts.objects.len()).filter(|o| !own.contains(&ObjectId(*o as u32))).for_each(|o| seen.set(cell, o, false));
    }
    let spoilt = Table::new(parts).unwrap_or_else(|e| panic!("{e}"));
    let mut show = Show::new(scene, &spoilt, [96, 72]);
    let n_wrong: usize = poses.iter().map(|pose| show.frame(pose)[1].n_wrong).sum();
    assert!(n_wrong > 0, "a table without what is seen from afar makes other pictures");
}
