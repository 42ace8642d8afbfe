//! Stab trees beside the table: how many sequences there are, what they take written out and what they take shared,
//! and how much of a table's rows they reach within a budget.

use clap::Parser;
use sightlines::bake::{
    GraphRef, PlanBakeOptions, PrtOptions, SceneBakeOptions, StabOptions, bake_plan, bake_prt, bake_scene, from_table,
    with_stab_trees,
};
use sightlines::cells::Plan;
use sightlines::formats::Wad;
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::geojson::read_plan;
use sightlines::formats::quake::{Prt, read_prt};
use sightlines::pvs::{CellId, StabTrees, Table};
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, office};
use sightlines_benches::program::{Common, exit, save};
use sightlines_benches::spec::SceneSpec;
use sightlines_tests::data_folder;
use sightlines_tests::world_files::prt_of_world;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Bytes of a node of a plain tree: cell, portal and parent.
const PLAIN: u64 = 12;

/// Stab trees: sequences and bytes.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// What to measure: office, a file (WAD, GeoJSON, GLB, glTF, OBJ, PRT), tower:16, level:2:2:1 (rooms along x and y, floors); may
    /// be given more than once. Without it: a choice of each, from $SIGHTLINES_DATA where it is set.
    #[arg(long = "scene", value_name = "SCENE")]
    scenes: Vec<String>,
    /// Nodes that the tree of one cell may have; 0 for what `build --stab-trees` takes.
    #[arg(long, value_delimiter = ',', default_values_t = [0])]
    nodes: Vec<usize>,
    /// Threads; 0 for one for each core.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Writes what was measured.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Writes the table for people.
    #[arg(long)]
    md: Option<PathBuf>,
}

/// What was measured of a scene with a budget.
#[derive(Debug, Clone)]
struct Row {
    scene: String,
    kind: &'static str,
    cells: usize,
    portals: usize,
    /// Of the table without trees.
    table_bytes: usize,
    max_nodes: usize,
    sequences: u64,
    /// Nodes of the shared graph.
    nodes: usize,
    edges: u64,
    /// What the table grows by.
    tree_bytes: usize,
    cut_cells: u64,
    open: u64,
    undecided: u64,
    largest: u64,
    /// Share of the pairs in rows that a sequence of the trees leads to.
    reached: f64,
    seconds: f64,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("pvs/stab_trees") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        args.scenes = ["office", "tower:1:2:1:0", "level:2:1:1"].map(str::to_owned).to_vec();
        args.nodes = vec![40, 2_000];
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let scenes = if args.scenes.is_empty() { choice() } else { args.scenes.clone() };
    let mut rows = Vec::new();
    for scene in &scenes {
        let table = load(scene, args.threads).map_err(|e| format!("{scene}: {e}"))?;
        for &nodes in &args.nodes {
            let row = measure(scene, &table, nodes, args.threads)?;
            eprintln!("{scene}: {} sequences, {:.2} s", row.sequences, row.seconds);
            rows.push(row);
        }
    }
    if args.common.test {
        check(&rows);
    }
    for (path, text) in [(&args.csv, csv(&rows)), (&args.md, markdown(&rows))] {
        save(path.as_deref(), || text)?;
    }
    println!("{}", markdown(&rows));
    Ok(())
}

/// The default scenes.
fn choice() -> Vec<String> {
    let generated = ["office", "tower:1", "tower:4"].map(str::to_owned);
    let files = [
        "plans/bimwhale_tallbuilding_1.geojson",
        "doom/freedoom1_E1M1.wad",
        "doom/freedm_MAP01.wad",
        "scenes/whale_large/whale_large.glb",
        "quake/dm3.prt",
        "quake/e1m1.prt",
    ];
    let Some(data) = data_folder("SIGHTLINES_DATA") else {
        return generated.into_iter().chain(["level:3:3:2".to_owned()]).collect();
    };
    generated.into_iter().chain(files.map(|file| data.join(file).display().to_string())).collect()
}

/// The table of a scene.
fn load(scene: &str, threads: usize) -> Result<Table, Box<dyn Error>> {
    if scene == "office" {
        return plan_table(&office(OfficeOptions::default())?, threads);
    }
    if let Some(numbers) = scene.strip_prefix("level:") {
        let numbers: Vec<u32> = numbers.split(':').map(str::parse).collect::<Result<_, _>>()?;
        let &[rooms_x, rooms_y, floors] = &numbers[..] else { return Err("a level is level:X:Y:FLOORS".into()) };
        return prt_table(&prt_of_world(&quake_like(QuakeLikeOptions { seed: 1, rooms_x, rooms_y, floors })?));
    }
    let path = Path::new(scene);
    match path.extension().and_then(|e| e.to_str()).unwrap_or_default() {
        "wad" => {
            let wad = Wad::read(path)?;
            let maps = list_maps(&wad);
            let map = DoomMap::parse(&wad, maps.first().ok_or("no map")?)?;
            plan_table(&map.plan()?, threads)
        }
        "geojson" => plan_table(&read_plan(path)?, threads),
        "prt" => prt_table(&read_prt(path)?),
        _ => {
            let scene = scene.parse::<SceneSpec>()?.load()?;
            Ok(bake_scene(&scene, &SceneBakeOptions { threads, ..SceneBakeOptions::default() })?.table)
        }
    }
}

fn plan_table(plan: &Plan, threads: usize) -> Result<Table, Box<dyn Error>> {
    Ok(bake_plan(plan, &PlanBakeOptions { threads, ..PlanBakeOptions::default() })?.table)
}

fn prt_table(prt: &Prt) -> Result<Table, Box<dyn Error>> {
    Ok(bake_prt(prt, PrtOptions::default())?.table)
}

fn measure(scene: &str, table: &Table, nodes: usize, threads: usize) -> Result<Row, Box<dyn Error>> {
    let graph = from_table::graph(table).ok_or("a table without portals")?;
    let max_nodes = match nodes {
        0 => GraphRef::from(&graph).most_nodes().ok_or("a table without portals")?,
        nodes => nodes,
    };
    let table_bytes = table.to_bytes().len();
    let options = StabOptions { max_nodes: Some(max_nodes), threads, ..StabOptions::default() };
    let baked = with_stab_trees(table.clone(), &graph, &options)?;
    let trees = baked.table.stab().ok_or("the trees were not kept")?;
    let bytes = baked.table.to_bytes();
    assert!(Table::from_bytes(&bytes)? == baked.table, "{scene}: what was written is read back");
    assert_eq!(trees.n_sequences(), u128::from(baked.report.trees.n_sequences), "{scene}: sharing changes no sequence");
    let (found, all) = reached(scene, &baked.table, trees);
    let kind = match table.dimension() {
        2 => "plane",
        _ if table.kind().is_quake() => "convex",
        _ => "boxes",
    };
    Ok(Row {
        scene: Path::new(scene).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        kind,
        cells: table.n_cells(),
        portals: table.portals().len(),
        table_bytes,
        max_nodes,
        sequences: baked.report.trees.n_sequences,
        nodes: trees.n_nodes(),
        edges: trees.n_edges(),
        tree_bytes: bytes.len() - table_bytes,
        cut_cells: baked.report.trees.n_cut_cells,
        open: baked.report.trees.n_open,
        undecided: baked.report.trees.n_undecided,
        largest: baked.report.trees.n_largest,
        reached: found as f64 / all.max(1) as f64,
        seconds: Duration::as_secs_f64(&baked.report.time),
    })
}

/// Pairs of a cell and another that its tree leads to, and pairs in rows. Checks that trees lead nowhere else, and
/// in the plane that whole ones lead everywhere.
fn reached(scene: &str, table: &Table, trees: &StabTrees) -> (u64, u64) {
    let (mut found, mut all) = (0, 0);
    let mut met_node = vec![u32::MAX; trees.n_nodes()];
    let mut met_cell = vec![u32::MAX; table.n_cells()];
    for cell in (0..table.n_cells() as u32).map(CellId) {
        met_cell[cell.idx()] = cell.0;
        let (mut is_cut, mut n) = (trees.is_root_open(cell), 1);
        let mut waiting = trees.roots(cell).to_vec();
        while let Some(node) = waiting.pop() {
            if std::mem::replace(&mut met_node[node as usize], cell.0) == cell.0 {
                continue;
            }
            is_cut |= trees.is_open(node);
            waiting.extend_from_slice(trees.children(node));
            let (portal, forward) = trees.gate(node);
            let to = table.portals()[portal.idx()].cells[usize::from(forward)];
            assert!(table.sees(cell, to), "{scene}: the tree of cell {cell} leads to cell {to}, which it does not see");
            n += u64::from(std::mem::replace(&mut met_cell[to.idx()], cell.0) != cell.0);
        }
        let seen = table.visible(cell).count() as u64;
        if table.dimension() == 2 && !is_cut {
            assert_eq!(n, seen, "{scene}: the tree of cell {cell} leads to all that it sees");
        }
        (found, all) = (found + n, all + seen);
    }
    (found, all)
}

/// What must hold of small scenes, whatever the machine.
fn check(rows: &[Row]) {
    assert_eq!(rows.len(), 6, "every scene was measured with every budget");
    for pair in rows.chunks(2) {
        let [small, large] = pair else { unreachable!("two budgets") };
        assert!(small.sequences < large.sequences && small.cut_cells > large.cut_cells, "{small:?} {large:?}");
        assert!(small.reached < large.reached && large.reached > 0.9, "{small:?} {large:?}");
        assert!(large.nodes as u64 * 2 < large.sequences, "equal trees are found: {large:?}");
        assert!(large.tree_bytes as u64 * 4 < large.sequences * PLAIN, "shared trees are small: {large:?}");
        assert!(large.largest <= large.max_nodes as u64, "{large:?}");
    }
    assert_eq!(
        rows.iter().map(|r| r.kind).collect::<Vec<_>>(),
        ["plane", "plane", "boxes", "boxes", "convex", "convex"]
    );
}

fn csv(rows: &[Row]) -> String {
    let mut out =
        "scene,kind,cells,portals,table_bytes,max_nodes,sequences,plain_bytes,nodes,edges,tree_bytes,cut_cells,open,\
                   undecided,largest,reached,seconds\n"
            .to_owned();
    for r in rows {
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            r.scene,
            r.kind,
            r.cells,
            r.portals,
            r.table_bytes,
            r.max_nodes,
            r.sequences,
            PLAIN * r.sequences,
            r.nodes,
            r.edges,
            r.tree_bytes,
            r.cut_cells,
            r.open,
            r.undecided,
            r.largest,
            r.reached,
            r.seconds
        );
    }
    out
}

fn markdown(rows: &[Row]) -> String {
    let mut out = String::from(INTRODUCTION);
    for r in rows {
        let plain = PLAIN * r.sequences;
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        let percent = |a: f64, b: f64| 100.0 * ratio(a, b);
        let [bytes, sequences] = [r.tree_bytes as f64, r.sequences as f64];
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.3} | {:.1} | {:.2} | {:.1} % | {:.1} % | {:.1} % | {:.2} |",
            r.scene,
            r.kind,
            r.cells,
            r.max_nodes,
            r.sequences,
            plain,
            r.nodes,
            r.edges,
            r.tree_bytes,
            ratio(bytes, sequences),
            ratio(plain as f64, bytes),
            ratio(bytes, r.table_bytes as f64),
            percent(r.cut_cells as f64, r.cells as f64),
            percent(r.open as f64, sequences),
            100.0 * r.reached,
            r.seconds
        );
    }
    out
}

const INTRODUCTION: &str = "# Stab trees beside the table

The stab tree of a cell lists the sequences of portals out of it that a sightline passes. *Plain* is what they take as trees
of 12 bytes a node (cell, portal, parent). *Nodes* and *edges* are of the graph in which equal trees, of one cell or
of several, are kept once; *bytes* is what the table grows by, *smaller* how many times that goes into plain, and *of the table*
how many times the table without trees goes into it. A tree has at most *budget* nodes and is cut breadth first: *cut* are the cells
whose tree was, *open* the sequences at which it was, beyond which anything may follow. *Reached* is the share of the
pairs of cells in rows that some sequence leads to: what is left are pairs that only sequences beyond the cut join.
Times are of one run on a machine with two cores that other work kept busy. All columns: [stab_trees.csv](stab_trees.csv). Made by
`cargo bench -p sightlines-benches --bench stab_trees -- --nodes 256,0 --md $PWD/docs/charts/stab_trees.md --csv $PWD/docs/charts/stab_trees.csv`.

| scene | kind | cells | budget | sequences | plain, bytes | nodes | edges | bytes | bytes a sequence | smaller | of the table | cut | open | reached | seconds |
| --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |
";
