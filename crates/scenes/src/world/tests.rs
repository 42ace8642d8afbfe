//! Properties of every world.

use super::*;
use crate::GenerateError;

/// FNV-1a over the whole content of a world.
fn checksum(world: &World) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut eat =
        |x: u64| x.to_le_bytes().iter().for_each(|&b| hash = (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01B3));
    for portal in world.graph.portals() {
        portal.cells.iter().for_each(|c| eat(u64::from(c.0)));
        portal.shape.corners().iter().flatten().for_each(|x| eat(x.to_bits()));
    }
    for plane in &world.planes {
        plane.normal.iter().for_each(|&n| eat(n as u64));
        eat(plane.offset.to_bits());
    }
    for leaf in &world.leafs {
        eat(leaf.cell.map_or(u64::MAX, |c| u64::from(c.0)));
        leaf.faces.iter().flatten().flatten().for_each(|x| eat(x.to_bits()));
    }
    hash
}

/// Number of points examined; panics if the world contradicts itself.
fn check(name: &str, world: &World) -> usize {
    let size = world.bounds();
    let scale = (0..3).map(|k| size.max[k] - size.min[k]).fold(0.0, f64::max);
    let magnitude = size.min.iter().chain(&size.max).fold(0.0f64, |m, x| m.max(x.abs()));
    // The possible error of doubles of that size, with a margin; it only excuses points, never portals.
    let near = 1e-12 * magnitude + 1e-9 * scale;
    let cells = world.cells();
    assert_eq!(cells.len(), world.graph.n_cells());
    assert!(cells.iter().zip(0..).all(|(leaf, k)| leaf.cell == Some(CellId(k))));
    let mut n_points = 0;
    for portal in world.graph.portals() {
        let corners = portal.shape.corners();
        for cell in portal.cells {
            let outside = corners.iter().map(|&p| -cells[cell.idx()].depth(p)).fold(0.0, f64::max);
            assert!(outside <= near, "{name}: a portal sticks out of cell {cell} by {outside}");
        }
        // A step from its middle in the direction of crossing leads from the first cell into the second.
        let middle = [0, 1, 2].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len() as f64);
        let normal = portal.shape.normal();
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        let inner = portal.shape.edges().map(|[a, b]| distance_from_line(middle, a, b)).fold(f64::INFINITY, f64::min);
        let step = 0.01 * inner / length;
        if step * length < 4.0 * near {
            continue;
        }
        let at = |side: f64| world.leaf_at([0, 1, 2].map(|k| middle[k] + side * step * normal[k]));
        for (side, cell) in [(-1.0, portal.cells[0]), (1.0, portal.cells[1])] {
            assert_eq!(world.leafs[at(side)].cell, Some(cell), "{name}: across a portal");
            n_points += 1;
        }
    }
    // Points of a leaf are located in it, and those next to its faces are located according to the portals.
    for (index, leaf) in world.leafs.iter().enumerate() {
        let n = leaf.faces.iter().flatten().count() as f64;
        let middle = [0, 1, 2].map(|k| leaf.faces.iter().flatten().map(|p| p[k]).sum::<f64>() / n);
        assert!(leaf.depth(middle) > 0.0, "{name}: the middle of leaf {index}");
        if leaf.depth(middle) > near {
            assert_eq!(world.leaf_at(middle), index, "{name}");
            n_points += 1;
        }
    }
    n_points
}

fn distance_from_line(p: Point3, a: Point3, b: Point3) -> f64 {
    let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| p[k] - a[k]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = |w: [f64; 3]| w.iter().map(|x| x * x).sum::<f64>().sqrt();
    length(cross) / length(u)
}

/// One step outwards from every point of a face of a cell lies another cell exactly if a portal is there. Portals are
/// neither lost nor invented.
fn faces_are_explained(world: &World) -> usize {
    let mut n_points = 0;
    let mut rng = Rng::new(5, 5);
    for leaf in world.cells() {
        let own = leaf.cell.expect("cells have ids");
        for face in &leaf.faces {
            for _ in 0..4 {
                let weights: Vec<f64> = face.iter().map(|_| f64::from(rng.between(1, 1000))).collect();
                let total: f64 = weights.iter().sum();
                let p: Point3 =
                    [0, 1, 2].map(|k| face.iter().zip(&weights).map(|(q, w)| q[k] * w).sum::<f64>() / total);
                let Some(shape) = Portal3::around(face) else { continue };
                let normal = shape.normal();
                let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
                let beyond = [0, 1, 2].map(|k| p[k] + normal[k] / length * 1e-3);
                let bounds = world.bounds();
                let is_outside = (0..3).any(|k| beyond[k] <= bounds.min[k] || beyond[k] >= bounds.max[k]);
                let there = world.leafs[world.leaf_at(beyond)].clone();
                if !is_outside && there.depth(beyond) < 5e-4 {
                    continue;
                }
                let expected = if is_outside { None } else { there.cell };
                let through = world.graph.exits(own).iter().find(|exit| {
                    let shape = &world.graph.portal(exit.portal).shape;
                    let n = shape.normal();
                    let q = beyond;
                    let inside = shape.edges().all(|[a, b]| {
                        let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| q[k] - a[k]));
                        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                        (0..3).map(|k| cross[k] * n[k]).sum::<f64>() > 0.0
                    });
                    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let a = shape.corners()[0];
                    let off = (0..3).map(|k| (q[k] - a[k]) * n[k]).sum::<f64>().abs() / length;
                    inside && off < 2e-3
                });
                assert_eq!(through.map(|exit| exit.to), expected, "cell {own}");
                n_points += 1;
            }
        }
    }
    n_points
}

#[test]
fn families_do_not_contradict_themselves() {
    let mut n_points = 0;
    for (name, world) in world_families() {
        assert!(world.graph.n_cells() > 0, "{name}");
        n_points += check(name, &world);
    }
    assert!(n_points > 1000, "{n_points}");
}

#[test]
fn random_worlds_do_not_contradict_themselves() {
    let (mut n_points, mut n_face_points, mut n_tilted) = (0, 0, 0);
    for seed in 0..30 {
        let world = bsp_world(BspWorldOptions { seed, leafs: 60, ..BspWorldOptions::default() }).unwrap();
        n_points += check("random", &world);
        n_face_points += faces_are_explained(&world);
        n_tilted += world.planes.iter().filter(|p| p.axis().is_none()).count();
        assert!(world.leafs.len() > 40, "{}", world.leafs.len());
    }
    assert!(n_points > 3000 && n_face_points > 15_000 && n_tilted > 500, "{n_points} {n_face_points} {n_tilted}");
}

#[test]
fn levels_do_not_contradict_themselves() {
    let (mut n_face_points, mut n_corners) = (0, Vec::new());
    for seed in 0..4 {
        let world = quake_like(QuakeLikeOptions { seed, ..QuakeLikeOptions::default() }).unwrap();
        assert!(check("level", &world) > 1500);
        n_face_points += faces_are_explained(&world);
        n_corners.extend(world.graph.portals().iter().map(|p| p.shape.corners().len()));
        assert!((200..1000).contains(&world.graph.n_cells()), "{}", world.graph.n_cells());
    }
    let kinds: Vec<usize> = (3..9).map(|n| n_corners.iter().filter(|&&m| m == n).count()).collect();
    assert!(kinds[..3].iter().all(|&n| n > 5) && kinds[5] > 0, "{kinds:?}");
    assert!(n_face_points > 5_000, "{n_face_points}");
}

/// The impostors: a world with one portal less, with one reversed, and with one between the wrong cells.
#[test]
fn checks_of_worlds_can_fail() {
    let world = bsp_world(BspWorldOptions::default()).unwrap();
    type Portals = Vec<([CellId; 2], Portal3)>;
    let with = |change: &dyn Fn(&mut Portals)| {
        let portals = world.graph.portals().iter();
        let mut portals = portals.map(|p| (p.cells, p.shape.clone())).collect();
        change(&mut portals);
        World { graph: CellGraph::of_portals(world.graph.n_cells(), portals), ..world.clone() }
    };
    let fails = |world: World| std::panic::catch_unwind(|| (check("", &world), faces_are_explained(&world))).is_err();
    assert!(!fails(with(&|_| {})));
    assert!(fails(with(&|p| drop(p.pop()))));
    assert!(fails(with(&|p| p[3].1 = p[3].1.reversed())));
    assert!(fails(with(&|p| p[3].0[0] = CellId((p[3].0[0].0 + 1) % 20))));
}

#[test]
fn worlds_are_the_same_everywhere() {
    let random = bsp_world(BspWorldOptions { seed: 3, leafs: 300, ..BspWorldOptions::default() }).unwrap();
    let level = quake_like(QuakeLikeOptions { seed: 3, ..QuakeLikeOptions::default() }).unwrap();
    let stairs = spiral_stairs(2).unwrap();
    assert_eq!([checksum(&random), checksum(&level), checksum(&stairs)], PINNED);
    let other = bsp_world(BspWorldOptions { seed: 4, leafs: 300, ..BspWorldOptions::default() }).unwrap();
    assert_ne!(checksum(&other), checksum(&random));
}

const PINNED: [u64; 3] = [1085901256612171324, 16892977601015940143, 9394820553867789378];

#[test]
fn corridors_are_boxes_in_a_row() {
    for (n, bends, width) in [(1, [0, 0], 4), (9, [1, 2], 13), (40, [1, 0], 100)] {
        let world = corridor(n, bends, width).unwrap();
        let n_portals = n as usize;
        assert_eq!((world.graph.n_cells(), world.graph.portals().len()), (n_portals + 1, n_portals));
        for k in 0..n_portals {
            let low = bends.map(|b| f64::from(b) * (k * k) as f64);
            let [a, b] = [-1.0, 1.0].map(|side| {
                let x = 32.0 * k as f64 + side;
                world.leafs[world.leaf_at([x, low[0] + 0.5, low[1] + 0.5])].cell.expect("a box is empty")
            });
            let exit = world.graph.exits(a).iter().find(|exit| exit.to == b).expect("boxes in a row");
            let corners = world.graph.portal(exit.portal).shape.corners();
            let bounds = corners.iter().fold(Aabb::EMPTY, |bounds, &p| bounds.with(p));
            let width = f64::from(width);
            let x = 32.0 * k as f64;
            assert_eq!(bounds, Aabb { min: [x, low[0], low[1]], max: [x, low[0] + width, low[1] + width] });
        }
    }
    assert!(corridor_sees([1, 0], 2, [0, 3]) && !corridor_sees([1, 0], 1, [3, 0]) && corridor_sees([9, 9], 1, [4, 6]));
}

#[test]
fn maps_of_worlds_keep_their_portals() {
    let world = spiral_stairs(1).unwrap();
    let n = world.graph.portals().len();
    let moved = world.moved([3.0, 5.0, -7.0]);
    assert_eq!(moved.moved([-3.0, -5.0, 7.0]), world);
    assert_eq!(world.scaled(0.25).scaled(4.0), world);
    let sheared = world.sheared([[1, 2, 0], [0, 1, 0], [0, 3, 1]]);
    assert_eq!(sheared.graph.portals().len(), n);
    assert!(check("sheared", &sheared) > 100);
    assert_ne!(world.jittered(1, 1e-9).graph, world.graph);
    assert!(std::panic::catch_unwind(|| world.sheared([[2, 0, 0], [0, 1, 0], [0, 0, 1]])).is_err());
}

#[test]
fn options_of_worlds_are_checked() {
    let text = |r: Result<World, GenerateError>| r.unwrap_err().to_string();
    let random = |leafs| bsp_world(BspWorldOptions { leafs, ..BspWorldOptions::default() });
    assert_eq!(text(random(0)), "leafs is 0, but must be from 1 to 20000");
    assert_eq!(text(corridor(0, [0, 0], 1)), "n_portals is 0, but must be from 1 to 200");
    let level = |floors| quake_like(QuakeLikeOptions { floors, ..QuakeLikeOptions::default() });
    assert_eq!(text(level(5)), "floors is 5, but must be from 1 to 4");
    assert!(spiral_stairs(9).is_err());
}
