//! Who is told of whom: bodies that walk through scenes, maps and plans at a bounded speed, told by [`Relevance`], and by what servers do
//! otherwise: a table of visibility alone, the reaches of cells alone, and nine rays for a pair.
//!
//! Whoever has a free segment to a part of another now has to be told of them since the time that both take for their reach. Ends with 1 if one was told
//! late by ours.

use clap::Parser;
use sightlines::bake::{BakeInput, BakeRequest, Bakeable, Runtime};
use sightlines::formats::Source;
use sightlines::geometry::Random;
use sightlines::pvs::{PlaceBuffer, Table};
use sightlines::relevance::{Body, Player, PlayerRole, ReachOptions, Reaches, Relevance, RelevanceOptions, Ways};
use sightlines::scenes::{TowerOptions, tower};
use sightlines_benches::program::Common;
use sightlines_benches::walkers::{Ground, Walkers};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Ticks and looks of servers.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Scenes, maps and plans; none for a tower.
    #[arg(long)]
    scene: Vec<PathBuf>,
    /// Which map of a WAD.
    #[arg(long)]
    map: Option<String>,
    /// Floors of the tower.
    #[arg(long, default_value_t = 16)]
    floors: u32,
    /// Steps of single walkers, in each scene.
    #[arg(long, default_value_t = 200_000)]
    movements: u64,
    /// Walkers.
    #[arg(long, default_value_t = 64)]
    players: usize,
    /// How far each gets until an answer counts, in metres.
    #[arg(long, default_value_t = 2.0)]
    reach: f64,
    /// Bodies go through portals only.
    #[arg(long)]
    by_walking: bool,
    /// Where chance begins.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Metres a tick of the sweep, and as many ticks to the reach as that gives.
const STEP: f64 = 0.25;
/// The ways to tell, in the order of their columns.
const WAYS: [&str; 4] = ["ours", "reaches of cells alone", "table alone", "nine rays"];

/// What a sweep found.
#[derive(Debug, Default)]
struct Sweep {
    /// Moments in which somebody has a free segment to somebody, and in how many of these they were told late, by each way.
    n_seen: u64,
    late: [u64; 4],
    /// Moments in which two have no free segment to each other wherever they get within the reach, as far as some hundred segments show; and of how many of
    /// these they are not told, by each way.
    n_unseen: u64,
    withheld: [u64; 4],
    /// Bodies of which nothing was known, of all in all ticks.
    n_outside: u64,
}

/// Whether the eyes of `a` have a free segment to the middle or a corner of the box of `b`.
fn nine_rays(ground: &Ground<'_>, a: [f64; 3], b: [f64; 3]) -> bool {
    let seen = ground.body(b).seen;
    ground.is_free(a, b) || seen.corners().into_iter().any(|corner| ground.is_free(a, corner))
}

fn by_table(table: &Table, a: &Body, b: &Body) -> bool {
    let mut touched = [Vec::new(), Vec::new()];
    let mut pending = Vec::new();
    for (cells, b) in touched.iter_mut().zip([a.eyes, b.seen]) {
        table.for_each_touching(b.min, b.max, &mut pending, |cell| {
            cells.push(cell);
            true
        });
    }
    touched.iter().any(Vec::is_empty) || touched[0].iter().any(|&i| touched[1].iter().any(|&j| table.sees(i, j)))
}

fn sweep(args: &Args, ground: &Ground<'_>, table: &Arc<Table>, reaches: &Reaches, n_ticks: u64) -> Sweep {
    const KEPT: usize = 64;
    let (n, far) = (args.players, STEP * ground.metre);
    let ticks = ((args.reach / STEP).ceil() as usize).clamp(1, KEPT - 1);
    let options = RelevanceOptions { hold: 0.0, ..RelevanceOptions::of(table) };
    let mut told = Relevance::new(table.clone(), reaches.clone(), options);
    // No look is left for any body.
    let mut coarse = Relevance::new(table.clone(), reaches.clone(), RelevanceOptions { looks: 0, ..options });
    let mut walkers = Walkers::new(ground, n, args.seed);
    let (mut random, mut place) = (Random::new(args.seed ^ 0x5eed), PlaceBuffer::new());
    let mut since = [vec![u64::MAX; n * n], vec![u64::MAX; n * n]];
    let mut paths: Vec<Vec<[f64; 3]>> = Vec::new();
    let mut found = Sweep::default();
    for tick in 0..n_ticks {
        walkers.step(ground, far, &mut place);
        let body = |p: [f64; 3]| Body { reach: ticks as f64 * far, ..ground.body(p) };
        let players: Vec<Player> =
            walkers.at.iter().map(|&p| Player { body: body(p), role: PlayerRole::ALONE }).collect();
        for (told, since) in [&mut told, &mut coarse].into_iter().zip(&mut since) {
            let changes = told.update(tick as f64 * 0.05, &players);
            found.n_outside += changes.n_outside as u64;
            changes.lost.iter().for_each(|&[a, b]| since[a as usize * n + b as usize] = u64::MAX);
            changes.gained.iter().for_each(|&[a, b]| since[a as usize * n + b as usize] = tick);
        }
        if paths.len() == KEPT {
            paths.remove(0);
        }
        paths.push(walkers.at.clone());
        // All at the start are told of at once.
        if tick < ticks as u64 {
            continue;
        }
        let before = &paths[paths.len() - 1 - ticks..];
        for _ in 0..n / 2 {
            let (i, j) = (random.below(n), random.below(n));
            if i == j {
                continue;
            }
            let (a, b) = (walkers.at[i], walkers.at[j]);
            let part = ground.part_of(b, &mut random);
            if !ground.is_free(a, part) {
                continue;
            }
            found.n_seen += 1;
            for (late, since) in found.late.iter_mut().zip(&since) {
                let at = since[i * n + j];
                *late += u64::from(at == u64::MAX || at > 0 && at + ticks as u64 > tick);
            }
            let was = |told: &dyn Fn([f64; 3], [f64; 3]) -> bool| before.iter().all(|at| told(at[i], at[j]));
            found.late[2] += u64::from(!was(&|a, b| by_table(table, &ground.body(a), &ground.body(b))));
            found.late[3] += u64::from(!was(&|a, b| nine_rays(ground, a, b)));
        }
        if tick % 50 == 0 {
            withheld(ground, table, &mut told, &walkers.at, args, &mut random, &mut found);
        }
    }
    found
}

/// Looks at pairs that do not see each other within the reach.
fn withheld(
    ground: &Ground<'_>,
    table: &Table,
    told: &mut Relevance,
    at: &[[f64; 3]],
    args: &Args,
    random: &mut Random,
    found: &mut Sweep,
) {
    const TRIES: usize = 512;
    let far = args.reach * ground.metre;
    for _ in 0..16 {
        let (i, j) = (random.below(args.players), random.below(args.players));
        let (a, b) = (at[i], at[j]);
        let mut sees = || {
            let (a, b) = (ground.within(a, far, random), ground.within(b, far, random));
            ground.is_free(a, ground.part_of(b, random))
        };
        if i == j || (0..TRIES).any(|_| sees()) {
            continue;
        }
        found.n_unseen += 1;
        let with = |p: [f64; 3]| Body { reach: far, ..ground.body(p) };
        let (a, b) = (with(a), with(b));
        let tells = [
            told.is_shown(i as u32, j as u32),
            !told.are_hidden_by_cells(&a, &b),
            by_table(table, &a, &b),
            nine_rays(ground, at[i], at[j]),
        ];
        found.withheld.iter_mut().zip(tells).for_each(|(withheld, tells)| *withheld += u64::from(!tells));
    }
}

/// Microseconds of ticks at 128 a second: mean and 99th percentile, of so many bodies of which some look.
fn ticks(
    ground: &Ground<'_>,
    table: &Arc<Table>,
    reaches: &Reaches,
    [n, n_viewers]: [usize; 2],
    seed: u64,
) -> [f64; 2] {
    const N: usize = 400;
    let mut told = Relevance::new(table.clone(), reaches.clone(), RelevanceOptions::of(table));
    let mut walkers = Walkers::new(ground, n, seed);
    let mut place = PlaceBuffer::new();
    let mut times = Vec::with_capacity(N);
    for tick in 0..N {
        walkers.step(ground, 5.0 * ground.metre / 128.0, &mut place);
        let role = |i: usize| if i < n_viewers { PlayerRole::ALONE } else { PlayerRole::THING };
        let body = |&p: &[f64; 3]| Body { reach: 2.0 * ground.metre, ..ground.body(p) };
        let players: Vec<Player> =
            walkers.at.iter().enumerate().map(|(i, p)| Player { body: body(p), role: role(i) }).collect();
        let start = Instant::now();
        told.update(tick as f64 / 128.0, &players);
        // In the first ticks all bodies are placed.
        if tick >= 20 {
            times.push(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    times.sort_by(f64::total_cmp);
    [times.iter().sum::<f64>() / times.len() as f64, times[times.len() * 99 / 100]]
}

fn of_input(args: &Args, name: &str, input: BakeInput<'_>) -> Result<bool, Box<dyn Error>> {
    let runtime = Runtime::default();
    let table = Arc::new(BakeRequest::default().prepare(input, &runtime)?.run(&runtime)?.table);
    let start = Instant::now();
    let ways = if args.by_walking { Ways::Portals } else { Ways::Straight };
    let reaches = Reaches::of(&table, &ReachOptions { ways, threads: 1, ..ReachOptions::default() })?;
    let seconds = start.elapsed().as_secs_f64();
    let n = table.n_cells();
    let n_bytes = reaches.to_bytes().len();
    let bits = n_bytes as f64 * 8.0 / (n as f64 * n as f64);
    println!("{name}: {n} cells, reaches in {seconds:.2} s on one thread, {n_bytes} bytes, {bits:.2} bits a pair");
    let ground = Ground::new(&table, input)?;
    let found = sweep(args, &ground, &table, &reaches, args.movements / args.players as u64);
    println!(
        "  {} movements, {} segments to bodies, {} pairs without one within {} m",
        args.movements, found.n_seen, found.n_unseen, args.reach
    );
    let outside = 100.0 * found.n_outside as f64 / (2 * args.movements).max(1) as f64;
    println!("  {outside:.2} % of bodies are partly outside of all cells");
    for (way, (late, withheld)) in WAYS.iter().zip(found.late.iter().zip(&found.withheld)) {
        let share = |k: u64, n: u64| 100.0 * k as f64 / n.max(1) as f64;
        println!(
            "  {way:<24} late {:>7.3} % ({late}), withheld {:>5.1} %",
            share(*late, found.n_seen),
            share(*withheld, found.n_unseen)
        );
    }
    if !args.common.test {
        for [n, viewers] in [[64, 64], [1000, 64]] {
            let [mean, p99] = ticks(&ground, &table, &reaches, [n, viewers], args.seed);
            println!("  {n} bodies, {viewers} of which look: {mean:.0} µs a tick, 99 of 100 within {p99:.0} µs");
        }
    }
    Ok(found.late[0] == 0 && found.late[1] == 0 && found.n_seen > 0)
}

fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    if args.scene.is_empty() {
        let floors = if args.common.test { 2 } else { args.floors };
        let scene = tower(TowerOptions { floors, ..TowerOptions::default() })?;
        return of_input(args, &format!("tower of {floors} floors"), (&scene).into());
    }
    let mut is_right = true;
    for path in &args.scene {
        let input = Bakeable::read(&Source::File(path), args.map.as_deref())?;
        is_right &= of_input(args, &path.display().to_string(), (&input).into())?;
    }
    Ok(is_right)
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("relevance") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.scene, args.players, args.movements) = (Vec::new(), 16, 16 * 600);
    }
    match run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
