//! A scene far from the origin has the same table as near it.

use sightlines::bake::{SceneBakeOptions, bake_scene};
use sightlines::cells::Scene;
use sightlines::pvs::{CellId, Table};
use sightlines::scenes::{TowerOptions, tower};

/// Coordinates of towers are multiples of 1/64, so this shift rounds nothing.
const SHIFT: [f64; 3] = [1e7, -1e7, 1e7];

fn shifted(p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| p[k] + SHIFT[k])
}

fn moved(scene: &Scene) -> Scene {
    let mut objects = scene.objects().to_vec();
    objects.iter_mut().flat_map(|o| &mut o.vertices).for_each(|p| *p = shifted(*p));
    Scene::new(objects).unwrap()
}

/// The table, moved as well.
fn moved_table(table: &Table) -> Table {
    let mut parts = table.clone().into_parts();
    parts.cells.iter_mut().for_each(|c| (c.min, c.max) = (shifted(c.min), shifted(c.max)));
    parts.portals.iter_mut().flat_map(|p| &mut p.points).for_each(|p| *p = shifted(*p));
    parts.objects.iter_mut().for_each(|o| (o.min, o.max) = (shifted(o.min), shifted(o.max)));
    parts.locator = sightlines::pvs::Locator::build(&parts.cell_bounds(), 3);
    Table::new(parts).unwrap()
}

/// Invariant: moving a scene moves cells, portals and objects, and changes no bit of what is seen.
#[test]
fn a_scene_far_away_has_the_same_table() {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let near = tower(options).unwrap();
    let bake = |scene: &Scene| bake_scene(scene, &SceneBakeOptions::default()).unwrap().table;
    let (here, there) = (bake(&near), bake(&moved(&near)));
    assert!(here.n_cells() > 20 && !here.objects().is_empty());
    assert_eq!(here.n_cells(), there.n_cells());
    for cell in (0..here.n_cells() as u32).map(CellId) {
        let seen = |table: &Table| table.visible(cell).map(|c| c.0).collect::<Vec<_>>();
        assert_eq!(seen(&here), seen(&there), "cells that cell {cell} sees");
        assert_eq!(here.visible_objects(cell), there.visible_objects(cell), "objects that cell {cell} sees");
    }
    assert_eq!(here.parts().cell_objects, there.parts().cell_objects);
    let (expected, found) = (moved_table(&here).into_parts(), there.into_parts());
    assert_eq!((&expected.cells, &expected.portals, &expected.info), (&found.cells, &found.portals, &found.info));
    assert_eq!(expected.objects, found.objects);
    // The impostor: a cell that is moved by one unit less is noticed.
    let mut cells = found.cells.clone();
    cells[0].min[0] -= 1.0;
    assert_ne!(expected.cells, cells);
}
