//! Furnished towers of 1 to 64 floors: how time, memory and tables grow, and how little a viewer has to draw.
//!
//! Measuring and drawing are two steps: `--csv` keeps what was measured, `--draw` makes a chart of such a file,
//! always the same one.

use clap::Parser;
use sightlines::bake::PortalMode;
use sightlines::cells::Scene;
use sightlines::pvs::Table;
use sightlines::scenes::TowerOptions;
use sightlines_benches::chart::{Panel, Series, exponent, svg};
use sightlines_benches::child::{self, Job, Limits, Outcome, portals_of};
use sightlines_benches::program::{Common, Files, exit, read_rows};
use sightlines_benches::shares::{mean_share, share_of, triangles_of};
use sightlines_benches::spec::SceneSpec;
use sightlines_testkit::Random;
use std::error::Error;
use std::process::ExitCode;
use std::time::Duration;

/// Height of a storey, and of eyes above its floor.
const STOREY: f64 = 3.0;
const EYES: [f64; 2] = [1.2, 1.8];
/// Random eyes.
const N_EYES: u64 = 2_000;

/// Towers: time, memory and shares against floors.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Floors of the towers.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 4, 8])]
    floors: Vec<u32>,
    /// Room places in a row, rows, and level of furniture.
    #[arg(long, value_delimiter = ',', num_args = 1, default_values_t = [6, 4, 2])]
    plan: Vec<u32>,
    /// Obscuration threshold.
    #[arg(long, default_value_t = 0.0)]
    tau: f64,
    /// Portal mode: bounding, exact.
    #[arg(long, default_value = "exact", value_parser = portals_of)]
    portals: PortalMode,
    /// Seconds that one bake may take.
    #[arg(long, default_value_t = 1800.0)]
    limit: f64,
    /// MiB that one bake may use.
    #[arg(long, default_value_t = 8192)]
    memory: u64,
    /// Threads of a bake; 0 for one for each core.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    #[command(flatten)]
    files: Files,
}

/// The columns of the file, in which [`Row`] keeps its numbers.
const COLUMNS: [&str; 12] = [
    "floors",
    "triangles",
    "objects",
    "cells",
    "portals",
    "cut_s",
    "see_s",
    "peak_bytes",
    "table_bytes",
    "share_by_volume",
    "share_of_eyes",
    "worst_eye",
];
const FLOORS: usize = 0;
const TRIANGLES: usize = 1;
const CELLS: usize = 3;
const CUT: usize = 5;
const SEE: usize = 6;
const PEAK: usize = 7;
const BYTES: usize = 8;
const BY_VOLUME: usize = 9;
const OF_EYES: usize = 10;
const WORST: usize = 11;

/// What was measured of a tower.
type Row = [f64; COLUMNS.len()];

fn main() -> ExitCode {
    child::serve();
    let mut args = Args::parse();
    if !args.common.is_wanted("bake/tower") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.floors, args.plan) = (vec![1, 2], vec![2, 1, 1]);
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let rows = args.files.rows(read, || measure(args))?;
    if args.common.test {
        check(&rows)?;
    }
    args.files.save_chart(|| chart(&rows))?;
    print(&rows);
    Ok(())
}

fn measure(args: &Args) -> Result<Vec<Row>, Box<dyn Error>> {
    let file = std::env::temp_dir().join(format!("sightlines-tower-{}.pvs", std::process::id()));
    let limits = Limits { time: Duration::try_from_secs_f64(args.limit)?, memory: args.memory << 20 };
    let &[rooms_x, rooms_y, furniture] = &args.plan[..] else { return Err("--plan takes three numbers".into()) };
    let mut rows = Vec::new();
    for &floors in &args.floors {
        let options = TowerOptions { floors, rooms_x, rooms_y, furniture, ..TowerOptions::default() };
        let spec = SceneSpec::Tower(options);
        let table = Some(file.clone());
        let (tau, portals, threads) = (args.tau, args.portals, args.threads);
        let job = Job { spec: spec.clone(), tau, portals, keep_solid: false, threads, table };
        match child::run(&job, &limits) {
            Outcome::Done(m) => {
                let table = Table::from_bytes(&std::fs::read(&file)?)?;
                let shares = shares(&spec.load()?, &table, floors);
                let counts = [m.n_triangles, m.n_objects, m.n_cells, m.n_portals, m.peak, m.table_bytes];
                let [triangles, objects, cells, portals, peak, bytes] = counts.map(|n| n as f64);
                let floors = f64::from(floors);
                let [volume, eyes, worst] = shares;
                rows.push([floors, triangles, objects, cells, portals, m.cut, m.see, peak, bytes, volume, eyes, worst]);
                eprintln!("{spec}: {cells} cells, {:.2} s, {:.0} MiB", m.cut + m.see, peak / 1048576.0);
            }
            Outcome::TimedOut(limit) => eprintln!("{spec}: stopped after {:.0} s", limit.as_secs_f64()),
            Outcome::TooLarge(bytes) => eprintln!("{spec}: stopped at {} MiB", bytes >> 20),
            Outcome::Failed => return Err(format!("{spec}: the bake failed").into()),
        }
        args.files.save_rows(|| write(&rows))?;
    }
    if file.is_file() {
        std::fs::remove_file(&file)?;
    }
    Ok(rows)
}

/// The share of triangles that a viewer's set has: on average over the cells by volume; on average over
/// random eyes at the height of people, wherever there is a cell; and the most for any of these eyes.
fn shares(scene: &Scene, table: &Table, floors: u32) -> [f64; 3] {
    let triangles = triangles_of(scene);
    let bounds = scene.bounds();
    let (mut sum, mut worst, mut n) = (0.0, 0.0f64, 0);
    for try_ in 0..100 * N_EYES {
        if n == N_EYES {
            break;
        }
        let mut random = Random::new(1, try_);
        let mut eye = random.point(&bounds);
        eye[1] = STOREY * random.below(floors as usize) as f64 + EYES[0] + (EYES[1] - EYES[0]) * random.unit();
        if table.in_dimension().expect("it is of space").at(eye).is_outside() {
            continue;
        }
        let share = share_of(
            &triangles,
            table
                .in_dimension()
                .expect("it is of space")
                .at(eye)
                .inside()
                .map_or(Vec::new(), |at| at.visible_objects().iter().map(|o| o.0).collect()),
        );
        (sum, worst, n) = (sum + share, worst.max(share), n + 1);
    }
    [mean_share(table, &triangles, |c| table.visible_objects(c).into_iter().map(|o| o.0)), sum / n.max(1) as f64, worst]
}

fn write(rows: &[Row]) -> String {
    let line = |row: &Row| row.map(|x| x.to_string()).join(",") + "\n";
    COLUMNS.join(",") + "\n" + &rows.iter().map(line).collect::<String>()
}

fn read(text: &str) -> Result<Vec<Row>, String> {
    let row = |line: &str| {
        let numbers: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        Row::try_from(numbers.ok()?).ok()
    };
    read_rows(text, &COLUMNS.join(","), row)
}

fn points(rows: &[Row], y: impl Fn(&Row) -> f64) -> Vec<[f64; 2]> {
    rows.iter().map(|row| [row[FLOORS], y(row)]).collect()
}

/// A name with the exponent against floors.
fn fitted(name: &str, points: &[[f64; 2]]) -> String {
    exponent(points).map_or_else(|| name.to_owned(), |b| format!("{name}: floors^{b:.2}"))
}

fn chart(rows: &[Row]) -> String {
    let series = |name: &str, y: &dyn Fn(&Row) -> f64| {
        let points = points(rows, y);
        Series::line(fitted(name, &points), points)
    };
    let mib = |column: usize| move |row: &Row| row[column] / f64::from(1 << 20);
    let panel = |title: &str, series: Vec<Series>| Panel::of_lines(title, "floors", series);
    let panels = [
        panel("time, seconds", vec![series("cut", &|r| r[CUT]), series("see", &|r| r[SEE])]),
        panel("memory, MiB", vec![series("peak", &mib(PEAK)), series("table", &mib(BYTES))]),
        panel(
            "triangles in a viewer's set, % of all",
            vec![
                series("mean by volume", &|r| 100.0 * r[BY_VOLUME]),
                series("mean of eyes", &|r| 100.0 * r[OF_EYES]),
                series("worst eye", &|r| 100.0 * r[WORST]),
            ],
        ),
    ];
    svg("Furnished towers", &panels)
}

fn print(rows: &[Row]) {
    println!(
        "| floors | triangles | cells | cut, s | see, s | peak, MiB | table, MiB | share by volume | share of eyes | worst eye |"
    );
    println!("| --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    for r in rows {
        let [peak, bytes] = [r[PEAK], r[BYTES]].map(|b| b / 1048576.0);
        let [volume, eyes, worst] = [r[BY_VOLUME], r[OF_EYES], r[WORST]].map(|x| 100.0 * x);
        println!(
            "| {} | {} | {} | {:.2} | {:.2} | {peak:.0} | {bytes:.2} | {volume:.2} % | {eyes:.2} % | {worst:.2} % |",
            r[FLOORS], r[TRIANGLES], r[CELLS], r[CUT], r[SEE]
        );
    }
    let fits = [
        ("time", points(rows, |r| r[CUT] + r[SEE])),
        ("peak of memory", points(rows, |r| r[PEAK])),
        ("table", points(rows, |r| r[BYTES])),
    ];
    for (name, points) in fits {
        let upper = &points[points.len() / 2..];
        let doubled = if upper.len() > 1 { fitted("; the larger half", upper) } else { String::new() };
        println!("bake/tower: {}{doubled}", fitted(name, &points));
    }
}

/// What must hold of small towers, whatever the machine.
fn check(rows: &[Row]) -> Result<(), Box<dyn Error>> {
    assert_eq!(rows.iter().map(|r| r[FLOORS]).collect::<Vec<_>>(), [1.0, 2.0], "every tower was measured");
    for pair in rows.windows(2) {
        assert!(pair[0][CELLS] < pair[1][CELLS] && pair[0][TRIANGLES] < pair[1][TRIANGLES], "towers grow");
        assert!(pair[0][BY_VOLUME] > pair[1][BY_VOLUME], "the higher a tower, the less of it is seen");
    }
    for row in rows {
        let shares = [BY_VOLUME, OF_EYES, WORST].map(|k| row[k]);
        assert!(shares.iter().all(|s| (0.0..=1.0).contains(s)) && shares[1] <= shares[2], "{shares:?}");
    }
    let text = write(rows);
    assert_eq!(read(&text)?, rows, "what was measured is read back");
    assert_eq!(chart(&read(&text)?), chart(rows), "the same numbers make the same chart");
    for broken in [text.replace("cells", "c"), text.replacen("\n1,", "\n", 1), text.replacen("\n1,", "\nx,", 1)] {
        assert!(read(&broken).is_err(), "{broken}");
    }
    Ok(())
}
