//! All 100 maps of Freedoom on one thread: the time of each map, the total, and a comparison with the tables that Freedoom ships,
//! which are those of ZenNode. Needs `SIGHTLINES_FREEDOOM`.

use clap::Parser;
use sightlines::bake::reject::{RejectOptions, reject_table};
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::{RejectTable, Wad};
use sightlines_benches::program::Common;
use std::path::Path;
use std::time::{Duration, Instant};

/// REJECT tables of Freedoom.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
}

fn main() {
    let Args { common } = Args::parse();
    if !common.is_wanted("bake/reject/freedoom") {
        return;
    }
    let Some(folder) = std::env::var_os("SIGHTLINES_FREEDOOM") else {
        eprintln!("SKIPPED: SIGHTLINES_FREEDOOM is not set, so Freedoom is not benched");
        return;
    };
    let mut maps: Vec<(String, u32, Duration)> = Vec::new();
    let (mut only_shipped, mut only_ours) = (0u64, 0u64);
    for name in ["freedoom1.wad", "freedoom2.wad", "freedm.wad"] {
        let wad = Wad::read(Path::new(&folder).join(name)).unwrap_or_else(|e| panic!("{e}"));
        for lumps in list_maps(&wad).iter().take(if common.test { 1 } else { usize::MAX }) {
            let start = Instant::now();
            let map = DoomMap::parse(&wad, lumps).unwrap_or_else(|e| panic!("{e}"));
            let options = RejectOptions { threads: 1, ..RejectOptions::default() };
            let (table, _) = reject_table(&map, &options).unwrap_or_else(|e| panic!("{e}"));
            let time = start.elapsed();
            assert!(!table.has_hand_made_effects());
            maps.push((format!("{name} {}", map.name()), map.n_sectors(), time));
            if let Some(shipped) = map.reject().and_then(|b| RejectTable::from_bytes(map.n_sectors(), b).ok()) {
                let pairs = (0..map.n_sectors()).flat_map(|a| (0..map.n_sectors()).map(move |b| (a, b)));
                for (a, b) in pairs {
                    only_shipped += u64::from(shipped.get(a, b) && !table.get(a, b));
                    only_ours += u64::from(table.get(a, b) && !shipped.get(a, b));
                }
            }
        }
    }
    let total: Duration = maps.iter().map(|m| m.2).sum();
    maps.sort_by_key(|m| std::cmp::Reverse(m.2));
    for (name, n_sectors, time) in maps.iter().take(5) {
        println!("bake/reject/{name}: {n_sectors} sectors, {:.0} ms", time.as_secs_f64() * 1e3);
    }
    println!("bake/reject/freedoom: {} maps, {:.2} s on one thread", maps.len(), total.as_secs_f64());
    println!("rejected by the shipped tables only: {only_shipped}; by ours only: {only_ours}");
}
