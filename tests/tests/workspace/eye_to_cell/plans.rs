//! Plans, against a ray that is turned about the eye in exact arithmetic.

use crate::eye_to_cell::ask::{Answer, Answers, Asker, missed, missed_within_bounds, not_nested};
use crate::eye_to_cell::plan_families::{N_PLACES, bake, eye, families, furnished, gaze, tables};
use proptest::prelude::*;
use sightlines::bake::Subdivide;
use sightlines::cells::{CellId, Plan};
use sightlines::eye_to_cell::{Doors, View};
use sightlines::geometry::Point2;
use sightlines::pvs::{PortalId, Table};
use sightlines_testkit::Random;
use sightlines_testkit::{EyeFan, axial_plan, draw, eye_fan, small_grid_plan};
use std::collections::BTreeSet;
use std::ops::AddAssign;

/// How much was looked at.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    /// Views.
    pub(crate) n_frames: usize,
    /// Cells and objects that a ray meets.
    pub(crate) n_met: usize,
    /// Cells that the exact method shows.
    pub(crate) n_exact: usize,
    /// Those of them that are only touched.
    pub(crate) n_touched: usize,
    /// Objects that the exact method shows, and those of them that no ray meets.
    pub(crate) n_objects: usize,
    pub(crate) n_surplus_objects: usize,
    /// Cells that each method shows.
    pub(crate) n_cells: [usize; 5],
    /// Bounded answers between the exact one and that of the incident portals.
    pub(crate) n_between: usize,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.n_frames += other.n_frames;
        self.n_met += other.n_met;
        self.n_exact += other.n_exact;
        self.n_touched += other.n_touched;
        self.n_objects += other.n_objects;
        self.n_surplus_objects += other.n_surplus_objects;
        self.n_between += other.n_between;
        (0..5).for_each(|k| self.n_cells[k] += other.n_cells[k]);
    }
}

/// The cells of a table and its objects, as polygons.
fn regions(table: &Table) -> Vec<Vec<Point2>> {
    let cells = table.cells().iter().map(|c| c.polygon.iter().map(|&[x, y]| Point2::new(x, y)).collect());
    let objects = table.objects().iter().map(|o| {
        let corners = [[o.min[0], o.min[1]], [o.max[0], o.min[1]], [o.max[0], o.max[1]], [o.min[0], o.max[1]]];
        corners.map(|[x, y]| Point2::new(x, y)).to_vec()
    });
    cells.chain(objects).collect()
}

/// What an eye sees by the oracle, with the closed portals in the way.
pub(crate) fn fan(plan: &Plan, table: &Table, closed: &[u32], eye: Point2) -> Option<EyeFan> {
    let closed: Vec<[Point2; 2]> = closed
        .iter()
        .map(|&p| [0, 1].map(|k| table.portals()[p as usize].points[k]).map(|[x, y, _]| Point2::new(x, y)))
        .collect();
    eye_fan(plan, &closed, &regions(table), eye)
}

/// Cells and objects apart. Left out are objects that reach out of the plan, where no cell shows them.
fn split(table: &Table, regions: &BTreeSet<u32>) -> Answer {
    let n_cells = table.n_cells() as u32;
    let (cells, objects) = regions.iter().partition::<BTreeSet<u32>, _>(|&&region| region < n_cells);
    let within = |object: &u32| {
        let o = &table.objects()[*object as usize];
        let corners = [[o.min[0], o.min[1]], [o.max[0], o.min[1]], [o.max[0], o.max[1]], [o.min[0], o.max[1]]];
        corners.iter().all(|corner| !table.in_dimension().unwrap().at(*corner).is_outside())
    };
    Answer { cells, objects: objects.iter().map(|o| o - n_cells).filter(within).collect() }
}

/// What is wrong with the answers to a view, if anything is: they are not nested, miss what a ray meets, or the
/// exact one has a cell that no ray touches, and that is none of the viewer's own, which are always shown.
pub(crate) fn judge(
    table: &Table,
    roots: &[CellId],
    answers: &Answers,
    bounded: &Answer,
    fan: &EyeFan,
    (centre, fov): (f64, f64),
) -> Result<Counts, String> {
    let [seen, touched] = [fan.seen(centre, fov), fan.touched(centre, fov)].map(|regions| split(table, &regions));
    let exact = &answers[4];
    let surplus = exact.cells.difference(&touched.cells).find(|cell| !roots.contains(&CellId(**cell)));
    let wrong = not_nested(answers).or_else(|| missed(answers, &seen)).or_else(|| missed_within_bounds(bounded, &seen));
    match wrong.or_else(|| surplus.map(|cell| format!("exact shows cell {cell}, which no ray touches"))) {
        Some(wrong) => Err(wrong),
        None => Ok(Counts {
            n_frames: 1,
            n_met: seen.cells.len() + seen.objects.len(),
            n_exact: exact.cells.len(),
            n_touched: exact.cells.difference(&seen.cells).filter(|cell| !roots.contains(&CellId(**cell))).count(),
            n_objects: exact.objects.len(),
            n_surplus_objects: exact.objects.len().saturating_sub(touched.objects.len()),
            n_cells: std::array::from_fn(|k| answers[k].cells.len()),
            n_between: 0,
        }),
    }
}

/// Some portals of a table to close: none, one, or a third of them.
pub(crate) fn some_doors(table: &Table, random: &mut Random) -> (Doors, Vec<u32>) {
    let n = table.portals().len();
    let mut closed = Vec::new();
    match random.below(3) {
        1 if n > 0 => closed.push(random.below(n) as u32),
        2 => closed.extend((0..n as u32).filter(|_| random.below(3) == 0)),
        _ => {}
    }
    let mut doors = Doors::all_open();
    closed.iter().for_each(|&portal| assert!(doors.close(PortalId(portal))));
    (doors, closed)
}

/// Looks from `n_eyes` places of each kind into a few directions each, with some portals closed.
fn check(plan: &Plan, table: &Table, n_eyes: usize, seed: u64) -> Result<Counts, String> {
    let mut asker = Asker::new(table);
    let mut counts = Counts::default();
    for place in 0..n_eyes * N_PLACES {
        let mut random = Random::new(seed, place as u64);
        let Some(eye) = eye(plan, table, place, &mut random) else { continue };
        let roots = table.in_dimension().unwrap().at([eye.x, eye.y]).cells().to_vec();
        let (doors, closed) = some_doors(table, &mut random);
        let Some(fan) = (!roots.is_empty()).then(|| fan(plan, table, &closed, eye)).flatten() else { continue };
        for _ in 0..3 {
            let (view, centre, fov) = gaze(table, eye, &mut random);
            let answers = asker.all(&roots, &view, &doors);
            counts += judge(table, &roots, &answers, &asker.bounded, &fan, (centre, fov)).map_err(|wrong| {
                let what = format!("eye {eye:?} in {roots:?}, centre {centre}, field {fov}, closed {closed:?}");
                format!("{wrong}: {what}, trees {}", table.stab().is_some())
            })?;
        }
    }
    counts.n_between = asker.n_between;
    Ok(counts)
}

fn check_all(plan: &Plan, n_eyes: usize, seed: u64) -> Result<Counts, String> {
    let mut counts = Counts::default();
    let furnished = furnished(plan, &mut Random::new(seed, u64::MAX));
    for table in tables(&furnished) {
        counts += check(&furnished, &table, n_eyes, seed)?;
    }
    Ok(counts)
}

proptest! {
    /// Invariant: in any plan, from anywhere, in any direction, with any portals closed, the answers are nested,
    /// miss nothing that a ray meets, and the exact one has nothing that no ray touches.
    #[test]
    fn plans_are_seen_as_they_are(plan in small_grid_plan(1..8), seed in any::<u64>()) {
        let checked = check_all(&plan, 1, seed);
        prop_assert!(checked.is_ok(), "{}", checked.unwrap_err());
    }

    /// As above, for plans that a k-d tree cuts.
    #[test]
    fn axial_plans_are_seen_as_they_are(plan in axial_plan(1..9), seed in any::<u64>()) {
        let checked = check_all(&plan, 1, seed);
        prop_assert!(checked.is_ok(), "{}", checked.unwrap_err());
    }
}

/// What the two properties look at is worth it: cells are hidden, methods differ, little is only touched.
#[test]
fn drawn_plans_are_worth_looking_at() {
    let plans = draw(&small_grid_plan(1..8), 60).into_iter().chain(draw(&axial_plan(1..9), 60));
    let mut counts = Counts::default();
    for (seed, plan) in (0..).zip(plans) {
        counts += check_all(&plan, 1, seed).unwrap_or_else(|wrong| panic!("{wrong}\n{plan:?}"));
    }
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 3_000 && counts.n_met > 10_000, "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a > b), "{counts:?}");
    assert!(counts.n_touched * 5 < counts.n_exact, "{counts:?}");
    assert!(counts.n_surplus_objects * 5 < counts.n_objects, "{counts:?}");
}

/// The same far from the origin, where coordinates have fewer digits left.
#[test]
fn plans_far_away_are_seen_as_they_are() {
    let mut counts = Counts::default();
    for (seed, plan) in (0..).zip(draw(&small_grid_plan(2..8), 40)) {
        let far = Point2::new(f64::from(1 << 19), -f64::from(1 << 18));
        let moved = plan.lines().iter().map(|line| (line.a + far, line.b + far));
        let plan = Plan::from_walls(moved).expect("walls on a grid");
        counts += check_all(&plan, 1, seed).unwrap_or_else(|wrong| panic!("{wrong}\n{plan:?}"));
    }
    assert!(counts.n_frames > 500 && counts.n_met > 2_000, "{counts:?}");
}

/// The same in offices, mazes, halls, Doom-like maps and everything that is degenerate.
#[test]
fn larger_plans_are_seen_as_they_are() {
    let mut counts = Counts::default();
    for (seed, (name, plan)) in (0..).zip(families()) {
        counts += check_all(&plan, 2, seed).unwrap_or_else(|wrong| panic!("{name}: {wrong}"));
    }
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 1_000 && counts.n_met > 10_000, "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a > b), "{counts:?}");
    assert!(counts.n_touched * 20 < counts.n_exact, "{counts:?}");
    assert!(counts.n_between > 5, "{counts:?}");
}

/// The same in halls with many pillars, where an eye in the open looks through very many sequences of portals: the
/// exact method must not give up, neither all round nor in a picture.
#[test]
fn open_halls_are_seen_exactly() {
    let mut counts = Counts::default();
    let halls = [sightlines::scenes::pillared_hall(3, 9, 9), sightlines::scenes::turned_pillared_hall(3, 7, 7)];
    for (seed, hall) in (0..).zip(halls) {
        let hall = hall.expect("a hall");
        let table = bake(&hall, Subdivide::Triangulation).expect("a plan on a grid");
        counts += check(&hall, &table, 4, seed).unwrap_or_else(|wrong| panic!("{wrong}"));
    }
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 100 && counts.n_cells[4] * 2 < counts.n_cells[0], "{counts:?}");
}

/// Eyes a few last places beside walls and borders, at places that no grid has, and far away from the origin:
/// nothing is missed that a ray meets, which is decided in doubles with some clearance.
#[test]
fn a_maze_is_seen_from_places_that_are_on_no_grid() {
    let plan = sightlines::scenes::maze(3, 5, 5).expect("a small maze");
    let table = bake(&plan, Subdivide::Triangulation).expect("a plan on a grid");
    let mut asker = Asker::new(&table);
    let mut n = 0;
    for seed in 0..200 {
        let mut random = Random::new(seed, 0);
        let Some(on_grid) = eye(&plan, &table, 1 + random.below(5), &mut random) else { continue };
        // The nearest double is as good as on the grid: what the grid's eye sees through an open set, within a
        // tenth of a degree, the other sees as well.
        let beside = |x: f64| f64::from_bits(x.to_bits().wrapping_add_signed(random.clone().below(3) as i64 - 1));
        let at = Point2::new(beside(on_grid.x), beside(on_grid.y));
        let roots = [
            table.in_dimension().unwrap().at([on_grid.x, on_grid.y]).cells().to_vec(),
            table.in_dimension().unwrap().at([at.x, at.y]).cells().to_vec(),
        ]
        .concat();
        let (Some(fan), Ok(view)) = (fan(&plan, &table, &[], on_grid), View::all_round([at.x, at.y, 0.0])) else {
            continue;
        };
        let wide = fan.sectors.iter().filter(|s| s.angles[1] - s.angles[0] > 1e-6);
        let cells = wide.flat_map(|s| s.seen.iter().copied()).collect();
        let answers = asker.all(&roots, &view, &Doors::all_open());
        assert_eq!(missed(&answers, &Answer { cells, ..Answer::default() }), None, "{at:?}");
        n += 1;
    }
    assert!(n > 150, "{n}");
}

/// Cells that can be walked to through open portals.
pub(crate) fn reachable(table: &Table, roots: &[CellId], doors: &Doors) -> BTreeSet<u32> {
    let mut reached: BTreeSet<u32> = roots.iter().map(|c| c.0).collect();
    loop {
        let before = reached.len();
        for (_, portal) in (0..).zip(table.portals()).filter(|(id, _)| doors.is_open(PortalId(*id))) {
            let [a, b] = portal.cells.map(|c| c.0);
            if reached.contains(&a) || reached.contains(&b) {
                reached.extend([a, b]);
            }
        }
        if reached.len() == before {
            return reached;
        }
    }
}
