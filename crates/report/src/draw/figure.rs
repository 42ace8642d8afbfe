//! What a plan consists of: convex pieces of cells in a plane, the doors between them, the walls around.

use super::section::Section;
use super::space::{Up, cut_by};
use crate::outline::{Outline, corners, ends, walls};
use sightlines_geometry::{Aabb, Point2, Segment2};
use sightlines_pvs::{CellId, Table};

/// A planar figure in scene units, x to the right and y upwards.
#[derive(Debug, Default)]
pub(super) struct Figure {
    pub(super) cells: Vec<Shape>,
    /// Doors, with the index of their portal.
    pub(super) doors: Vec<(usize, Segment2)>,
    pub(super) walls: Vec<Segment2>,
    /// Objects, with their id.
    pub(super) objects: Vec<(u32, Aabb<2>)>,
    /// The surfaces of the scene, if they are known.
    pub(super) section: Option<Section>,
}

/// A cell in the plane of the picture.
#[derive(Debug)]
pub(super) struct Shape {
    pub(super) id: CellId,
    /// Counter-clockwise.
    pub(super) corners: Vec<Point2>,
    pub(super) group: Option<u32>,
}

impl Figure {
    /// All of a planar table.
    pub(super) fn of_plan(table: &Table) -> Self {
        let cells = ids(table).zip(table.cells());
        let cells = cells.map(|(id, cell)| Shape { id, corners: corners(cell), group: cell.group }).collect();
        let doors = table.portals().iter().enumerate().filter_map(|(i, p)| Some((i, ends(&p.points)?))).collect();
        let flat = |p: [f64; 3]| [p[0], p[1]];
        let boxes = table.objects().iter().map(|o| Aabb { min: flat(o.min), max: flat(o.max) });
        Self { cells, doors, objects: (0..).zip(boxes).collect(), ..Self::default() }.walled(table)
    }

    /// What a horizontal plane cuts of a table in space. On a border between two storeys of cells it cuts
    /// the upper one.
    pub(super) fn of_slice(table: &Table, up: Up, height: f64) -> Self {
        let cells = ids(table).zip(table.cells()).filter(|(_, c)| cut_by(height, c.min[up.axis()], c.max[up.axis()]));
        let shape = |(id, c): (CellId, &sightlines_pvs::CellRecord)| {
            let Aabb { min: [x0, y0], max: [x1, y1] } = up.seen_from_above(c.min, c.max);
            let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point2::new(x, y)).to_vec();
            Shape { id, corners, group: c.group }
        };
        let door = |(i, p): (usize, &sightlines_pvs::PortalRecord)| {
            let Aabb { min, max } = Aabb::around(p.points.iter().copied());
            // A door in a floor has no extent upwards, so no plane cuts it.
            let cut = cut_by(height, min[up.axis()], max[up.axis()]);
            let Aabb { min: [x0, y0], max: [x1, y1] } = up.seen_from_above(min, max);
            cut.then_some((i, Segment2::new(Point2::new(x0, y0), Point2::new(x1, y1))))
        };
        let doors = table.portals().iter().enumerate().filter_map(door).collect();
        Self { cells: cells.map(shape).collect(), doors, ..Self::default() }.walled(table)
    }

    fn walled(self, table: &Table) -> Self {
        let mut outlines: Vec<Outline<'_>> = vec![Outline::default(); table.n_cells()];
        for shape in &self.cells {
            outlines[shape.id.idx()].corners = &shape.corners;
        }
        for (portal, door) in &self.doors {
            table.portals()[*portal].cells.iter().for_each(|cell| outlines[cell.idx()].doors.push(*door));
        }
        // In a table whose portals were stripped the walls are unknown.
        let are_walls_known = table.n_cells() < 2 || !table.portals().is_empty();
        let walls = if are_walls_known { walls(&outlines) } else { Vec::new() };
        Self { walls, ..self }
    }

    /// The same with the surfaces of the scene, in place of the walls that the cells tell of.
    pub(super) fn with_section(self, section: Section) -> Self {
        Self { walls: Vec::new(), section: Some(section), ..self }
    }

    /// Whether the borders of the cells are all that tells them apart: there are neither walls nor doors.
    pub(super) fn has_bare_cells(&self) -> bool {
        self.walls.is_empty() && self.doors.is_empty() && self.cells.len() > 1
    }

    /// The box around the cells and the surfaces; empty if there are none.
    pub(super) fn bounds(&self) -> Aabb<2> {
        let cells = self.cells.iter().flat_map(|c| c.corners.iter().map(|p| [p.x, p.y]));
        Aabb::around(cells.chain(self.section.iter().flat_map(Section::points)))
    }
}

fn ids(table: &Table) -> impl Iterator<Item = CellId> {
    (0u32..).take(table.n_cells()).map(CellId)
}
