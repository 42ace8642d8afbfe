//! One bake in a process of its own, so that its peak of memory is its own and it can be stopped.

use crate::measure::{memory_of, peak};
use crate::spec::SceneSpec;
use sightlines::bake::{PortalMode, SceneBakeOptions, bake_scene};
use sightlines::kdtree::SceneOptions;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// First argument of a process that bakes one scene and says what it took.
const BAKE: &str = "--bake-job";
/// How often a running bake is looked at.
const WATCH: Duration = Duration::from_millis(20);

/// What to bake, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The scene.
    pub spec: SceneSpec,
    /// Obscuration threshold of the k-d tree.
    pub tau: f64,
    /// Portals that the search goes through.
    pub portals: PortalMode,
    /// Whether the insides of solid things stay cells.
    pub keep_solid: bool,
    /// Number of threads; 0 for one for each core.
    pub threads: usize,
    /// Where to write the table, if anywhere.
    pub table: Option<PathBuf>,
}

/// How much a bake may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Wall-clock time.
    pub time: Duration,
    /// Memory in use, in bytes; looked at now and then.
    pub memory: u64,
}

/// What a bake took and found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Measured {
    /// Triangles of the scene.
    pub n_triangles: u64,
    /// Objects of the scene.
    pub n_objects: u64,
    /// Cells of the table.
    pub n_cells: u64,
    /// Portals of the table.
    pub n_portals: u64,
    /// Unordered pairs of different cells that see each other.
    pub n_cell_pairs: u64,
    /// Pairs of a cell and an object that it sees.
    pub n_object_pairs: u64,
    /// Seconds to cut.
    pub cut: f64,
    /// Seconds to decide who sees what.
    pub see: f64,
    /// Most bytes in use at once after the bake, scene and table included; 0 where the system does not tell.
    pub peak: u64,
    /// Bytes of the table as a file.
    pub table_bytes: u64,
}

/// How a bake ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// With a table.
    Done(Measured),
    /// Stopped after so long.
    TimedOut(Duration),
    /// Stopped with so many bytes in use.
    TooLarge(u64),
    /// With an error, which is on standard error; or by a signal.
    Failed,
}

/// The name of a portal mode on command lines and in tables.
pub fn portals_name(mode: PortalMode) -> &'static str {
    match mode {
        PortalMode::Bounding => "bounding",
        PortalMode::Exact => "exact",
    }
}

/// The portal mode with a name.
///
/// # Errors
/// What to write instead.
pub fn portals_of(name: &str) -> Result<PortalMode, String> {
    let modes = [PortalMode::Bounding, PortalMode::Exact];
    let found = modes.into_iter().find(|m| portals_name(*m) == name);
    found.ok_or_else(|| "neither bounding nor exact".to_owned())
}

/// If this process was started by [`run`], bakes, answers and ends; else does nothing. To be called first by
/// every program that runs jobs.
pub fn serve() {
    serve_jobs(BAKE, |args| answer(args).map(|measured| to_text(&measured)));
}

/// If this process was started with `word` as its first argument, prints what `answer` makes of the others and ends;
/// else does nothing.
pub fn serve_jobs(word: &str, answer: impl Fn(&[String]) -> Result<String, Box<dyn std::error::Error>>) {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if args.first().is_none_or(|a| a != word) {
        return;
    }
    let code = match answer(&args[1..]) {
        Ok(text) => {
            print!("{text}");
            0
        }
        Err(error) => {
            eprintln!("{error}");
            2
        }
    };
    std::process::exit(code);
}

fn answer(args: &[String]) -> Result<Measured, Box<dyn std::error::Error>> {
    let [spec, tau, portals, keep_solid, threads, table] = args else { return Err("a job has six parts".into()) };
    let job = Job {
        spec: spec.parse()?,
        tau: tau.parse()?,
        portals: portals_of(portals)?,
        keep_solid: keep_solid.parse()?,
        threads: threads.parse()?,
        table: (table != "-").then(|| table.into()),
    };
    bake(&job)
}

/// Bakes in this process, and writes the table if that was asked for.
///
/// # Errors
/// Scenes that cannot be loaded or baked, and files that cannot be written.
pub fn bake(job: &Job) -> Result<Measured, Box<dyn std::error::Error>> {
    let scene = job.spec.load()?;
    let cut = SceneOptions { tau: job.tau, keep_solid: job.keep_solid, ..SceneOptions::default() };
    let options = SceneBakeOptions { cut, portals: job.portals, threads: job.threads, ..SceneBakeOptions::default() };
    let baked = bake_scene(&scene, &options).map_err(|error| format!("{}: {error}", job.spec))?;
    // Before the table is written: only a program that writes files pays for that.
    let peak = peak();
    let bytes = baked.table.to_bytes();
    if let Some(path) = &job.table {
        std::fs::write(path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(Measured {
        n_triangles: scene.n_triangles() as u64,
        n_objects: scene.objects().len() as u64,
        n_cells: baked.table.n_cells() as u64,
        n_portals: baked.table.portals().len() as u64,
        n_cell_pairs: baked.report.n_visible_pairs,
        n_object_pairs: baked.report.n_objects_seen,
        cut: baked.report.cut_time.as_secs_f64(),
        see: baked.report.see_time.as_secs_f64(),
        peak,
        table_bytes: bytes.len() as u64,
    })
}

/// Bakes in a process of its own: this program again, whose `main` calls [`serve`] first.
pub fn run(job: &Job, limits: &Limits) -> Outcome {
    let Ok(program) = std::env::current_exe() else { return Outcome::Failed };
    let table = job.table.as_deref().unwrap_or(Path::new("-"));
    let mut command = Command::new(program);
    command.args([BAKE, &job.spec.to_string(), &job.tau.to_string(), portals_name(job.portals)]);
    command.args([job.keep_solid.to_string(), job.threads.to_string()]).arg(table).stdout(Stdio::piped());
    match command.spawn() {
        Ok(child) => watch(child, limits),
        Err(error) => {
            eprintln!("{command:?}: {error}");
            Outcome::Failed
        }
    }
}

/// Waits for a bake, and ends it where it takes too much.
fn watch(mut child: Child, limits: &Limits) -> Outcome {
    let start = Instant::now();
    let id = child.id().to_string();
    loop {
        let memory = memory_of(&id, "VmRSS:").unwrap_or(0);
        let stop = if start.elapsed() > limits.time {
            Some(Outcome::TimedOut(limits.time))
        } else if memory > limits.memory {
            Some(Outcome::TooLarge(memory))
        } else {
            None
        };
        if let Some(outcome) = stop {
            // It may have ended by itself just now, which is as good.
            let _ = child.kill();
            let _ = child.wait();
            return outcome;
        }
        match child.try_wait() {
            Ok(Some(_)) => break,
            Ok(None) => std::thread::sleep(WATCH),
            Err(_) => return Outcome::Failed,
        }
    }
    let Ok(output) = child.wait_with_output() else { return Outcome::Failed };
    let measured = output.status.success().then(|| from_text(&String::from_utf8_lossy(&output.stdout))).flatten();
    measured.map_or(Outcome::Failed, Outcome::Done)
}

fn to_text(m: &Measured) -> String {
    let counts = [m.n_triangles, m.n_objects, m.n_cells, m.n_portals, m.n_cell_pairs, m.n_object_pairs];
    let names = ["triangles", "objects", "cells", "portals", "cell_pairs", "object_pairs"];
    let mut text: String = names.iter().zip(counts).map(|(name, n)| format!("{name} {n}\n")).collect();
    text += &format!("cut {}\nsee {}\npeak {}\ntable_bytes {}\n", m.cut, m.see, m.peak, m.table_bytes);
    text
}

fn from_text(text: &str) -> Option<Measured> {
    let values: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(' ')).collect();
    let count = |key: &str| values.get(key)?.parse::<u64>().ok();
    let seconds = |key: &str| values.get(key)?.parse::<f64>().ok();
    Some(Measured {
        n_triangles: count("triangles")?,
        n_objects: count("objects")?,
        n_cells: count("cells")?,
        n_portals: count("portals")?,
        n_cell_pairs: count("cell_pairs")?,
        n_object_pairs: count("object_pairs")?,
        cut: seconds("cut")?,
        see: seconds("see")?,
        peak: count("peak")?,
        table_bytes: count("table_bytes")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read_back() {
        let spec = "tower:1:1:1:0".parse().unwrap();
        let job = Job { spec, tau: 0.0, portals: PortalMode::Bounding, keep_solid: false, threads: 1, table: None };
        let measured = bake(&job).unwrap();
        assert!(measured.n_cells > 1 && measured.n_object_pairs > measured.n_cells, "{measured:?}");
        let text = to_text(&measured);
        assert_eq!(from_text(&text), Some(measured));
        assert_eq!(from_text(text.strip_suffix("\n").unwrap().rsplit_once('\n').unwrap().0), None);
    }

    #[test]
    fn jobs_that_make_no_sense_are_refused() {
        let answer = |args: [&str; 6]| answer(&args.map(str::to_owned)).map_err(|e| e.to_string());
        assert!(answer(["tower:1:1:1:0", "0", "exact", "false", "1", "-"]).is_ok());
        assert!(answer(["no-such-file.glb", "0", "exact", "false", "1", "-"]).unwrap_err().contains("no-such-file"));
        assert!(answer(["tower:1:1:1:0", "2", "exact", "false", "1", "-"]).unwrap_err().starts_with("tower:1:1:1:0"));
        assert!(answer(["tower:1:1:1:0", "0", "wide", "false", "1", "-"]).is_err());
    }

    /// A process that does nothing but wait stands in for a bake that takes too long.
    #[test]
    fn bakes_that_take_too_much_are_stopped() {
        let sleeper = || Command::new("sleep").arg("60").stdout(Stdio::piped()).spawn();
        let Ok(child) = sleeper() else { return eprintln!("SKIPPED: there is no program called sleep") };
        let short = Limits { time: Duration::from_millis(50), memory: u64::MAX };
        assert_eq!(watch(child, &short), Outcome::TimedOut(short.time));
        if memory_of("self", "VmRSS:").is_some() {
            let tight = Limits { time: Duration::from_secs(60), memory: 1 };
            assert!(matches!(watch(sleeper().unwrap(), &tight), Outcome::TooLarge(_)));
        }
    }
}
