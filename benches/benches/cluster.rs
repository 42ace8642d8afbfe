//! What a cluster would give: workers that share units of work, simulated from the times that the units took.
//!
//! Workers claim shards as those of `job work` do: as many at once as [`batch`] says, in the order of shards. Each prepares first, and goes through all results in the end.
//! Machines of the cluster count as fast as the one that was measured, and the folder that they share as free of waiting.

use clap::Parser;
use sightlines::checkpoint::{batch, cut};
use sightlines_benches::program::{Common, exit};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

/// Workers that share units of work.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// What a bake has said with `-v`: lines that end in `NAME: SECONDS s`, one for each unit.
    #[arg(long)]
    log: Option<PathBuf>,
    /// Seconds that each worker prepares.
    #[arg(long, default_value_t = 0.0)]
    prepare: f64,
    /// Seconds that each worker takes to go through all results.
    #[arg(long, default_value_t = 0.0)]
    merge: f64,
    /// Shards, at most.
    #[arg(long, default_value_t = 100_000)]
    shards: usize,
    /// Numbers of workers.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 10, 100, 1000])]
    workers: Vec<usize>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("cluster") {
        return ExitCode::SUCCESS;
    }
    exit(run(&args))
}

/// The times of units in a log.
fn times(log: &str) -> Vec<f64> {
    let time = |line: &str| line.strip_suffix(" s")?.rsplit_once(": ")?.1.parse().ok();
    log.lines().filter_map(time).collect()
}

/// Units in shards, all of the same cost as far as anybody knows before.
fn shards_of(times: &[f64], most: usize) -> Vec<f64> {
    cut(&vec![1.0; times.len()], most).iter().map(|shard| times[shard.begin..shard.end].iter().sum()).collect()
}

/// When the last worker has done its last shard, if all begin after `prepare` seconds.
fn makespan(shards: &[f64], n_workers: usize, prepare: f64) -> f64 {
    // Who is free first, in billionths of a second: numbers that can be ordered.
    let ticks = |seconds: f64| (seconds * 1e9) as u64;
    let mut free: BinaryHeap<Reverse<u64>> = (0..n_workers).map(|_| Reverse(ticks(prepare))).collect();
    let (mut next, mut last) = (0, ticks(prepare));
    while next < shards.len() {
        let Some(Reverse(now)) = free.pop() else { break };
        let n = batch(shards.len() - next, shards.len(), n_workers).min(shards.len() - next);
        let end = now + ticks(shards[next..next + n].iter().sum());
        next += n;
        last = last.max(end);
        free.push(Reverse(end));
    }
    last as f64 / 1e9
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    check();
    let Some(path) = args.log.as_ref().filter(|_| !args.common.test) else {
        println!("cluster  the simulation agrees with what can be computed by hand");
        return Ok(());
    };
    let log = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut times = times(&log);
    if times.is_empty() {
        return Err(format!("{}: no line ends in a time", path.display()).into());
    }
    let (all, shards) = (times.iter().sum::<f64>(), shards_of(&times, args.shards));
    times.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "{} units, {all:.1} s: median {:.3} s, 99 % {:.3} s, longest {:.3} s; {} shards",
        times.len(),
        at(0.5),
        at(0.99),
        at(1.0),
        shards.len()
    );
    let one = args.prepare + all + args.merge;
    for &n in &args.workers {
        let took = makespan(&shards, n, args.prepare) + args.merge;
        let beside = (args.prepare + args.merge) * n as f64;
        println!(
            "{n:6} workers {took:10.2} s: {:.1} times as fast as one, {:.1} % of {n} times; preparing and merging {:.2} % of the work",
            one / took,
            100.0 * one / took / n as f64,
            100.0 * beside / (beside + all)
        );
    }
    Ok(())
}

/// Cases that can be computed by hand.
fn check() {
    assert_eq!(times(" INFO tile 0_1: 0.525 s\nwrote x: 7 tiles\n INFO tile b: c: 2.000 s\n"), [0.525, 2.0]);
    // One after the other; all at once; as long as the longest; and with a last one that nobody shares.
    assert_eq!(makespan(&[1.0; 6], 1, 2.0), 8.0);
    assert_eq!(makespan(&[1.0; 6], 6, 2.0), 3.0);
    assert_eq!(makespan(&[1.0, 5.0, 1.0], 3, 0.0), 5.0);
    assert_eq!(makespan(&[1.0, 1.0, 1.0, 9.0], 2, 0.0), 10.0);
    assert_eq!(makespan(&[], 4, 1.5), 1.5);
    assert_eq!(shards_of(&[1.0, 2.0, 3.0, 4.0], 2), [3.0, 7.0]);
}
