use super::super::{Sight, sight_by_solids};
use super::*;
use sightlines_scenes::world::{BspWorldOptions, bsp_world, corridor, corridor_sees, pillar_ring};

#[test]
fn sequences_agree_with_the_known_corridor() {
    let mut counts = [0; 3];
    for (bends, width) in [([0, 0], 16), ([1, 0], 4), ([1, 2], 3), ([3, 1], 6)] {
        for shear in [[[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[1, 2, 0], [1, 3, 0], [1, 0, 1]]] {
            let straight = corridor(5, bends, width).unwrap();
            let cells = straight.cells();
            let place = |cell: u32| (cells[cell as usize].bounds().max[0] / 32.0) as u32;
            for ([a, b], passable) in sequences_between(&straight.sheared(shear).graph, 5) {
                let boxes = [place(a), place(b)];
                let known = corridor_sees(bends, width, boxes);
                let grazes = !known && corridor_sees(bends, width + 1, boxes);
                let expected = match (known, grazes) {
                    (true, _) => Passable::Open,
                    (_, true) => Passable::Touched,
                    _ => Passable::Blocked,
                };
                assert_eq!(passable, expected, "{bends:?} {width} {boxes:?}");
                counts[passable as usize] += 1;
            }
        }
    }
    assert!(counts.iter().all(|&n| n > 5), "{counts:?}");
}

#[test]
fn sequences_agree_with_segments() {
    let mut counts = [[0; 3]; 3];
    // Corners of axial worlds are small integers; the others take ten times as long.
    for (tilted_percent, n_seeds) in [(0, 10), (60, 3)] {
        for seed in 0..n_seeds {
            let world = bsp_world(BspWorldOptions { seed, leafs: 12, solid_percent: 50, tilted_percent }).unwrap();
            let margin = if tilted_percent == 0 { -1e-9 } else { 1e-6 };
            for ([a, b], passable) in sequences_between(&world.graph, 4) {
                let sight = sight_by_solids(&world, CellId(a), CellId(b), margin, 500).sight;
                assert!(!(sight == Sight::Hidden && passable == Passable::Open), "{seed} {a} {b}");
                assert!(!(sight == Sight::Sees && passable == Passable::Blocked), "{seed} {a} {b}");
                counts[passable as usize][sight as usize] += 1;
            }
        }
    }
    let agree = counts[0][Sight::Hidden as usize] + counts[2][Sight::Sees as usize];
    let total: usize = counts.iter().flatten().sum();
    assert!(counts[0][Sight::Hidden as usize] > 5 && agree * 10 > total * 8, "{counts:?}");
}

#[test]
fn a_ring_is_walked_both_ways() {
    let world = pillar_ring();
    let known = sequences_between(&world.graph, 3);
    let n = world.graph.n_cells();
    assert_eq!(known.len(), n * (n - 1) / 2);
    assert!(known.values().filter(|&&p| p == Passable::Open).count() > n);
}

/// The impostors: a portal turned round, and one moved away, block what was open.
#[test]
fn sequences_depend_on_each_portal() {
    let square =
        |x: f64, y: f64| Portal3::around(&[[x, y, 0.0], [x, y + 4.0, 0.0], [x, y + 4.0, 4.0], [x, y, 4.0]]).unwrap();
    let row = [square(0.0, 0.0), square(8.0, 1.0), square(16.0, 3.0)];
    assert_eq!(sequence_brute_force(&row), Passable::Open);
    let with = |k: usize, portal: Portal3| {
        let mut row = row.clone();
        row[k] = portal;
        sequence_brute_force(&row)
    };
    for (k, portal) in row.iter().enumerate() {
        assert_eq!(with(k, portal.reversed()), Passable::Blocked);
        assert_eq!(with(k, square(8.0 * k as f64, 40.0)), Passable::Blocked);
    }
    assert_eq!(with(1, square(8.0, 5.5)), Passable::Touched);
    assert_eq!(with(1, square(8.0, 5.25)), Passable::Open);
}
