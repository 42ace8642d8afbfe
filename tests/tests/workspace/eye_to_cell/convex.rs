//! Worlds of convex cells, against rays through what is solid.

use crate::eye_to_cell::ask::{Answer, Asker, missed, missed_within_bounds, not_nested};
use crate::eye_to_cell::picture::{Picture, along, dot, minus};
use crate::eye_to_cell::plans::reachable;
use sightlines::bake::{StabOptions, from_table, with_stab_trees};
use sightlines::eye_to_cell::{Doors, View};
use sightlines::geometry::{Aabb, Point3};
use sightlines::pvs::{
    CellId, CellRecord, Locator, ObjectId, ObjectRecord, PortalId, PortalRecord, Table, TableKind, TableParts,
};
use sightlines::scenes::world::{
    BspWorldOptions, QuakeLikeOptions, World, WorldLeaf, bsp_world, quake_like, world_families,
};
use sightlines_testkit::Random;
use sightlines_tests::merged::{Merged, exact};

/// The table of the clusters of a world: boxes around leafs, portals, visibility; every cell is an object as well.
fn table(world: &World, Merged { of, graph }: &Merged) -> Table {
    let mut boxes = vec![Aabb::EMPTY; graph.n_cells()];
    for (leaf, &cell) in world.cells().iter().zip(of) {
        let (around, b) = (&mut boxes[cell as usize], leaf.bounds());
        *around = around.with(b.min).with(b.max);
    }
    let cell = |b: &Aabb<3>| CellRecord { min: b.min, max: b.max, group: None, polygon: vec![] };
    let cells: Vec<CellRecord> = boxes.iter().map(cell).collect();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    // Portals of worlds turn about the direction of crossing, those of tables towards who crosses.
    let portal = |p: &sightlines::cells::Portal<sightlines::cells::Convex>| PortalRecord {
        cells: p.cells,
        sides: p.sides,
        points: p.shape.reversed().corners().to_vec(),
    };
    let object = |c: &CellRecord| ObjectRecord { name: String::new(), min: c.min, max: c.max };
    let parts = TableParts {
        portals: graph.portals().iter().map(portal).collect(),
        rows: exact(graph).cells,
        objects: cells.iter().map(object).collect(),
        cell_objects: (0..cells.len() as u32).map(|id| vec![ObjectId(id)]).collect(),
        locator: Locator::build(&bounds, 3),
        cells,
        // As tables of portal files, so that stab trees know what they are.
        ..TableParts::empty(3, TableKind::QuakePortalFile)
    };
    Table::new(parts).expect("the parts fit together")
}

/// The range of a ray inside a leaf whose planes are moved outwards.
fn inside(leaf: &WorldLeaf, eye: Point3, d: Point3, outwards: f64, range: [f64; 2]) -> Option<[f64; 2]> {
    let mut range = range;
    for plane in &leaf.planes {
        let length = dot(plane.normal.map(f64::from), plane.normal.map(f64::from)).sqrt();
        let (at, by) = (plane.distance(eye) - outwards, dot(plane.normal.map(f64::from), d) / length);
        if by == 0.0 {
            if at > 0.0 {
                return None;
            }
        } else if by > 0.0 {
            range[1] = range[1].min(-at / by);
        } else {
            range[0] = range[0].max(-at / by);
        }
    }
    (range[0] < range[1]).then_some(range)
}

struct Stage<'w> {
    leafs: Vec<&'w WorldLeaf>,
    /// The cell of each.
    of: &'w [u32],
    solids: Vec<&'w WorldLeaf>,
    /// Rays keep this far from what is solid, and come this deep into what they pass.
    clear: f64,
}

impl<'w> Stage<'w> {
    fn new(world: &'w World, of: &'w [u32]) -> Self {
        let b = world.bounds();
        let size = (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
        Self { leafs: world.cells(), of, solids: world.solids().collect(), clear: size / f64::from(1 << 20) }
    }

    /// Adds the cells that a ray passes before it comes near anything solid. `closed` are portals in the way.
    fn shoot(&self, closed: &[&PortalRecord], eye: Point3, d: Point3, seen: &mut Answer) {
        let ahead = [0.0, f64::INFINITY];
        let length = dot(d, d).sqrt();
        let d = d.map(|x| x / length);
        let solid = self.solids.iter().filter_map(|leaf| inside(leaf, eye, d, self.clear, ahead)).map(|r| r[0]);
        let doors = closed.iter().filter_map(|portal| {
            let [p, q, r] = [0, 1, 2].map(|k| portal.points[k]);
            let [u, v] = [minus(q, p), minus(r, p)];
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            // Everything that crosses the plane of a closed portal stops there: less is seen, and that is enough.
            let t = dot(minus(p, eye), normal) / dot(d, normal);
            (t >= -self.clear).then_some((t - self.clear).max(0.0))
        });
        let end = solid.chain(doors).fold(f64::INFINITY, f64::min);
        let passed = |leaf: &WorldLeaf| inside(leaf, eye, d, -self.clear, [0.0, end]).is_some();
        let passed: Vec<u32> =
            self.of.iter().zip(&self.leafs).filter(|(_, leaf)| passed(leaf)).map(|(id, _)| *id).collect();
        seen.cells.extend(&passed);
        seen.objects.extend(&passed);
    }

    /// The cells that a viewer is in, all of those that are as near as rounding.
    fn locate(&self, eye: Point3) -> Vec<CellId> {
        let near = |leaf: &WorldLeaf| leaf.depth(eye) > -1e-3 * self.clear;
        let mut cells: Vec<CellId> =
            self.of.iter().zip(&self.leafs).filter(|(_, leaf)| near(leaf)).map(|(id, _)| CellId(*id)).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// The corners of all leafs of a cell.
    fn corners(&self, cell: u32) -> Vec<Point3> {
        let leafs = self.leafs.iter().zip(self.of).filter(|(_, of)| **of == cell);
        leafs.flat_map(|(leaf, _)| leaf.faces.concat()).collect()
    }
}

/// The middle of some points, weighted by chance.
fn mean(points: &[Point3], random: &mut Random) -> Point3 {
    let weights: Vec<f64> = points.iter().map(|_| random.unit()).collect();
    let sum: f64 = weights.iter().sum();
    let mut p = [0.0; 3];
    points.iter().zip(&weights).for_each(|(q, w)| p = along(p, *q, w / sum));
    p
}

#[derive(Debug, Default)]
struct Counts {
    n_frames: usize,
    n_seen: usize,
    n_exact: usize,
    n_confirmed: usize,
    n_cells: [usize; 5],
}

/// Looks from cells, portals and their corners.
fn check(world: &World, merged: &Merged, n_eyes: usize, counts: &mut Counts) -> Result<(), String> {
    let (stage, table) = (Stage::new(world, &merged.of), table(world, merged));
    if table.portals().is_empty() {
        return Ok(());
    }
    let stab = StabOptions { max_nodes: Some(100), threads: 1, ..StabOptions::default() };
    let trees = with_stab_trees(table.clone(), &from_table::graph(&table).expect("the table stores its graph"), &stab)
        .expect("the table has its geometry")
        .table;
    let mut askers = [Asker::new(&table), Asker::new(&trees)];
    for kind in 0..n_eyes {
        let mut random = Random::new(3, kind as u64);
        let portal = &table.portals()[random.below(table.portals().len())];
        let eye = match kind % 3 {
            0 => {
                let leaf = stage.leafs[random.below(stage.leafs.len())];
                mean(&leaf.faces.concat(), &mut random)
            }
            1 => mean(&portal.points, &mut random),
            _ => portal.points[random.below(portal.points.len())],
        };
        let roots = stage.locate(eye);
        let mut doors = Doors::all_open();
        if kind % 4 == 3 {
            (0..4).for_each(|_| _ = doors.close(PortalId(random.below(table.portals().len()) as u32)));
        }
        let closed: Vec<&PortalRecord> = (0..)
            .zip(table.portals())
            .filter(|(id, _)| !doors.is_open(PortalId(*id)))
            .map(|(_, portal)| portal)
            .collect();
        let towards = |random: &mut Random| {
            let portal = &table.portals()[random.below(table.portals().len())];
            let aim = match random.below(3) {
                0 => portal.points[random.below(portal.points.len())],
                _ => mean(&portal.points, random),
            };
            let aim = minus(aim, eye);
            if aim == [0.0; 3] || random.below(4) == 0 { random.direction() } else { aim }
        };
        let walked = reachable(&table, &roots, &doors);
        let mut all = Answer::default();
        for frame in 0..3 {
            let picture = Picture::random(eye, towards(&mut random), &mut random);
            let mut seen = Answer::default();
            for _ in 0..60 {
                let aim = towards(&mut random);
                let d = if picture.contains(aim) { aim } else { picture.direction(&mut random) };
                stage.shoot(&closed, eye, d, &mut seen);
            }
            all.cells.extend(&seen.cells);
            all.objects.extend(&seen.objects);
            let round = View::all_round(eye).expect("a finite eye");
            let (view, seen) = if frame == 2 { (&round, &all) } else { (&picture.view, &seen) };
            for asker in &mut askers {
                let answers = asker.all(&roots, view, &doors);
                let what = || format!("eye {eye:?} in {roots:?}, view {view:?}, {} doors closed", doors.n_closed());
                if let Some(wrong) = not_nested(&answers)
                    .or_else(|| missed(&answers, seen))
                    .or_else(|| missed_within_bounds(&asker.bounded, seen))
                {
                    return Err(format!("{wrong}: {}", what()));
                }
                if let Some(cell) = answers[2].cells.difference(&walked).next() {
                    return Err(format!("cell {cell} is behind closed portals: {}", what()));
                }
                counts.n_frames += 1;
                counts.n_seen += seen.cells.len();
                answers.iter().enumerate().for_each(|(k, answer)| counts.n_cells[k] += answer.cells.len());
                if frame == 2 && kind % 3 == 0 && closed.is_empty() {
                    let mut confirmed = seen.clone();
                    for &cell in &answers[4].cells {
                        let faces = stage.corners(cell);
                        for _ in 0..40 {
                            if !confirmed.cells.contains(&cell) {
                                stage.shoot(&[], eye, minus(mean(&faces, &mut random), eye), &mut confirmed);
                            }
                        }
                    }
                    counts.n_exact += answers[4].cells.len();
                    counts.n_confirmed += answers[4].cells.intersection(&confirmed.cells).count();
                }
            }
        }
    }
    Ok(())
}

/// Invariant: in worlds of convex cells, with any portals closed, the answers are nested and miss nothing that a
/// ray passes; and rays pass most of the exact answer.
#[test]
fn convex_worlds_are_seen_as_rays_see_them() {
    let mut counts = Counts::default();
    let mut look = |name: &str, world: &World, n_eyes: usize| {
        let leafs: Vec<u32> = (0..world.graph.n_cells() as u32).collect();
        let leafs = Merged::new(&world.graph, &leafs);
        check(world, &leafs, n_eyes, &mut counts).unwrap_or_else(|wrong| panic!("{name}: {wrong}"));
    };
    for (name, world) in world_families() {
        look(name, &world, 12);
    }
    for seed in 0..3 {
        let options = BspWorldOptions { seed, leafs: 40, solid_percent: 45, tilted_percent: 60 };
        let world = bsp_world(options).expect("options within their ranges");
        look("random", &world, 12);
        look("far", &world.moved([1e6, -1e6, 1e6]), 12);
        look("noise", &world.jittered(seed, 1e-13), 12);
        look("axial", &bsp_world(BspWorldOptions { tilted_percent: 0, ..options }).expect("as above"), 12);
    }
    let level = quake_like(QuakeLikeOptions { seed: 1, rooms_x: 2, rooms_y: 2, floors: 1 }).expect("few rooms");
    look("level", &level, 24);
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 2_000 && counts.n_seen > 6_000, "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a > b), "{counts:?}");
    assert!(counts.n_confirmed * 100 > counts.n_exact * 85, "{counts:?}");
}

/// The same where leafs are merged to clusters that are not convex. What is solid within one hides nothing, so rays pass less of the answer.
#[test]
fn merged_clusters_are_seen_as_rays_see_them() {
    let (mut counts, mut n_bent) = (Counts::default(), 0);
    for seed in 0..16 {
        let tilted_percent = if seed % 2 == 0 { 0 } else { 60 };
        let options = BspWorldOptions { seed, leafs: 40, solid_percent: 45, tilted_percent };
        let world = bsp_world(options).expect("options within their ranges");
        let merged = Merged::at_random(&world.graph, &mut Random::new(seed, 5), seed % 4 < 2);
        n_bent += usize::from(merged.as_if_convex().portals().len() < merged.graph.portals().len());
        check(&world, &merged, 16, &mut counts).unwrap_or_else(|wrong| panic!("seed {seed}: {wrong}"));
    }
    eprintln!("{n_bent} {counts:?}");
    assert!(n_bent > 12 && counts.n_frames > 1_000 && counts.n_seen > 3_000, "{n_bent} {counts:?}");
    assert!(counts.n_confirmed * 100 > counts.n_exact * 70, "{counts:?}");
}
