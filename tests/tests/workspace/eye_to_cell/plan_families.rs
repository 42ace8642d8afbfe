//! Plans with tables, eyes in them, and where they look.

use sightlines::bake::{PlanBakeOptions, StabOptions, Subdivide, bake_plan, from_table, with_stab_trees};
use sightlines::cells::{Plan, PlanObject};
use sightlines::eye_to_cell::View;
use sightlines::geometry::{Aabb, Point2};
use sightlines::pvs::Table;
use sightlines::scenes::{self, OfficeOptions};
use sightlines_testkit::Random;
use std::f64::consts::TAU;

/// The table of a plan; `None` if the plan has no region, or crossings had to be rounded: then cells are those of walls
/// bent by a rounding error, which no exact answer fits.
pub(crate) fn bake(plan: &Plan, subdivide: Subdivide) -> Option<Table> {
    let options = PlanBakeOptions { subdivide, threads: 1, ..PlanBakeOptions::default() };
    let baked = bake_plan(plan, &options).ok()?;
    (baked.report.n_rounded_crossings == 0 && baked.report.n_ignored_walls == 0).then_some(baked.table)
}

/// The tables of a plan by both subdivisions, each also with stab trees, whole ones and ones that were cut.
pub(crate) fn tables(plan: &Plan) -> Vec<Table> {
    let subdivisions: &[Subdivide] = match plan.is_axial() {
        true => &[Subdivide::KdTree, Subdivide::Triangulation],
        false => &[Subdivide::Triangulation],
    };
    let with_trees = |table: Table| {
        let stab = |max_nodes| {
            let options = StabOptions { max_nodes, threads: 1, ..StabOptions::default() };
            with_stab_trees(table.clone(), &from_table::graph(&table).expect("the table stores its graph"), &options)
                .expect("the table has its geometry")
                .table
        };
        [stab(None), stab(Some(6)), table]
    };
    subdivisions.iter().filter_map(|&subdivide| bake(plan, subdivide)).flat_map(with_trees).collect()
}

/// The same plan with some boxes as objects, on quarters of the grid; none if the plan is empty or very large.
pub(crate) fn furnished(plan: &Plan, random: &mut Random) -> Plan {
    let bounds = plan.bounds();
    if !(0..2).all(|k| (0.0..4096.0).contains(&(bounds.max[k] - bounds.min[k]))) {
        return plan.clone();
    }
    let object = |k: usize| {
        let mut place = |axis: usize| {
            let n = ((bounds.max[axis] - bounds.min[axis]) * 4.0) as usize + 1;
            bounds.min[axis].floor() + random.below(n) as f64 / 4.0
        };
        let min = [place(0), place(1)];
        let size = [0.25, 0.25 + 0.5 * (k % 2) as f64];
        let bounds = Aabb { min, max: [min[0] + size[0], min[1] + size[1]] };
        PlanObject { name: format!("object {k}"), bounds }
    };
    Plan::new(plan.lines().to_vec(), (0..6).map(object).collect()).expect("boxes on the grid")
}

/// Larger plans of all kinds, by name.
pub(crate) fn families() -> Vec<(String, Plan)> {
    let fits = "options within their ranges";
    let office = OfficeOptions { rooms_x: 4, rooms_y: 2, ..OfficeOptions::default() };
    let thick = OfficeOptions { wall_thickness: 0.25, seed: 3, ..office };
    let mut all = vec![
        ("office".to_owned(), scenes::office(office).expect(fits)),
        ("office with thick walls".to_owned(), scenes::office(thick).expect(fits)),
        ("maze".to_owned(), scenes::maze(7, 6, 5).expect(fits)),
        ("hall".to_owned(), scenes::pillared_hall(7, 3, 3).expect(fits)),
        ("turned hall".to_owned(), scenes::turned_pillared_hall(7, 2, 2).expect(fits)),
        ("doom-like".to_owned(), scenes::doom_like(7, 2).expect(fits)),
    ];
    all.extend(scenes::degenerate::all().into_iter().map(|(name, plan)| (name.to_owned(), plan)));
    all
}

/// Kinds of places of [`eye`].
pub(crate) const N_PLACES: usize = 6;

/// A place for an eye: anywhere on a grid of sixteenths (0), a corner of a cell (1), the middle of a portal (2), a
/// place on a wall (3), on the end of one (4), on the border between two cells (5). `None` if the plan has no such
/// thing.
pub(crate) fn eye(plan: &Plan, table: &Table, place: usize, random: &mut Random) -> Option<Point2> {
    let mid = |a: [f64; 2], b: [f64; 2]| Point2::new(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
    let mut pick = |n: usize| (n > 0).then(|| random.below(n));
    Some(match place % N_PLACES {
        0 => {
            let Aabb { min, max } = Some(plan.bounds()).filter(|b| !b.is_empty())?;
            let mut at = |k: usize| {
                let n = ((max[k] - min[k]) * 16.0) as usize + 1;
                pick(n).map(|i| min[k] + i as f64 / 16.0)
            };
            Point2::new(at(0)?, at(1)?)
        }
        1 => {
            let polygon = &table.cells()[pick(table.n_cells())?].polygon;
            let [x, y] = polygon[pick(polygon.len())?];
            Point2::new(x, y)
        }
        2 => {
            let portal = &table.portals()[pick(table.portals().len())?];
            let [l, r] = [portal.points[0], portal.points[1]];
            mid([l[0], l[1]], [r[0], r[1]])
        }
        3 | 4 => {
            let line = &plan.lines()[pick(plan.lines().len())?];
            if place % N_PLACES == 4 { line.a } else { mid([line.a.x, line.a.y], [line.b.x, line.b.y]) }
        }
        _ => {
            let polygon = &table.cells()[pick(table.n_cells())?].polygon;
            let k = pick(polygon.len())?;
            mid(polygon[k], polygon[(k + 1) % polygon.len()])
        }
    })
}

/// Fields of view in degrees, from less than one to all.
const FIELDS: [f64; 10] = [0.1, 0.7, 5.0, 40.0, 90.0, 179.9, 180.0, 250.0, 359.9, 360.0];

/// Where a viewer looks: the view, and the same as the angle of its centre and its width in radians.
pub(crate) fn gaze(table: &Table, eye: Point2, random: &mut Random) -> (View, f64, f64) {
    let at = [eye.x, eye.y];
    if random.below(5) == 0 {
        return (View::all_round([eye.x, eye.y, 0.0]).expect("a finite eye"), 0.0, TAU);
    }
    let fov = FIELDS[random.below(FIELDS.len())].to_radians();
    let angle = TAU * random.unit();
    let mut direction = [angle.cos(), angle.sin()];
    let n_portals = table.portals().len();
    if random.below(3) > 0 && n_portals > 0 {
        // At the end of a portal: half of the view passes by it.
        let end = table.portals()[random.below(n_portals)].points[random.below(2)];
        if end[..2] != at {
            direction = [end[0] - eye.x, end[1] - eye.y];
        }
    }
    let view = View::planar(at, direction, fov).expect("numbers in their ranges");
    (view, direction[1].atan2(direction[0]), fov)
}
