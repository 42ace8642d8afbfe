//! Quake maps: time against over-estimation of several methods, each in a process of its own.
//!
//! What is measured is kept in a file, row by row; a later run goes on with what is not there yet, or measures some
//! rows again. Ends with 1 if the exact search misses a pair that is known to be visible, or says something else with
//! another number of threads.

use clap::Parser;
use sightlines::pvs::BitMatrix;
use sightlines_benches::measure::{CpuClock, Work};
use sightlines_benches::program::{Common, save};
use sightlines_benches::quake::MapSpec;
use sightlines_benches::quake::chart::svg;
use sightlines_benches::quake::job::{self, Answer, ClusterMethod, METHODS, Measured};
use sightlines_benches::quake::rows::{Row, both_ways, csv, known, markdown, n_missing, n_pairs, of_map, put, read};
use sightlines_tests::{data_folder, files};
use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs that take less than this, in seconds of processor time, are repeated; the quickest one counts.
const SHORT: f64 = 10.0;

/// Time against over-estimation of methods on Quake maps.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// A map of $SIGHTLINES_DATA/quake by name, a portal file, or world:SEED:ROOMS_X:ROOMS_Y:FLOORS; may be given more
    /// than once. Without it: all maps there, or generated worlds if the variable is not set.
    #[arg(long = "map")]
    maps: Vec<String>,
    /// Methods: base, sampling, separators, symmetric, exact.
    #[arg(long, value_delimiter = ',', default_value = "base,sampling,separators,symmetric,exact")]
    methods: Vec<ClusterMethod>,
    /// Seconds of processor time that the classical walk may take.
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// Seconds of processor time that the exact search may take.
    #[arg(long, default_value_t = 3600.0)]
    limit_exact: f64,
    /// How often short runs are repeated.
    #[arg(long, default_value_t = 3)]
    repeats: usize,
    /// Keeps what is measured, and what other runs have measured.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Leaves out maps of which that file has all methods.
    #[arg(long, requires = "csv")]
    resume: bool,
    /// Measures nothing, only writes what that file has.
    #[arg(long, requires = "csv")]
    draw: bool,
    /// Writes tables as Markdown.
    #[arg(long)]
    md: Option<PathBuf>,
    /// Writes the chart.
    #[arg(long)]
    svg: Option<PathBuf>,
}

fn main() -> ExitCode {
    job::serve();
    let mut args = Args::parse();
    if !args.common.is_wanted("stabtree/quake") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.maps, args.methods, args.repeats) = (vec!["world:1:2:2:2".to_owned()], METHODS.to_vec(), 1);
    }
    match run(&args) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(n_wrong) => {
            eprintln!("{n_wrong} answers of the exact search are wrong");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// Measures and writes; how many answers of the exact search were wrong.
fn run(args: &Args) -> Result<usize, Box<dyn Error>> {
    let mut rows = match &args.csv {
        Some(path) if path.is_file() => {
            let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
            read(&text).map_err(|e| format!("{}: {e}", path.display()))?
        }
        _ => Vec::new(),
    };
    let mut n_wrong = 0;
    if !args.draw {
        let file = std::env::temp_dir().join(format!("sightlines-quake-{}.bits", std::process::id()));
        for spec in specs(args)? {
            let result = one_map(args, &spec, &file, &mut rows);
            // Only a job that went as far as writing has left it.
            let _ = std::fs::remove_file(&file);
            n_wrong += result?;
        }
    }
    write(args, &rows)?;
    println!("{}", markdown(&rows));
    if args.common.test {
        check(&rows);
    }
    Ok(n_wrong)
}

/// The maps asked for, or all there are, small ones first.
fn specs(args: &Args) -> Result<Vec<MapSpec>, Box<dyn Error>> {
    let folder = || data_folder("SIGHTLINES_DATA").map(|data| data.join("quake"));
    if !args.maps.is_empty() {
        let named = |text: &String| {
            let is_name = !text.contains([':', '/', '.']);
            let path = is_name.then(folder).flatten().map(|folder| folder.join(text).with_extension("prt"));
            path.map_or_else(|| text.parse(), |path| Ok(MapSpec::File(path)))
        };
        return Ok(args.maps.iter().map(named).collect::<Result<_, _>>()?);
    }
    let Some(folder) = folder() else {
        return Ok(["world:1:3:3:2", "world:1:5:4:2", "world:1:6:6:3"]
            .map(str::parse)
            .into_iter()
            .collect::<Result<_, _>>()?);
    };
    let mut files = files(&folder, "prt");
    files.sort_by_key(|file| file.metadata().map_or(0, |m| m.len()));
    Ok(files.into_iter().map(MapSpec::File).collect())
}

fn write(args: &Args, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let texts = [(&args.csv, csv(rows)), (&args.md, markdown(rows)), (&args.svg, svg(rows))];
    for (path, text) in texts {
        save(path.as_deref(), || text)?;
    }
    Ok(())
}

/// What is known of a map while its methods are measured.
struct Map<'a> {
    args: &'a Args,
    spec: &'a MapSpec,
    /// Where jobs leave their tables.
    file: &'a Path,
    n_clusters: usize,
    n_portals: usize,
    witness: Option<BitMatrix>,
}

fn one_map(args: &Args, spec: &MapSpec, file: &Path, rows: &mut Vec<Row>) -> Result<usize, Box<dyn Error>> {
    let graph = spec.graph()?;
    let (n_clusters, n_portals) = (graph.n_cells(), graph.portals().len());
    let map = Map { args, spec, file, n_clusters, n_portals, witness: spec.witness(n_clusters)? };
    let wanted: BTreeSet<ClusterMethod> = args.methods.iter().copied().collect();
    let own = of_map(rows, &spec.name());
    if args.resume && wanted.iter().all(|&method| own.iter().any(|row| row.method == method)) {
        return Ok(0);
    }
    eprintln!("{}: {n_clusters} clusters, {n_portals} portals", spec.name());
    let mut n_wrong = 0;
    let (mut walked, mut answers) = (None, Vec::new());
    for method in wanted {
        let (measured, answer) = match method {
            ClusterMethod::Symmetric => {
                let walk = walked.take().map_or_else(|| map.measure(ClusterMethod::Separators), Ok)?;
                symmetric(walk)
            }
            _ => map.measure(method)?,
        };
        let mut row = map.row(method, measured, &answer);
        if method == ClusterMethod::Exact && row.measured.done == 1.0 {
            n_wrong += usize::from(row.missing > Some(0)) + map.with_threads(&mut row, &answer)?;
        }
        eprintln!("  {method}: {:.2} s, {} pairs, {} missing", row.measured.cpu, row.pairs, row.missing.unwrap_or(0));
        if method == ClusterMethod::Separators {
            walked = Some((row.measured.clone(), answer.clone()));
        }
        put(rows, row);
        answers.push((method, answer));
        prove(&spec.name(), &answers, rows);
        write(args, rows)?;
    }
    Ok(n_wrong)
}

/// Once the exact search is at its end, says of this run's other methods what they hide of its pairs.
fn prove(map: &str, answers: &[(ClusterMethod, Answer)], rows: &mut [Row]) {
    let is_done = |row: &Row| row.map == map && row.method == ClusterMethod::Exact && row.measured.done == 1.0;
    if !rows.iter().any(is_done) {
        return;
    }
    let Some((_, exact)) = answers.iter().find(|(method, _)| *method == ClusterMethod::Exact) else { return };
    let proven = exact.proven();
    let n_proven = n_pairs(&proven);
    for row in rows.iter_mut().filter(|row| row.map == map) {
        match answers.iter().find(|(method, _)| *method == row.method) {
            Some((_, answer)) => row.proven = Some([n_proven, n_missing(&proven, &answer.table)]),
            // An earlier run held it against an earlier search.
            None => row.proven = row.proven.filter(|[n, _]| *n == n_proven),
        }
    }
}

/// The walk, and then its pairs taken both ways.
fn symmetric((mut measured, walked): (Measured, Answer)) -> (Measured, Answer) {
    let clock = CpuClock::start(Work::Threads);
    let table = both_ways(&walked.table);
    measured.cpu += clock.elapsed().as_secs_f64();
    (measured, Answer { table, ..walked })
}

impl Map<'_> {
    /// One thread, the quickest of several runs.
    fn measure(&self, method: ClusterMethod) -> Result<(Measured, Answer), Box<dyn Error>> {
        let mut best = self.run(method, 1)?;
        for _ in 1..self.args.repeats {
            if best.0.cpu < SHORT {
                let again = self.run(method, 1)?;
                assert!(again.1 == best.1 && again.0.counters == best.0.counters, "{}: {method} repeats", self.spec);
                best = if again.0.cpu < best.0.cpu { again } else { best };
            }
        }
        Ok(best)
    }

    fn run(&self, method: ClusterMethod, threads: usize) -> Result<(Measured, Answer), Box<dyn Error>> {
        let limit = if method == ClusterMethod::Exact { self.args.limit_exact } else { self.args.limit };
        Ok(job::run(self.spec, (method, threads, limit), self.file, self.n_clusters)?)
    }

    /// The exact search with 2 and 8 threads, which must change nothing; how often it did.
    fn with_threads(&self, row: &mut Row, answer: &Answer) -> Result<usize, Box<dyn Error>> {
        let mut n_wrong = 0;
        for threads in [2, 8] {
            let repeats = if threads == 2 && row.measured.cpu < SHORT { self.args.repeats.max(1) } else { 1 };
            for _ in 0..repeats {
                let (measured, other) = self.run(ClusterMethod::Exact, threads)?;
                if other != *answer || measured.counters != row.measured.counters {
                    eprintln!("WRONG {}: {threads} threads say something else than one", self.spec);
                    n_wrong += 1;
                }
                if threads == 2 {
                    row.wall_two = Some(row.wall_two.map_or(measured.wall, |wall| wall.min(measured.wall)));
                }
            }
        }
        Ok(n_wrong)
    }

    fn row(&self, method: ClusterMethod, measured: Measured, answer: &Answer) -> Row {
        let witness = self.witness.as_ref();
        Row {
            map: self.spec.name(),
            clusters: self.n_clusters as u64,
            portals: self.n_portals as u64,
            witnessed: witness.map(n_pairs),
            method,
            measured,
            wall_two: None,
            pairs: n_pairs(&answer.table),
            missing: witness.map(|witness| n_missing(witness, &answer.table)),
            undecided: 2 * answer.undecided.len() as u64,
            proven: None,
        }
    }
}

/// What must hold of a small world, whatever the machine.
fn check(rows: &[Row]) {
    let map = rows[0].map.as_str();
    let own = of_map(rows, map);
    assert_eq!(own.iter().map(|row| row.method).collect::<Vec<_>>(), METHODS, "every method was measured");
    let [base, sampling, separators, symmetric, exact] = own[..] else { panic!("five methods") };
    let witnessed = exact.witnessed.expect("lines show what is visible");
    assert!(witnessed > 1000 && Some(exact.pairs - exact.undecided) == known(&own));
    assert!(own.iter().all(|row| row.measured.done == 1.0 && row.measured.cpu > 0.0));
    assert_eq!([base.missing, exact.missing], [Some(0); 2]);
    let hidden = own.iter().map(|row| row.proven.expect("the exact search came to its end")[1]);
    assert_eq!(
        hidden.clone().filter(|n| *n > 0).count(),
        1,
        "what sampling alone has not found: {:?}",
        hidden.collect::<Vec<_>>()
    );
    assert!(sampling.proven.is_some_and(|[_, hidden]| hidden > 0));
    assert!(sampling.pairs <= exact.pairs && exact.pairs < base.pairs, "bounds on both sides");
    assert!(symmetric.pairs <= separators.pairs && separators.pairs < base.pairs, "planes hide something");
    // Few lines are shot, which miss some that the search has a line for.
    assert!(
        exact.pairs * 4 < witnessed * 5 && exact.pairs <= symmetric.pairs,
        "{} pairs, {witnessed} witnessed",
        exact.pairs
    );
    assert!(exact.wall_two.is_some_and(|s| s > 0.0));
    // A table that lacks a pair is found out, or this bench could not fail.
    let spec: MapSpec = map.parse().unwrap_or_else(|e| panic!("{e}"));
    let n = usize::try_from(own[0].clusters).expect("few clusters");
    let witness = spec.witness(n).unwrap_or_else(|e| panic!("{e}")).expect("lines are shot through worlds");
    let mut spoilt = witness.clone();
    let [a, b] = (0..n).flat_map(|a| (0..a).map(move |b| [a, b])).find(|&[a, b]| witness.get(a, b)).expect("a pair");
    spoilt.set(a, b, false);
    assert_eq!([n_missing(&witness, &spoilt), n_missing(&witness, &witness)], [1, 0]);
}
