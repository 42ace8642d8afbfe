//! A question under way: what the methods share.

use super::Scratch;
use super::clip::{Clipper, Eye};
use crate::doors::Doors;
use crate::front::Facing;
use crate::side::{MOST_SIDES, Reach, Side, Vector, radius, sub};
use crate::subgraph::{LocalEdge, LocalMirror, VisibleSubgraph};
use crate::view::{View, ViewPart};
use crate::visible_set::{Reflection, VisibleSet};
use sightlines_geometry::Aabb;

/// One convex part of a view, in one subgraph.
pub(super) struct Query<'a> {
    pub(super) subgraph: &'a VisibleSubgraph,
    pub(super) view: &'a View,
    pub(super) doors: &'a Doors,
    pub(super) scratch: &'a mut Scratch,
    pub(super) seen: &'a mut VisibleSet,
    pub(super) reach: Reach,
}

/// The zeroth method.
pub(super) fn all(subgraph: &VisibleSubgraph, view: &View, seen: &mut VisibleSet) {
    seen.add_cells(subgraph.cells.iter().copied());
    seen.add_objects(subgraph.objects.iter().copied());
    let reach = view.reach(radius(&subgraph.extent, view.eye));
    for cell in 0..subgraph.cells.len() as u32 {
        for mirror in subgraph.mirrors_of(cell) {
            reflect_whole(subgraph, view, cell, mirror, &[], reach, seen);
        }
    }
}

impl<'a> Query<'a> {
    pub(super) fn new(
        subgraph: &'a VisibleSubgraph,
        view: &'a View,
        part: &ViewPart,
        doors: &'a Doors,
        scratch: &'a mut Scratch,
        seen: &'a mut VisibleSet,
    ) -> Self {
        let reach = view.reach(radius(&subgraph.extent, view.eye));
        scratch.view.clear();
        scratch.view.extend(part.sides(reach));
        scratch.cell_in_view.clear(subgraph.cells.len());
        scratch.way_in_view.clear(subgraph.ways.len());
        scratch.kept.clear(subgraph.cells.len());
        scratch.object_in_view.clear(subgraph.objects.len());
        Self { subgraph, view, doors, scratch, seen, reach }
    }

    /// Whether the view may meet the box of a cell; the root's always does.
    #[inline]
    pub(super) fn cell_in_view(&mut self, cell: u32) -> bool {
        let (subgraph, sides, eye) = (self.subgraph, &self.scratch.view, self.view.eye);
        self.scratch
            .cell_in_view
            .get(cell, || cell == subgraph.root || !excluded(sides, &subgraph.bounds[cell as usize], eye))
    }

    /// Whether the view may meet a portal that is open and that the eye is not behind, and the cell that it leads to.
    #[inline]
    pub(super) fn way_in_view(&mut self, index: u32) -> bool {
        let (subgraph, view) = (self.subgraph, self.view);
        let way = &subgraph.ways[index as usize];
        if !self.doors.is_open(way.portal) || !self.cell_in_view(way.to) {
            return false;
        }
        let sides = &self.scratch.view;
        self.scratch.way_in_view.get(index, || {
            way.front.facing(subgraph.corners(way.first_corner, way.n_corners), view.eye, view.slack) != Facing::Behind
                && some_corner_inside_each(sides, subgraph.corners(way.first_corner, way.n_corners), view.eye)
        })
    }

    /// The eye, for clipping.
    pub(super) fn eye(&self) -> Eye {
        Eye { planar: self.subgraph.planar, at: self.view.eye, reach: self.reach }
    }

    pub(super) fn way(&self, index: u32) -> LocalEdge {
        self.subgraph.ways[index as usize]
    }

    /// Keeps a cell with all of it that the view may meet.
    pub(super) fn keep(&mut self, cell: u32) {
        if !self.scratch.kept.add(cell) {
            return;
        }
        self.seen.add_cell(self.subgraph.cells[cell as usize]);
        for &object in self.subgraph.objects_of(cell) {
            self.keep_object(object);
        }
        for mirror in self.subgraph.mirrors_of(cell) {
            reflect_whole(self.subgraph, self.view, cell, mirror, &self.scratch.view, self.reach, self.seen);
        }
    }

    /// Keeps those cells that no portal leads to, as far as the view may meet them.
    pub(super) fn keep_apart_cells(&mut self) {
        for &cell in &self.subgraph.apart_cells {
            if self.cell_in_view(cell) {
                self.keep(cell);
            }
        }
    }

    /// Keeps those objects that touch no cell, as far as the view may meet them.
    pub(super) fn keep_loose_objects(&mut self) {
        for &object in &self.subgraph.loose_objects {
            self.keep_object(object);
        }
    }

    fn keep_object(&mut self, object: u32) {
        let id = self.subgraph.objects[object as usize];
        if !self.seen.has_object(id) && self.object_in_view(object) {
            self.seen.add_object(id);
        }
    }

    /// Whether the view may meet the box of an object.
    #[inline]
    pub(super) fn object_in_view(&mut self, object: u32) -> bool {
        let (subgraph, eye) = (self.subgraph, self.view.eye);
        let Scratch { object_in_view, view, .. } = &mut *self.scratch;
        object_in_view.get(object, || !excluded(view, &subgraph.object_bounds[object as usize], eye))
    }

    /// Keeps the objects of a cell that is seen by a cone within the view.
    ///
    /// A cone has left out those sides of the view that its last portal makes needless, and a box may reach beyond the
    /// portal; so the view is tested as well.
    pub(super) fn keep_objects_in(&mut self, cell: u32, cone: &[Side]) {
        self.scratch.work.take(self.subgraph.objects_of(cell).len() as u64);
        for &object in self.subgraph.objects_of(cell) {
            let id = self.subgraph.objects[object as usize];
            if !self.seen.has_object(id)
                && self.object_in_view(object)
                && !excluded(cone, &self.subgraph.object_bounds[object as usize], self.view.eye)
            {
                self.seen.add_object(id);
            }
        }
    }
}

/// Whether a box is certainly outside one of the sides.
#[inline]
pub(super) fn excluded(sides: &[Side], bounds: &Aabb<3>, eye: Vector) -> bool {
    sides.iter().any(|side| side.excludes_box(bounds, eye))
}

/// Whether no side certainly has all the corners outside.
fn some_corner_inside_each(sides: &[Side], corners: &[Vector], eye: Vector) -> bool {
    sides.iter().all(|side| corners.iter().any(|&c| !side.lets_go(side.value(sub(c, eye)))))
}

/// Notes what is seen in a whole mirror, within the sides of the view.
fn reflect_whole(
    subgraph: &VisibleSubgraph,
    view: &View,
    cell: u32,
    mirror: &LocalMirror,
    sides: &[Side],
    reach: Reach,
    seen: &mut VisibleSet,
) {
    let corners = subgraph.corners(mirror.first_corner, mirror.n_corners);
    let facing = mirror.front.facing(corners, view.eye, view.slack);
    if facing == Facing::Behind || !some_corner_inside_each(sides, corners, view.eye) {
        return;
    }
    let mut frame: Vec<Side> = Vec::with_capacity(sides.len() + corners.len());
    if facing == Facing::Before && corners.len() <= MOST_SIDES {
        let eye = Eye { planar: subgraph.planar, at: view.eye, reach };
        Clipper::default().narrow(eye, corners, &[], &mut frame);
    }
    frame.extend_from_slice(sides);
    seen.reflections.push(reflection(subgraph, view, cell, mirror, &frame));
}

/// What is looked at in a mirror through a cone with these sides.
pub(super) fn reflection(
    subgraph: &VisibleSubgraph,
    view: &View,
    cell: u32,
    mirror: &LocalMirror,
    cone: &[Side],
) -> Reflection {
    Reflection { mirror: mirror.mirror, cell: subgraph.cells[cell as usize], view: view.mirrored(&mirror.front, cone) }
}

/// Notes what the eye sees in the mirrors of a cell, within the cone by which it sees the cell.
pub(super) fn keep_mirrors(query: &mut Query<'_>, cell: u32, cone: &[Side]) {
    let (subgraph, eye) = (query.subgraph, query.eye());
    let Query { view, scratch, seen, .. } = query;
    for mirror in subgraph.mirrors_of(cell) {
        let corners = subgraph.corners(mirror.first_corner, mirror.n_corners);
        let mut window = Vec::new();
        let seen_in = match mirror.front.facing(corners, view.eye, view.slack) {
            Facing::Behind => false,
            Facing::Before => scratch.clipper.narrow(eye, corners, cone, &mut window),
            Facing::Level => {
                window.extend_from_slice(cone);
                true
            }
        };
        if seen_in {
            seen.reflections.push(reflection(subgraph, view, cell, mirror, &window));
        }
    }
}
