//! One method on one map, in a process of its own: its time and its peak of memory are its own.

use super::{MapError, MapSpec, matrix_of};
use crate::measure::{CpuClock, Work, peak};
use sightlines::cells::{CellGraph, Convex};
use sightlines::pvs::BitMatrix;
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use sightlines_testkit::convex::{ClassicalLevel, ClassicalOptions, classical};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::str::FromStr;

/// First argument of a process that runs one method and says what it took.
const JOB: &str = "--quake-job";

/// A way to find out which clusters see which.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ClusterMethod {
    /// Only the first, coarse bound of our search.
    Base,
    /// The lines that our search begins with, and nothing else.
    Sampling,
    /// The classical walk with planes between portals, as programs do it.
    Separators,
    /// The same, and of its pairs only those that are found from both ends.
    Symmetric,
    /// Our search to its end.
    Exact,
}

/// All methods, in the order of tables.
pub const METHODS: [ClusterMethod; 5] = [
    ClusterMethod::Base,
    ClusterMethod::Sampling,
    ClusterMethod::Separators,
    ClusterMethod::Symmetric,
    ClusterMethod::Exact,
];

impl ClusterMethod {
    /// What it is called in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Sampling => "sampling",
            Self::Separators => "separators",
            Self::Symmetric => "symmetric",
            Self::Exact => "exact",
        }
    }

    /// What it is called for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Base => "base pass",
            Self::Sampling => "sampling only",
            Self::Separators => "separators only",
            Self::Symmetric => "separators + symmetric",
            Self::Exact => "exact",
        }
    }
}

impl FromStr for ClusterMethod {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = METHODS.into_iter().find(|m| m.name() == text);
        found.ok_or_else(|| format!("not one of {}", METHODS.map(Self::name).join(", ")))
    }
}

impl fmt::Display for ClusterMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a method took and said of itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measured {
    /// Seconds of processor time, user and system together; of the clock where the system does not tell.
    pub cpu: f64,
    /// Seconds by the clock.
    pub wall: f64,
    /// Most bytes in use at once, the map included; 0 where the system does not tell.
    pub peak: u64,
    /// Done share of the whole, below 1 if it was stopped.
    pub done: f64,
    /// What it counted, as `name=value` with spaces between.
    pub counters: String,
}

/// What a method says of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Which clusters see which.
    pub table: BitMatrix,
    /// Pairs of it, lower first, that count as visible without a line that shows it.
    pub undecided: Vec<[u32; 2]>,
}

impl Answer {
    /// The table without what is undecided: of the exact search, pairs that a line joins each.
    pub fn proven(&self) -> BitMatrix {
        let mut table = self.table.clone();
        for [a, b] in self.undecided.iter().map(|pair| pair.map(|cluster| cluster as usize)) {
            table.set(a, b, false);
            table.set(b, a, false);
        }
        table
    }

    fn to_bytes(&self) -> Vec<u8> {
        let rows = (0..self.table.n_rows()).flat_map(|row| self.table.row(row).iter().copied());
        let pairs = self.undecided.iter().map(|&[a, b]| u64::from(a) << 32 | u64::from(b));
        rows.chain(pairs).flat_map(u64::to_le_bytes).collect()
    }

    fn from_bytes(bytes: &[u8], n: usize) -> Option<Self> {
        let words = words_of(bytes);
        let (rows, pairs) = words.split_at_checked(n * n.div_ceil(64))?;
        let undecided: Vec<[u32; 2]> = pairs.iter().map(|&word| [(word >> 32) as u32, word as u32]).collect();
        let fits = undecided.iter().all(|&[a, b]| a < b && (b as usize) < n);
        matrix_of(n, rows).filter(|_| fits).map(|table| Self { table, undecided })
    }
}

/// If this process was started by [`run`], does the job, answers and ends; else does nothing. To be called first by
/// every program that runs jobs.
pub fn serve() {
    crate::child::serve_jobs(JOB, |args| answer(args).map(|measured| to_text(&measured)));
}

fn answer(args: &[String]) -> Result<Measured, Box<dyn std::error::Error>> {
    let [spec, method, threads, limit, file] = args else { return Err("a job has five parts".into()) };
    let graph = spec.parse::<MapSpec>()?.graph()?;
    let (measured, answer) = measure(&graph, method.parse()?, threads.parse()?, limit.parse()?);
    std::fs::write(file, answer.to_bytes()).map_err(|e| format!("{file}: {e}"))?;
    Ok(measured)
}

/// Runs a method in this process; after `limit` seconds of processor time it is stopped at the next occasion, and what
/// is not decided by then counts as visible. The peak is that of the process.
pub fn measure(graph: &CellGraph<Convex>, method: ClusterMethod, threads: usize, limit: f64) -> (Measured, Answer) {
    let clock = CpuClock::start(Work::Threads);
    let took = || clock.elapsed().as_secs_f64();
    let mut measured = Measured { done: 1.0, ..Measured::default() };
    let mut undecided = Vec::new();
    let table = match method {
        ClusterMethod::Separators | ClusterMethod::Symmetric => {
            let level =
                if method == ClusterMethod::Symmetric { ClassicalLevel::Symmetric } else { ClassicalLevel::Separators };
            let options = ClassicalOptions { level, ..ClassicalOptions::default() };
            let seen = classical(graph, options, || took() > limit);
            measured.done = seen.n_finished as f64 / seen.n_gates.max(1) as f64;
            measured.counters = format!("clips={} steps={}", seen.clips, seen.steps);
            matrix_of(graph.n_cells(), &seen.rows.concat()).expect("a row for each cell")
        }
        ClusterMethod::Base | ClusterMethod::Sampling | ClusterMethod::Exact => {
            let options = ConvexOptions { fast: method == ClusterMethod::Base, threads };
            let mut search = ConvexSearch::new(graph, options);
            let is_over = |search: &ConvexSearch| method == ClusterMethod::Sampling && search.state().stage >= 2;
            let mut is_going = true;
            // Nothing is known before the first stage is done.
            while is_going && !is_over(&search) && (search.state().stage == 0 || took() <= limit) {
                is_going = search.advance();
            }
            measured.counters = search.state().counters.named().map(|(k, v)| format!("{k}={v}")).join(" ");
            if method == ClusterMethod::Exact {
                let chain = search.chain();
                measured.counters += &format!(" work={} chain={}", chain.all, chain.longest);
            }
            if is_over(&search) {
                search.state().visible.clone()
            } else if is_going {
                measured.done = search.progress().share;
                search.state().possible.clone()
            } else {
                let seen = search.finish();
                undecided = seen.undecided;
                seen.cells
            }
        }
    };
    measured.cpu = took();
    measured.wall = clock.wall().as_secs_f64();
    // Before the table is written: only a program that writes files pays for that.
    measured.peak = peak();
    (measured, Answer { table, undecided })
}

/// Runs a method in a process of its own: this program again, whose `main` calls [`serve`] first. `file` is where the
/// answer is kept meanwhile.
///
/// # Errors
/// Processes that cannot be started, or fail, which then is on standard error too.
pub fn run(
    spec: &MapSpec,
    (method, threads, limit): (ClusterMethod, usize, f64),
    file: &Path,
    n_clusters: usize,
) -> Result<(Measured, Answer), MapError> {
    let failed = |what: String| MapError::Read(format!("{spec}: {method}: {what}"));
    let program = std::env::current_exe().map_err(|e| failed(e.to_string()))?;
    let mut command = Command::new(program);
    command.args([JOB, &spec.to_string(), method.name(), &threads.to_string(), &limit.to_string()]).arg(file);
    let output = command.stderr(Stdio::inherit()).output().map_err(|e| failed(e.to_string()))?;
    let measured = output.status.success().then(|| from_text(&String::from_utf8_lossy(&output.stdout))).flatten();
    let measured = measured.ok_or_else(|| failed(format!("ended with {}", output.status)))?;
    let bytes = std::fs::read(file).map_err(|e| failed(e.to_string()))?;
    let answer = Answer::from_bytes(&bytes, n_clusters).ok_or_else(|| failed("no table of clusters".to_owned()))?;
    Ok((measured, answer))
}

/// Words with the least byte first.
pub(super) fn words_of(bytes: &[u8]) -> Vec<u64> {
    bytes.chunks_exact(8).map(|b| b.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte))).collect()
}

fn to_text(m: &Measured) -> String {
    let Measured { cpu, wall, peak, done, counters } = m;
    format!("cpu {cpu}\nwall {wall}\npeak {peak}\ndone {done}\ncounters {counters}\n")
}

fn from_text(text: &str) -> Option<Measured> {
    let values: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(' ')).collect();
    let number = |key: &str| values.get(key)?.parse::<f64>().ok();
    let count = |key: &str| values.get(key)?.parse::<u64>().ok();
    let counters = (*values.get("counters")?).to_owned();
    let (cpu, wall, done) = (number("cpu")?, number("wall")?, number("done")?);
    Some(Measured { cpu, wall, peak: count("peak")?, done, counters })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level() -> CellGraph<Convex> {
        "world:1:2:1:1".parse::<MapSpec>().unwrap().graph().unwrap()
    }

    #[test]
    fn answers_are_read_back() {
        let (measured, mut answer) = measure(&level(), ClusterMethod::Exact, 1, f64::INFINITY);
        assert!(
            measured.cpu > 0.0
                && measured.done == 1.0
                && measured.counters.contains("beams=")
                && measured.counters.contains(" chain="),
            "{measured:?}"
        );
        let n = answer.table.n_rows();
        assert!(answer.table.is_symmetric() && answer.table.count_ones() > n as u64);
        answer.undecided = vec![[0, 1], [3, 7]];
        assert_eq!(Answer::from_bytes(&answer.to_bytes(), n).as_ref(), Some(&answer));
        assert_eq!(Answer::from_bytes(&answer.to_bytes()[..8 * (n - 1)], n), None);
        assert!(!answer.proven().get(7, 3) && answer.proven().get(0, 0));
        let text = to_text(&measured);
        assert_eq!(from_text(&text), Some(measured));
        assert_eq!(from_text(text.strip_suffix("\n").unwrap().rsplit_once('\n').unwrap().0), None);
        assert_eq!(words_of(&0x0102_0304_0506_0708u64.to_le_bytes()), [0x0102_0304_0506_0708]);
    }

    #[test]
    fn what_is_stopped_says_how_far_it_came() {
        let graph = level();
        let (exact, Answer { table: seen, .. }) = measure(&graph, ClusterMethod::Exact, 1, f64::INFINITY);
        let (stopped, Answer { table: possible, .. }) = measure(&graph, ClusterMethod::Exact, 1, 0.0);
        assert!(exact.done == 1.0 && stopped.done < 1.0, "{stopped:?}");
        let hidden = |row: usize| possible.row(row).iter().zip(seen.row(row)).any(|(may, seen)| seen & !may != 0);
        assert!(!(0..seen.n_rows()).any(hidden) && possible.count_ones() > seen.count_ones());
    }

    #[test]
    fn jobs_that_make_no_sense_are_refused() {
        let answer = |args: [&str; 5]| answer(&args.map(str::to_owned)).map_err(|e| e.to_string());
        assert!(answer(["no-such-file.prt", "exact", "1", "9", "-"]).unwrap_err().contains("no-such-file"));
        assert!(answer(["world:1:1:1:1", "guess", "1", "9", "-"]).unwrap_err().contains("sampling"));
        assert!(answer(["world:1:1:1:1", "exact", "one", "9", "-"]).is_err());
    }
}
