//! Bakes a plan, proves its table, and checks the proofs: that of an office, or the first map of a WAD.
//!
//! Run as `cargo run --release -p sightlines-bake --example prove_a_plan -- [MAP.wad]`.

use sightlines_bake::{PlanBakeOptions, Proofs, bake_plan, certify_table};
use sightlines_cells::Plan;
use sightlines_certificates::planar::PlanarProofs;
use sightlines_formats::{DoomMap, Wad, doom::list_maps};
use sightlines_scenes::{OfficeOptions, office};
use sightlines_stabtree::{CertifyOptions, planar_network};
use std::error::Error;
use std::time::Instant;

fn plan() -> Result<Plan, Box<dyn Error>> {
    let Some(path) = std::env::args().nth(1) else {
        return Ok(office(OfficeOptions { seed: 5, rooms_x: 10, rooms_y: 4, ..OfficeOptions::default() })?);
    };
    let wad = Wad::read(path)?;
    let lumps = list_maps(&wad).into_iter().next().ok_or("no map")?;
    Ok(DoomMap::parse(&wad, &lumps)?.plan()?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let baked = bake_plan(&plan()?, &PlanBakeOptions::default())?;
    let table = &baked.table;
    let n = table.n_cells() as u64;
    println!(
        "{n} cells, {} pairs see each other, {} do not; decided in {:?}",
        baked.report.n_visible_pairs,
        n * (n - 1) / 2 - baked.report.n_visible_pairs,
        baked.report.see_time
    );
    let certified = certify_table(table, &baked.graph, &CertifyOptions::default())?;
    let bytes = certified.proofs.to_bytes();
    let Proofs::Plan(made) = &certified.proofs else { return Err("a plan has proofs of a plan".into()) };
    let n_blocks: usize = made.walks.iter().map(|walk| walk.decisions.blocks.len()).sum();
    println!(
        "proven in {:?}: {} lines, {} walks with {n_blocks} blocked chains, {} bytes",
        certified.time,
        made.lines.len(),
        made.walks.len(),
        bytes.len()
    );
    let start = Instant::now();
    let proofs = PlanarProofs::from_bytes(&bytes)?;
    let proven = proofs.check(&planar_network(&baked.graph)?)?;
    println!(
        "checked in {:?}: {} pairs are visible, {} are hidden, {} are open",
        start.elapsed(),
        proven.visible.len(),
        proven.hidden.len(),
        proven.n_open()
    );
    Ok(())
}
