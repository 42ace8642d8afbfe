//! All segments between two cells, subdivided until what is solid blocks each piece, or one is free.
//!
//! A segment that leaves one cell and ends in another begins on a portal of the first and ends on one of the second.
//! Pieces are pairs of triangles, one on either portal. A plane between the two is crossed by the segments of a
//! piece within the hull of where those from corner to corner cross it: seen from one point, the other triangle is
//! drawn on the plane in perspective, so within the hull of its corners' images. If all of the hull is solid, the
//! piece is blocked. Which plane is tried, a segment through the middle says.
//!
//! What lies between the two comes from the tree alone: portals on the way are ignored.

use sightlines_cells::CellId;
use sightlines_geometry::{Point3, Portal3};
use sightlines_scenes::world::{World, WorldChild, WorldPlane};
use std::collections::VecDeque;

/// Whether two cells see each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// A segment is free, with clearance: an open set of lines is.
    Sees,
    /// All segments are blocked.
    Hidden,
    /// Not known, within the number of pieces that were allowed.
    Undecided,
}

/// An answer, and what it took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SightBySolids {
    /// The answer.
    pub sight: Sight,
    /// Number of pieces looked at.
    pub n_pieces: usize,
}

type Triangle = [Point3; 3];

/// Decides whether cells `a` and `b` see each other, by at most `budget` pieces.
///
/// With `margin > 0`, `Hidden` holds even if everything that is empty grows by it, and `Sees` if everything solid
/// does: take some 1e-6 of the size of a world whose corners are rounded. With `margin < 0` only lines are ruled out
/// that are clear of what is solid by its magnitude: for worlds with exact corners, in which no slit is that thin;
/// `Sees` then needs a clearance of the same magnitude.
pub fn sight_by_solids(world: &World, a: CellId, b: CellId, margin: f64, budget: usize) -> SightBySolids {
    let sees = |n_pieces| SightBySolids { sight: Sight::Sees, n_pieces };
    if a == b || world.graph.exits(a).iter().any(|exit| exit.to == b) {
        return sees(0);
    }
    let doors = |cell: CellId| -> Vec<Portal3> {
        let portals = world.graph.exits(cell).iter().map(|exit| world.graph.portal(exit.portal));
        portals.map(|p| if p.cells[0] == cell { p.shape.clone() } else { p.shape.reversed() }).collect()
    };
    let (from, to) = (doors(a), doors(b));
    let mut waiting: VecDeque<(&Portal3, &Portal3, [Triangle; 2])> = VecDeque::new();
    for p in &from {
        for q in &to {
            waiting.extend(triangles(p).flat_map(|s| triangles(q).map(move |t| (p, q, [s, t]))));
        }
    }
    let mut n_pieces = 0;
    while let Some((p, q, piece)) = waiting.pop_front() {
        // Who leaves one cell for the other is in front of both portals, each seen from its own cell.
        if is_behind(p, &piece[1], -margin) || is_behind(q, &piece[0], -margin) {
            continue;
        }
        if n_pieces == budget {
            return SightBySolids { sight: Sight::Undecided, n_pieces };
        }
        n_pieces += 1;
        let middle = piece.map(|t| middle(&t));
        if !reaches(world, &middle, margin.abs(), true) {
            return sees(n_pieces);
        }
        if !is_blocked(world, &piece, middle, margin) {
            waiting.extend(halves(piece).map(|half| (p, q, half)));
        }
    }
    SightBySolids { sight: Sight::Hidden, n_pieces }
}

/// A portal as a fan.
fn triangles(portal: &Portal3) -> impl Iterator<Item = Triangle> + '_ {
    portal.corners()[1..].windows(2).map(|pair| [portal.corners()[0], pair[0], pair[1]])
}

/// Whether a triangle is nowhere more than `limit` in front of a portal.
fn is_behind(portal: &Portal3, triangle: &Triangle, limit: f64) -> bool {
    let (normal, o) = (portal.normal(), portal.corners()[0]);
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    let distance = |p: &Point3| (0..3).map(|k| (p[k] - o[k]) * normal[k]).sum::<f64>() / length;
    triangle.iter().all(|p| distance(p) <= limit)
}

fn middle(triangle: &Triangle) -> Point3 {
    [0, 1, 2].map(|k| (triangle[0][k] + triangle[1][k] + triangle[2][k]) / 3.0)
}

/// The piece, cut in two through its longest edge.
fn halves([s, t]: [Triangle; 2]) -> [[Triangle; 2]; 2] {
    let longest = |t: &Triangle| {
        let length = |k: usize| (0..3).map(|j| (t[k][j] - t[(k + 1) % 3][j]).powi(2)).sum::<f64>();
        (1..3).fold((length(0), 0), |best, k| if length(k) > best.0 { (length(k), k) } else { best })
    };
    let cut = |t: &Triangle, k: usize| {
        let (p, q, r) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        let m = [0, 1, 2].map(|j| (p[j] + q[j]) / 2.0);
        [[p, m, r], [m, q, r]]
    };
    let ((length_s, edge_s), (length_t, edge_t)) = (longest(&s), longest(&t));
    if length_s > length_t { cut(&s, edge_s).map(|s| [s, t]) } else { cut(&t, edge_t).map(|t| [s, t]) }
}

/// Whether a section of what is solid blocks all segments of a piece.
fn is_blocked(world: &World, piece: &[Triangle; 2], middle: [Point3; 2], margin: f64) -> bool {
    solids_along(world, middle).into_iter().any(|(leaf, at)| {
        let through = [0, 1, 2].map(|k| middle[0][k] + at * (middle[1][k] - middle[0][k]));
        world.leafs[leaf].planes.iter().any(|plane| {
            let n = plane.normal.map(f64::from);
            let section = WorldPlane { offset: (0..3).map(|k| n[k] * through[k]).sum(), ..*plane };
            crossings(&section, piece).is_some_and(|hull| !reaches(world, &hull, margin, false))
        })
    })
}

/// The solid leafs that a segment passes, and the middle of what it has in each, from 0 to 1.
fn solids_along(world: &World, segment: [Point3; 2]) -> Vec<(usize, f64)> {
    let root = if world.nodes.is_empty() { WorldChild::Leaf(0) } else { WorldChild::Node(0) };
    let mut waiting = vec![(root, [0.0, 1.0])];
    let mut found = Vec::new();
    while let Some((child, [start, end])) = waiting.pop() {
        match child {
            WorldChild::Leaf(leaf) => {
                if world.leafs[leaf].cell.is_none() && end > start {
                    found.push((leaf, (start + end) / 2.0));
                }
            }
            WorldChild::Node(node) => {
                let node = world.nodes[node];
                let [d, e] = segment.map(|p| world.planes[node.plane].distance(p));
                let near = usize::from(d < 0.0);
                if (d < 0.0) == (e < 0.0) {
                    waiting.push((node.children[near], [start, end]));
                } else {
                    let at = (d / (d - e)).clamp(start, end);
                    waiting.push((node.children[1 - near], [at, end]));
                    waiting.push((node.children[near], [start, at]));
                }
            }
        }
    }
    found
}

/// The hull of where the segments of a piece cross a plane, counter-clockwise about its normal; `None` if the plane
/// is not between the triangles.
fn crossings(plane: &WorldPlane, [s, t]: &[Triangle; 2]) -> Option<Vec<Point3>> {
    let (mut ds, mut dt) = (s.map(|p| plane.distance(p)), t.map(|p| plane.distance(p)));
    if ds[0] < 0.0 {
        (ds, dt) = (ds.map(|d| -d), dt.map(|d| -d));
    }
    if ds.iter().any(|&d| d <= 0.0) || dt.iter().any(|&d| d >= 0.0) {
        return None;
    }
    let mut points = Vec::with_capacity(9);
    for (p, &d) in s.iter().zip(&ds) {
        for (q, &e) in t.iter().zip(&dt) {
            let at = d / (d - e);
            points.push([0, 1, 2].map(|k| p[k] + at * (q[k] - p[k])));
        }
    }
    // Corners that rounding takes off the plane do not matter: margins are larger.
    Some(hull(points, plane))
}

/// The hull of points of a plane, drawn along the axis that it faces most.
fn hull(mut points: Vec<Point3>, plane: &WorldPlane) -> Vec<Point3> {
    let axis = (0..3).max_by_key(|&k| plane.normal[k].abs()).expect("there are three axes");
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    points.sort_by(|p, q| p[u].total_cmp(&q[u]).then(p[v].total_cmp(&q[v])));
    let turn = |a: &Point3, b: &Point3, c: &Point3| (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    let chain = |points: &mut dyn Iterator<Item = &Point3>| {
        let mut chain: Vec<Point3> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if turn(&a, &b, p) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut points.iter());
    let upper = chain(&mut points.iter().rev());
    if lower.is_empty() { points } else { [lower, upper].concat() }
}

/// Whether any of a polygon, or of a segment, is in a leaf that is solid, or in one that is not. Leafs count as larger
/// by `margin` on all sides, or as smaller if it is negative.
fn reaches(world: &World, polygon: &[Point3], margin: f64, solid: bool) -> bool {
    let root = if world.nodes.is_empty() { WorldChild::Leaf(0) } else { WorldChild::Node(0) };
    let mut waiting = vec![(root, polygon.to_vec())];
    while let Some((child, polygon)) = waiting.pop() {
        match child {
            WorldChild::Leaf(leaf) => {
                if world.leafs[leaf].cell.is_none() == solid {
                    return true;
                }
            }
            WorldChild::Node(node) => {
                let node = world.nodes[node];
                let plane = world.planes[node.plane];
                for (child, side) in node.children.into_iter().zip([1.0, -1.0]) {
                    let part = part_in_front(&polygon, |p| side * plane.distance(p) + margin);
                    if !part.is_empty() {
                        waiting.push((child, part));
                    }
                }
            }
        }
    }
    false
}

/// What of a convex polygon has a distance of 0 or more.
fn part_in_front(polygon: &[Point3], distance: impl Fn(Point3) -> f64) -> Vec<Point3> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (d, e) = (distance(p), distance(q));
        if d >= 0.0 {
            part.push(p);
        }
        if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
            let at = d / (d - e);
            part.push([0, 1, 2].map(|j| p[j] + at * (q[j] - p[j])));
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::super::seen_by_rays;
    use super::*;
    use sightlines_scenes::world::{BspWorldOptions, bsp_world, corridor, corridor_sees, separate_rooms};

    /// All pairs of cells, lower id first, with what is known of them; and how many of each answer.
    fn table(world: &World, margin: f64, budget: usize) -> (Vec<([u32; 2], Sight)>, [usize; 3]) {
        let n = world.graph.n_cells() as u32;
        let mut counts = [0; 3];
        let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| [a, b]));
        let decide = |[a, b]: [u32; 2]| {
            let sight = sight_by_solids(world, CellId(a), CellId(b), margin, budget).sight;
            counts[sight as usize] += 1;
            ([a, b], sight)
        };
        let table = pairs.map(decide).collect();
        (table, counts)
    }

    #[test]
    fn segments_agree_with_the_known_corridor() {
        let mut sum = [0; 3];
        // In the second and the last there are pairs between which lines only graze.
        for (bends, width) in [([0, 0], 16), ([1, 0], 4), ([1, 2], 5), ([3, 1], 6)] {
            let world = corridor(7, bends, width).unwrap();
            let cells = world.cells();
            let place = |cell: u32| (cells[cell as usize].bounds().max[0] / 32.0) as u32;
            let (table, counts) = table(&world, -1e-9, 4000);
            for ([a, b], sight) in table {
                let known = corridor_sees(bends, width, [place(a), place(b)]);
                assert!(sight != Sight::Sees || known, "{bends:?} {a} {b}");
                assert!(sight != Sight::Hidden || !known, "{bends:?} {a} {b}");
            }
            (0..3).for_each(|k| sum[k] += counts[k]);
        }
        assert!(sum[0] > 60 && sum[1] > 10 && sum[2] < 20, "{sum:?}");
    }

    #[test]
    fn segments_and_rays_do_not_contradict_each_other() {
        let (mut sum, mut n_seen) = ([0; 3], 0);
        for seed in 0..12 {
            for tilted_percent in [0, 60] {
                let world = bsp_world(BspWorldOptions { seed, leafs: 18, solid_percent: 45, tilted_percent }).unwrap();
                let seen = seen_by_rays(&world, 3000, seed).pairs;
                let margin = if tilted_percent == 0 { -1e-9 } else { 1e-6 };
                let (table, counts) = table(&world, margin, 1500);
                for (pair, sight) in table {
                    assert!(!(sight == Sight::Hidden && seen.contains(&pair)), "{seed} {tilted_percent} {pair:?}");
                }
                (0..3).for_each(|k| sum[k] += counts[k]);
                n_seen += seen.len();
            }
        }
        assert!(sum[0] > 300 && sum[1] > 100 && sum[2] < sum[1], "{sum:?}");
        assert!(n_seen * 10 > sum[0] * 9, "{n_seen} {sum:?}");
    }

    /// The impostor: where a wall is called empty, what was hidden is seen.
    #[test]
    fn segments_depend_on_what_is_solid() {
        let mut world = separate_rooms();
        let (before, counts) = table(&world, 1e-6, 2000);
        assert_eq!(counts[0], 9);
        let hidden = counts[1];
        assert!(hidden > 30, "{before:?}");
        for leaf in &mut world.leafs {
            leaf.cell.get_or_insert(CellId(0));
        }
        // Some portals face away from each other; their cells stay hidden.
        let (_, counts) = table(&world, 1e-6, 2000);
        assert!(counts[0] > 30, "{counts:?}");
    }
}
