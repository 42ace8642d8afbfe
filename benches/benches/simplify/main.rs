//! Simplification by what triangles intercept: how much is left at a budget, what fresh rays find changed, and the ordinary metric of shape
//! at equal counts.
//!
//! Measuring and drawing are two steps: `--csv` keeps what was measured, `--draw` makes a chart of such a file, always the same. Ends with 1
//! if a bound is above its budget, or if more is found changed than was promised.

mod cases;
mod measured;
#[cfg(feature = "meshopt")]
mod meshopt;

use clap::Parser;
use measured::Row;
use sightlines::simplify::{HiddenBy, PreparedScene, SimplifyOptions};
use sightlines_benches::chart::{Panel, Series, svg};
use sightlines_benches::program::{Common, Files, read_csv, write_csv};
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

/// Simplification for a volume of viewpoints.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Scenes, of: tower, city, and names of real scenes with the file of their cells.
    #[arg(long, value_delimiter = ',', default_values_t = ["tower", "city", "sponza:cells_walk"].map(str::to_owned))]
    scenes: Vec<String>,
    /// Views of each scene.
    #[arg(long, default_value_t = 2)]
    views: usize,
    /// Budgets.
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 1e-4, 1e-3, 1e-2])]
    budgets: Vec<f64>,
    /// Shares of the budget that are kept for collapsing.
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 0.5])]
    collapse: Vec<f64>,
    /// Fresh eyes for each measurement.
    #[arg(long, default_value_t = 16)]
    eyes: usize,
    /// Rays from each eye at least; there are more for small budgets.
    #[arg(long, default_value_t = 20_000)]
    rays: u64,
    #[command(flatten)]
    files: Files,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("simplify") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.scenes, args.views, args.eyes, args.rays) = (vec!["small".to_owned()], 1, 4, 2000);
        args.budgets = vec![0.0, 1e-2];
    }
    match run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// Whether every promise was kept.
fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let rows = args.files.rows(read_csv, || measure(args))?;
    if args.common.test {
        check(&rows)?;
    }
    args.files.save_chart(|| chart(&rows))?;
    if args.files.draw.is_none() {
        measured::print(&rows);
    }
    let broken: Vec<&Row> = rows.iter().filter(|r| r.breaks_its_promise()).collect();
    broken.iter().for_each(|r| eprintln!("BROKEN: {r:?}"));
    Ok(broken.is_empty())
}

fn measure(args: &Args) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for name in &args.scenes {
        for case in cases::named(name, args.views)? {
            let make = || case.method();
            let by = HiddenBy { method: Some(&make), table: case.table.as_deref() };
            let start = Instant::now();
            let prepared = PreparedScene::new(&case.scene, &case.views, &by, &SimplifyOptions::default())?;
            let seconds = start.elapsed().as_secs_f64();
            eprintln!("{name}, view {}: {seconds:.1} s to ask what is hidden", case.view);
            for &budget in &args.budgets {
                // Nothing is collapsed without a budget.
                let shares = if budget == 0.0 { &args.collapse[..1] } else { &args.collapse[..] };
                let merged = shares.last().map(|&collapse| (collapse, true));
                for how in shares.iter().map(|&collapse| (collapse, false)).chain(merged) {
                    rows.extend(measured::all(&case, &prepared, budget, how, args.eyes, args.rays)?);
                    args.files.save_rows(|| write_csv(&rows))?;
                }
            }
        }
    }
    Ok(rows)
}

/// Share of triangles left by budget, and what is changed by what is left.
fn chart(rows: &[Row]) -> String {
    let mut scenes: Vec<&str> = rows.iter().map(|r| r.scene.as_str()).collect();
    scenes.dedup();
    let lines = |metric: &str, flat: bool, y: fn(&Row) -> f64| -> Vec<Series> {
        let line = |scene: &&str| {
            let mut points: Vec<[f64; 2]> = rows
                .iter()
                .filter(|r| r.scene == *scene && r.metric == metric && r.flat == flat && r.budget > 0.0)
                .map(|r| [r.budget, y(r)])
                .collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            Series::line(format!("{scene}, {metric}"), points)
        };
        scenes.iter().map(line).collect()
    };
    let panel = |title: &str, series: Vec<Series>| Panel::of_lines(title, "budget", series);
    let left = |r: &Row| r.left as f64 / r.before as f64;
    let panels = [
        panel("share of triangles left", lines("intercepts", false, left)),
        panel("the same, faces in one plane merged", lines("intercepts", true, left)),
        panel("share of rays changed, worst eye", lines("intercepts", false, |r| r.aimed)),
        panel("the same, metric of shape, equal counts", lines("shape", false, |r| r.worst)),
    ];
    svg("Simplification", &panels)
}

/// What must hold of a small scene, whatever the machine.
fn check(rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let ours: Vec<&Row> = rows.iter().filter(|r| r.metric == "intercepts").collect();
    assert!(ours.len() == 5 && rows.len() >= 10, "{} rows", rows.len());
    let (none, some): (Vec<&Row>, Vec<&Row>) = ours.iter().partition(|r| r.budget == 0.0);
    assert!(none.iter().all(|r| r.changed == 0.0) && some.iter().all(|r| r.changed > 0.0), "{ours:?}");
    assert!(some.iter().all(|r| r.left < none[usize::from(r.flat)].left) && none[1].left < none[0].left, "{ours:?}");
    let text = write_csv(rows);
    // Numbers that are none are not equal to themselves.
    assert_eq!(write_csv(&read_csv::<Row>(&text)?), text, "what was measured is read back");
    assert_eq!(chart(&read_csv(&text)?), chart(rows), "the same numbers make the same chart");
    assert!(read_csv::<Row>(&text.replacen("intercepts,", "", 1)).is_err());
    let mut broken = some[0].clone();
    broken.worst = broken.bound * 4.0;
    assert!(broken.breaks_its_promise() && !some[0].breaks_its_promise());
    broken = Row { worst: 0.0, aimed: broken.bound * 1.5, ..broken };
    assert!(broken.breaks_its_promise());
    Ok(())
}
