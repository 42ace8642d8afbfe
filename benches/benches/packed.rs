//! Tables as small files: bytes against time to read a row against over-estimation.
//!
//! For each table: what its rows take in several codings, and how long one row takes when its block has to be
//! unpacked and when it is there; what is seen too much when the rows have to fit a share of that. Then a file of
//! more than 100 MB, and how long it takes to open it and ask the first question.

use clap::Parser;
use sightlines::bake::{PlanBakeOptions, PrtOptions, SceneBakeOptions, bake_plan, bake_prt, bake_scene};
use sightlines::formats::Wad;
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::quake::read_prt;
use sightlines::formats::scene::read_scene;
use sightlines::kdtree::SceneOptions;
use sightlines::pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, PlaceBuffer, PortalRecord, Table, TableKind, TableParts,
};
use sightlines::scenes;
use sightlines_benches::codings::{CodedRows, RowCoding, unpack_runs, zero_runs};
use sightlines_benches::program::{Common, exit, save};
use sightlines_benches::spec::SceneSpec;
use sightlines_packed::{Distinct, PackError, PackOptions, Packed, pack_report};
use sightlines_testkit::mutate::SplitMix;
use sightlines_tests::{data_folder, files};
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Shares of the exact rows that lossy tables may take, per cent.
const BUDGETS: [u64; 3] = [75, 50, 25];

/// Codings of tables: bytes, time, over-estimation.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Tables to measure too.
    #[arg(long = "table")]
    tables: Vec<PathBuf>,
    /// Measures nothing else.
    #[arg(long, requires = "tables")]
    only: bool,
    /// Cells of the large file; 0 for none.
    #[arg(long, default_value_t = 40_000)]
    large: u32,
    /// Rows that are read of each table.
    #[arg(long, default_value_t = 2000)]
    rows: usize,
    /// Writes what was measured.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Writes tables as Markdown.
    #[arg(long)]
    md: Option<PathBuf>,
}

/// What was measured of a coding of a table.
struct Row {
    table: String,
    cells: usize,
    coding: String,
    bytes: u64,
    /// Bytes of one bit for each pair.
    dense: u64,
    /// Nanoseconds for a row whose block has to be unpacked, and for one whose block is there.
    cold: Option<f64>,
    warm: Option<f64>,
    /// Cells seen over cells seen in the exact table, on average; the same of objects; `None`: cannot be had.
    seen: Option<[f64; 2]>,
    /// Seconds to pack.
    pack: f64,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("packed") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.large, args.rows) = (2000, 50);
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let mut rows = Vec::new();
    for (name, table) in tables(args)? {
        eprintln!("{name}: {} cells", table.n_cells());
        codings(args, &name, &table, &mut rows)?;
        budgets(args, &name, &table, &mut rows)?;
    }
    let large = if args.large > 0 { large(args)? } else { String::new() };
    let text = markdown(&rows) + &large;
    println!("{text}");
    for (path, text) in [(&args.csv, csv(&rows)), (&args.md, text)] {
        save(path.as_deref(), || text)?;
    }
    Ok(())
}

type Named = (String, Table);

/// The requested tables: given ones, and real ones, or generated ones without the data.
fn tables(args: &Args) -> Result<Vec<Named>, Box<dyn Error>> {
    let mut tables = Vec::new();
    for path in &args.tables {
        let table = Table::from_bytes(&std::fs::read(path)?).map_err(|e| format!("{}: {e}", path.display()))?;
        tables.push((path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), table));
    }
    if args.only {
        return Ok(tables);
    }
    let scene = |scene: &sightlines::cells::Scene, tau| {
        let cut = SceneOptions { tau, ..SceneOptions::default() };
        bake_scene(scene, &SceneBakeOptions { cut, ..SceneBakeOptions::default() }).map(|baked| baked.table)
    };
    let tower = |name: &str| -> Result<Named, Box<dyn Error>> {
        Ok((name.to_owned(), scene(&name.parse::<SceneSpec>()?.load()?, 0.0)?))
    };
    let data = if args.common.test { None } else { data_folder("SIGHTLINES_DATA") };
    let Some(data) = data else {
        let size = if args.common.test { 2 } else { 12 };
        let plan = bake_plan(&scenes::doom_like(1, size)?, &PlanBakeOptions::default())?;
        tables.push((format!("doom-like:{size}"), plan.table));
        tables.push(tower(if args.common.test { "tower:1:2:1:1" } else { "tower:2" })?);
        return Ok(tables);
    };
    for name in ["freedm_MAP05", "freedoom1_E1M6"] {
        let wad = Wad::read(data.join("doom").join(name).with_extension("wad"))?;
        let lumps = list_maps(&wad).into_iter().next().ok_or("a WAD without maps")?;
        let plan = DoomMap::parse(&wad, &lumps)?.plan()?;
        tables.push((name.to_owned(), bake_plan(&plan, &PlanBakeOptions::default())?.table));
    }
    for (name, tau) in [("whale_large", 0.0), ("office_a", 0.3)] {
        let path = files(&data.join("scenes").join(name), "glb").remove(0);
        tables.push((name.to_owned(), scene(&read_scene(&path)?.scene, tau)?));
    }
    tables.push(("e1m1".to_owned(), bake_prt(&read_prt(data.join("quake/e1m1.prt"))?, PrtOptions::default())?.table));
    tables.push(tower("tower:4")?);
    Ok(tables)
}

/// Nanoseconds that `ask` takes for random rows below `n`, on average over `n_asked` of them.
fn time(n_asked: usize, n: usize, mut ask: impl FnMut(usize)) -> f64 {
    let mut random = SplitMix::new(1);
    let asked: Vec<usize> = (0..n_asked).map(|_| random.below(n)).collect();
    let start = Instant::now();
    asked.into_iter().for_each(&mut ask);
    start.elapsed().as_secs_f64() * 1e9 / n_asked as f64
}

fn codings(args: &Args, name: &str, table: &Table, rows: &mut Vec<Row>) -> Result<(), Box<dyn Error>> {
    let matrix = &table.parts().rows;
    let n = table.n_cells();
    let dense = (n * n.div_ceil(8)) as u64;
    let row = |coding: &str, bytes: usize| Row {
        table: name.to_owned(),
        cells: n,
        coding: coding.to_owned(),
        bytes: bytes as u64,
        dense,
        cold: None,
        warm: None,
        seen: None,
        pack: 0.0,
    };
    let mut cells: Vec<CellId> = Vec::new();
    let warm = time(args.rows, n, |i| {
        cells.clear();
        cells.extend(table.visible(CellId(i as u32)));
    });
    rows.push(Row { warm: Some(warm), ..row("dense", dense as usize) });
    let runs: Vec<Vec<u8>> = (0..n).map(|i| zero_runs(matrix.row(i), n)).collect();
    let mut out = Vec::new();
    let warm = time(args.rows, n, |i| unpack_runs(&runs[i], n, &mut out));
    assert!((0..n).all(|i| (unpack_runs(&runs[i], n, &mut out), out == matrix.row(i)).1), "runs come back");
    let bytes = runs.iter().map(Vec::len).sum::<usize>() + 4 * n;
    rows.push(Row { cold: Some(warm), warm: Some(warm), ..row("zero runs (Quake)", bytes) });
    let start = Instant::now();
    let distinct = Distinct::new(matrix);
    let pack = start.elapsed().as_secs_f64();
    assert_eq!(distinct.expand(), *matrix, "repetitions come back");
    let bits = &distinct.bits;
    let map = if bits.n_rows() == n { 0 } else { 4 * n };
    rows.push(Row { pack, ..row("rows and columns shared", bits.n_rows() * bits.n_cols().div_ceil(8) + map) });
    for coding in RowCoding::ALL {
        for per_block in [64, 256] {
            let start = Instant::now();
            let coded = CodedRows::new(bits, coding, per_block)?;
            let pack = start.elapsed().as_secs_f64();
            let n_rows = bits.n_rows();
            assert!((0..n_rows).step_by(1 + n_rows / 50).all(|i| (coded.row(i, &mut out), out == bits.row(i)).1));
            let cold = time(args.rows.min(500), n_rows, |i| coded.row(i, &mut out));
            let name = format!("shared, {coding:?}, zstd, {per_block} rows").to_lowercase();
            rows.push(Row { cold: Some(cold), pack, ..row(&name, coded.n_bytes() + map) });
        }
    }
    let start = Instant::now();
    let (bytes, report) = pack_report(table, &PackOptions::default())?;
    let pack = start.elapsed().as_secs_f64();
    let [cold, warm] = [0, usize::MAX].map(|cache| -> Result<f64, Box<dyn Error>> {
        let packed = Packed::open(bytes.clone(), cache)?;
        if cache > 0 {
            (0..n).try_for_each(|i| packed.visible(CellId(i as u32), &mut cells))?;
        }
        Ok(time(args.rows.min(if cache > 0 { usize::MAX } else { 500 }), n, |i| {
            packed.visible(CellId(i as u32), &mut cells).unwrap_or_else(|e| panic!("{e}"));
            assert!(cells.binary_search(&CellId(i as u32)).is_ok(), "a cell sees itself");
        }))
    });
    assert_eq!(Packed::open(bytes, 0)?.to_table()?, *table, "the table comes back");
    rows.push(Row {
        cold: Some(cold?),
        warm: Some(warm?),
        seen: Some([1.0; 2]),
        pack,
        ..row("packed", report.row_bytes as usize)
    });
    Ok(())
}

/// Cells and objects that are seen, summed over all cells, after a look whether `less` is in `table`.
fn seen(table: &Table, less: &Table) -> [f64; 2] {
    let mut sums = [0; 2];
    for cell in (0..table.n_cells() as u32).map(CellId) {
        assert!(less.row(cell).iter().zip(table.row(cell)).all(|(a, b)| a & !b == 0), "cell {cell} sees less");
        let objects = table.visible_objects(cell);
        let hidden = |o: &ObjectId| objects.binary_search(o).is_err();
        assert!(!less.visible_objects(cell).iter().any(hidden), "cell {cell} sees fewer objects");
        sums[0] += table.visible(cell).count();
        sums[1] += objects.len();
    }
    sums.map(|sum| sum as f64)
}

fn budgets(args: &Args, name: &str, table: &Table, rows: &mut Vec<Row>) -> Result<(), Box<dyn Error>> {
    let (_, exact) = pack_report(table, &PackOptions::default())?;
    let before = seen(table, table);
    let n = table.n_cells();
    for share in BUDGETS {
        let max_bytes = exact.bytes - exact.row_bytes * (100 - share) / 100;
        let start = Instant::now();
        let (bytes, more) = match pack_report(table, &PackOptions { max_bytes: Some(max_bytes), class: None }) {
            Ok((bytes, report)) => {
                assert!(bytes.len() as u64 <= max_bytes, "the budget is kept");
                (report.row_bytes, Some(seen(&Packed::open(bytes, 1 << 24)?.to_table()?, table)))
            }
            Err(PackError::Budget { smallest, .. }) => (smallest - (exact.bytes - exact.row_bytes), None),
            Err(error) => return Err(error.into()),
        };
        assert!(!args.common.test || more.is_none_or(|more| more[0] > before[0] && bytes < exact.row_bytes));
        rows.push(Row {
            table: name.to_owned(),
            cells: n,
            coding: format!("packed into {share} %"),
            bytes,
            dense: (n * n.div_ceil(8)) as u64,
            cold: None,
            warm: None,
            seen: more.map(|more| [0, 1].map(|k| if before[k] > 0.0 { more[k] / before[k] } else { 1.0 })),
            pack: start.elapsed().as_secs_f64(),
        });
    }
    Ok(())
}

/// A table whose rows hardly compress: a grid of cells, each pair by a hash.
fn hashed(n: u32) -> Result<Table, Box<dyn Error>> {
    let width = f64::from(n).sqrt().ceil() as u32;
    let place = |i: u32| [f64::from(i % width), f64::from(i / width), 0.0];
    let cell = |i: u32| {
        let [x, y, z] = place(i);
        CellRecord { min: [x, y, z], max: [x + 1.0, y + 1.0, z + 3.0], group: None, polygon: vec![] }
    };
    let cells: Vec<CellRecord> = (0..n).map(cell).collect();
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    let mut rows = BitMatrix::new(n as usize, n as usize);
    for i in 0..n {
        for (k, word) in rows.row_mut(i as usize).iter_mut().enumerate() {
            for j in 64 * k as u32..n.min(64 * k as u32 + 64) {
                let hash = (u64::from(i.min(j)) << 32 | u64::from(i.max(j))).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                let on = i == j || (hash ^ hash >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 63 == 1;
                *word |= u64::from(on) << (j % 64);
            }
        }
    }
    let door = |i: u32, to: u32, z: f64| {
        let [x, y, _] = place(to);
        let [dx, dy] = if to == i + 1 { [0.0, 1.0] } else { [-1.0, 0.0] };
        let points = vec![[x, y, 0.0], [x - dx, y + dy, 0.0], [x - dx, y + dy, z], [x, y, z]];
        PortalRecord { cells: [CellId(i), CellId(to)], sides: [1, 3], points }
    };
    let portals = (0..n).flat_map(|i| {
        let right = (i % width + 1 < width && i + 1 < n).then(|| door(i, i + 1, 2.5));
        right.into_iter().chain((i + width < n).then(|| door(i, i + width, 2.0)))
    });
    let portals = portals.collect();
    let locator = Locator::build(&bounds, 3);
    let cell_objects = vec![vec![]; n as usize];
    Ok(Table::new(TableParts {
        cells,
        portals,
        rows,
        locator,
        cell_objects,
        ..TableParts::empty(3, TableKind::Unspecified)
    })?)
}

/// Opens a large file, locates a point, and asks for the row there; each time as if for the first time.
fn large(args: &Args) -> Result<String, Box<dyn Error>> {
    let table = hashed(args.large)?;
    let start = Instant::now();
    let (bytes, _) = pack_report(&table, &PackOptions::default())?;
    let pack = start.elapsed().as_secs_f64();
    let n_bytes = bytes.len();
    let path = std::env::temp_dir().join(format!("sightlines-packed-{}.bin", std::process::id()));
    std::fs::write(&path, bytes)?;
    let mut times = Vec::new();
    let (mut resident, mut read) = (0, 0);
    let mut random = SplitMix::new(7);
    let asked = (|| -> Result<(), Box<dyn Error>> {
        for _ in 0..31 {
            let (min, max) = table.parts().cell_bounds()[random.below(table.n_cells())];
            let eye: [f64; 3] = std::array::from_fn(|k| f64::midpoint(min[k], max[k]));
            let (mut buffer, mut seen) = (PlaceBuffer::new(), Vec::new());
            let start = Instant::now();
            let packed = Packed::open(std::fs::File::open(&path)?, 16 << 20)?;
            let cells = packed.cells_at(eye, &mut buffer)?.inside().expect("the middle of a cell is inside");
            packed.visible(cells[0], &mut seen)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
            assert!(cells == table.place_at(eye).cells() && seen.iter().copied().eq(table.visible(cells[0])));
            (resident, read) = (packed.resident_bytes(), packed.stats().bytes_read);
        }
        Ok(())
    })();
    std::fs::remove_file(&path)?;
    asked?;
    times.sort_by(f64::total_cmp);
    let mib = |n: f64| n / f64::from(1 << 20);
    Ok(format!(
        "\nA file of {:.0} MiB ({} cells, {} portals, rows that hardly compress), opened, a point located, its row read: \
         {:.2} ms in the median of 31, {:.2} ms at most, with the file in the page cache; {:.1} MiB read, {:.1} MiB of them \
         resident. Packing took {pack:.0} s.\n",
        mib(n_bytes as f64),
        table.n_cells(),
        table.portals().len(),
        times[times.len() / 2],
        times[times.len() - 1],
        mib(read as f64),
        mib(resident as f64),
    ))
}

fn csv(rows: &[Row]) -> String {
    let mut out =
        "table,cells,coding,bytes,dense_bytes,cold_ns,warm_ns,cells_over_exact,objects_over_exact,pack_s\n".to_owned();
    let number = |x: Option<f64>| x.map(|x| format!("{x:.4}")).unwrap_or_default();
    for row in rows {
        let seen = [0, 1].map(|k| number(row.seen.map(|seen| seen[k])));
        let coding = row.coding.replace(", ", " ");
        let Row { table, cells, bytes, dense, .. } = row;
        let (cold, warm) = (number(row.cold), number(row.warm));
        let _ = writeln!(
            out,
            "{table},{cells},{coding},{bytes},{dense},{cold},{warm},{},{},{:.3}",
            seen[0], seen[1], row.pack
        );
    }
    out
}

fn markdown(rows: &[Row]) -> String {
    let mut out = "| table | cells | coding | bytes | of dense | row cold, ns | row warm, ns | cells seen | objects seen | pack, s |\n\
        | --- | --: | --- | --: | --: | --: | --: | --: | --: | --: |\n"
        .to_owned();
    let number = |x: Option<f64>, digits: usize| x.map(|x| format!("{x:.digits$}")).unwrap_or_default();
    let mut last = "";
    for row in rows {
        let (table, cells) = if row.table == last { ("", String::new()) } else { (&*row.table, row.cells.to_string()) };
        last = &row.table;
        let share = 100.0 * row.bytes as f64 / row.dense.max(1) as f64;
        let seen = [0, 1].map(|k| match (row.seen, row.coding.contains("into")) {
            (None, true) => "not to be had".to_owned(),
            (seen, _) => number(seen.map(|seen| seen[k]), 3),
        });
        let (cold, warm) = (number(row.cold, 0), number(row.warm, 0));
        let (coding, bytes) = (&row.coding, row.bytes);
        let _ = writeln!(
            out,
            "| {table} | {cells} | {coding} | {bytes} | {share:.1} % | {cold} | {warm} | {} | {} | {:.3} |",
            seen[0], seen[1], row.pack
        );
    }
    out
}
