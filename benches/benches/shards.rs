//! Jobs: what shards, planning and merging cost beside a build by one process.
//!
//! Times on the wall need a quiet machine with a core for each worker. Processor time does not: if the processes of a job need as much of it as one process, and
//! end at about the same time, the job takes the time of one divided by their number.

use clap::Parser;
use sightlines_benches::measure::{CpuClock, Work};
use sightlines_benches::program::{Common, exit};
use sightlines_testkit::mutate::SplitMix;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Jobs beside one process.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// The program [default: target/release/sightlines of this workspace]
    #[arg(long)]
    program: Option<PathBuf>,
    /// Blocks along the side of the city; it has 69 cells and four houses for each block. 0 for no city.
    #[arg(long, default_value_t = 12)]
    blocks: u32,
    /// Floors of the tower; 0 for no tower.
    #[arg(long, default_value_t = 64)]
    floors: u32,
    /// Shards of each phase.
    #[arg(long, default_value_t = 64)]
    shards: u32,
    /// Processes at once.
    #[arg(long, default_value_t = 2)]
    workers: u32,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("shards") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.blocks, args.floors, args.shards) = (1, 1, 4);
    }
    exit(run(&args))
}

/// Seconds on the wall and of processors.
#[derive(Debug, Clone, Copy, Default)]
struct Cost {
    wall: f64,
    cpu: f64,
}

struct Bench {
    program: PathBuf,
    folder: PathBuf,
}

impl Bench {
    /// Runs a command line, words with spaces between them, and returns what it took.
    fn run(&self, line: &str) -> Result<Cost, Box<dyn Error>> {
        let clock = CpuClock::start(Work::Children);
        let mut command = Command::new(&self.program);
        command.args(line.split(' ')).arg("-q").current_dir(&self.folder).stdout(Stdio::null());
        let status = command.status().map_err(|error| format!("{}: {error}", self.program.display()))?;
        if !status.success() {
            return Err(format!("{line}: {status}").into());
        }
        let [wall, cpu] = [clock.wall(), clock.elapsed()].map(|time| time.as_secs_f64());
        Ok(Cost { wall, cpu })
    }

    /// Measures a build, by one process and as a job.
    fn measure(&self, name: &str, build: &str, args: &Args) -> Result<(), Box<dyn Error>> {
        let Args { shards, workers, .. } = *args;
        let one = self.run(&format!("build {build} --threads 1 -o {name}-one.pvs"))?;
        let plan =
            self.run(&format!("job plan -o {name}-job --shards {shards} build {build} --threads 1 -o {name}.pvs"))?;
        let all = self.run(&format!("job submit {name}-job --workers {workers}"))?;
        let read = |name: String| std::fs::read(self.folder.join(name));
        if read(format!("{name}.pvs"))? != read(format!("{name}-one.pvs"))? {
            return Err(format!("{name}: the job has other bytes").into());
        }
        // What every worker does beside its units: nothing else is left to do.
        let beside = self.run(&format!("job work {name}-job"))?;
        println!(
            "{name:8} one process {:.1} s, {:.1} s of a processor; {workers} workers {:.1} s, {:.1} s: {:.2} times as fast, {:.3} times the work; \
             planning {:.2} s, preparing and merging {:.2} s for each worker, {:.1} % of the work more than one process",
            one.wall,
            one.cpu,
            all.wall + plan.wall,
            all.cpu + plan.cpu,
            one.wall / (all.wall + plan.wall),
            (all.cpu + plan.cpu) / one.cpu,
            plan.cpu,
            beside.cpu,
            100.0 * (plan.cpu + f64::from(workers - 1) * beside.cpu) / (all.cpu + plan.cpu)
        );
        Ok(())
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let program = args
        .program
        .clone()
        .unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/release/sightlines"));
    if !program.is_file() {
        eprintln!("SKIPPED shards: there is no program {}", program.display());
        return Ok(());
    }
    let folder = std::env::temp_dir().join(format!("sightlines-shards-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let bench = Bench { program: program.canonicalize()?, folder };
    let measured = measure(&bench, args);
    std::fs::remove_dir_all(&bench.folder)?;
    measured
}

fn measure(bench: &Bench, args: &Args) -> Result<(), Box<dyn Error>> {
    if args.blocks > 0 {
        let [scene, cells] = city(args.blocks);
        std::fs::write(bench.folder.join("city.obj"), scene)?;
        std::fs::write(bench.folder.join("city.json"), cells)?;
        bench.measure("city", "city.obj --cells city.json --method line-space", args)?;
    }
    if args.floors > 0 {
        bench.run(&format!("generate tower --floors {} -o tower.glb", args.floors))?;
        bench.measure("tower", "tower.glb", args)?;
    }
    Ok(())
}

/// Blocks of four houses with streets between them, as OBJ, and boxes of four metres along the streets at the height of eyes, as JSON.
fn city(n_blocks: u32) -> [String; 2] {
    /// Metres of a bay, bays of a house, and bays from block to block.
    const BAY: f64 = 4.0;
    const LOT: u32 = 5;
    const PITCH: u32 = 13;
    let mut random = SplitMix::new(1);
    let mut below = |n: u64| random.next() % n;
    let (mut out, mut cells, mut n_corners) = (String::new(), Vec::new(), 0);
    let mut solid = |name: &str, min: [f64; 3], max: [f64; 3]| {
        for k in 0..8_usize {
            let [x, y, z] = [0, 1, 2].map(|axis: usize| if k >> axis & 1 == 0 { min[axis] } else { max[axis] });
            let _ = writeln!(out, "v {x} {y} {z}");
        }
        let _ = writeln!(out, "o {name}");
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let [a, b, c, d] = [a, b, c, d].map(|corner: usize| n_corners + corner + 1);
            let _ = writeln!(out, "f {a} {b} {c}\nf {a} {c} {d}");
        }
        n_corners += 8;
    };
    let width = f64::from(n_blocks * PITCH + 3) * BAY;
    solid("ground", [-12.0, -4.0, -12.0], [width, 0.0, width]);
    for [x, z] in (0..n_blocks * n_blocks).map(|block| [block % n_blocks * PITCH, block / n_blocks * PITCH]) {
        for lot in 0..4 {
            let [dx, dz] = [lot % 2, lot / 2];
            let back = [0, 1].map(|_| u32::from(below(4) == 0));
            let floors = 2 + below(5) + if below(6) == 0 { 4 + below(7) } else { 0 };
            let from = [x + dx * LOT + (1 - dx) * back[0], z + dz * LOT + (1 - dz) * back[1]].map(f64::from);
            let to = [from[0] + f64::from(LOT - back[0]), from[1] + f64::from(LOT - back[1])];
            let min = [from[0] * BAY, 0.0, from[1] * BAY];
            solid(&format!("house_{x}_{z}_{lot}"), min, [to[0] * BAY, floors as f64 * 4.0, to[1] * BAY]);
        }
        for [i, j] in (0..PITCH * PITCH).map(|bay| [bay % PITCH, bay / PITCH]) {
            if i >= 2 * LOT || j >= 2 * LOT {
                let [low, high] = [0, 1].map(|d| [f64::from(x + i + d) * BAY, f64::from(z + j + d) * BAY]);
                cells.push(format!(
                    "{{\"id\":\"{x}_{z}_{i}_{j}\",\"min\":[{},1.25,{}],\"max\":[{},2.25,{}]}}",
                    low[0], low[1], high[0], high[1]
                ));
            }
        }
    }
    [out, format!("{{\"cells\":[{}]}}", cells.join(","))]
}
