//! What Slurm says of its queue and its nodes, and what it is told.

use super::{EngineError, POLL};
use std::collections::HashSet;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// How often Slurm may fail to take a job, a poll apart: its controller may be starting again.
const PATIENCE: usize = 60;
/// How many polls lie between two looks at tasks and nodes.
const TICKS: usize = 10;
/// At so many looks in a row nothing of an array may be going on before it is given up.
const STUCK: usize = 8;

/// Asks a program of Slurm.
fn ask(program: &str, words: &[&str]) -> Result<Output, EngineError> {
    let asked = Command::new(program).args(words).stdin(Stdio::null()).output();
    asked.map_err(|source| EngineError::start(program, source))
}

/// Queues a script; the number of the job. Tries for a while: the controller may be starting again.
pub(super) fn sbatch(script: &Path, after: Option<&str>, stop: fn() -> bool) -> Result<String, EngineError> {
    let mut last = String::new();
    for _ in 0..PATIENCE {
        let mut command = Command::new("sbatch");
        command.arg("--parsable").stdin(Stdio::null());
        if let Some(after) = after {
            // Whatever became of the shards: the merge finds out what is missing.
            command.arg(format!("--dependency=afterany:{after}"));
        }
        let done = command.arg(script).output().map_err(|source| EngineError::start("sbatch", source))?;
        let text = String::from_utf8_lossy(&done.stdout);
        if done.status.success() {
            return Ok(text.trim().split(';').next().unwrap_or_default().to_owned());
        }
        last = String::from_utf8_lossy(&done.stderr).trim().to_owned();
        if !is_of_controller(&last) || stop() {
            break;
        }
        std::thread::sleep(POLL);
    }
    Err(EngineError::Failed { name: "sbatch".to_owned(), message: last })
}

/// Cancels jobs, as far as Slurm can.
pub(super) fn cancel(jobs: &[&str]) {
    // If it cannot be asked, the jobs end by themselves.
    let _ = ask("scancel", jobs);
}

/// Whether Slurm knows, and knows nothing of these jobs any more. Nothing follows from silence.
pub(super) fn is_gone(jobs: &[&str]) -> Result<bool, EngineError> {
    let asked = ask("squeue", &["-h", "-o", "%i", "-j", &jobs.join(",")])?;
    let said = String::from_utf8_lossy(&asked.stderr);
    Ok(match asked.status.success() {
        true => asked.stdout.iter().all(u8::is_ascii_whitespace),
        false => said.contains("Invalid job id"),
    })
}

/// Whether Slurm says that a job waits.
pub(super) fn is_pending(job: &str) -> Result<bool, EngineError> {
    let asked = ask("squeue", &["-h", "-o", "%T", "-j", job])?;
    Ok(asked.status.success() && asked.stdout.trim_ascii() == b"PENDING")
}

/// Whether a message is about a controller that does not answer.
fn is_of_controller(message: &str) -> bool {
    ["Unable to contact slurm controller", "timed out", "Connection refused", "Zero Bytes were transmitted"]
        .iter()
        .any(|text| message.contains(text))
}

/// Watches an array for tasks that will never end.
#[derive(Debug, Default)]
pub(super) struct Watch {
    n_polls: usize,
    /// How often in a row there was nothing else, and what there was.
    n_stuck: usize,
    stuck: Vec<String>,
}

impl Watch {
    /// Looks at an array, now and then; the tasks that are left of it, if all of them have been stuck for a while.
    pub(super) fn look(&mut self, array: &str) -> Option<Vec<String>> {
        self.n_polls += 1;
        if !self.n_polls.is_multiple_of(TICKS) {
            return None;
        }
        let text = |program, words: &[&str]| {
            let asked = ask(program, words).ok().filter(|asked| asked.status.success())?;
            Some(String::from_utf8_lossy(&asked.stdout).into_owned())
        };
        let tasks = text("squeue", &["-h", "-r", "-o", "%i|%T|%N|%r", "-j", array]);
        let nodes = text("sinfo", &["-h", "-N", "-o", "%N|%T"]);
        // Nothing follows from silence.
        let stuck = tasks.zip(nodes).and_then(|(tasks, nodes)| stuck(&tasks, &nodes)).unwrap_or_default();
        self.saw(stuck)
    }

    fn saw(&mut self, stuck: Vec<String>) -> Option<Vec<String>> {
        self.n_stuck = match (stuck.is_empty(), stuck == self.stuck) {
            (true, _) => 0,
            (false, true) => self.n_stuck + 1,
            (false, false) => 1,
        };
        self.stuck = stuck;
        (self.n_stuck >= STUCK).then(|| std::mem::take(&mut self.stuck))
    }
}

/// Why a task waits that nothing will start.
const NEVER: [&str; 5] = [
    "launch failed requeued held",
    "JobHeldAdmin",
    "job requeued in held state",
    "BadConstraints",
    "DependencyNeverSatisfied",
];

/// The tasks of an array, if there are any and none of them will end: they are on nodes that do not answer, or nothing will start them.
///
/// * `tasks`: a line for each: its number, its state, its nodes and why it waits, with `|` between them
/// * `nodes`: a line for each: its name and its state
fn stuck(tasks: &str, nodes: &str) -> Option<Vec<String>> {
    let (mut dead, mut alive) = (HashSet::new(), HashSet::new());
    for (node, state) in nodes.lines().filter_map(|line| line.trim().split_once('|')) {
        // A star stands for a node that does not answer.
        let is_dead = state.ends_with('*') || ["down", "fail", "unknown", "powered_down"].contains(&state);
        if is_dead { &mut dead } else { &mut alive }.insert(node);
    }
    let mut found = Vec::new();
    for line in tasks.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let mut words = line.splitn(4, '|');
        let (id, state, node, reason) = (words.next()?, words.next()?, words.next()?, words.next()?);
        let is_stuck = match state {
            "PENDING" => NEVER.iter().any(|never| reason.contains(never)),
            // A task has one node, unless options for sbatch say otherwise; then nothing is known.
            _ => dead.contains(node) && !alive.contains(node),
        };
        if !is_stuck {
            return None;
        }
        found.push(format!("{id} ({})", if state == "PENDING" { reason } else { state }));
    }
    found.sort();
    (!found.is_empty()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn controllers_that_start_again_are_waited_for() {
        let away = "sbatch: error: Batch job submission failed: Unable to contact slurm controller (connect failure)";
        assert!(is_of_controller(away) && !is_of_controller("sbatch: error: invalid partition specified: x"));
    }

    #[test]
    fn tasks_of_dead_nodes_are_stuck_and_others_are_not() {
        let nodes = "w0|mixed\nw1|down*\nw2|idle*\nw3|down\n";
        let of = |tasks: &str| stuck(tasks, nodes);
        assert_eq!(of("7_3|RUNNING|w1|None\n"), Some(vec!["7_3 (RUNNING)".to_owned()]));
        let all = "7_3|COMPLETING|w2|NonZeroExitCode\n7_1|RUNNING|w3|None\n7_4|PENDING||launch failed requeued held\n";
        assert_eq!(of(all).map(|all| all.len()), Some(3));
        // One that goes on, or may begin, is waited for.
        for line in
            ["7_5|RUNNING|w0|None", "7_5|PENDING||Resources", "7_5|PENDING||BeginTime", "7_5|PENDING||JobHeldUser"]
        {
            assert_eq!(of(&format!("{all}{line}\n")), None, "{line}");
        }
        // An empty queue, a node that nobody knows, and what is no answer.
        assert_eq!((of(""), of("7_3|RUNNING|w9|None"), of("slurm_load_jobs error")), (None, None, None));
    }

    #[test]
    fn only_what_stays_stuck_is_given_up() {
        let mut watch = Watch::default();
        let task = || vec!["7_3 (RUNNING)".to_owned()];
        for _ in 1..STUCK {
            assert_eq!(watch.saw(task()), None);
        }
        assert_eq!(watch.saw(Vec::new()), None);
        for _ in 1..STUCK {
            assert_eq!(watch.saw(task()), None);
        }
        assert_eq!(watch.saw(task()), Some(task()));
    }
}
