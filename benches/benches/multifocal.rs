//! What multifocal buffers find of what is hidden: rectangles and boxes, against rays.
//!
//! For each measure and number of planes, size of the volume and tilt of the rectangles: how many of the boxes that
//! no ray reaches are found, and how long one volume takes. Ends with 1 if a box that a ray reaches is called hidden.

use clap::Parser;
use sightlines::geometry::Aabb;
use sightlines::multifocal::{
    BufferJob, BufferPlane, FromRegion, Layout, Measure, Multifocal, MultifocalBackend, Occluder, OccluderSelection,
    Volume,
};
use sightlines::multifocal_cpu::{Fast, Reference};
use sightlines::scenes::{Occlusion, OcclusionOptions, occlusion};
use sightlines_benches::program::Common;
use sightlines_testkit::{SampledView, sampled_view};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Over-estimation and soundness of multifocal buffers.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Half sizes of the volume.
    #[arg(long, value_delimiter = ',', default_values_t = [0.25, 0.5])]
    halves: Vec<f64>,
    /// Tilts of the rectangles, in hundredths.
    #[arg(long, value_delimiter = ',', default_values_t = [0, 30, 60])]
    tilts: Vec<u32>,
    /// Seeds of the benchmark; shares are over all of them.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 3])]
    seeds: Vec<u64>,
    /// Numbers of planes on each side.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 4, 17])]
    planes: Vec<u32>,
    /// Texels along the longer side of each plane.
    #[arg(long, default_value_t = Layout::default().texels)]
    texels: u32,
    /// Rays of each benchmark.
    #[arg(long, default_value_t = 1_000_000)]
    rays: u64,
}

/// A benchmark, and what rays saw of it.
struct Case {
    made: Occlusion,
    volume: Aabb<3>,
    seen: SampledView,
}

/// What one way finds in several benchmarks.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    n_hidden: usize,
    /// No ray reaches them.
    n_unseen: usize,
    /// Called hidden, and reached by a ray.
    n_wrong: usize,
    time: Duration,
}

impl Found {
    fn share(&self) -> f64 {
        self.n_hidden as f64 / self.n_unseen.max(1) as f64
    }
}

/// The ways to ask: every measure on its own planes, and heights carried from plane to plane.
fn layouts(args: &Args) -> Vec<Layout> {
    let mut layouts = Vec::new();
    for &planes in &args.planes {
        let layout = |measure, carry| Layout { planes, texels: args.texels, measure, carry, ..Layout::default() };
        layouts.extend(Measure::ALL.map(|measure| layout(measure, false)));
        if planes > 1 {
            layouts.extend(Measure::ALL.into_iter().filter(|m| m.is_height()).map(|measure| layout(measure, true)));
        }
    }
    layouts
}

/// All benchmarks of one tilt and size, with what rays see.
fn cases(args: &Args, tilt: u32, half: f64) -> Vec<Case> {
    let case = |&seed: &u64| {
        let made =
            occlusion(OcclusionOptions { seed, tilt, ..OcclusionOptions::default() }).expect("tilts are checked");
        let volume = Occlusion::volume(half);
        let seen = sampled_view(&made.scene, &volume, &made.occludees, args.rays, seed);
        Case { made, volume, seen }
    };
    args.seeds.iter().map(case).collect()
}

/// Each rectangle is an occluder.
fn occluders(made: &Occlusion) -> Vec<Occluder> {
    let halves = |r: [_; 4]| [[r[0], r[1], r[2]], [r[0], r[2], r[3]]];
    let whole = |r: [_; 4]| Occluder::patch(r.to_vec(), &halves(r)).expect("rectangles have areas");
    made.rectangles().map(whole).collect()
}

/// Asks about all boxes of a case.
fn ask(case: &Case, layout: Layout, found: &mut Found) {
    let occluders = Arc::new(OccluderSelection::new(occluders(&case.made), usize::MAX));
    let scene = case.made.occludees.iter().fold(case.made.scene.bounds(), |all, b| all.with(b.min).with(b.max));
    // The fast backend has no form of one measure.
    let mut method: Box<dyn FromRegion> = match layout.measure {
        Measure::ClippedEuclid => Box::new(Multifocal::new(Reference, occluders, scene, layout)),
        _ => Box::new(Multifocal::new(Fast::new(), occluders, scene, layout)),
    };
    let volume = Volume::new(case.volume).expect("cubes are volumes");
    let start = Instant::now();
    let mut umbra = method.umbra(&volume).expect("the CPU does not fail");
    let hidden: Vec<usize> = (0..case.made.occludees.len()).filter(|&i| umbra.hides(&case.made.occludees[i])).collect();
    found.time += start.elapsed();
    found.n_wrong += case.seen.refuted(hidden.iter().copied()).len();
    found.n_hidden += hidden.len();
    found.n_unseen += case.seen.unseen().count();
}

/// Whether a layout can be afforded: the measure of the reference is for one plane, and few texels.
fn is_affordable(layout: &Layout) -> bool {
    layout.measure != Measure::ClippedEuclid || layout.planes == 1 && layout.texels <= 32
}

/// Prints the table; how many boxes were wrongly called hidden.
fn table(args: &Args) -> usize {
    println!("| half | tilt | boxes hidden | measure | planes | carried | found | ms a volume |");
    println!("| ---: | ---: | ---: | --- | ---: | --- | ---: | ---: |");
    let mut n_wrong = 0;
    for (&half, &tilt) in args.halves.iter().flat_map(|half| args.tilts.iter().map(move |tilt| (half, tilt))) {
        let cases = cases(args, tilt, half);
        for layout in layouts(args).into_iter().filter(is_affordable) {
            let mut found = Found::default();
            cases.iter().for_each(|case| ask(case, layout, &mut found));
            let n: usize = cases.iter().map(|case| case.made.occludees.len()).sum();
            println!(
                "| {half} | {:.2} | {:.1} % | {} | {} | {} | {:.1} % | {:.2} |",
                f64::from(tilt) / 100.0,
                100.0 * found.n_unseen as f64 / n as f64,
                layout.measure.name(),
                layout.planes,
                if layout.carry { "yes" } else { "no" },
                100.0 * found.share(),
                found.time.as_secs_f64() * 1e3 / cases.len() as f64,
            );
            n_wrong += found.n_wrong;
        }
    }
    n_wrong
}

/// Checks on small benchmarks that nothing that is seen is called hidden, and that more planes find more.
fn check(args: &Args) {
    let args = Args { seeds: vec![1], rays: 100_000, ..args.clone() };
    let cases = cases(&args, 30, 0.25);
    let find = |planes, measure, carry| {
        let mut found = Found::default();
        let layout = Layout { planes, texels: 64, measure, carry, ..Layout::default() };
        cases.iter().for_each(|case| ask(case, layout, &mut found));
        assert_eq!(found.n_wrong, 0, "{measure:?}: what is seen is called hidden");
        found
    };
    let one = find(1, Measure::SectionHeight, false);
    let carried = find(17, Measure::SectionHeight, true);
    let distances = find(1, Measure::Euclid, false);
    assert!(one.n_unseen > 100 && one.n_hidden > 10 && distances.n_hidden > 0, "{one:?} {distances:?}");
    assert!(carried.share() > one.share() && carried.share() > 0.5, "{one:?} {carried:?}");
    // The impostor: who calls everything hidden is found out.
    let all = 0..cases[0].made.occludees.len();
    assert!(cases[0].seen.refuted(all).len() > 100);
    println!("multifocal: checked");
}

/// Times to fill one buffer on one thread: umbrae and heights of many rectangles.
fn fill(args: &Args) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be started");
    println!("\n| occluders | texels | measure | ms on one thread | blocked |");
    println!("| ---: | ---: | --- | ---: | ---: |");
    let sizes = if args.common.test { vec![(50, 64)] } else { vec![(1000, 512), (10_000, 1024)] };
    for (n, texels) in sizes {
        let options = OcclusionOptions { occluders: n, tilt: 60, ..OcclusionOptions::default() };
        let made = occlusion(options).expect("numbers are in range");
        let occluders = occluders(&made);
        let volume = Volume::new(Occlusion::volume(0.25)).expect("cubes are volumes");
        let plane = BufferPlane::new(2, true, Occlusion::FAR, [-9.0; 2], [9.0; 2], [texels; 2]).expect("a good window");
        for measure in [Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight] {
            let job = BufferJob::new(volume, vec![plane], &occluders, measure, false).expect("a good job");
            let (mut fast, mut out) = (Fast::new(), Vec::new());
            let mut once = || {
                let start = Instant::now();
                pool.install(|| fast.render(&job, &mut out)).expect("the CPU does not fail");
                start.elapsed()
            };
            let rounds = if args.common.test { 1 } else { 7 };
            let mut times: Vec<Duration> = (0..rounds).map(|_| once()).collect();
            times.sort_unstable();
            let blocked = out[0].n_blocked() as f64 / f64::from(texels * texels);
            assert!(blocked > 0.05 && blocked <= 1.0, "{blocked} of the texels are blocked");
            let ms = times[times.len() / 2].as_secs_f64() * 1e3;
            println!("| {n} | {texels} x {texels} | {} | {ms:.2} | {:.1} % |", measure.name(), 100.0 * blocked);
        }
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("multifocal") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        check(&args);
        fill(&args);
        return ExitCode::SUCCESS;
    }
    fill(&args);
    println!();
    match table(&args) {
        0 => ExitCode::SUCCESS,
        n => {
            eprintln!("{n} boxes that rays reach are called hidden");
            ExitCode::FAILURE
        }
    }
}
