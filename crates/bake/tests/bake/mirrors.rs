//! Mirrors of tables: rays that hit a mirror hit a part of it in the cell where they hit, and parts are nowhere else.

use proptest::prelude::*;
use sightlines_bake::{PlanBakeOptions, SceneBakeOptions, Subdivide, bake_plan, bake_scene};
use sightlines_cells::{LineId, MovingObject, Plan, PlanLine, Scene, SceneObject};
use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, MirrorRecord, Table, TableParts};
use sightlines_testkit::mutate::SplitMix;

fn without(table: &Table, part: usize) -> Table {
    let mut parts = table.clone().into_parts();
    parts.mirrors.remove(part);
    Table::new(TableParts { ..parts }).unwrap()
}

fn cross(a: Point2, b: Point2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Where a ray meets a segment, as a share of the ray's direction and of the segment.
fn meet(eye: Point2, towards: Point2, a: Point2, b: Point2) -> Option<(f64, f64)> {
    let (d, e) = (towards, b - a);
    let turn = cross(d, e);
    let (t, s) = (cross(a - eye, e) / turn, cross(a - eye, d) / turn);
    (turn != 0.0 && t > 0.0 && (0.0..=1.0).contains(&s)).then_some((t, s))
}

/// Shoots rays from places in cells: the first wall that a ray meets is a mirror if and only if a part of it, as the cells
/// there have it, is met at the place, from its side. How many rays met mirrors, and how many met other walls.
fn check_plan(plan: &Plan, table: &Table, seed: u64) -> Result<[usize; 2], String> {
    let (mut random, mut n_met) = (SplitMix::new(seed), [0, 0]);
    let ends = |part: &MirrorRecord| [part.points[0], part.points[1]].map(|p| Point2::new(p[0], p[1]));
    for _ in 0..400 {
        let mut unit = || random.below(1 << 20) as f64 / f64::from(1 << 20);
        let bounds = plan.bounds();
        let eye = Point2::new(
            bounds.min[0] + unit() * (bounds.max[0] - bounds.min[0]),
            bounds.min[1] + unit() * (bounds.max[1] - bounds.min[1]),
        );
        let towards = Point2::new(unit() - 0.5, unit() - 0.5);
        if table.in_dimension().unwrap().at([eye.x, eye.y]).is_outside() {
            continue;
        }
        let walls = (0u32..).map(LineId).zip(plan.lines()).filter(|(_, line)| line.opaque);
        let mut hits: Vec<(f64, f64, LineId)> =
            walls.filter_map(|(id, l)| meet(eye, towards, l.a, l.b).map(|(t, s)| (t, s, id))).collect();
        hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        // Where two lines meet, or near an end, a ray does not tell.
        let Some(&(t, s, id)) = hits.first() else { continue };
        if hits.get(1).is_some_and(|next| next.0 < t * (1.0 + 1e-6)) || !(1e-6..1.0 - 1e-6).contains(&s) {
            continue;
        }
        let before = eye + towards * (t * (1.0 - 1e-7));
        let cells = table.in_dimension().unwrap().at([before.x, before.y]).cells().to_vec();
        let is_met = |part: &&MirrorRecord| {
            let [left, right] = ends(part);
            let near = meet(eye, towards, left, right).is_some_and(|(at, _)| (at / t - 1.0).abs() < 1e-9);
            // Seen from its side, the left end is on the left.
            near && cross(left - eye, right - eye) < 0.0
        };
        let found = table.mirrors().iter().filter(|part| cells.contains(&part.cell)).find(is_met);
        let wanted = plan.mirrors().binary_search(&id).is_ok();
        match found {
            Some(part) if !wanted => return Err(format!("{eye} {towards}: {part:?} where there is wall {id:?}")),
            None if wanted => return Err(format!("{eye} {towards}: nothing of mirror {id:?} in {cells:?}")),
            Some(part) if LineId(part.mirror.0) != id => return Err(format!("{part:?} instead of {id:?}")),
            _ => n_met[usize::from(!wanted)] += 1,
        }
    }
    Ok(n_met)
}

/// A hall of 8 by 6 with some walls on a grid, each of which is a mirror or not.
fn plan(walls: &[(usize, usize, usize, usize, bool)], slanted: bool) -> Plan {
    let p = |x: usize, y: usize| Point2::new(x as f64, y as f64);
    let hull = [(0, 0, 8, 0), (8, 0, 8, 6), (8, 6, 0, 6), (0, 6, 0, 0)].map(|(a, b, c, d)| (a, b, c, d, a == 8));
    let mut lines = Vec::new();
    let mut mirrors = Vec::new();
    for &(ax, ay, bx, by, is_mirror) in hull.iter().chain(walls) {
        let b = if slanted {
            p(bx, by)
        } else if (ax + ay) % 2 == 0 {
            p(ax, by)
        } else {
            p(bx, ay)
        };
        if p(ax, ay) == b {
            continue;
        }
        if is_mirror {
            mirrors.push(LineId(lines.len() as u32));
        }
        lines.push(PlanLine::wall(p(ax, ay), b));
    }
    Plan::new(lines, vec![]).unwrap().with_mirrors(mirrors).unwrap()
}

/// Whether two lines have more than a point in common: there a ray hits both.
fn overlaps(plan: &Plan) -> bool {
    let on = |l: &PlanLine, p: Point2| cross(l.b - l.a, p - l.a) == 0.0;
    let along = |l: &PlanLine, p: Point2| (l.b - l.a).dot(p - l.a) / (l.b - l.a).length_squared();
    plan.lines().iter().enumerate().any(|(i, l)| {
        plan.lines()[i + 1..].iter().any(|m| {
            let [a, b] = [along(l, m.a), along(l, m.b)];
            on(l, m.a) && on(l, m.b) && a.min(b) < 1.0 && a.max(b) > 0.0
        })
    })
}

fn walls() -> impl Strategy<Value = Vec<(usize, usize, usize, usize, bool)>> {
    prop::collection::vec((0..9usize, 0..7usize, 0..9usize, 0..7usize, any::<bool>()), 0..7)
}

proptest! {
    /// Of plans whose walls follow the axes, in both subdivisions.
    #[test]
    fn rays_hit_the_mirrors_of_axial_plans(walls in walls(), seed in any::<u64>()) {
        let plan = plan(&walls, false);
        prop_assume!(!overlaps(&plan));
        for subdivide in [Subdivide::KdTree, Subdivide::Triangulation] {
            let baked = bake_plan(&plan, &PlanBakeOptions { subdivide, threads: 1, ..PlanBakeOptions::default() }).unwrap();
            prop_assert_eq!(baked.report.n_lost_mirrors, 0);
            prop_assert_eq!(baked.report.n_mirror_parts, baked.table.mirrors().len());
            let n = check_plan(&plan, &baked.table, seed);
            prop_assert!(n.as_ref().is_ok_and(|n| n[0] + n[1] > 50), "{subdivide}: {n:?}");
        }
    }

    /// Of plans with walls in any direction. A mirror that crosses others at points without doubles may be lost, and then
    /// says so.
    #[test]
    fn rays_hit_the_mirrors_of_slanted_plans(walls in walls(), seed in any::<u64>()) {
        let plan = plan(&walls, true);
        prop_assume!(!overlaps(&plan));
        let options = PlanBakeOptions { subdivide: Subdivide::Triangulation, threads: 1, ..PlanBakeOptions::default() };
        let baked = bake_plan(&plan, &options).unwrap();
        prop_assert!(baked.report.n_lost_mirrors == 0 || baked.report.n_rounded_crossings > 0);
        prop_assume!(baked.report.n_lost_mirrors == 0 && baked.report.n_dropped_pieces == 0);
        let n = check_plan(&plan, &baked.table, seed);
        prop_assert!(n.as_ref().is_ok_and(|n| n[0] + n[1] > 50), "{n:?}");
    }
}

/// Two rooms, between them a wall that is a mirror, with a door beside it.
fn two_rooms() -> Plan {
    plan(&[(4, 2, 4, 6, true), (4, 1, 4, 0, false)], true)
}

#[test]
fn parts_are_found_on_both_sides_and_a_missing_one_is_noticed() {
    let plan = two_rooms();
    for subdivide in [Subdivide::KdTree, Subdivide::Triangulation] {
        let table = bake_plan(&plan, &PlanBakeOptions { subdivide, ..PlanBakeOptions::default() }).unwrap().table;
        let [n_mirrors, n_walls] = check_plan(&plan, &table, 5).unwrap();
        assert!(n_mirrors > 50 && n_walls > 50, "{n_mirrors} {n_walls}");
        // From the west the left end is in the north... of one who looks east.
        let wall: Vec<&MirrorRecord> = table.mirrors().iter().filter(|part| part.mirror.0 == 4).collect();
        let looks_east = |part: &&MirrorRecord| part.points[0][1] > part.points[1][1];
        assert!(wall.iter().any(looks_east) && wall.iter().any(|part| !looks_east(part)));
        assert_eq!(Table::from_bytes(&table.to_bytes()).as_ref(), Ok(&table));
        for part in 0..table.mirrors().len() {
            let impostor = without(&table, part);
            assert!((0..20).any(|seed| check_plan(&plan, &impostor, seed).is_err()), "{:?}", table.mirrors()[part]);
        }
    }
}

#[test]
fn mirrors_that_are_not_followed_are_counted() {
    let options = PlanBakeOptions { subdivide: Subdivide::KdTree, ..PlanBakeOptions::default() };
    let baked = bake_plan(&plan(&[(1, 1, 3, 2, true), (5, 1, 5, 4, true)], true), &options).unwrap();
    assert_eq!((baked.report.n_lost_mirrors, baked.report.n_ignored_walls), (1, 1));
}

/// A box as an object, with its fronts outwards.
fn cuboid(name: &str, min: [f64; 3], max: [f64; 3]) -> SceneObject {
    let corner = |k: u32| std::array::from_fn(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

fn quad(name: &str, corners: [[f64; 3]; 4]) -> SceneObject {
    SceneObject { name: name.to_owned(), vertices: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

/// A hall with a pillar, a mirror on its east wall, one that stands in the hall, one that is too small to cut cells, and one
/// that leans.
fn hall() -> Scene {
    let inside = SceneObject {
        triangles: cuboid("", [0.0; 3], [1.0; 3]).triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        ..cuboid("hall", [0.0, 0.0, 0.0], [16.0, 4.0, 12.0])
    };
    let objects = vec![
        inside,
        cuboid("pillar", [6.0, 0.0, 5.0], [7.0, 4.0, 6.0]),
        quad("east", [[16.0, 1.0, 2.0], [16.0, 3.0, 2.0], [16.0, 3.0, 9.0], [16.0, 1.0, 9.0]]),
        quad("free", [[10.0, 0.0, 3.0], [10.0, 3.5, 3.0], [10.0, 3.5, 8.0], [10.0, 0.0, 8.0]]),
        quad("small", [[3.0, 1.0, 2.0], [3.2, 1.0, 2.0], [3.2, 1.0, 2.2], [3.0, 1.0, 2.2]]),
        quad("leaning", [[1.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.5], [1.0, 2.0, 1.5]]),
    ];
    Scene::new(objects).unwrap().with_mirrors(vec![2, 3, 4, 5]).unwrap()
}

/// As in the plane: what a ray hits first of mirrors and pillar, and whether cells there have it.
fn check_scene(table: &Table, seed: u64) -> Result<usize, String> {
    // Axis, place and extent of the mirrors.
    let mirrors: [(usize, f64, [f64; 3], [f64; 3]); 3] = [
        (0, 16.0, [16.0, 1.0, 2.0], [16.0, 3.0, 9.0]),
        (0, 10.0, [10.0, 0.0, 3.0], [10.0, 3.5, 8.0]),
        (1, 1.0, [3.0, 1.0, 2.0], [3.2, 1.0, 2.2]),
    ];
    let (mut random, mut n_met) = (SplitMix::new(seed), 0);
    for k in 0..3000 {
        let mut unit = || random.below(1 << 20) as f64 / f64::from(1 << 20);
        let (axis, at, min, max) = mirrors[k % 3];
        let hit: [f64; 3] = std::array::from_fn(|j| min[j] + unit() * (max[j] - min[j]));
        let eye = [16.0 * unit(), 4.0 * unit(), 12.0 * unit()];
        // Just before the mirror; whatever is between does not matter to whose part it is.
        let before: [f64; 3] = std::array::from_fn(|j| hit[j] + 1e-7 * (eye[j] - hit[j]));
        let is_near_end = (0..3).any(|j| j != axis && (hit[j] - min[j]).min(max[j] - hit[j]) < 1e-5);
        if (eye[axis] - at).abs() < 1e-3 || is_near_end {
            continue;
        }
        let cells = table.in_dimension().unwrap().at(before).cells().to_vec();
        let is_met = |part: &&MirrorRecord| {
            let corners = &part.points;
            let within = |j: usize| corners.iter().any(|c| c[j] <= hit[j]) && corners.iter().any(|c| c[j] >= hit[j]);
            // Counter-clockwise as seen from the eye: the normal points to it.
            let [u, v] = [0, 1].map(|i| -> [f64; 3] { std::array::from_fn(|j| corners[i + 1][j] - corners[i][j]) });
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            (0..3).all(within) && (0..3).map(|j| normal[j] * (eye[j] - hit[j])).sum::<f64>() > 0.0
        };
        if !table.mirrors().iter().filter(|part| cells.contains(&part.cell)).any(|part| is_met(&part)) {
            return Err(format!("nothing at {hit:?} as seen from {eye:?}, in {cells:?}"));
        }
        n_met += 1;
    }
    Ok(n_met)
}

#[test]
fn rays_hit_the_mirrors_of_scenes() {
    let baked = bake_scene(&hall(), &SceneBakeOptions { threads: 1, ..SceneBakeOptions::default() }).unwrap();
    let table = &baked.table;
    assert!(check_scene(table, 1).unwrap() > 1000);
    assert_eq!(baked.report.n_mirror_parts, table.mirrors().len());
    assert_eq!((baked.report.n_lost_mirrors, baked.report.n_other_mirror_triangles), (0, 2));
    // The twin: parts are on mirrors, in their cells, and together as large as the mirrors.
    let area = |part: &MirrorRecord| {
        let extent = |j: usize| {
            let all = || part.points.iter().map(|p| p[j]);
            all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
        };
        [[1, 2], [0, 2]].iter().map(|&[u, v]| extent(u) * extent(v)).fold(0.0, f64::max)
    };
    let sum: f64 = table.mirrors().iter().map(area).sum();
    let whole = 14.0 + 2.0 * 17.5 + 2.0 * 0.04;
    assert!((sum - whole).abs() < 1e-9, "{sum}: {whole}");
    for part in table.mirrors() {
        let cell = &table.cells()[part.cell.idx()];
        assert!(part.points.iter().all(|p| (0..3).all(|j| cell.min[j] <= p[j] && p[j] <= cell.max[j])));
    }
    assert_eq!(Table::from_bytes(&table.to_bytes()).as_ref(), Ok(table));
    for part in 0..table.mirrors().len() {
        let impostor = without(table, part);
        assert!((0..40).any(|seed| check_scene(&impostor, seed).is_err()), "{:?}", table.mirrors()[part]);
    }
}

#[test]
fn mirrors_that_move_do_not_reflect() {
    let still = hall();
    let mirror = still.mirrors()[0];
    let parts = |scene: &Scene| {
        let baked = bake_scene(scene, &SceneBakeOptions::default()).unwrap();
        (baked.report.n_mirror_parts, baked.report.n_moving_mirrors, baked.table.mirrors().len())
    };
    let (n_parts, ..) = parts(&still);
    let moving = still.clone().with_moving(vec![MovingObject { object: mirror, within: None }]).unwrap();
    let (n_left, n_moving, n_records) = parts(&moving);
    assert!(n_moving == 1 && n_left < n_parts && n_left == n_records, "{n_left} {n_parts}");
    // The twin: all others reflect as before.
    let others = still.mirrors()[1..].to_vec();
    let without = moving.with_mirrors(others).unwrap();
    assert_eq!(parts(&without), (n_left, 0, n_left));
    assert_eq!(parts(&still).1, 0);
}

#[test]
fn mirrors_in_what_is_solid_are_counted() {
    let mut objects = hall().objects().to_vec();
    objects.push(quad("walled in", [[6.5, 1.0, 5.2], [6.5, 2.0, 5.2], [6.5, 2.0, 5.8], [6.5, 1.0, 5.8]]));
    let scene = Scene::new(objects).unwrap().with_mirrors(vec![6]).unwrap();
    let baked = bake_scene(&scene, &SceneBakeOptions::default()).unwrap();
    assert_eq!((baked.report.n_mirror_parts, baked.report.n_lost_mirrors), (0, 1));
    assert!(baked.table.mirrors().iter().all(|part| part.cell != CellId(u32::MAX)));
}
