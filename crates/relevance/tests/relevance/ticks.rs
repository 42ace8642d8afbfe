//! Who is shown to whom, against brute force, and never late.

use crate::grid::{Grid, body, cell, distances, grids, point, square, world};
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Random};
use sightlines_pvs::{CellId, Table};
use sightlines_relevance::{
    Body, Player, PlayerRole, ReachOptions, Reaches, Relevance, RelevanceOptions, Ways, WhoMoves,
};
use std::sync::Arc;

fn reaches(table: &Table, ways: Ways) -> Reaches {
    Reaches::of(table, &ReachOptions { ladder: vec![0.5, 1.0, 2.0, 4.0], ways, ..ReachOptions::default() })
        .expect("reaches")
}

fn relevance(table: &Arc<Table>, ways: Ways, options: RelevanceOptions) -> Relevance {
    Relevance::new(table.clone(), reaches(table, ways), options)
}

const EXACT: RelevanceOptions = RelevanceOptions { hold: 0.0, looks: usize::MAX, slack: 0.0, walk: 100.0 };

/// Whether a pair may see each other within its reaches, by all pairs of cells.
fn by_definition(table: &Table, far: &[Vec<f64>], ways: Ways, a: &Body, b: &Body) -> bool {
    let n = table.n_cells();
    // A camera on an arm goes on no ways.
    let near = |at: &Aabb<3>, reach: f64, ways: Ways| {
        let here: Vec<usize> = (0..n).filter(|&i| square(at, &cell(table, i)) == 0.0).collect();
        let walks = |k: usize| ways == Ways::Straight || here.iter().any(|&i| i == k || far[i][k] <= reach);
        let here = |k: usize| square(at, &cell(table, k)) <= reach * reach && walks(k);
        (0..n).filter(|&k| here(k)).collect::<Vec<usize>>()
    };
    let eye_ways = if a.arm == 0.0 { ways } else { Ways::Straight };
    let (from, to) = (near(&a.eyes, a.reach + a.arm, eye_ways), near(&b.seen, b.reach, ways));
    from.iter().any(|&i| to.iter().any(|&j| table.sees(CellId(i as u32), CellId(j as u32))))
}

/// A body of whole coordinates and halves.
fn some_body(random: &mut Random, all: &Aabb<3>) -> Body {
    let mut some_box = || {
        let min: [f64; 3] = std::array::from_fn(|k| (random.unit() * (2.0 * all.max[k] + 1.0)).floor() / 2.0);
        Aabb { min, max: std::array::from_fn(|k| (min[k] + random.below(3) as f64 / 2.0).min(all.max[k])) }
    };
    let (eyes, seen) = (some_box(), some_box());
    Body { eyes, seen, reach: random.below(5) as f64 / 2.0, arm: random.below(3) as f64 / 2.0 }
}

proptest! {
    /// With no slack and as many looks as are wanted, all answers are those of the definition; with few looks they are no less.
    #[test]
    fn answers_are_those_of_the_definition(grid in grids(), portals: bool, looks in 0usize..4) {
        let table = grid.table();
        let ways = if portals && !table.portals().is_empty() { Ways::Portals } else { Ways::Straight };
        let far = distances(&table, ways);
        let all = world(&table);
        let mut random = Random::new(grid.seed ^ 1);
        let players: Vec<Player> = (0..6).map(|_| Player { body: some_body(&mut random, &all), role: PlayerRole::ALONE }).collect();
        let mut exact = relevance(&table, ways, EXACT);
        let mut coarse = relevance(&table, ways, RelevanceOptions { looks, ..EXACT });
        exact.update(0.0, &players);
        let n_coarse = coarse.update(0.0, &players).n_coarse;
        prop_assert!(n_coarse <= 6 - looks);
        for i in 0..6 {
            for j in (0..6).filter(|&j| j != i) {
                let (a, b) = (&players[i].body, &players[j].body);
                let expected = by_definition(&table, &far, ways, a, b);
                prop_assert_eq!(exact.is_shown(i as u32, j as u32), expected, "{} {}", i, j);
                prop_assert!(coarse.is_shown(i as u32, j as u32) || !expected);
                let may = exact.may_see_within(a, b);
                prop_assert!(may || !expected);
                prop_assert!(!may || expected, "one question is answered as all");
            }
        }
    }
}

/// Walkers of a bounded speed who stay in the grid, and in it on ways through portals if they have to.
struct Walkers {
    at: Vec<[f64; 3]>,
    random: Random,
}

impl Walkers {
    const STEP: f64 = 0.125;

    fn new(table: &Table, n: usize, seed: u64) -> Self {
        let (mut random, all) = (Random::new(seed), world(table));
        Self { at: (0..n).map(|_| random.point(&all)).collect(), random }
    }

    fn step(&mut self, table: &Table, ways: Ways) {
        let all = world(table);
        let cells = |p: [f64; 3]| (0..table.n_cells()).filter(|&i| cell(table, i).contains(p)).collect::<Vec<usize>>();
        for at in &mut self.at {
            let (way, far) = (self.random.direction(), Self::STEP * self.random.unit());
            let to: [f64; 3] = std::array::from_fn(|k| at[k] + way[k] * far);
            if !all.contains(to) {
                continue;
            }
            let (from, into) = (cells(*at), cells(to));
            let passes = |i: usize, j: usize| {
                let joins = |p: &&sightlines_pvs::PortalRecord| p.cells.iter().all(|c| c.idx() == i || c.idx() == j);
                // The side between two cells of a grid is open as a whole, so the straight step passes it.
                i == j || table.portals().iter().any(|p| joins(&p))
            };
            if ways == Ways::Straight || from == into || from.len() == 1 && into.len() == 1 && passes(from[0], into[0])
            {
                *at = to;
            }
        }
    }
}

/// Of all moments in which two walkers see each other by `truth`: how many there are, how many are late, and of how many pairs and moments
/// all in all one is shown to the other.
struct Run {
    n_seen: usize,
    n_late: usize,
    n_shown: usize,
    n_all: usize,
}

/// Walks for a while. Each pair that sees each other has to be shown since as many ticks as they take for their reach.
fn walk(truth: &Table, told: &mut Relevance, ways: Ways, seed: u64, arm: [f64; 2]) -> Run {
    const N: usize = 5;
    const TICKS: usize = 6;
    let mut walkers = Walkers::new(truth, N, seed);
    let mut since = [[0usize; N]; N];
    let mut run = Run { n_seen: 0, n_late: 0, n_shown: 0, n_all: 0 };
    let mut random = Random::new(seed ^ 77);
    for tick in 0..200 {
        walkers.step(truth, ways);
        let body = |p: &[f64; 3]| Body { reach: Walkers::STEP * TICKS as f64, arm: arm[1], ..body(*p) };
        let players: Vec<Player> =
            walkers.at.iter().map(|p| Player { body: body(p), role: PlayerRole::ALONE }).collect();
        told.update(tick as f64, &players);
        for (i, since) in since.iter_mut().enumerate() {
            // The camera is anywhere within the true arm.
            let (way, far) = (random.direction(), arm[0] * random.unit());
            let eye: [f64; 3] = std::array::from_fn(|k| walkers.at[i][k] + way[k] * far);
            for j in (0..N).filter(|&j| j != i) {
                if !told.is_shown(i as u32, j as u32) {
                    since[j] = tick + 1;
                }
                let sees = |k: usize, l: usize| {
                    cell(truth, k).contains(eye)
                        && cell(truth, l).contains(walkers.at[j])
                        && truth.sees(CellId(k as u32), CellId(l as u32))
                };
                let n = truth.n_cells();
                run.n_all += 1;
                run.n_shown += usize::from(told.is_shown(i as u32, j as u32));
                if (0..n).any(|k| (0..n).any(|l| sees(k, l))) {
                    run.n_seen += 1;
                    run.n_late += usize::from(since[j] > 0 && since[j] + TICKS > tick);
                }
            }
        }
    }
    run
}

/// Nobody comes into sight late, on either kind of ways; and a table of which one pair is hidden that should not be, one portal too few, and an arm that
/// was forgotten, come too late somewhere.
#[test]
fn nobody_is_late_and_impostors_are() {
    let (mut n_seen, mut n_shown, mut n_all, mut late) = (0, 0, 0, [0; 3]);
    let options = RelevanceOptions { hold: 0.0, looks: 3, slack: 0.0625, walk: 2.0 };
    for seed in 0..30 {
        let grid = Grid { size: [6, 3, 1], seed, blind: 120 };
        let table = grid.table();
        for ways in [Ways::Straight, Ways::Portals] {
            let told = &mut relevance(&table, ways, options);
            let run = walk(&table, told, ways, seed, [0.25, 0.25]);
            assert_eq!(run.n_late, 0, "seed {seed}, {ways:?}");
            n_seen += run.n_seen;
            n_shown += run.n_shown;
            n_all += run.n_all;
        }
        // Impostors.
        late[0] +=
            walk(&table, &mut relevance(&table, Ways::Straight, options), Ways::Straight, seed, [2.5, 0.0]).n_late;
        let mut parts = grid.parts();
        let seen =
            (1..parts.cells.len()).flat_map(|i| (0..i).map(move |j| (i, j))).find(|&(i, j)| parts.rows.get(i, j));
        if let Some((i, j)) = seen {
            parts.rows.set(i, j, false);
            parts.rows.set(j, i, false);
            let less = Arc::new(Table::new(parts).expect("a table"));
            late[1] +=
                walk(&table, &mut relevance(&less, Ways::Straight, options), Ways::Straight, seed, [0.0; 2]).n_late;
        }
        let mut parts = grid.parts();
        let portals = parts.portals.len();
        parts.portals.retain(|p| p.cells[0] != CellId(0));
        if parts.portals.len() < portals && !parts.portals.is_empty() {
            let less = Arc::new(Table::new(parts).expect("a table"));
            late[2] +=
                walk(&table, &mut relevance(&less, Ways::Portals, options), Ways::Portals, seed, [0.0; 2]).n_late;
        }
    }
    assert!(n_seen > 1_000, "{n_seen} moments");
    assert!(n_shown * 10 < n_all * 8, "not all are shown: {n_shown} of {n_all}");
    assert!(late.iter().all(|&n| n > 0), "each impostor is late: {late:?}");
}

/// Two rooms in a row that do not see each other, and a third that sees both.
fn rooms() -> Arc<Table> {
    let mut parts = Grid { size: [3, 1, 1], seed: 0, blind: usize::MAX }.parts();
    for i in 0..3 {
        for k in 0..3 {
            (parts.cells[i].min[k], parts.cells[i].max[k]) =
                if k == 0 { (4.0 * i as f64, 4.0 * i as f64 + 4.0) } else { (0.0, 4.0) };
        }
    }
    parts.portals.clear();
    for (i, j) in [(0, 1), (1, 2)] {
        parts.rows.set(i, j, true);
        parts.rows.set(j, i, true);
    }
    let bounds: Vec<_> = parts.cells.iter().map(|c| (c.min, c.max)).collect();
    parts.locator = sightlines_pvs::Locator::build(&bounds, 3);
    Arc::new(Table::new(parts).expect("a table"))
}

fn player(x: f64) -> Player {
    Player { body: body([x, 2.0, 2.0]), role: PlayerRole::ALONE }
}

#[test]
fn what_is_gained_is_held() {
    let table = rooms();
    let mut told = relevance(&table, Ways::Straight, RelevanceOptions { hold: 1.0, ..EXACT });
    let mut at = |now: f64, x: f64| {
        let changes = told.update(now, &[player(x), player(9.0)]);
        (changes.gained.clone(), changes.lost.clone())
    };
    let (none, both) = (Vec::new(), vec![[0, 1], [1, 0]]);
    assert_eq!(at(0.0, 2.0), (none.clone(), none.clone()), "hidden");
    assert_eq!(at(1.0, 6.0), (both.clone(), none.clone()), "seen from the middle");
    assert_eq!(at(2.0, 2.0), (none.clone(), none.clone()), "held");
    assert_eq!(at(2.5, 6.0), (none.clone(), none.clone()), "seen again, so it was shown all the time");
    assert_eq!(at(3.0, 2.0), (none.clone(), none.clone()));
    assert_eq!(at(3.9, 2.0), (none.clone(), none.clone()));
    let (gained, mut lost) = at(4.0, 2.0);
    lost.sort_unstable();
    assert_eq!((gained, lost), (none, both), "a second after it was seen last");
}

#[test]
fn teams_and_spectators() {
    let table = rooms();
    let mut told = relevance(&table, Ways::Straight, EXACT);
    let with = |x: f64, role: PlayerRole| Player { role, ..player(x) };
    let players = [
        with(1.0, PlayerRole::of_team(1)),
        with(9.0, PlayerRole::of_team(1)),
        with(9.0, PlayerRole::of_team(2)),
        with(1.0, PlayerRole::SPECTATOR),
        with(1.0, PlayerRole::THING),
    ];
    told.update(0.0, &players);
    let shown: Vec<Vec<u32>> = (0..5).map(|i| told.shown_to(i).collect()).collect();
    assert_eq!(shown, [vec![1, 4], vec![0, 2], vec![1], vec![0, 1, 2, 4], vec![]]);
}

#[test]
fn of_whom_nothing_is_known_is_shown() {
    let table = rooms();
    let nan = f64::NAN;
    let cases = [
        ("outside", point([2.0, 2.0, 9.0])),
        ("far away", point([1e300; 3])),
        ("NaN", point([nan, 2.0, 2.0])),
        ("infinite", Aabb { min: [-f64::INFINITY; 3], max: [f64::INFINITY; 3] }),
        ("empty", Aabb::EMPTY),
        ("larger than the world", Aabb { min: [-1e9; 3], max: [1e9; 3] }),
    ];
    for (what, b) in cases {
        let mut told = relevance(&table, Ways::Straight, EXACT);
        let strange = Player { body: Body::new(b, b), role: PlayerRole::ALONE };
        told.update(0.0, &[player(2.0), strange]);
        assert!(told.is_shown(0, 1) && told.is_shown(1, 0), "{what}");
        told.update(0.0, &[player(2.0), player(9.0)]);
        assert!(!told.is_shown(0, 1), "a place again, and no hold");
    }
    for (reach, arm) in [(nan, 0.0), (-1.0, 0.0), (0.0, nan), (f64::INFINITY, 0.0), (1e300, 0.0)] {
        let mut told = relevance(&table, Ways::Straight, EXACT);
        let strange = Player { body: Body { reach, arm, ..body([9.0, 2.0, 2.0]) }, role: PlayerRole::ALONE };
        told.update(0.0, &[player(2.0), strange]);
        assert!(told.is_shown(1, 0), "reach {reach}, arm {arm}");
        assert!(told.may_see_within(&strange.body, &player(2.0).body));
    }
}

/// In cells that leave gaps a body that is partly outside of them may be seen where nothing is known; elsewhere what is between cells is solid. Beyond all cells
/// nothing is known in either.
#[test]
fn gaps_show() {
    use sightlines_pvs::{SceneMethods, TableKind};
    let mut parts = (*rooms()).clone().into_parts();
    parts.cells[1].min[0] = 5.0;
    parts.locator = sightlines_pvs::Locator::build(&parts.cells.iter().map(|c| (c.min, c.max)).collect::<Vec<_>>(), 3);
    let solid = Arc::new(Table::new(parts.clone()).expect("a table"));
    parts.kind = TableKind::SceneGivenCells { hidden_by: SceneMethods::default() };
    let gaps = Arc::new(Table::new(parts).expect("a table"));
    let from = |x: f64, to: [f64; 3]| Aabb { min: [x, 2.0, 2.0], max: to };
    let cases = [
        (from(3.5, [4.5, 2.5, 4.0]), [false, true], [0, 1]),
        (from(3.5, [4.0, 2.5, 4.0]), [false, false], [0, 0]),
        (from(0.5, [1.0, 2.5, 4.5]), [true, true], [1, 1]),
        (from(3.5, [5.5, 2.5, 4.0]), [true, true], [0, 1]),
        (from(5.5, [9.5, 2.5, 4.0]), [true, true], [0, 0]),
    ];
    for (b, shown, n) in cases {
        for (k, table) in [&solid, &gaps].into_iter().enumerate() {
            let mut told = relevance(table, Ways::Straight, EXACT);
            let there = Player { body: Body::new(point([1.0, 2.0, 2.0]), b), role: PlayerRole::ALONE };
            let n_outside = told.update(0.0, &[player(9.0), there]).n_outside;
            assert_eq!((told.is_shown(0, 1), n_outside), (shown[k], n[k]), "{b:?}, {k}");
        }
    }
}

/// Roles change while nobody moves.
#[test]
fn roles_change() {
    let table = rooms();
    let mut told = relevance(&table, Ways::Straight, EXACT);
    let with = |x: f64, role: PlayerRole| Player { role, ..player(x) };
    let shown = |told: &mut Relevance, roles: [PlayerRole; 2]| {
        told.update(0.0, &[with(2.0, roles[0]), with(9.0, roles[1])]);
        (told.is_shown(0, 1), told.is_shown(1, 0))
    };
    assert_eq!(shown(&mut told, [PlayerRole::of_team(1), PlayerRole::of_team(2)]), (false, false));
    assert_eq!(shown(&mut told, [PlayerRole::of_team(1), PlayerRole::of_team(1)]), (true, true));
    assert_eq!(shown(&mut told, [PlayerRole::THING, PlayerRole::SPECTATOR]), (false, true));
    assert_eq!(shown(&mut told, [PlayerRole::ALONE, PlayerRole::ALONE]), (false, false));
}

/// Players that come and go, and those of whom one does not move.
#[test]
fn numbers_of_players_change() {
    let table = rooms();
    let mut told = relevance(&table, Ways::Straight, EXACT);
    told.update(0.0, &[]);
    assert_eq!(told.update(0.0, &[player(2.0), player(6.0)]).gained.len(), 2);
    assert_eq!(told.update(0.0, &[player(2.0), player(6.0)]).n_looks, 0);
    let changes = told.update(0.0, &[player(2.0), player(6.0), player(9.0)]);
    assert_eq!((changes.gained.len(), changes.lost.len()), (2, 0), "the third and the second");
    assert!(told.is_shown(1, 2) && !told.is_shown(0, 2) && !told.is_shown(0, 9) && told.shown_to(9).count() == 0);
    told.update(0.0, &[player(2.0)]);
    assert!(!told.is_shown(0, 1));
}

#[test]
fn reaches_of_one_who_moves_tell_nothing_of_two() {
    // All cells are blind but for themselves, and the outer ones 4 apart.
    let mut parts = (*rooms()).clone().into_parts();
    parts.rows = sightlines_pvs::BitMatrix::identity(3);
    let table = Arc::new(Table::new(parts).expect("a table"));
    let options = ReachOptions { ladder: vec![1.0, 2.0], movers: WhoMoves::One, ..ReachOptions::default() };
    let reaches = Reaches::of(&table, &options).expect("reaches");
    let mut told = Relevance::new(table, reaches, RelevanceOptions { looks: 0, ..EXACT });
    for (reaches, shown) in
        [([0.0, 1.0], false), ([2.0, 0.0], false), ([0.5, 0.5], true), ([0.0, 3.0], true), ([5.0, 0.0], true)]
    {
        let with = |x: f64, reach: f64| Player { body: Body { reach, ..body([x, 2.0, 2.0]) }, role: PlayerRole::ALONE };
        told.update(0.0, &[with(1.0, reaches[0]), with(9.0, reaches[1])]);
        assert_eq!(told.is_shown(0, 1), shown, "{reaches:?}");
    }
}

/// Whose eyes are in a wall sees everything, however much is looked at and on whatever ways.
#[test]
fn eyes_in_a_wall_see_everything() {
    let mut parts = Grid { size: [3, 1, 1], seed: 0, blind: usize::MAX }.parts();
    let first = parts.cells[0].max[0];
    parts.cells[0].max[0] = first - 0.5;
    let bounds: Vec<_> = parts.cells.iter().map(|c| (c.min, c.max)).collect();
    parts.locator = sightlines_pvs::Locator::build(&bounds, 3);
    let table = Arc::new(Table::new(parts).expect("a table"));
    let far = cell(&table, 2).max;
    let eyes =
        |x: f64| Body::new(point([x, 0.5, 0.5]), Aabb { min: [0.25, 0.25, 0.25], max: [first - 0.1, 0.75, 0.75] });
    for (ways, looks) in [(Ways::Straight, 9), (Ways::Straight, 0), (Ways::Portals, 9), (Ways::Portals, 0)] {
        if ways == Ways::Portals && table.portals().is_empty() {
            continue;
        }
        for (x, shown) in [(first - 0.25, true), (first - 0.75, false)] {
            let mut told = relevance(&table, ways, RelevanceOptions { looks, ..EXACT });
            let who = |body: Body| Player { body, role: PlayerRole::ALONE };
            told.update(0.0, &[who(eyes(x)), who(body(far))]);
            assert_eq!(told.is_shown(0, 1), shown, "{ways:?}, {looks} looks, {x}");
            assert_eq!(told.may_see_within(&eyes(x), &body(far)), shown);
        }
    }
}

/// A table along other axes than its scene hides no more than the same table along those of the scene, and not much less.
#[test]
fn frames_are_no_matter() {
    use sightlines_pvs::Frame;
    let (mut n_same, mut n_more) = (0, 0);
    for seed in 0..40 {
        let grid = Grid { size: [6, 3, 1], seed, blind: 120 };
        let plain = grid.table();
        let frame = Frame::new([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], 1e-3).expect("a frame");
        let turned = Arc::new((*plain).clone().with_frame(Some(frame)).expect("a table"));
        let (mut random, all) = (Random::new(seed), world(&plain));
        let at: Vec<[f64; 3]> = (0..6).map(|_| random.point(&all)).collect();
        let with = |p: [f64; 3]| Player { body: Body { reach: 0.5, ..body(p) }, role: PlayerRole::ALONE };
        for ways in [Ways::Straight, Ways::Portals] {
            let [mut a, mut b] = [&plain, &turned].map(|table| relevance(table, ways, EXACT));
            a.update(0.0, &at.iter().map(|&p| with(p)).collect::<Vec<_>>());
            b.update(0.0, &at.iter().map(|&p| with(frame.to_scene(p))).collect::<Vec<_>>());
            for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
                let (plain, turned) = (a.is_shown(i, j), b.is_shown(i, j));
                assert!(turned || !plain, "seed {seed}: {i} {j}");
                *(if turned == plain { &mut n_same } else { &mut n_more }) += 1;
            }
        }
    }
    assert!(n_more * 50 < n_same, "{n_more} of {}", n_same + n_more);
}

/// In a plan the third coordinate does not count.
#[test]
fn plans_are_flat() {
    use sightlines_pvs::{TableKind, TableParts};
    let space = rooms();
    let mut parts = TableParts::empty(2, TableKind::PlanKdTree);
    parts.cells = space.cells().to_vec();
    for cell in &mut parts.cells {
        (cell.min[2], cell.max[2]) = (0.0, 0.0);
    }
    parts.rows = space.parts().rows.clone();
    parts.cell_objects = vec![Vec::new(); 3];
    let bounds: Vec<_> = parts.cells.iter().map(|c| (c.min, c.max)).collect();
    parts.locator = sightlines_pvs::Locator::build(&bounds, 2);
    let plan = Arc::new(Table::new(parts).expect("a table"));
    let with =
        |x: f64, z: f64, reach: f64| Player { body: Body { reach, ..body([x, 2.0, z]) }, role: PlayerRole::ALONE };
    for z in [0.0, -7.0, 1e9, f64::NAN] {
        for (reach, shown) in [(1.0, false), (3.5, true)] {
            let mut told = relevance(&plan, Ways::Straight, EXACT);
            let n_outside = told.update(0.0, &[with(1.0, z, reach), with(10.0, -z, reach)]).n_outside;
            assert_eq!((told.is_shown(0, 1), n_outside), (shown, 0), "{z} {reach}");
        }
    }
}

/// What is no length, no box or no table of these reaches is never hidden by that.
#[test]
fn strange_input_hides_nothing() {
    let table = rooms();
    let nan = f64::NAN;
    let [a, b] = [body([2.0, 2.0, 2.0]), body([9.0, 2.0, 2.0])];
    for walk in [nan, -1.0, 0.0, f64::INFINITY] {
        let grid = Grid { size: [6, 1, 1], seed: 3, blind: usize::MAX }.table();
        if grid.portals().is_empty() {
            continue;
        }
        let mut told = relevance(&grid, Ways::Portals, RelevanceOptions { walk, ..EXACT });
        let mut known = relevance(&grid, Ways::Portals, EXACT);
        for reach in [1.0, 5.0, 20.0] {
            let [p, q] = [0, 5].map(|i| cell(&grid, i).min).map(|p| Body { reach, ..body(p) });
            assert!(told.may_see_within(&p, &q) || !known.may_see_within(&p, &q), "walk {walk}");
        }
    }
    let mut told = relevance(&table, Ways::Straight, EXACT);
    assert!(!told.may_see_within(&a, &b));
    for (reach, arm) in [(-1.0, 1.0), (2.0, -2.0), (0.0, nan), (nan, 0.0)] {
        assert!(told.may_see_within(&Body { reach, arm, ..a }, &b), "{reach} {arm}");
        assert_eq!(told.time_to_sight(&Body { arm, ..a }, &b, [1.0, nan]), 0.0);
    }
    for arm in [nan, -1.0] {
        assert!(told.deadlines(&Body { arm, ..a }, 1.0).iter().all(|&at| at == 0.0), "{arm}");
    }
    let there = b.seen;
    for strange in [point([nan; 3]), Aabb::EMPTY] {
        let path = [(0.0, there), (1.0, strange), (2.0, there)];
        assert_eq!(told.exposure(&path, &[a], 0.0).seconds(), 2.0);
        assert_eq!(told.exposure(&path, &[], 0.0).spans, []);
    }
    assert_eq!(told.exposure(&[(3.0, a.seen)], &[a], 0.0).first(), Some(3.0), "a moment");
    assert_eq!(told.exposure(&[(3.0, there), (4.0, there)], &[a], -1.0).seconds(), 1.0, "no speed");
    // Reaches of a table with other portals are no reaches of this one.
    let mut parts = (*Grid { size: [4, 1, 1], seed: 3, blind: 9 }.table()).clone().into_parts();
    let one = Table::new(parts.clone()).expect("a table");
    parts.portals[0].points[0][1] += 0.5;
    let other = Table::new(parts).expect("a table");
    let reaches = reaches(&one, Ways::Portals);
    assert!(reaches.are_of(&one) && !reaches.are_of(&other));
    assert!(Reaches::from_bytes(&reaches.to_bytes(), &other).is_err());
}

/// Distances whose squares are too large for a double.
#[test]
fn coordinates_may_be_huge() {
    let mut parts = (*rooms()).clone().into_parts();
    for (k, cell) in parts.cells.iter_mut().enumerate() {
        (cell.min[0], cell.max[0]) = (4e160 * k as f64, 4e160 * (k + 1) as f64);
    }
    let bounds: Vec<_> = parts.cells.iter().map(|c| (c.min, c.max)).collect();
    parts.locator = sightlines_pvs::Locator::build(&bounds, 3);
    let table = Arc::new(Table::new(parts).expect("a table"));
    let mut told = relevance(&table, Ways::Straight, EXACT);
    let [a, b] = [2e160, 10e160].map(|x| body([x, 2.0, 2.0]));
    let within = |reach: f64, told: &mut Relevance| told.may_see_within(&Body { reach, ..a }, &Body { reach, ..b });
    assert_eq!([1e160, 3e160].map(|reach| within(reach, &mut told)), [false, true]);
    let seconds = told.time_to_sight(&a, &b, [1e160, 1e160]);
    assert!(seconds > 1.9 && seconds <= 2.0, "{seconds}");
}

/// Those who come and go do not take the looks of others, and things need no room for what they are told.
#[test]
fn things_come_and_go() {
    let table = rooms();
    let mut told = relevance(&table, Ways::Straight, RelevanceOptions { looks: 250, ..EXACT });
    let thing = |x: f64| Player { role: PlayerRole::THING, ..player(x) };
    let mut all: Vec<Player> = (0..20_000).map(|i| thing(0.5 + f64::from(i % 110) / 10.0)).collect();
    all[7] = player(2.0);
    for _ in 0..100 {
        told.update(0.0, &all);
    }
    assert_eq!(told.update(0.0, &all).n_coarse, 0, "all were placed at last");
    let shown: Vec<u32> = told.shown_to(7).collect();
    let seen = |i: &u32| *i != 7 && all[*i as usize].body.eyes.min[0] <= 8.0;
    assert_eq!(shown, (0..20_000).filter(seen).collect::<Vec<u32>>());
    all.push(thing(1.0));
    let changes = told.update(0.0, &all);
    assert_eq!((changes.n_looks, changes.n_coarse, &changes.gained[..]), (1, 0, &[[7, 20_000]][..]));
    all.pop();
    let changes = told.update(0.0, &all);
    assert_eq!((changes.n_looks, changes.n_coarse, changes.lost.len()), (0, 0, 0));
}
