//! A server and its clients on this machine, by UDP: bots walk, and each is sent the places of those whom it could see before newer news is drawn. Beside it what
//! servers do otherwise: all places to all, or nine rays for each pair in each tick.
//!
//! ```sh
//! cargo run --release -p sightlines-benches --example server -- --scene e1m1.bsp --way relevance
//! cargo run --release -p sightlines-benches --example server -- --scene e1m1.bsp --way nine-rays
//! ```

use clap::{Parser, ValueEnum};
use sightlines::bake::{BakeInput, BakeRequest, Bakeable, Runtime};
use sightlines::formats::Source;
use sightlines::geometry::Random;
use sightlines::pvs::PlaceBuffer;
use sightlines::relevance::{Body, Player, PlayerRole, ReachOptions, Reaches, Relevance, RelevanceOptions};
use sightlines::scenes::{TowerOptions, tower};
use sightlines_benches::walkers::{Ground, Walkers};
use std::collections::VecDeque;
use std::error::Error;
use std::net::UdpSocket;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Way {
    Relevance,
    NineRays,
    Everything,
}

/// Bots on a server.
#[derive(Debug, Parser)]
struct Args {
    /// The map; a small tower if none is named.
    #[arg(long)]
    scene: Option<PathBuf>,
    /// Who is told of whom.
    #[arg(long, value_enum, default_value = "relevance")]
    way: Way,
    /// At most as many as fit into a packet.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u16).range(2..=4096))]
    bots: u16,
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// Ticks as fast as the machine can, in place of 128 a second.
    #[arg(long)]
    fast: bool,
    /// Round trip and interpolation, in seconds.
    #[arg(long, default_value_t = 0.22)]
    latency: f64,
}

/// Metres a second.
const SPEED: f64 = 5.0;
/// Of each bot in a packet: its number, and its place in single precision.
const ENTRY: usize = 14;
const HZ: f64 = 128.0;

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let scene = tower(TowerOptions { floors: 3, ..TowerOptions::default() })?;
    let file = args.scene.as_ref().map(|path| Bakeable::read(&Source::File(path), None)).transpose()?;
    let input: BakeInput<'_> = file.as_ref().map_or_else(|| (&scene).into(), Into::into);
    let runtime = Runtime::default();
    let table = Arc::new(BakeRequest::default().prepare(input, &runtime)?.run(&runtime)?.table);
    let reaches = Reaches::of(&table, &ReachOptions::default())?;
    let ground = Ground::new(&table, input)?;
    let n = usize::from(args.bots);
    let mut relevance = Relevance::new(table.clone(), reaches, RelevanceOptions::of(&table));
    let mut walkers = Walkers::new(&ground, n, 1);
    let (mut random, mut place) = (Random::new(2), PlaceBuffer::new());
    // A tick more than the latency: news is sent once a tick.
    let delay = (args.latency * HZ).ceil() as usize + 1;
    let reach = SPEED * delay as f64 / HZ * ground.metre;

    let server = UdpSocket::bind("127.0.0.1:0")?;
    let clients: Vec<UdpSocket> = (0..n).map(|_| UdpSocket::bind("127.0.0.1:0")).collect::<Result<_, _>>()?;
    for client in &clients {
        client.set_nonblocking(true)?;
    }
    let addresses = clients.iter().map(UdpSocket::local_addr).collect::<Result<Vec<_>, _>>()?;

    let (mut packet, mut inbox) = (Vec::new(), vec![0; 2 + ENTRY * n]);
    // What each client was sent, tick by tick, until it is drawn.
    let mut sent: VecDeque<Vec<Vec<bool>>> = VecDeque::new();
    let (mut n_bytes, mut n_got, mut n_seen, mut n_late, mut busy) = (0u64, 0u64, 0u64, 0u64, Duration::ZERO);
    let n_ticks = (args.seconds * HZ) as u64;
    let start = Instant::now();
    for tick in 0..n_ticks {
        walkers.step(&ground, SPEED * ground.metre / HZ, &mut place);
        let players: Vec<Player> = walkers
            .at
            .iter()
            .map(|&p| Player { body: Body { reach, ..ground.body(p) }, role: PlayerRole::ALONE })
            .collect();
        let since = Instant::now();
        if args.way == Way::Relevance {
            relevance.update(tick as f64 / HZ, &players);
        }
        let shows = |to: usize, of: usize| match args.way {
            Way::Relevance => relevance.is_shown(to as u32, of as u32),
            Way::Everything => true,
            Way::NineRays => {
                let corners = players[of].body.seen.corners();
                let eye = walkers.at[to];
                ground.is_free(eye, walkers.at[of]) || corners.into_iter().any(|corner| ground.is_free(eye, corner))
            }
        };
        let shown: Vec<Vec<bool>> = (0..n).map(|to| (0..n).map(|of| to != of && shows(to, of)).collect()).collect();
        busy += since.elapsed();
        for (to, address) in addresses.iter().enumerate() {
            packet.clear();
            packet.extend((tick as u16).to_le_bytes());
            for of in (0..n).filter(|&of| shown[to][of]) {
                packet.extend((of as u16).to_le_bytes());
                walkers.at[of].iter().for_each(|&x| packet.extend((x as f32).to_le_bytes()));
            }
            n_bytes += server.send_to(&packet, address)? as u64;
        }
        // Clients read what there is.
        for client in &clients {
            while let Ok(len) = client.recv(&mut inbox) {
                n_got += len as u64;
            }
        }
        sent.push_back(shown);
        if sent.len() > delay {
            let drawn = sent.pop_front().ok_or("nothing was sent")?;
            for _ in 0..n {
                let (to, of) = (random.below(n), random.below(n));
                let part = ground.part_of(walkers.at[of], &mut random);
                if to != of && ground.is_free(walkers.at[to], part) {
                    n_seen += 1;
                    n_late += u64::from(!drawn[to][of]);
                }
            }
        }
        if !args.fast {
            let due = Duration::from_secs_f64((tick + 1) as f64 / HZ);
            std::thread::sleep(due.saturating_sub(start.elapsed()));
        }
    }
    let all = n_ticks * n as u64 * (2 + ENTRY * (n - 1)) as u64;
    println!("{} cells, {n} bots, {n_ticks} ticks in {:.1} s", table.n_cells(), start.elapsed().as_secs_f64());
    println!(
        "sent     {n_bytes} bytes, {:.1} % of all places to all; {n_got} bytes came in",
        100.0 * n_bytes as f64 / all.max(1) as f64
    );
    println!(
        "work     {:.0} µs a tick to decide who is told of whom",
        busy.as_secs_f64() * 1e6 / n_ticks.max(1) as f64
    );
    println!(
        "late     {n_late} of {n_seen} sights that were tried, {:.0} ms after they were sent",
        delay as f64 / HZ * 1e3
    );
    Ok(())
}
