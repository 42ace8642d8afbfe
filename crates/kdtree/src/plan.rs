//! From a plan to a graph of cells and portals in the plane.

use crate::build::{KdOptions, subdivide};
use crate::error::KdError;
use crate::face::AxialFace;
use crate::tree::{AxialCell, AxialPortal, AxialTree};
use sightlines_cells::{CellGraph, ConvexCell2, LineId, Plan, Planar, Portal, Portal2};
use sightlines_geometry::Point2;

/// What a k-d tree can follow of a plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanFaces {
    /// The opaque axis-parallel lines, in input order, and then the joints of the plan that are.
    pub faces: Vec<AxialFace<2>>,
    /// The opaque lines that run in another direction, ascending. They divide nothing and hide nothing.
    pub left_over: Vec<LineId>,
}

/// A plan, cut.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSubdivision {
    /// The tree, for point location.
    pub tree: AxialTree<2>,
    /// Its cells and portals, with the same ids.
    pub graph: CellGraph<Planar>,
    /// The opaque lines that were not followed, ascending; see [`PlanFaces::left_over`].
    pub left_over: Vec<LineId>,
}

/// Separates the lines of a plan: opaque and axis-parallel, or opaque otherwise. Lines that are not opaque are dropped.
/// O(n).
pub fn plan_faces(plan: &Plan) -> PlanFaces {
    let mut out = PlanFaces::default();
    for (id, line) in (0u32..).map(LineId).zip(plan.lines()).filter(|(_, line)| line.opaque) {
        match axial_face(line.a, line.b) {
            Some(face) => out.faces.push(face),
            None => out.left_over.push(id),
        }
    }
    out.faces.extend(plan.joints().iter().filter_map(|joint| axial_face(joint.from, joint.to)));
    out
}

fn axial_face(a: Point2, b: Point2) -> Option<AxialFace<2>> {
    let (a, b) = (a.to_array(), b.to_array());
    let axis = (0..2).find(|&axis| a[axis] == b[axis])?;
    let end = |pick: fn(f64, f64) -> f64| std::array::from_fn(|k| pick(a[k], b[k]));
    Some(AxialFace::new(axis, end(f64::min), end(f64::max)))
}

/// Cuts the box around all lines of `plan` along its opaque axis-parallel lines.
///
/// Outside of [`Plan::bounds`] there are no cells, so a viewer there has no answer; between viewers inside, nothing is
/// lost, as the box is convex. Errs towards "visible": lines that are not axis-parallel hide nothing; they are listed
/// in [`PlanSubdivision::left_over`].
///
/// Cost: see [`subdivide`].
///
/// # Errors
/// [`KdError::Empty`] and [`KdError::Flat`] for plans without lines or without extent along an axis, [`KdError::Tau`],
/// [`KdError::TooManyCells`].
pub fn subdivide_plan(plan: &Plan, options: &KdOptions) -> Result<PlanSubdivision, KdError> {
    let PlanFaces { faces, left_over } = plan_faces(plan);
    let tree = subdivide(&faces, plan.bounds(), options)?;
    let graph = planar_graph(&tree);
    Ok(PlanSubdivision { tree, graph, left_over })
}

/// The cells and portals of a tree as a graph, with the same ids. Cells name no groups.
///
/// Sides are numbered 0 for -x, 1 for +x, 2 for -y, 3 for +y. O(n log n) for n cells and portals.
pub fn planar_graph(tree: &AxialTree<2>) -> CellGraph<Planar> {
    CellGraph::new(tree.cells().iter().map(rectangle).collect(), tree.portals().iter().map(planar_portal).collect())
}

fn rectangle(cell: &AxialCell<2>) -> ConvexCell2 {
    let ([x0, y0], [x1, y1]) = (cell.bounds.min, cell.bounds.max);
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    ConvexCell2 { polygon: corners.map(Point2::from_array).to_vec(), groups: Vec::new() }
}

fn planar_portal(portal: &AxialPortal<2>) -> Portal<Planar> {
    let (min, max) = (Point2::from_array(portal.min), Point2::from_array(portal.max));
    // Towards +x, the left is +y; towards +y, it is -x.
    let shape = if portal.axis == 0 { Portal2 { left: max, right: min } } else { Portal2 { left: min, right: max } };
    let low_side = 2 * portal.axis as u32;
    Portal { cells: portal.cells, sides: [low_side + 1, low_side], shape }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::{CellId, PlanLine};

    fn line(ax: f64, ay: f64, bx: f64, by: f64) -> PlanLine {
        PlanLine::wall(Point2::new(ax, ay), Point2::new(bx, by))
    }

    #[test]
    fn lines_are_sorted() {
        let mut window = line(1., 0., 1., 4.);
        window.opaque = false;
        let plan = Plan::new(vec![line(0., 4., 0., 0.), window, line(0., 0., 3., 1.), line(2., 1., 0., 1.)], vec![]);
        let PlanFaces { faces, left_over } = plan_faces(&plan.unwrap());
        assert_eq!(left_over, [LineId(2)]);
        assert_eq!(faces, [AxialFace::new(0, [0., 0.], [0., 4.]), AxialFace::new(1, [0., 1.], [2., 1.])]);
    }

    #[test]
    fn a_door_each_way() {
        // Three rooms in an L: one door towards +x, one towards +y.
        let walls = vec![
            line(2., 0., 2., 1.),
            line(2., 2., 2., 3.),
            line(0., 3., 4., 3.),
            line(0., 3., 3., 3.),
            line(0., 0., 4., 0.),
            line(0., 5., 4., 5.),
            line(0., 3., 0., 0.),
        ];
        let plan = Plan::new(walls, vec![]).unwrap();
        let PlanSubdivision { graph, tree, .. } = subdivide_plan(&plan, &KdOptions::default()).unwrap();
        graph.assert_well_formed();
        assert_eq!(graph.n_cells(), 3);
        let [portal] = graph.portals() else { panic!("one door, {:?}", graph.portals()) };
        let [left, right] = [Point2::new(2., 2.), Point2::new(2., 1.)];
        assert_eq!(
            (portal.cells, portal.sides, portal.shape),
            ([CellId(0), CellId(1)], [1, 0], Portal2 { left, right })
        );
        assert_eq!(tree.locate([1., 4.]), Some(CellId(2)));
    }

    #[test]
    fn plans_without_room() {
        let cut = |lines| subdivide_plan(&Plan::new(lines, vec![]).unwrap(), &KdOptions::default());
        assert_eq!(cut(vec![]).unwrap_err(), KdError::Empty);
        assert_eq!(cut(vec![line(1., 1., 1., 4.)]).unwrap_err(), KdError::Flat { axis: 0 });
        let slanted = cut(vec![line(0., 0., 1., 4.)]).unwrap();
        assert_eq!((slanted.graph.n_cells(), slanted.left_over.len()), (1, 1));
    }
}
