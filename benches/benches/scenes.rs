//! Tables of scenes against rays: nothing that a ray joins is missing, and how much more than that there is.
//!
//! Each scene is baked for each threshold and portal mode, each time in a process of its own; then lines are
//! followed through the scene and held against all its tables. Ends with 1 if a table misses a pair.

use clap::Parser;
use sightlines::bake::PortalMode;
use sightlines::cells::Scene;
use sightlines::pvs::{ObjectId, Table};
use sightlines_benches::child::{self, Job, Limits, Measured, Outcome, portals_name, portals_of};
use sightlines_benches::program::{Common, save};
use sightlines_benches::recorded::{Hidden, compare};
use sightlines_benches::spec::SceneSpec;
use sightlines_benches::witness::{Missing, Pair, RayOptions, Verdict, judge};
use sightlines_tests::{data_folder, scene_folders, scene_witness};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Missing pairs that are printed of each table.
const SHOWN: usize = 10;

/// Over-estimation and soundness of tables of scenes.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// A GLB or OBJ file, or tower:FLOORS, or tower:FLOORS:ROOMS_X:ROOMS_Y:FURNITURE; may be given more than
    /// once. Without it: all of $SIGHTLINES_DATA/scenes, and towers.
    #[arg(long = "scene")]
    scenes: Vec<SceneSpec>,
    /// Floors of the towers, if no scenes are given.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 4])]
    towers: Vec<u32>,
    /// Obscuration thresholds.
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 0.1, 0.3, 0.6])]
    taus: Vec<f64>,
    /// Portal modes: bounding, exact.
    #[arg(long, value_delimiter = ',', default_value = "bounding,exact", value_parser = portals_of)]
    portals: Vec<PortalMode>,
    /// Lines to follow in each scene.
    #[arg(long, default_value_t = 1_000_000)]
    rays: u64,
    /// Where chance begins.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Seconds that one bake may take.
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// MiB that one bake may use.
    #[arg(long, default_value_t = 8192)]
    memory: u64,
    /// Threads of bakes and rays; 0 for one for each core.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Writes the table as CSV, scene by scene.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Writes the table as Markdown, scene by scene.
    #[arg(long)]
    md: Option<PathBuf>,
    /// Leaves out the comparison with what the data folder says was seen.
    #[arg(long)]
    no_recorded: bool,
}

/// A line of the table.
struct Row {
    scene: String,
    tau: f64,
    portals: &'static str,
    outcome: Outcome,
    verdict: Option<Verdict>,
}

/// Everything that is printed and written.
#[derive(Default)]
struct Report {
    rows: Vec<Row>,
    /// Markdown of what else was found.
    recorded: String,
    n_missing: usize,
}

fn main() -> ExitCode {
    child::serve();
    let mut args = Args::parse();
    if !args.common.is_wanted("bake/scenes") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        args.scenes = vec!["tower:1:2:1:1".parse().unwrap_or_else(|e| panic!("{e}"))];
        (args.rays, args.taus) = (args.rays.min(20_000), vec![0.0, 0.3]);
    }
    match measure(&args) {
        Ok(report) => conclude(&args, &report),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn conclude(args: &Args, report: &Report) -> ExitCode {
    println!("{}", markdown(&report.rows));
    print!("{}", report.recorded);
    if args.common.test {
        let done = report.rows.iter().filter(|r| r.verdict.as_ref().is_some_and(|v| v.n_objects_witnessed > 100));
        assert_eq!(done.count(), args.taus.len() * args.portals.len(), "every bake has a verdict");
    }
    let n_failed = report.rows.iter().filter(|r| r.outcome == Outcome::Failed).count();
    if n_failed > 0 {
        eprintln!("{n_failed} bakes failed");
    }
    if report.n_missing > 0 {
        eprintln!("{} pairs that rays join are missing", report.n_missing);
    }
    if report.n_missing + n_failed > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn measure(args: &Args) -> Result<Report, Box<dyn std::error::Error>> {
    let folder = std::env::temp_dir().join(format!("sightlines-scenes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut report = Report::default();
    let mut result = Ok(());
    for spec in scenes(args)? {
        eprintln!("{spec}");
        result = one_scene(args, &spec, &folder, &mut report);
        if result.is_err() {
            break;
        }
        for (path, text) in [(&args.csv, csv(&report.rows)), (&args.md, markdown(&report.rows) + &report.recorded)] {
            save(path.as_deref(), || text)?;
        }
    }
    std::fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    result.map(|()| report)
}

/// The scenes that were named, or all there are.
fn scenes(args: &Args) -> Result<Vec<SceneSpec>, Box<dyn std::error::Error>> {
    if !args.scenes.is_empty() {
        return Ok(args.scenes.clone());
    }
    let mut found = Vec::new();
    for folder in data_folder("SIGHTLINES_DATA").iter().flat_map(|data| scene_folders(data)) {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let files = ["glb", "gltf", "obj"].map(|extension| folder.join(&name).with_extension(extension));
        let file = files.into_iter().find(|f| f.is_file());
        found.push(SceneSpec::File(file.ok_or_else(|| format!("{}: no scene", folder.display()))?));
    }
    for floors in &args.towers {
        found.push(format!("tower:{floors}").parse()?);
    }
    Ok(found)
}

fn one_scene(
    args: &Args,
    spec: &SceneSpec,
    folder: &Path,
    report: &mut Report,
) -> Result<(), Box<dyn std::error::Error>> {
    let scene = spec.load()?;
    let (mut rows, mut tables, mut with_table) = (Vec::new(), Vec::new(), Vec::new());
    for &tau in &args.taus {
        for &portals in &args.portals {
            let (outcome, table) = bake(args, spec, folder, tau, portals, false)?;
            eprintln!("  tau {tau}, {}: {}", portals_name(portals), outcome_name(&outcome));
            if let Some(table) = table {
                with_table.push(rows.len());
                tables.push(table);
            }
            rows.push(Row { scene: spec.name(), tau, portals: portals_name(portals), outcome, verdict: None });
        }
    }
    if !args.no_recorded {
        // The first threshold with the last portal mode is what is compared.
        let table = with_table.iter().position(|&row| row + 1 == args.portals.len()).map(|k| &tables[k]);
        recorded(args, spec, folder, table, report)?;
    }
    let options = RayOptions { n_rays: args.rays, seed: args.seed, threads: args.threads };
    if args.common.test {
        impostor(&scene, &tables, &options);
    }
    if !tables.is_empty() {
        let start = Instant::now();
        let verdicts = judge(&scene, &tables, &options);
        let seconds = start.elapsed().as_secs_f64();
        eprintln!("  {} of {} lines are clear, {seconds:.1} s", verdicts.n_clear, args.rays);
        for (row, verdict) in with_table.into_iter().zip(verdicts.tables) {
            print_missing(&rows[row], &verdict.missing);
            report.n_missing += verdict.missing.len();
            rows[row].verdict = Some(verdict);
        }
    }
    report.rows.append(&mut rows);
    Ok(())
}

/// One bake in a process of its own, and its table.
fn bake(
    args: &Args,
    spec: &SceneSpec,
    folder: &Path,
    tau: f64,
    portals: PortalMode,
    keep_solid: bool,
) -> Result<(Outcome, Option<Table>), Box<dyn std::error::Error>> {
    let file = folder.join("table.pvs");
    let limits = Limits { time: Duration::try_from_secs_f64(args.limit)?, memory: args.memory << 20 };
    let (spec, table) = (spec.clone(), Some(file.clone()));
    let outcome = child::run(&Job { spec, tau, portals, keep_solid, threads: args.threads, table }, &limits);
    let table = match outcome {
        Outcome::Done(_) => Some(Table::from_bytes(&std::fs::read(&file)?)?),
        _ => None,
    };
    Ok((outcome, table))
}

/// What the data folder says was seen, with and without the insides of solid things as cells.
fn recorded(
    args: &Args,
    spec: &SceneSpec,
    folder: &Path,
    without: Option<&Table>,
    report: &mut Report,
) -> Result<(), Box<dyn std::error::Error>> {
    let SceneSpec::File(path) = spec else { return Ok(()) };
    let Some(own) = path.parent().filter(|p| p.is_dir()) else { return Ok(()) };
    let witness = scene_witness(own);
    let (Some(&tau), Some(&portals)) = (args.taus.first(), args.portals.last()) else { return Ok(()) };
    if witness.is_empty() {
        return Ok(());
    }
    if report.recorded.is_empty() {
        report.recorded = "\nWhat the data folder says was seen, as pairs of a place and an object:\n\n\
             | scene | solid cells | places | in no cell | seen | hidden | hidden, by place |\n\
             | --- | --- | --: | --: | --: | --: | --- |\n"
            .to_owned();
    }
    let mut line = |name: &str, found: Option<Hidden>| {
        let _ = match found {
            Some(h) => writeln!(
                report.recorded,
                "| {} | {name} | {} | {} | {} | {} | {} |",
                spec.name(),
                witness.len(),
                h.n_places_outside,
                h.n_seen,
                h.n_hidden(),
                places(&h)
            ),
            None => writeln!(report.recorded, "| {} | {name} | {} | | | no table | |", spec.name(), witness.len()),
        };
    };
    line("left out", without.map(|table| compare(table, &witness)));
    let (_, with) = bake(args, spec, folder, tau, portals, true)?;
    line("kept", with.map(|table| compare(&table, &witness)));
    Ok(())
}

/// The first places from which something is hidden.
fn places(hidden: &Hidden) -> String {
    let some = hidden.hidden.iter().take(4).map(|(place, objects)| format!("{place}: {objects:?}"));
    let more = hidden.hidden.len().saturating_sub(4);
    let tail = (more > 0).then(|| format!("and {more} places more"));
    some.chain(tail).collect::<Vec<_>>().join("; ")
}

fn print_missing(row: &Row, missing: &[Missing]) {
    for m in missing.iter().take(SHOWN) {
        let pair = match m.pair {
            Pair::Object(cell, object) => format!("cell {cell} sees object {object}"),
            Pair::Cells(a, b) => format!("cells {a} and {b} see each other"),
        };
        let (tau, portals) = (row.tau, row.portals);
        eprintln!(
            "MISSING {} tau {tau} {portals}: {pair}, on line {} through {:?} along {:?}",
            row.scene, m.ray, m.origin, m.direction
        );
    }
}

/// A table that lacks a pair is found out, or this bench could not fail.
fn impostor(scene: &Scene, tables: &[Table], options: &RayOptions) {
    let table = tables.last().expect("the small tower is baked");
    let mut parts = table.clone().into_parts();
    let seen = parts.objects_seen.as_mut().expect("tables of scenes say which objects are seen");
    for (cell, own) in parts.cell_objects.iter().enumerate() {
        // What touches a cell cannot be taken out.
        (0..parts.objects.len()).filter(|o| !own.contains(&ObjectId(*o as u32))).for_each(|o| seen.set(cell, o, false));
    }
    let spoilt = Table::new(parts).unwrap_or_else(|e| panic!("{e}"));
    let verdicts = judge(scene, &[spoilt], options);
    assert!(!verdicts.tables[0].missing.is_empty(), "a table without what is seen from afar is found out");
}

fn outcome_name(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Done(m) => format!("{} cells in {:.2} s", m.n_cells, m.cut + m.see),
        Outcome::TimedOut(limit) => format!("stopped after {:.0} s", limit.as_secs_f64()),
        Outcome::TooLarge(bytes) => format!("stopped at {} MiB", bytes >> 20),
        Outcome::Failed => "failed".to_owned(),
    }
}

/// The names of the columns, for people and for programs.
const COLUMNS: [(&str, &str); 20] = [
    ("scene", "scene"),
    ("tau", "tau"),
    ("portals", "portals"),
    ("triangles", "triangles"),
    ("objects", "objects"),
    ("cells", "cells"),
    ("doors", "portals"),
    ("cut_s", "cut, s"),
    ("see_s", "see, s"),
    ("peak_mib", "peak, MiB"),
    ("reported", "reported (cell, object)"),
    ("witnessed", "witnessed"),
    ("over", "over-estimation"),
    ("dark_cells", "dark cells"),
    ("over_lit", "over-estimation, not dark"),
    ("everything", "reported, of all"),
    ("cells_over", "over-estimation, cells"),
    ("share", "viewer's triangles"),
    ("sampled_share", "sampled lower bound"),
    ("missing", "missing"),
];

/// The columns of a row, as text; percentages and seconds with as many digits as `exact` asks for.
fn fields(row: &Row, exact: bool) -> Vec<String> {
    let head = [row.scene.clone(), row.tau.to_string(), row.portals.to_owned()];
    let mut out = head.to_vec();
    let Outcome::Done(m) = row.outcome else {
        out.push(outcome_name(&row.outcome));
        out.resize(COLUMNS.len(), String::new());
        return out;
    };
    let Measured { n_triangles, n_objects, n_cells, n_portals, cut, see, peak, .. } = m;
    out.extend([n_triangles, n_objects, n_cells, n_portals].map(|n| n.to_string()));
    out.extend([cut, see].map(|s| format!("{s:.3}")));
    out.push((peak >> 20).to_string());
    if let Some(v) = &row.verdict {
        let share = |x: f64| if exact { format!("{x:.6}") } else { format!("{:.2} %", 100.0 * x) };
        let ratio = |x: f64| if x.is_finite() { format!("{x:.3}") } else { String::new() };
        let all = (n_cells * n_objects).max(1) as f64;
        out.extend([v.n_objects_reported, v.n_objects_witnessed].map(|n| n.to_string()));
        out.push(ratio(v.over_estimation()));
        out.push(v.n_dark_cells.to_string());
        out.push(ratio(v.over_estimation_lit()));
        out.push(share(v.n_objects_reported as f64 / all));
        out.push(ratio(v.n_cells_reported as f64 / v.n_cells_witnessed as f64));
        out.extend([v.reported_share, v.witnessed_share].map(share));
        out.push(v.missing.len().to_string());
    }
    out.resize(COLUMNS.len(), String::new());
    out
}

fn markdown(rows: &[Row]) -> String {
    let line = |fields: Vec<String>| format!("| {} |\n", fields.join(" | "));
    let mut text = line(COLUMNS.iter().map(|c| c.1.to_owned()).collect());
    text += &line(COLUMNS.iter().enumerate().map(|(i, _)| if i < 3 { "---" } else { "--:" }.to_owned()).collect());
    rows.iter().for_each(|row| text += &line(fields(row, false)));
    text
}

fn csv(rows: &[Row]) -> String {
    let mut text = COLUMNS.map(|c| c.0).join(",") + "\n";
    rows.iter().for_each(|row| text += &(fields(row, true).join(",") + "\n"));
    text
}
