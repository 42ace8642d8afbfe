//! Towers and real buildings, against a ray tracer over all triangles.

use crate::eye_to_cell::ask::{Answer, Asker, missed, missed_within_bounds, not_nested};
use crate::eye_to_cell::picture::{Picture, minus};
use sightlines::bake::{SceneBakeOptions, StabOptions, bake_scene, from_table, with_stab_trees};
use sightlines::cells::Scene;
use sightlines::eye_to_cell::{Doors, View};
use sightlines::formats::scene::read_scene;
use sightlines::geometry::{Aabb, Point3};
use sightlines::pvs::{CellId, Table};
use sightlines::scenes::{TowerOptions, tower};
use sightlines_testkit::{CellIndex, Random, RayScene};
use sightlines_tests::data_folder;
use std::collections::BTreeSet;

#[derive(Debug, Default)]
struct Counts {
    n_frames: usize,
    n_seen: usize,
    /// Of the exact answers all round.
    n_exact: usize,
    n_confirmed: usize,
    n_cells: [usize; 5],
    n_objects: [usize; 5],
}

/// A scene, its table, and rays through it.
struct Stage {
    table: Table,
    rays: RayScene,
    index: CellIndex,
}

impl Stage {
    fn new(scene: &Scene) -> Self {
        let table = bake_scene(scene, &SceneBakeOptions::default()).expect("a scene").table;
        let rays = RayScene::new(scene);
        let bounds: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
        Self { index: rays.cell_index(&bounds), table, rays }
    }

    /// An eye: anywhere in a cell, in the middle of a portal or near its rim, or on a corner of a cell.
    fn eye(&self, kind: usize, random: &mut Random) -> Point3 {
        let cell = &self.table.cells()[random.below(self.table.n_cells())];
        let portal = &self.table.portals()[random.below(self.table.portals().len())].points;
        let place = Aabb::around(portal.iter().copied());
        match kind % 4 {
            0 => random.point(&Aabb { min: cell.min, max: cell.max }),
            1 => random.point(&place),
            2 => [0, 1, 2].map(|k| 0.5 * (place.min[k] + place.max[k])),
            _ => [0, 1, 2].map(|k| if random.below(2) == 0 { cell.min[k] } else { cell.max[k] }),
        }
    }

    /// Adds what a ray passes and meets. Returns whether it found anything.
    fn shoot(&self, eye: Point3, direction: Point3, seen: &mut Answer) -> bool {
        let Some(mut line) = self.rays.clear_line(eye, direction) else { return false };
        // Only what is ahead.
        line.clear[0] = 0.0;
        let mut passed = Vec::new();
        self.index.passed(&line, &mut passed);
        seen.cells.extend(passed);
        seen.objects.extend(line.ends[1]);
        true
    }

    /// A direction: towards a corner of a portal that the cell may look through or a little beside it, or any.
    fn towards(&self, eye: Point3, near: &[CellId], random: &mut Random) -> Point3 {
        let portal = &self.table.portals()[random.below(self.table.portals().len())];
        let may_see = |cell: &CellId| near.iter().any(|root| self.table.sees(*root, *cell));
        let corner = portal.points[random.below(portal.points.len())];
        let aim = minus(corner, eye);
        if random.below(4) == 0 || aim == [0.0; 3] || !portal.cells.iter().any(may_see) {
            return random.direction();
        }
        let beside = random.direction().map(|x| x * [1e-5, 1e-3, 0.05][random.below(3)]);
        let length = aim.iter().map(|x| x * x).sum::<f64>().sqrt();
        [0, 1, 2].map(|k| aim[k] / length + beside[k])
    }

    /// Looks from `n_eyes` places, in pictures and all round, with `n_rays` each.
    fn check(&self, tables: &[&Table], n_eyes: usize, n_rays: usize, counts: &mut Counts) -> Result<(), String> {
        let mut askers: Vec<Asker<'_>> = tables.iter().map(|table| Asker::new(table)).collect();
        for kind in 0..n_eyes {
            let mut random = Random::new(11, kind as u64);
            let eye = self.eye(kind, &mut random);
            let roots = self.table.in_dimension().unwrap().at(eye).cells().to_vec();
            let mut all = Answer::default();
            for frame in 0..4 {
                let aim = self.towards(eye, &roots, &mut random);
                let picture = Picture::random(eye, aim, &mut random);
                let mut seen = Answer::default();
                for _ in 0..n_rays {
                    let aim = self.towards(eye, &roots, &mut random);
                    let direction = if picture.contains(aim) { aim } else { picture.direction(&mut random) };
                    self.shoot(eye, direction, &mut seen);
                }
                all.cells.extend(&seen.cells);
                all.objects.extend(&seen.objects);
                let round = View::all_round(eye).expect("a finite eye");
                let view = if frame == 3 { &round } else { &picture.view };
                let seen = if frame == 3 { all.clone() } else { seen };
                for asker in &mut askers {
                    let answers = asker.all(&roots, view, &Doors::all_open());
                    if let Some(wrong) = not_nested(&answers)
                        .or_else(|| missed(&answers, &seen))
                        .or_else(|| missed_within_bounds(&asker.bounded, &seen))
                    {
                        return Err(format!("{wrong}: eye {eye:?} in {roots:?}, view {view:?}"));
                    }
                    counts.n_frames += 1;
                    counts.n_seen += seen.cells.len() + seen.objects.len();
                    for (method, answer) in answers.iter().enumerate() {
                        counts.n_cells[method] += answer.cells.len();
                        counts.n_objects[method] += answer.objects.len();
                    }
                    if frame == 3 && !all.cells.is_empty() {
                        let exact = self.confirm(eye, &answers[4].cells, &mut all, &mut random);
                        counts.n_exact += answers[4].cells.len();
                        counts.n_confirmed += exact;
                    }
                }
            }
        }
        Ok(())
    }

    /// How many of some cells rays pass, aimed at those that none was seen to pass.
    fn confirm(&self, eye: Point3, cells: &BTreeSet<u32>, seen: &mut Answer, random: &mut Random) -> usize {
        for &cell in cells {
            let record = &self.table.cells()[cell as usize];
            let place = Aabb { min: record.min, max: record.max };
            let mut tries = 0;
            while !seen.cells.contains(&cell) && tries < 60 {
                let aim = minus(random.point(&place), eye);
                self.shoot(eye, aim, seen);
                tries += 1;
            }
        }
        cells.intersection(&seen.cells).count()
    }
}

/// Invariant: in a furnished tower the answers are nested and miss nothing that a ray hits or passes, with stab
/// trees and without; and rays pass most cells of the exact answer.
#[test]
fn a_small_tower_is_seen_as_rays_see_it() {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let stage = Stage::new(&tower(options).expect("a small tower"));
    let stab = StabOptions { max_nodes: Some(500), ..StabOptions::default() };
    let trees = with_stab_trees(
        stage.table.clone(),
        &from_table::graph(&stage.table).expect("the table stores its graph"),
        &stab,
    )
    .expect("the table has its geometry")
    .table;
    let mut counts = Counts::default();
    stage.check(&[&stage.table, &trees], 40, 120, &mut counts).unwrap_or_else(|wrong| panic!("{wrong}"));
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 300 && counts.n_seen > 3_000, "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a > b) && counts.n_objects.is_sorted_by(|a, b| a >= b), "{counts:?}");
    assert!(counts.n_confirmed * 10 > counts.n_exact * 9, "{counts:?}");
}

/// The same in real buildings.
#[test]
fn real_buildings_are_seen_as_rays_see_them() {
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    for name in ["whale_large", "duplex"] {
        let file = folder.join(format!("scenes/{name}/{name}.glb"));
        let stage = Stage::new(&read_scene(file).unwrap_or_else(|e| panic!("{e}")).scene);
        let mut counts = Counts::default();
        stage.check(&[&stage.table], 24, 200, &mut counts).unwrap_or_else(|wrong| panic!("{name}: {wrong}"));
        eprintln!("{name}: {counts:?}");
        assert!(counts.n_frames == 96 && counts.n_seen > 1_000, "{name}: {counts:?}");
        assert!(counts.n_cells.is_sorted_by(|a, b| a > b), "{name}: {counts:?}");
    }
}
