//! How many single-sided faces the viewers of a table can see from behind.
//!
//! Engines draw only the front of such a face, and a table takes it to hide from both sides: it holds for viewers who never see its back. How
//! far that is true of the cells of a table is bounded here from both sides.

use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_geometry::vector::{dot, normal};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random, orient3d};
use sightlines_multifocal::RaySampler;
use sightlines_pvs::Table;

/// Rays from all cells together.
const N_RAYS: usize = 1 << 16;

/// How many triangles that hide, and of which only the front is drawn, can be seen from behind by somebody in a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Backs {
    /// Such triangles.
    pub n_triangles: usize,
    /// An upper bound. Where cells leave no gaps but solid matter: those with a cell right behind them. Else those with any part of a cell behind
    /// their plane, which are many more.
    pub n_at_most: usize,
    /// A lower bound: those of which rays from somewhere in a cell met the back first. Rays are traced in doubles.
    pub n_by_rays: usize,
}

impl Backs {
    /// Counts for the cells of a table, of the scene that it was made of, along its axes. The same arguments give the same counts, with any
    /// number of threads.
    ///
    /// Cost: O(log n) for each triangle and each of some ten thousand rays; where cells leave gaps, at worst O(cells) for each triangle.
    pub fn of(table: &Table, scene: &Scene) -> Self {
        let Survey { may_be_seen, met } = Survey::of(table, scene);
        Self {
            n_triangles: may_be_seen.len(),
            n_at_most: may_be_seen.iter().filter(|may| **may).count(),
            // Rounded rays may slip through where two faces meet: what is excluded exactly is.
            n_by_rays: met.into_iter().filter(|&t| may_be_seen[t]).count(),
        }
    }
}

/// Single-sided triangles, as cells see them.
struct Survey {
    /// Whether a back may be seen, triangle by triangle.
    may_be_seen: Vec<bool>,
    /// Those whose backs rays met.
    met: Vec<usize>,
}

impl Survey {
    fn of(table: &Table, scene: &Scene) -> Self {
        let occluders = scene.occluders().filter(|(object, _)| scene.is_single_sided(*object));
        let triangles: Vec<[Point3; 3]> = occluders.flat_map(|(_, object)| object.corners()).collect();
        if triangles.is_empty() {
            return Self { may_be_seen: Vec::new(), met: Vec::new() };
        }
        let cells: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
        let may_be_seen: Vec<bool> = if table.kind().cells_fill_space() {
            with_a_cell_behind(&triangles, &cells)
        } else {
            triangles.par_iter().map(|t| cells.iter().any(|cell| reaches_behind(t, cell))).collect()
        };
        let met = met_from_behind(&triangles, scene, &cells);
        Self { may_be_seen, met }
    }
}

/// Whether a part of a box is behind the plane of a triangle. Exact.
fn reaches_behind([a, b, c]: &[Point3; 3], cell: &Aabb<3>) -> bool {
    cell.corners().into_iter().any(|corner| orient3d(*a, *b, *c, corner) < 0.0)
}

/// Triangles with a cell right behind them, of cells around which nothing is but solid matter.
///
/// Who sees a back sees an open set of its points, along lines that are in cells up to there. The cell before such a point reaches behind the triangle,
/// and overlaps the box around it along each axis along which that has an extent. What is outside of the box around all cells may be seen through its border.
fn with_a_cell_behind(triangles: &[[Point3; 3]], cells: &[Aabb<3>]) -> Vec<bool> {
    let all = Aabb::around(cells.iter().flat_map(|b| [b.min, b.max]));
    let tree = BoxTree::build(cells, 4);
    let has_one = |t: &[Point3; 3]| {
        let around = Aabb::<3>::around(*t);
        if (0..3).any(|k| around.min[k] < all.min[k] || around.max[k] > all.max[k]) {
            return cells.iter().any(|cell| reaches_behind(t, cell));
        }
        let meets = |b: &Aabb<3>| {
            (0..3).all(|k| match around.min[k] < around.max[k] {
                true => b.min[k] < around.max[k] && around.min[k] < b.max[k],
                false => b.min[k] <= around.min[k] && around.min[k] <= b.max[k],
            })
        };
        let mut found = false;
        tree.visit(meets, |i| {
            let cell = &cells[i as usize];
            found = found || (meets(cell) && reaches_behind(t, cell));
        });
        found
    };
    triangles.par_iter().map(has_one).collect()
}

/// Which of `triangles` rays from the cells meet from behind before anything else, ascending.
fn met_from_behind(triangles: &[[Point3; 3]], scene: &Scene, cells: &[Aabb<3>]) -> Vec<usize> {
    if cells.is_empty() {
        return Vec::new();
    }
    // Each triangle is an object of the sampler: first those that are counted, then all others that hide.
    let is_counted = |object: u32| scene.is_single_sided(object);
    let others = scene.occluders().filter(|(object, _)| !is_counted(*object)).flat_map(|(_, object)| object.corners());
    let all: Vec<[Point3; 3]> = triangles.iter().copied().chain(others).collect();
    let rays = RaySampler::new(all.iter().map(std::slice::from_ref));
    let n_of_each = N_RAYS.div_ceil(cells.len());
    let from = |(cell, bounds): (usize, &Aabb<3>)| {
        let mut random = Random::new(cell as u64);
        let met = (0..n_of_each).filter_map(|_| {
            let (origin, way) = (random.point(bounds), random.direction());
            let first = rays.first_hit(origin, way)? as usize;
            let t = triangles.get(first)?;
            (dot(normal(*t), way) > 0.0).then_some(first)
        });
        met.collect::<Vec<usize>>()
    };
    let mut met: Vec<usize> = cells.par_iter().enumerate().flat_map_iter(from).collect();
    met.sort_unstable();
    met.dedup();
    met
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::SceneObject;
    use sightlines_pvs::{BitMatrix, CellRecord, Locator, SceneMethods, TableKind, TableParts};

    fn quad(corners: [Point3; 4]) -> SceneObject {
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        SceneObject { name: String::new(), vertices: corners.to_vec(), triangles }
    }

    /// A square across x, from 0 to 1, whose front is towards larger x, or smaller ones.
    fn screen(x: f64, is_forward: bool) -> SceneObject {
        let (y, z) = if is_forward {
            ([0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0])
        } else {
            ([0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 1.0, 0.0])
        };
        quad(std::array::from_fn(|i| [x, y[i], z[i]]))
    }

    fn table(cells: &[[Point3; 2]], fill_space: bool) -> Table {
        let hidden_by = SceneMethods { sightlines: true, ..SceneMethods::default() };
        let kind =
            if fill_space { TableKind::SceneKdTree { hidden_by } } else { TableKind::SceneGivenCells { hidden_by } };
        let record = |&[min, max]: &[Point3; 2]| CellRecord { min, max, polygon: Vec::new(), group: None };
        let n = cells.len();
        let mut parts = TableParts::empty(3, kind);
        parts.locator = Locator::build(&cells.iter().map(|&[min, max]| (min, max)).collect::<Vec<_>>(), 3);
        parts.cells = cells.iter().map(record).collect();
        parts.rows = BitMatrix::identity(n);
        parts.cell_objects = vec![Vec::new(); n];
        Table::new(parts).expect("a table")
    }

    fn backs(objects: Vec<SceneObject>, single: Vec<u32>, cells: &[[Point3; 2]], fill_space: bool) -> [usize; 3] {
        let scene = Scene::new(objects).and_then(|scene| scene.with_single_sided(single)).expect("a scene");
        let table = table(cells, fill_space);
        let Backs { n_triangles, n_at_most, n_by_rays } = Backs::of(&table, &scene);
        // No ray of these scenes passes near an edge: all that rays meet is within the bound, unless cells only claim to fill the space.
        let Survey { may_be_seen, met } = Survey::of(&table, &scene);
        let all = Aabb::around(cells.iter().flatten().copied());
        let volume = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).product::<f64>();
        let filled = cells.iter().map(|&[min, max]| volume(&Aabb { min, max })).sum::<f64>() == volume(&all);
        assert!(fill_space && !filled || met.iter().all(|&t| may_be_seen[t]) && met.len() == n_by_rays);
        [n_triangles, n_at_most, n_by_rays]
    }

    #[test]
    fn a_cell_behind_sees_backs_and_one_in_front_does_not() {
        let (front, back) = ([[1.0, 0.0, 0.0], [2.0, 1.0, 1.0]], [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]);
        for fill_space in [true, false] {
            let of =
                |forward: bool, cells: &[[Point3; 2]]| backs(vec![screen(1.0, forward)], vec![0], cells, fill_space);
            assert_eq!(of(true, &[front]), [2, 0, 0]);
            assert_eq!(of(true, &[back]), [2, 2, 2]);
            assert_eq!(of(true, &[front, back]), [2, 2, 2]);
            assert_eq!(of(false, &[front]), [2, 2, 2]);
        }
        // Both sides are drawn.
        assert_eq!(backs(vec![screen(1.0, true)], vec![], &[front, back], true), [0; 3]);
    }

    /// A cell beside a face that reaches behind its plane is not right behind it; where cells leave gaps, it counts.
    #[test]
    fn the_bound_is_as_near_as_the_cells_allow() {
        let beside = [[[1.0, 0.0, 0.0], [2.0, 1.0, 1.0]], [[0.0, 1.0, 0.0], [2.0, 2.0, 1.0]]];
        assert_eq!(backs(vec![screen(1.0, true)], vec![0], &beside, true), [2, 0, 0]);
        let [n, at_most, _] = backs(vec![screen(1.0, true)], vec![0], &beside, false);
        assert_eq!([n, at_most], [2, 2]);
        // Something in the way of rays is no bound.
        let hidden = vec![screen(1.0, true), screen(0.5, true)];
        assert_eq!(backs(hidden, vec![0], &[[[0.0, 0.0, 0.0], [0.4, 1.0, 1.0]]], false), [2, 2, 0]);
        // Beyond the box around the cells.
        assert_eq!(backs(vec![screen(3.0, true)], vec![0], &[[[1.0, 0.0, 0.0], [2.0, 1.0, 1.0]]], true), [2, 2, 2]);
    }

    /// Slanted: a cell that it crosses is on both sides.
    #[test]
    fn slanted_faces_have_the_cell_that_they_cross_behind_them() {
        let slanted = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0]]);
        assert_eq!(backs(vec![slanted], vec![0], &[[[0.0; 3], [1.0; 3]]], true), [2, 2, 2]);
    }
}
