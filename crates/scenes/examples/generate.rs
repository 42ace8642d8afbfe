//! Prints the size of one scene of every generator.

use sightlines_cells::Plan;
use sightlines_scenes::{
    BspWorldOptions, OfficeOptions, QuakeLikeOptions, SceneError, TowerOptions, World, bsp_world, degenerate,
    doom_like, maze, office, pillared_hall, quake_like, tower, turned_pillared_hall, world,
};

fn main() -> Result<(), SceneError> {
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
    Ok(())
}
