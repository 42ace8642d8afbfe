//! Bakes any input in one call, as the program `sightlines build` does: a plan, a scene in space by two methods, and the
//! clusters of a Quake map; then adds stab trees and proofs, from the graph that the bake returns.
//!
//! Run as `cargo run --release -p sightlines-bake --example any_input`.

use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::{BakeInput, BakeRequest, Baked, CellsFrom, Report, Runtime, SceneMethod, StabOptions, bake};
use sightlines_formats::quake::prt::parse_prt;
use sightlines_scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines_stabtree::CertifyOptions;
use std::error::Error;

/// Bakes, and prints what the table and the report say.
fn show<'i>(what: &str, input: impl Into<BakeInput<'i>>, options: &BakeRequest) -> Result<Baked, Box<dyn Error>> {
    let baked = bake(input, options)?;
    let n_pairs = match &baked.report {
        Report::Plan(report) => report.n_visible_pairs,
        Report::Scene(report) => report.n_visible_pairs,
        Report::Regions(report) => report.n_visible_pairs,
        Report::Clusters(report) => report.n_visible_pairs(),
        Report::Map(report) => report.clusters.n_visible_pairs(),
        _ => 0,
    };
    let (n_cells, n_portals) = (baked.graph.n_cells(), baked.graph.n_portals());
    println!("{what}: {}, {n_cells} cells, {n_portals} portals, {n_pairs} visible pairs", baked.table.kind());
    Ok(baked)
}

/// A portal file of three rooms in a row, with a window between neighbours.
const ROOMS: &[u8] = b"PRT1\n3\n2\n4 0 1 (8 0 0) (8 2 0) (8 2 2) (8 0 2)\n4 1 2 (16 6 6) (16 8 6) (16 8 8) (16 6 8)\n";

fn main() -> Result<(), Box<dyn Error>> {
    let floor = office(OfficeOptions { seed: 5, rooms_x: 6, rooms_y: 3, ..OfficeOptions::default() })?;
    let scene = tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() })?;
    let rooms = parse_prt(ROOMS)?;
    let standard = BakeRequest::default();

    let plan = show("an office floor", &floor, &standard)?;
    show("a storey by sightlines", &scene, &standard)?;
    let method = Some(SceneMethod::FromRegion(OcclusionMethod::Shafts));
    let grid = BakeRequest { method, cells: Some(CellsFrom::Grid([3, 1, 2])), ..BakeRequest::default() };
    show("a grid in the storey by view shafts", &scene, &grid)?;
    show("rooms of a portal file", &rooms, &standard)?;

    let auto = BakeRequest { method: Some(SceneMethod::Auto), ..BakeRequest::default() };
    let prepared = auto.prepare(&scene, &Runtime::default())?;
    let choice = prepared.decisions().choice.as_ref().ok_or("nothing was chosen")?;
    println!("auto chooses {} for the storey: {}", choice.method, choice.reasons.join("; "));
    assert_eq!(prepared.recipe().method, SceneMethod::Sightlines, "its walls are perpendicular to axes");

    let (plan, trees) = plan.with_stab_trees(&StabOptions::default())?;
    println!("the floor has {} sequences of portals with a sightline", trees.trees.n_sequences);
    let certified = plan.certify(&CertifyOptions::default())?;
    println!("its proofs take {} bytes", certified.proofs.to_bytes().len());
    Ok(())
}
