//! Lines through a world, against what is solid in it.

use sightlines_geometry::{Point3, Random};
use sightlines_scenes::world::{World, WorldLeaf};
use std::collections::BTreeSet;

/// What lines showed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeenByRays {
    /// Pairs of different cells, lower id first, that a free piece of a line passes both.
    pub pairs: BTreeSet<[u32; 2]>,
    /// Pieces of lines that are free of what is solid and pass two cells at least.
    pub n_free: usize,
}

/// Share of the world's size by which a line stays clear of what is solid, and by which it is inside what it sees.
///
/// Coordinates of worlds are off by some 1e-13 of their magnitude. Clearance is a million times that, even in a
/// world that has been moved away by a thousand times its size; so a small turn of the line changes nothing, and an
/// open set of lines sees the same.
const CLEARANCE: f64 = 1.0 / (1u64 << 20) as f64;

/// Shoots `n` lines: half of them through two random points of random cells, half through two random portals. A lower
/// bound of the visibility. O(n · planes of leafs).
///
/// Portals only say where to aim; what is free the faces of the solid leafs say, and which cells are passed those of
/// the empty ones.
///
/// # Panics
/// If the world has no cell.
pub fn seen_by_rays(world: &World, n: usize, seed: u64) -> SeenByRays {
    let mut chance = Chance(Random::new(seed));
    let cells = world.cells();
    let solids: Vec<&WorldLeaf> = world.solids().collect();
    let portals = world.graph.portals();
    let bounds = world.bounds();
    let size = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let mut seen = SeenByRays::default();
    for round in 0..n {
        let mut aim = || match portals.len() {
            1.. if round % 2 == 1 => {
                let portal = &portals[chance.below(portals.len())];
                chance.point(portal.shape.corners())
            }
            _ => {
                let cell = cells[chance.below(cells.len())];
                let corners: Vec<Point3> = cell.faces.iter().flatten().copied().collect();
                chance.point(&corners)
            }
        };
        let line = [aim(), aim()];
        for piece in free_pieces(line, &solids, bounds.min.iter().chain(&bounds.max), CLEARANCE * size) {
            let passed: Vec<u32> = cells
                .iter()
                .zip(0..)
                .filter(|(leaf, _)| passes(line, leaf, piece, CLEARANCE * size))
                .map(|c| c.1)
                .collect();
            seen.n_free += usize::from(passed.len() > 1);
            for (k, &a) in passed.iter().enumerate() {
                seen.pairs.extend(passed[k + 1..].iter().map(|&b| [a, b]));
            }
        }
    }
    seen
}

/// The parts of a line that stay clear of what is solid, within the world, from low to high. A line that has no
/// direction has none.
fn free_pieces<'b>(
    [p, q]: [Point3; 2],
    solids: &[&WorldLeaf],
    bounds: impl Iterator<Item = &'b f64>,
    clearance: f64,
) -> Vec<[f64; 2]> {
    let length = (0..3).map(|k| (q[k] - p[k]) * (q[k] - p[k])).sum::<f64>().sqrt();
    if length < 1000.0 * clearance {
        return Vec::new();
    }
    // Beyond the box around the world nothing is free; all cells are inside it.
    let reach = bounds.map(|x| x.abs()).fold(0.0, f64::max) * 8.0 / length;
    let mut blocked: Vec<[f64; 2]> =
        solids.iter().filter_map(|leaf| inside([p, q], leaf, clearance, [-reach, reach])).collect();
    blocked.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut pieces = Vec::new();
    let mut at = -reach;
    for [start, end] in blocked {
        if start > at {
            pieces.push([at, start]);
        }
        at = at.max(end);
    }
    pieces.push([at, reach]);
    pieces
}

/// The part of a line that is inside a leaf whose planes are moved outwards.
fn inside([p, q]: [Point3; 2], leaf: &WorldLeaf, outwards: f64, range: [f64; 2]) -> Option<[f64; 2]> {
    let mut range = range;
    for plane in &leaf.planes {
        // Distances go from d at p by e each time the line goes from p to q.
        let d = plane.distance(p) - outwards;
        let e = plane.distance(q) - outwards - d;
        if e == 0.0 {
            if d > 0.0 {
                return None;
            }
        } else if e > 0.0 {
            range[1] = range[1].min(-d / e);
        } else {
            range[0] = range[0].max(-d / e);
        }
    }
    (range[0] < range[1]).then_some(range)
}

/// Whether a piece of a line comes deep enough into a leaf.
fn passes(line: [Point3; 2], leaf: &WorldLeaf, piece: [f64; 2], depth: f64) -> bool {
    inside(line, leaf, -depth, piece).is_some()
}

/// Pseudorandom points of leaves.
struct Chance(Random);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        (((self.0.bits() >> 32) * n as u64) >> 32) as usize
    }

    /// A point within the hull of some points: most of the weight goes to few of them, so that ends are tried too.
    fn point(&mut self, corners: &[Point3]) -> Point3 {
        let weights: Vec<f64> =
            corners.iter().map(|_| ((self.0.bits() >> 40) as f64 / (1u64 << 24) as f64).powi(4)).collect();
        let total: f64 = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        [0, 1, 2].map(|k| corners.iter().zip(&weights).map(|(p, w)| p[k] * w).sum::<f64>() / total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_scenes::world::{corridor, corridor_sees, separate_rooms, world_families};

    /// Cells of a corridor by their place in the row.
    fn places(world: &World) -> Vec<u32> {
        let mut cells: Vec<(f64, u32)> =
            world.cells().iter().zip(0..).map(|(leaf, k)| (leaf.bounds().min[0], k)).collect();
        cells.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut places = vec![0; cells.len()];
        cells.iter().zip(0..).for_each(|(&(_, cell), place)| places[cell as usize] = place);
        places
    }

    #[test]
    fn rays_see_what_is_known_to_be_seen() {
        let (mut n_found, mut n_known) = (0, 0);
        for (bends, width) in [([0, 0], 16), ([1, 0], 9), ([1, 2], 13), ([3, 1], 20)] {
            let world = corridor(9, bends, width).unwrap();
            let places = places(&world);
            let seen = seen_by_rays(&world, 20_000, 1);
            for [a, b] in &seen.pairs {
                let boxes = [places[*a as usize], places[*b as usize]];
                assert!(corridor_sees(bends, width, boxes), "{bends:?} {width} {boxes:?}");
            }
            n_found += seen.pairs.len();
            n_known += (0..10).map(|i| (0..i).filter(|&j| corridor_sees(bends, width, [i, j])).count()).sum::<usize>();
        }
        assert!(n_found * 20 > n_known * 19, "{n_found} of {n_known}");
    }

    #[test]
    fn rays_stay_where_they_are_let() {
        let world = separate_rooms();
        let seen = seen_by_rays(&world, 5000, 3);
        // Three pairs of rooms, each with what joins them, and nothing else.
        assert_eq!(seen.pairs.len(), 9);
        for (name, world) in world_families() {
            let seen = seen_by_rays(&world, 500, 1);
            // Slivers are thinner than the clearance of lines.
            let least = if world.graph.portals().is_empty() || name == "slivers" { 0 } else { 5 };
            assert!(seen.pairs.len() >= least, "{name}: {}", seen.pairs.len());
        }
    }

    /// The impostor: with a wall taken away, lines see what is not there.
    #[test]
    fn rays_depend_on_what_is_solid() {
        let mut world = separate_rooms();
        let n = seen_by_rays(&world, 5000, 3).pairs.len();
        world.leafs.retain(|leaf| leaf.cell.is_some() || leaf.bounds().max[0] < 70.0);
        assert!(seen_by_rays(&world, 5000, 3).pairs.len() > n);
    }
}
