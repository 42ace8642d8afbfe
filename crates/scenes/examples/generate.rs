//! Prints the size of one scene of every generator.

use sightlines_cells::Plan;
use sightlines_scenes::{
    BspWorldOptions, DepthPairsOptions, GenerateError, OfficeOptions, QuakeLikeOptions, SurfaceOptions, TowerOptions,
    World, bsp_world, coplanar, cycles, degenerate, depth_pairs, doom_like, interleaved, lattice, maze, office,
    pillared_hall, quake_like, slivers, soup, split_worst, tower, turned_pillared_hall, world,
};

fn main() -> Result<(), GenerateError> {
    let show = |name: &str, plan: &Plan| {
        let kind = if plan.is_axial() { "axial" } else { "not axial" };
        let (lines, groups, objects) = (plan.lines().len(), plan.n_groups(), plan.objects().len());
        println!("{name}: {lines} lines ({kind}), {groups} groups, {objects} objects");
    };
    show("office", &office(OfficeOptions::default())?);
    show("office with thick walls", &office(OfficeOptions { wall_thickness: 0.25, ..Default::default() })?);
    show("maze", &maze(1, 40, 30)?);
    show("pillared hall", &pillared_hall(1, 12, 8)?);
    show("hall with turned pillars", &turned_pillared_hall(1, 12, 8)?);
    show("Doom-like map", &doom_like(1, 8)?);
    for (name, plan) in degenerate::all() {
        show(name, &plan);
    }
    for floors in [1, 4, 16, 64] {
        let scene = tower(TowerOptions { floors, ..Default::default() })?;
        println!("tower of {floors} floors: {} objects, {} triangles", scene.objects().len(), scene.n_triangles());
    }
    let show = |name: &str, world: &World| {
        let (leafs, cells, portals) = (world.leafs.len(), world.graph.n_cells(), world.graph.portals().len());
        println!("{name}: {leafs} leafs, {cells} cells, {portals} portals");
    };
    show("random world", &bsp_world(BspWorldOptions { leafs: 1000, ..Default::default() })?);
    show("Quake-like level", &quake_like(QuakeLikeOptions::default())?);
    show("large Quake-like level", &quake_like(QuakeLikeOptions { rooms_x: 8, rooms_y: 8, floors: 2, seed: 1 })?);
    for (name, world) in world::world_families() {
        show(name, &world);
    }
    let some = SurfaceOptions::default();
    for scene in [soup(some)?, coplanar(some)?, slivers(some)?, cycles(999)?, interleaved(1000)?, lattice(1000)?] {
        println!("{}: {} objects, {} triangles", scene.objects()[0].name, scene.objects().len(), scene.n_triangles());
    }
    let (worst, pairs) = (split_worst(1000)?, depth_pairs(DepthPairsOptions::default())?);
    println!("worst case for splits: {} triangles; pairs of faces: {}", worst.n_triangles(), pairs.objects().len() / 2);
    Ok(())
}
