//! Prints the size of one scene of every generator.

use sightlines_cells::Plan;
use sightlines_scenes::{
    OfficeOptions, SceneError, TowerOptions, degenerate, doom_like, maze, office, pillared_hall, tower,
    turned_pillared_hall,
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
    Ok(())
}
