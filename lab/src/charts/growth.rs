//! Time and memory against the size of scenes, with fitted exponents; each run in a process of its own.

use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::bake::{PlanBakeOptions, SceneBakeOptions, bake_plan, bake_scene};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use sightlines_benches::chart::{Panel, Point, Series, exponent};
use sightlines_benches::child::serve_jobs;
use sightlines_benches::measure::{SHORT, peak, timed};
use sightlines_benches::quake::MapSpec;
use std::process::{Command, Stdio};

const NAME: &str = "growth";
/// First argument of a process that runs one job and says what it took.
const JOB: &str = "--growth-job";

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// How many cells a scene has, how many pairs of different cells see each other, and how many seconds it took.
type Took = (u64, u64, f64);

/// A kind of scenes that grows.
struct Kind {
    name: &'static str,
    size_of: &'static str,
    quick: &'static [u32],
    full: &'static [u32],
    /// Bakes one of such a size.
    run: fn(u32) -> Result<Took, Failure>,
}

const KINDS: [Kind; 3] = [
    Kind { name: "towers", size_of: "floors", quick: &[1, 2, 4], full: &[1, 2, 4, 8, 16, 32, 64], run: of_tower },
    Kind {
        name: "office plans",
        size_of: "rooms",
        quick: &[4, 16, 64],
        full: &[4, 16, 64, 256, 1024, 4096],
        run: of_plan,
    },
    Kind {
        name: "Quake-like worlds",
        size_of: "rooms",
        quick: &[4, 8, 16],
        full: &[4, 8, 16, 32, 64, 128],
        run: of_world,
    },
];

/// Time and memory against the size of scenes.
#[derive(Debug, Clone, Copy)]
pub struct Growth;

impl Family for Growth {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Growth: time and memory against the size of scenes"
    }

    fn about(&self) -> &'static str {
        "Whole bakes on one thread, each in a process of its own: towers with furniture, cut into boxes; office plans, cut into polygons; \
         generated levels of convex cells. Time is to cut, to compute visibility and to make the table; of the levels, whose cells are there already, only to \
         decide. Memory is the most that the process had in use, the scene, the program and its table included, so that small scenes show the program's own. Exponents are fitted by least squares of \
         logarithms, for all sizes and for the larger half of them; 1 is linear. Cells that see each other grow too: a table of n cells has n² bits."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for kind in &KINDS {
            for &size in settings.pick(kind.quick, kind.full) {
                rows.push(one(settings, kind, size)?);
            }
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        let panel = |kind: &Kind, title: &str, unit: &str, y: &dyn Fn(&Row) -> Option<f64>| {
            let of_kind: Vec<&Row> = rows.iter().filter(|r| r.scene == kind.name).collect();
            let at = |r: &&Row| Some([r.size as f64, y(r)?]);
            let points: Vec<[f64; 2]> = of_kind.iter().filter_map(at).collect();
            let larger = &points[points.len() / 2..];
            let fit = |points: &[[f64; 2]], what: &str| {
                exponent(points).map_or_else(|| "too few points".to_owned(), |b| format!("{what}: size^{b:.2}"))
            };
            let series = |name: String, slot: usize, points: &[[f64; 2]]| Series {
                name,
                slot,
                points: points.iter().map(|&at| Point { at, is_unsafe: false }).collect(),
                is_joined: true,
            };
            Panel {
                title: format!("{}: {title}", kind.name),
                names: [kind.size_of.to_owned(), unit.to_owned()],
                series: vec![series(fit(&points, "all"), 0, &points), series(fit(larger, "larger half"), 1, larger)],
                has_front: false,
            }
        };
        let both = |kind: &Kind| {
            [
                panel(kind, "time", "seconds on one thread", &|r| r.seconds),
                panel(kind, "memory", "MiB at most", &|r| Some(r.bytes? as f64 / f64::from(1 << 20))),
            ]
        };
        KINDS.iter().flat_map(both).collect()
    }
}

/// If this process was started to run one job, runs it and ends; else does nothing. To be called first by the program.
pub fn serve() {
    let run = |kind: &str, size: &str| -> Result<String, Failure> {
        let kind = KINDS.iter().find(|k| k.name == kind).ok_or("no such kind of scenes")?;
        let (n_cells, n_pairs, seconds) = (kind.run)(size.parse()?)?;
        Ok(format!("{n_cells} {n_pairs} {seconds} {}", peak()))
    };
    serve_jobs(JOB, |args| {
        let [kind, size] = args else { return Err("a job has two parts".into()) };
        run(kind, size).map_err(|error| -> Box<dyn std::error::Error> { error })
    });
}

/// One run; short ones again, of which the quickest counts.
fn one(settings: &Settings, kind: &Kind, size: u32) -> Result<Row, ChartError> {
    let name = format!("{} of {size} {}", kind.name, kind.size_of);
    let failed = |e: Failure| ChartError::measure(NAME, &name, e);
    let run = || -> Result<[f64; 4], Failure> {
        let mut command = Command::new(std::env::current_exe()?);
        let output = command.args([JOB, kind.name, &size.to_string()]).stderr(Stdio::inherit()).output()?;
        let text = String::from_utf8_lossy(&output.stdout);
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        let numbers = <[f64; 4]>::try_from(numbers).ok().filter(|_| output.status.success());
        numbers.ok_or_else(|| format!("a job ended with {}", output.status).into())
    };
    let mut best = run().map_err(failed)?;
    let mut repeats = 1;
    while repeats < settings.pick(2, 5) && best[2] < SHORT {
        let again = run().map_err(failed)?;
        best = if again[2] < best[2] { again } else { best };
        repeats += 1;
    }
    let [n_cells, n_pairs, seconds, peak] = best;
    Ok(Row {
        size: u64::from(size),
        size_of: kind.size_of.to_owned(),
        repeats,
        seconds: Some(seconds),
        reported: Some(n_pairs as u64),
        bytes: (peak > 0.0).then_some(peak as u64),
        note: format!("{n_cells} cells"),
        ..settings.row(NAME, "shipped", kind.name)
    })
}

fn of_tower(floors: u32) -> Result<Took, Failure> {
    let scene = tower(TowerOptions { floors, ..TowerOptions::default() })?;
    let options = SceneBakeOptions { threads: 1, ..SceneBakeOptions::default() };
    let (baked, seconds) = timed(|| bake_scene(&scene, &options));
    let baked = baked?;
    Ok((baked.table.n_cells() as u64, 2 * baked.report.n_visible_pairs, seconds))
}

fn of_plan(rooms: u32) -> Result<Took, Failure> {
    let side = f64::from(rooms).sqrt().round() as u32;
    let plan = office(OfficeOptions { rooms_x: side, rooms_y: rooms / side, ..OfficeOptions::default() })?;
    let (baked, seconds) = timed(|| bake_plan(&plan, &PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() }));
    let table = baked?.table;
    let rows = &table.parts().rows;
    Ok((table.n_cells() as u64, rows.count_ones() - rows.n_rows() as u64, seconds))
}

fn of_world(rooms: u32) -> Result<Took, Failure> {
    // Two floors; as square as can be.
    let per_floor = rooms / 2;
    let wide = (1..=per_floor).filter(|w| per_floor.is_multiple_of(*w) && w * w <= per_floor).max().unwrap_or(1);
    let graph = format!("world:1:{}:{wide}:2", per_floor / wide).parse::<MapSpec>()?.graph()?;
    let (seen, seconds) = timed(|| {
        let mut search = ConvexSearch::new(&graph, ConvexOptions { fast: false, threads: 1 });
        while search.advance() {}
        search.finish()
    });
    let n = graph.n_cells() as u64;
    Ok((n, seen.cells.count_ones() - n, seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_grows() {
        for kind in &KINDS {
            let [small, large] = [kind.quick[0], kind.quick[1]].map(|size| (kind.run)(size).unwrap());
            assert!(small.0 < large.0 && small.1 < large.1 && small.1 > small.0, "{}: {small:?} {large:?}", kind.name);
        }
    }

    #[test]
    fn exponents_are_in_the_legend() {
        let row = |size: u64| Row {
            scene: "towers".into(),
            size,
            seconds: Some((size * size) as f64),
            bytes: Some(size << 20),
            ..Row::default()
        };
        let rows: Vec<Row> = [1, 2, 4, 8].map(row).to_vec();
        let panels = Growth.panels(&rows);
        assert_eq!(panels.len(), 6);
        let names: Vec<&str> = panels[..2].iter().flat_map(|p| &p.series).map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["all: size^2.00", "larger half: size^2.00", "all: size^1.00", "larger half: size^1.00"]);
    }
}
