//! Which pixels there are and which are filled.

use crate::dense::{At, Walls, meet, point, walls};
use proptest::prelude::*;
use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use sightlines_visibility_graph::{GridError, PixelGrid};
use std::collections::BTreeSet;

/// Coordinates in quarters of a spacing of 4, so that all centres and borders are whole numbers.
const SPACING: i64 = 4;

/// The centres of a grid by definition: multiples of the spacing next to the bounds and between them.
fn centres(walls: &Walls) -> Vec<At> {
    let of = |k: usize| {
        let all = || walls.0.iter().flatten().map(|p| p[k]);
        // Of two that are equally near to a bound, the lower one begins and the higher one ends.
        let low = (all().min().unwrap() - SPACING / 2).div_euclid(SPACING)
            + i64::from((all().min().unwrap() - SPACING / 2).rem_euclid(SPACING) != 0);
        let high = (all().max().unwrap() + SPACING / 2).div_euclid(SPACING);
        (low..=high).map(|k| k * SPACING)
    };
    of(0).flat_map(|x| of(1).map(move |y| [x, y])).collect()
}

/// What is reached from some points among all by steps to neighbours, found by repetition.
fn reached(walls: &Walls, all: &[At], from: &[At]) -> BTreeSet<At> {
    let mut found: BTreeSet<At> = from.iter().copied().collect();
    loop {
        let near = |a: At, b: At| (0..2).all(|k| (a[k] - b[k]).abs() <= SPACING);
        let new: Vec<At> = all
            .iter()
            .copied()
            .filter(|&p| !found.contains(&p) && found.iter().any(|&q| near(p, q) && !walls.meet([p, q])))
            .collect();
        if new.is_empty() {
            return found;
        }
        found.extend(new);
    }
}

fn listed(points: &[Point2]) -> Vec<At> {
    points.iter().map(|p| [p.x as i64, p.y as i64]).collect()
}

/// Whether the closed pixel around a centre, or one of the eight around it, touches a wall.
fn is_near(walls: &Walls, all: &[At], [x, y]: At) -> bool {
    let h = SPACING / 2;
    all.iter().filter(|p| (p[0] - x).abs() <= SPACING && (p[1] - y).abs() <= SPACING).any(|&[x, y]| {
        let corners = [[x - h, y - h], [x + h, y - h], [x + h, y + h], [x - h, y + h]];
        let inside = |p: At| (p[0] - x).abs() <= h && (p[1] - y).abs() <= h;
        walls.0.iter().any(|&wall| inside(wall[0]) || (0..4).any(|k| meet([corners[k], corners[(k + 1) % 4]], wall)))
    })
}

/// Walls on any whole numbers, sometimes on multiples of a step, away from the origin.
fn moved_walls() -> impl Strategy<Value = Walls> {
    (prop_oneof![walls(27, 1, 0..9), walls(28, 2, 0..9), walls(24, 4, 0..9)], -9i64..9, -9i64..9)
        .prop_map(|(walls, dx, dy)| Walls(walls.0.into_iter().map(|w| w.map(|[x, y]| [x + dx, y + dy])).collect()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn seeds_fill_what_steps_reach(walls in moved_walls(), pick in any::<prop::sample::Index>(), dx in -1i64..=1, dy in -1i64..=1) {
        let all = centres(&walls);
        let grid = PixelGrid::over(&walls.plan(), SPACING as f64).unwrap();
        let [columns, rows] = grid.size();
        prop_assert_eq!(columns * rows, all.len());
        let centre = all[pick.index(all.len())];
        let seed = [centre[0] + dx, centre[1] + dy];
        match grid.fill(&[point(seed)]) {
            Ok(points) => {
                prop_assert!(!walls.meet([seed, centre]));
                let expected: Vec<At> = reached(&walls, &all, &[centre]).into_iter().collect();
                prop_assert_eq!(listed(points.coordinates()), expected, "columns in order");
                for (k, &p) in points.coordinates().iter().enumerate() {
                    prop_assert_eq!(points.is_near_wall(k as u32), is_near(&walls, &all, listed(&[p])[0]));
                }
            }
            Err(GridError::SeedBlocked { .. }) => prop_assert!(walls.meet([seed, centre])),
            Err(other) => prop_assert!(false, "{}", other),
        }
    }

    #[test]
    fn what_is_not_reached_from_outside_is_enclosed(walls in moved_walls(), gap in any::<bool>()) {
        // Without one of the sides of the box much is open.
        let walls = if gap { Walls(walls.0[..walls.0.len() - 1].to_vec()) } else { walls };
        let all = centres(&walls);
        let [low, high] = [all[0], all[all.len() - 1]];
        let ring = |from: i64, to: i64| (from - SPACING..=to + SPACING).step_by(SPACING as usize);
        let wide: Vec<At> = ring(low[0], high[0]).flat_map(|x| ring(low[1], high[1]).map(move |y| [x, y])).collect();
        let outside = reached(&walls, &wide, &wide[..1]);
        let expected: Vec<At> =
            all.iter().copied().filter(|&p| !outside.contains(&p) && !walls.meet([p, p])).collect();
        match PixelGrid::over(&walls.plan(), SPACING as f64).unwrap().enclosed() {
            Ok(points) => prop_assert_eq!(listed(points.coordinates()), expected),
            Err(error) => {
                prop_assert_eq!(error, GridError::NothingEnclosed);
                prop_assert!(expected.is_empty());
            }
        }
    }
}

fn square(from: f64, to: f64) -> Plan {
    let corners = [[from, from], [to, from], [to, to], [from, to]].map(|[x, y]| Point2::new(x, y));
    Plan::from_walls((0..4).map(|k| (corners[k], corners[(k + 1) % 4]))).unwrap()
}

#[test]
fn centres_are_multiples_of_the_spacing() {
    // Bounds at 0.3 and 0.5 spacings beyond a multiple, positive and negative.
    for (low, first) in [(1.3, 1.0), (1.5, 1.0), (1.6, 2.0), (-1.3, -1.0), (-1.5, -2.0), (-1.6, -2.0), (0.0, 0.0)] {
        let grid = PixelGrid::over(&square(low, low + 3.0), 1.0).unwrap();
        let centre = grid.centre(sightlines_visibility_graph::Pixel { column: 0, row: 0 });
        assert_eq!([centre.x, centre.y], [first; 2], "{low}");
    }
}

#[test]
fn what_makes_no_grid_is_refused() {
    let plan = square(0.0, 4.0);
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(PixelGrid::over(&plan, spacing), Err(GridError::Spacing(_))));
    }
    let text = |error: GridError| error.to_string();
    assert_eq!(
        text(PixelGrid::over(&plan, 1e-5).unwrap_err()),
        "a spacing of 0.00001 makes more than 67108864 pixels of 4 by 4 units"
    );
    assert!(matches!(PixelGrid::over(&plan, 5e-324), Err(GridError::TooFine { .. })));
    assert!(matches!(PixelGrid::over(&plan, 1e300), Err(GridError::Coordinate(_))));
    assert_eq!(PixelGrid::over(&Plan::default(), 1.0).unwrap_err(), GridError::NoWalls);
    let grid = PixelGrid::over(&plan, 1.0).unwrap();
    assert_eq!(text(grid.fill(&[Point2::new(5.0, 1.0)]).unwrap_err()), "the seed (5, 1) lies outside the grid");
    assert!(matches!(grid.fill(&[Point2::new(0.2, 2.0)]), Err(GridError::SeedBlocked { .. })));
    assert!(grid.fill(&[]).unwrap().is_empty());
    assert_eq!(grid.enclosed().unwrap().len(), 9);
    let wall = Plan::from_walls([(Point2::new(0.0, 0.0), Point2::new(5.0, 3.0))]).unwrap();
    assert_eq!(PixelGrid::over(&wall, 1.0).unwrap().enclosed().unwrap_err(), GridError::NothingEnclosed);
}

/// A long slanted wall through a fine grid: no step leads through it, wherever pixels of its list begin.
#[test]
fn slanted_walls_are_closed() {
    let at = |x: f64, y: f64| Point2::new(x, y);
    let corners = [at(0.0, 0.0), at(97.0, 31.0), at(97.0, 60.0), at(0.0, 29.0)];
    let mut lines: Vec<(Point2, Point2)> = (0..4).map(|k| (corners[k], corners[(k + 1) % 4])).collect();
    lines.push((at(0.0, 13.0), at(97.0, 44.0)));
    let grid = PixelGrid::over(&Plan::from_walls(lines.iter().copied()).unwrap(), 0.1).unwrap();
    let (low, high) = (grid.fill(&[at(50.0, 20.0)]).unwrap(), grid.fill(&[at(50.0, 40.0)]).unwrap());
    let line = |p: &Point2| p.x * 31.0 / 97.0;
    assert!(low.coordinates().iter().all(|p| (line(p)..line(p) + 13.0).contains(&p.y)) && low.len() > 100_000);
    assert!(high.coordinates().iter().all(|p| (line(p) + 13.0..line(p) + 29.0).contains(&p.y)) && high.len() > 100_000);
    // Without the wall they are one: the test can tell.
    let open = PixelGrid::over(&Plan::from_walls(lines[..4].iter().copied()).unwrap(), 0.1).unwrap();
    let all = open.fill(&[at(50.0, 20.0)]).unwrap().len();
    assert!(all >= low.len() + high.len(), "{all}");
}

/// A building with walls drawn by their outlines, one unit thick, and with an open door or without.
fn thick_walled(has_door: bool) -> Plan {
    let ring = |low: f64, [width, height]: [f64; 2]| {
        let [right, top] = [width - low, height - low];
        [[low, low, low, top], [low, top, right, top], [right, top, right, low]]
    };
    let mut walls = [ring(0.0, [20.0, 12.0]), ring(1.0, [20.0, 12.0])].concat();
    // Below, with the door from 8 to 10.
    for (y, from, to) in [(0.0, 0.0, 20.0), (1.0, 1.0, 19.0)] {
        if has_door {
            walls.extend([[from, y, 8.0, y], [10.0, y, to, y]]);
        } else {
            walls.push([from, y, to, y]);
        }
    }
    if has_door {
        walls.extend([[8.0, 0.0, 8.0, 1.0], [10.0, 0.0, 10.0, 1.0]]);
    }
    walls.push([12.0, 4.0, 12.0, 11.0]);
    let point = |x: f64, y: f64| Point2::new(x, y);
    Plan::from_walls(walls.into_iter().map(|[ax, ay, bx, by]| (point(ax, ay), point(bx, by)))).unwrap()
}

#[test]
fn the_interior_of_a_building_with_an_open_door_is_found() {
    let is_in_room = |p: &Point2| (1.0..=19.0).contains(&p.x) && (1.0..=11.0).contains(&p.y);
    let closed = PixelGrid::over(&thick_walled(false), 0.5).unwrap();
    let interior = closed.interior().unwrap();
    assert!(interior.is_enclosed && interior.points == closed.enclosed().unwrap());
    let open = PixelGrid::over(&thick_walled(true), 0.5).unwrap();
    let interior = open.interior().unwrap();
    let n_in_rooms = closed.enclosed().unwrap().coordinates().iter().filter(|p| is_in_room(p)).count();
    let found = interior.points.coordinates();
    let n_found = found.iter().filter(|p| is_in_room(p)).count();
    assert!(!interior.is_enclosed && n_in_rooms > 600, "{n_in_rooms}");
    // What sees out through the door in two directions is left out, and the doorway is not.
    assert!(n_found > n_in_rooms * 9 / 10 && found.len() - n_found <= 8, "{n_found} of {n_in_rooms}, {}", found.len());
    // The impostor: what is enclosed is the insides of the walls alone.
    assert!(open.enclosed().unwrap().coordinates().iter().all(|p| !is_in_room(p)));
    let wall = Plan::from_walls([(Point2::new(0.0, 0.0), Point2::new(5.0, 3.0))]).unwrap();
    assert_eq!(PixelGrid::over(&wall, 1.0).unwrap().interior().unwrap_err(), GridError::NothingEnclosed);
}
