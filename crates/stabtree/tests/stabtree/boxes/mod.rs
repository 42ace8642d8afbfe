//! Random graphs of boxes in a cube, and objects.

use proptest::prelude::*;
use sightlines_cells::{Axial, BoxCell, CellGraph, CellId, Portal};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_kdtree::{AxialFace, AxialPortal, KdOptions, subdivide};

/// Side of the cube that scenes are in.
pub(crate) const SIDE: i32 = 4;

fn unordered([p, q]: [[i32; 3]; 2]) -> Aabb<3> {
    let corner = |k: usize, high: bool| f64::from(if high { p[k].max(q[k]) } else { p[k].min(q[k]) });
    Aabb { min: [0, 1, 2].map(|k| corner(k, false)), max: [0, 1, 2].map(|k| corner(k, true)) }
}

pub(crate) fn faces(most: usize) -> impl Strategy<Value = Vec<AxialFace<3>>> {
    let ends = || prop::array::uniform3(0..=SIDE);
    let face = (0..3usize, ends(), ends()).prop_map(|(axis, p, mut q)| {
        q[axis] = p[axis];
        let Aabb { min, max } = unordered([p, q]);
        AxialFace::new(axis, min, max)
    });
    prop::collection::vec(face, 1..most)
}

/// Boxes with corners at halves of the grid; some are flat, some are points.
pub(crate) fn objects() -> impl Strategy<Value = Vec<Aabb<3>>> {
    let ends = || prop::array::uniform3(-1..=2 * SIDE + 1);
    let half = |b: Aabb<3>| Aabb { min: b.min.map(|x| x / 2.0), max: b.max.map(|x| x / 2.0) };
    prop::collection::vec((ends(), ends()).prop_map(move |(p, q)| half(unordered([p, q]))), 0..6)
}

/// Cuts the cube along faces, and leaves out the cells with `out` set.
pub(crate) fn cut(faces: &[AxialFace<3>], out: &[bool]) -> (CellGraph<Axial>, Vec<Aabb<3>>) {
    cut_box(faces, Aabb { min: [0.0; 3], max: [f64::from(SIDE); 3] }, out)
}

/// The same in any box.
pub(crate) fn cut_box(faces: &[AxialFace<3>], bounds: Aabb<3>, out: &[bool]) -> (CellGraph<Axial>, Vec<Aabb<3>>) {
    let tree = subdivide(faces, bounds, &KdOptions::default()).expect("the scene is good");
    let is_out = |cell: CellId| out[cell.idx() % out.len()];
    let (mut cells, mut solid, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for (id, cell) in (0u32..).map(CellId).zip(tree.cells()) {
        ids.push(CellId(cells.len() as u32));
        if is_out(id) { solid.push(cell.bounds) } else { cells.push(BoxCell { bounds: cell.bounds }) }
    }
    let portal = |p: &AxialPortal<3>| {
        let axis = p.axis as u8;
        let shape = AxialDoor { extent: Aabb { min: p.min, max: p.max }, axis, forward: true };
        let sides = [2 * u32::from(axis) + 1, 2 * u32::from(axis)];
        Portal { cells: p.cells.map(|c| ids[c.idx()]), sides, shape }
    };
    let kept = tree.portals().iter().filter(|p| p.cells.into_iter().all(|c| !is_out(c)));
    let graph = CellGraph::<Axial>::new(cells, kept.map(portal).collect());
    graph.assert_well_formed();
    (graph, solid)
}
