//! Packed tables of the large class: a generated table is written row by row, opened and asked, beside a table of the small
//! class in the same run.
//!
//! The table is a city of square cells, numbered along a Morton curve. Blocks of four by four cells see whole other blocks,
//! the nearer the more of them; and of each pair of cells of such blocks one in twenty is hidden all the same, so that rows have
//! holes and none equals another. Each cell sees about a thousand others.

use clap::Parser;
use sightlines::packed::{PackOptions, PackWriter, Packed, SizeClass, StreamOptions, pack};
use sightlines::pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, PlaceBuffer, PortalRecord, Table, TableKind,
    TableParts,
};
use sightlines_benches::measure::{median, memory_of};
use sightlines_benches::program::{Common, exit};
use sightlines_testkit::mutate::SplitMix;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Cells along the side of a block.
const SIDE: u32 = 4;
/// How far blocks see, in blocks.
const REACH: i64 = 12;

/// Large packed tables: bytes, memory, times.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Cells of the large table; a little less for a square of blocks.
    #[arg(long, default_value_t = 1_000_000)]
    cells: u32,
    /// Cells of the small table.
    #[arg(long, default_value_t = 20_000)]
    small: u32,
    /// Queries of each kind.
    #[arg(long, default_value_t = 20_000)]
    queries: usize,
    /// Whether each cell has a row of objects.
    #[arg(long, default_value_t = true, action = clap::ArgAction::Set)]
    objects: bool,
    /// Checks the whole file afterwards, and prints how long that takes.
    #[arg(long)]
    verify: bool,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("large_tables") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.cells, args.small, args.queries, args.verify) = (20_000, 2500, 1000, true);
    }
    exit(run(&args))
}

/// A square of blocks.
struct City {
    /// Cells along a side.
    width: u32,
    /// The cell at each place, row by row, and the place of each cell.
    id_at: Vec<u32>,
    place_of: Vec<[u32; 2]>,
}

/// The bits of both numbers in turn.
fn morton([x, y]: [u32; 2]) -> u64 {
    (0..32).fold(0, |code, k| code | u64::from(x >> k & 1) << (2 * k) | u64::from(y >> k & 1) << (2 * k + 1))
}

fn hash(a: u64, b: u64) -> u64 {
    let mixed = (a.min(b) << 32 | a.max(b)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ mixed >> 31).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    mixed ^ mixed >> 29
}

impl City {
    fn new(n_cells: u32) -> Self {
        let width = (f64::from(n_cells).sqrt() as u32 / SIDE).max(1) * SIDE;
        let mut place_of: Vec<[u32; 2]> = (0..width * width).map(|i| [i % width, i / width]).collect();
        place_of.sort_by_cached_key(|&place| morton(place));
        let mut id_at = vec![0; place_of.len()];
        for (id, [x, y]) in (0u32..).zip(&place_of) {
            id_at[(y * width + x) as usize] = id;
        }
        Self { width, id_at, place_of }
    }

    fn n_cells(&self) -> u32 {
        self.place_of.len() as u32
    }

    fn id(&self, x: u32, y: u32) -> u32 {
        self.id_at[(y * self.width + x) as usize]
    }

    /// The first cells of the blocks that a block sees, ascending; the cells of a block have consecutive numbers.
    fn blocks_seen(&self, [x, y]: [u32; 2]) -> Vec<u32> {
        let n = i64::from(self.width / SIDE);
        let own = self.id(x * SIDE, y * SIDE);
        let mut seen = Vec::new();
        for (dx, dy) in (-REACH..=REACH).flat_map(|dx| (-REACH..=REACH).map(move |dy| (dx, dy))) {
            let (u, v) = (i64::from(x) + dx, i64::from(y) + dy);
            if !(0..n).contains(&u) || !(0..n).contains(&v) {
                continue;
            }
            let other = self.id(u as u32 * SIDE, v as u32 * SIDE);
            // Streets run along both axes; elsewhere the nearer, the more is seen.
            let far = dx.abs().max(dy.abs());
            let share = if dx == 0 || dy == 0 { 200 } else { 220 / (far as u64 + 6) };
            if far <= 1 || hash(u64::from(own), u64::from(other)) >> 56 < share {
                seen.push(other);
            }
        }
        seen.sort_unstable();
        seen
    }

    /// Calls `visit` with each row in turn: the cell, the cells that it sees, the objects that it sees.
    fn for_each_row(
        &self,
        mut visit: impl FnMut(CellId, &[CellId], &[ObjectId]) -> Result<(), Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        let (mut row, mut objects, mut blocks) = (Vec::new(), Vec::new(), Vec::new());
        for cell in 0..self.n_cells() {
            if cell.is_multiple_of(SIDE * SIDE) {
                let [x, y] = self.place_of[cell as usize];
                blocks = self.blocks_seen([x / SIDE, y / SIDE]);
            }
            row.clear();
            let all = blocks.iter().flat_map(|&first| first..first + SIDE * SIDE);
            let open = |other: u32| {
                other == cell || !hash(u64::from(cell) | 1 << 31, u64::from(other) | 1 << 31).is_multiple_of(20)
            };
            row.extend(all.filter(|&other| open(other)).map(CellId));
            objects.clear();
            objects.extend(row.iter().map(|other| ObjectId(other.0 / SIDE)));
            objects.dedup();
            visit(CellId(cell), &row, &objects)?;
        }
        Ok(())
    }

    fn parts(&self) -> TableParts {
        let at = |x: u32, y: u32| [f64::from(x) * 3.5, f64::from(y) * 3.5];
        let cell = |(i, &[x, y]): (usize, &[u32; 2])| {
            let ([x0, y0], [x1, y1]) = (at(x, y), at(x + 1, y + 1));
            let top = 2.5 + 0.5 * (hash(i as u64, 7) % 8) as f64;
            CellRecord { min: [x0, y0, 0.0], max: [x1, y1, top], group: None, polygon: vec![] }
        };
        let mut parts = TableParts::empty(3, TableKind::Unspecified);
        parts.cells = self.place_of.iter().enumerate().map(cell).collect();
        for (i, &[x, y]) in self.place_of.iter().enumerate() {
            let [x1, y1] = at(x + 1, y + 1);
            let [x0, y0] = at(x, y);
            let wall = |a: [f64; 2], b: [f64; 2]| {
                vec![[a[0], a[1], 0.0], [b[0], b[1], 0.0], [b[0], b[1], 2.0], [a[0], a[1], 2.0]]
            };
            let mut door = |to: u32, points| {
                parts.portals.push(PortalRecord { cells: [CellId(i as u32), CellId(to)], sides: [1, 3], points });
            };
            if x + 1 < self.width {
                door(self.id(x + 1, y), wall([x1, y0 + 1.0], [x1, y0 + 2.0]));
            }
            if y + 1 < self.width {
                door(self.id(x, y + 1), wall([x0 + 1.0, y1], [x0 + 2.0, y1]));
            }
        }
        for o in 0..self.n_cells() / SIDE {
            let CellRecord { min, max, .. } = &parts.cells[(o * SIDE) as usize];
            parts.objects.push(ObjectRecord { name: format!("thing {o}"), min: *min, max: *max });
        }
        parts.cell_objects = (0..self.n_cells()).map(|i| vec![ObjectId(i / SIDE)]).collect();
        parts.locator = Locator::build(&parts.cell_bounds(), 3);
        parts
    }
}

/// A file that is removed in the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        Self(std::env::temp_dir().join(format!("sightlines-{name}-{}.pvz", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // Where it cannot be removed, it stays in the folder for such files.
        let _ = std::fs::remove_file(&self.0);
    }
}

fn mib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let memory = |key: &str| memory_of("self", key).map_or(f64::NAN, mib);
    let large = Scratch::new("large");
    let city = City::new(args.cells);
    let start = Instant::now();
    let parts = city.parts();
    let (n_portals, n_objects) = (parts.portals.len(), parts.objects.len());
    println!(
        "{} cells, {n_portals} portals, {n_objects} objects; the parts in {:.1} s, {:.0} MiB in memory",
        city.n_cells(),
        start.elapsed().as_secs_f64(),
        memory("VmRSS:")
    );
    let start = Instant::now();
    let options = StreamOptions { objects_seen: args.objects };
    let mut writer = PackWriter::new(BufWriter::new(File::create(&large.0)?), &parts, &options)?;
    let frame = start.elapsed().as_secs_f64();
    let peak_parts = memory("VmHWM:");
    drop(parts);
    let before = memory("VmRSS:");
    let start = Instant::now();
    let (mut n_seen, mut n_runs, mut seconds) = (0, 0, 0.0);
    city.for_each_row(|_, row, objects| {
        n_seen += row.len();
        n_runs += 1 + row.windows(2).filter(|pair| pair[1].0 != pair[0].0 + 1).count();
        let start = Instant::now();
        writer.push(row, args.objects.then_some(objects))?;
        seconds += start.elapsed().as_secs_f64();
        Ok(())
    })?;
    let (_, report) = writer.finish()?;
    let n = f64::from(city.n_cells());
    println!(
        "each cell sees {:.0} in {:.0} runs; all but the rows written in {frame:.1} s, rows in {seconds:.1} s, and {:.1} s to make them",
        n_seen as f64 / n,
        n_runs as f64 / n,
        start.elapsed().as_secs_f64() - seconds
    );
    println!(
        "memory of the process: {peak_parts:.0} MiB at most with the parts, {before:.0} MiB without them, {:.0} MiB after the rows, {:.0} MiB at most",
        memory("VmRSS:"),
        memory("VmHWM:")
    );
    println!(
        "{:.0} MiB on disk, {:.1} bytes a cell, {:.1} of them rows",
        mib(report.bytes),
        report.bytes as f64 / n,
        report.row_bytes as f64 / n
    );
    let packed = Packed::open(File::open(&large.0)?, 0)?;
    let parts: Vec<String> = packed
        .part_sizes()
        .iter()
        .filter(|part| part.bytes > 0)
        .map(|part| format!("{} {:.2}{}", part.id, mib(part.bytes), if part.resident { " resident" } else { "" }))
        .collect();
    println!("parts, MiB: {}", parts.join(", "));
    if args.verify {
        let start = Instant::now();
        Packed::open(File::open(&large.0)?, 64 << 20)?.verify()?;
        println!("the whole file checked in {:.1} s", start.elapsed().as_secs_f64());
    }
    check_rows(&packed, &city, args)?;
    drop(packed);

    let few = City::new(args.small);
    let mut parts = few.parts();
    parts.rows = BitMatrix::new(few.place_of.len(), few.place_of.len());
    let mut seen = BitMatrix::new(few.place_of.len(), parts.objects.len());
    few.for_each_row(|cell, row, objects| {
        row.iter().for_each(|other| parts.rows.set(cell.idx(), other.idx(), true));
        objects.iter().for_each(|object| seen.set(cell.idx(), object.idx(), true));
        Ok(())
    })?;
    parts.objects_seen = args.objects.then_some(seen);
    let table = Table::new(parts)?;
    let mut times = Vec::new();
    for (class, name) in [(SizeClass::Small, "small"), (SizeClass::Large, "few-large")] {
        let file = Scratch::new(name);
        let start = Instant::now();
        let bytes = pack(&table, &PackOptions { max_bytes: None, class: Some(class) })?;
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "the small table in the class {class:?}: {} cells, {:.1} bytes a cell, packed in {seconds:.1} s",
            few.n_cells(),
            bytes.len() as f64 / f64::from(few.n_cells())
        );
        std::fs::write(&file.0, bytes)?;
        times.push(ask(&file.0, &few, args)?);
    }
    times.push(ask(&large.0, &city, args)?);
    println!("\n| | small class, small table | large class, small table | large class, large table | of small |");
    println!("| --- | --: | --: | --: | --: |");
    for (k, what) in WHAT.iter().enumerate() {
        let [small, few, many] = [0, 1, 2].map(|i: usize| times[i][k]);
        println!("| {what} | {small:.2} | {few:.2} | {many:.2} | {:.2} |", many / small);
    }
    Ok(())
}

/// Rows of the file against those of the city, some of them, and the cells at their middles.
fn check_rows(packed: &Packed<File>, city: &City, args: &Args) -> Result<(), Box<dyn Error>> {
    let (mut seen, mut seen_objects, mut buffer, mut n) = (Vec::new(), Vec::new(), PlaceBuffer::new(), 0);
    let step = 1 + city.n_cells() / 500;
    city.for_each_row(|cell, row, objects| {
        if cell.0.is_multiple_of(step) {
            packed.visible(cell, &mut seen)?;
            assert_eq!(seen, row, "the row of cell {cell}");
            if args.objects {
                packed.objects_seen(cell, &mut seen_objects)?;
                assert_eq!(seen_objects, objects, "the objects of cell {cell}");
            }
            let (min, max) = packed.cell_box(cell)?;
            let middle = std::array::from_fn(|k| f64::midpoint(min[k], max[k]));
            assert_eq!(packed.cells_at(middle, &mut buffer)?.inside(), Some(&[cell][..]), "the middle of cell {cell}");
            n += 1;
        }
        Ok(())
    })?;
    assert!(n > 100, "{n} rows were compared");
    Ok(())
}

const WHAT: [&str; 8] = [
    "open, µs",
    "open, locate, read a row, µs",
    "`cells_at`, blocks there, µs",
    "`visible`, blocks there, µs",
    "`objects_seen`, blocks there, µs",
    "`cells_at`, each block read, µs",
    "`visible`, each block read, µs",
    "`objects_seen`, each block read, µs",
];

/// Times of a file, as in [`WHAT`]. Blocks "are there" for a viewer among some thousand neighbouring cells, with room for them.
fn ask(path: &Path, city: &City, args: &Args) -> Result<[f64; 8], Box<dyn Error>> {
    let micros = |start: Instant| start.elapsed().as_secs_f64() * 1e6;
    let mut random = SplitMix::new(5);
    let (mut buffer, mut cells, mut objects) = (PlaceBuffer::new(), Vec::new(), Vec::new());
    let middle = |cell: u32| {
        let [x, y] = city.place_of[cell as usize];
        [f64::from(x) * 3.5 + 1.25, f64::from(y) * 3.5 + 1.5, 1.0]
    };
    let (mut opens, mut firsts) = (Vec::new(), Vec::new());
    for _ in 0..51 {
        let cell = random.below(city.place_of.len()) as u32;
        let start = Instant::now();
        let packed = Packed::open(File::open(path)?, 16 << 20)?;
        opens.push(micros(start));
        let here = packed.cells_at(middle(cell), &mut buffer)?.inside().expect("the middle of a cell is inside");
        assert_eq!(here, [CellId(cell)]);
        packed.visible(here[0], &mut cells)?;
        firsts.push(micros(start));
    }
    let mut times = vec![median(opens), median(firsts)];
    let near = city.place_of.len().min(4096);
    let first = random.below(city.place_of.len() - near + 1);
    for cache in [64 << 20, 0] {
        let packed = Packed::open(File::open(path)?, cache)?;
        let n = if cache == 0 { args.queries / 10 } else { args.queries };
        let asked: Vec<u32> = (0..n).map(|_| (first + random.below(near)) as u32).collect();
        for what in 0..3 {
            let mut ask = |cell: u32| -> Result<(), Box<dyn Error>> {
                match what {
                    0 => assert!(!packed.cells_at(middle(cell), &mut buffer)?.is_outside()),
                    1 => packed.visible(CellId(cell), &mut cells)?,
                    _ => packed.objects_seen(CellId(cell), &mut objects)?,
                }
                Ok(())
            };
            if cache > 0 {
                (first..first + near).try_for_each(|cell| ask(cell as u32))?;
            }
            // The least of fifteen repeats.
            let mut least = f64::INFINITY;
            for _ in 0..15 {
                let start = Instant::now();
                asked.iter().try_for_each(|&cell| ask(cell))?;
                least = least.min(micros(start) / n as f64);
            }
            times.push(least);
        }
    }
    times.try_into().map_err(|_| "eight times".into())
}
