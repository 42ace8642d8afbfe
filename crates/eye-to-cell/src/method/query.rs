//! A question under way: what the methods share.

use super::clip::{Clipper, Eye};
use crate::doors::Doors;
use crate::front::Facing;
use crate::outlook::{LocalMirror, LocalWay, Outlook};
use crate::scratch::Scratch;
use crate::seen::{Reflection, Seen};
use crate::side::{MOST_SIDES, Reach, Side, Vector, radius, sub};
use crate::view::{View, ViewPart};
use sightlines_geometry::Aabb;

/// One convex part of a view, in one outlook.
pub(super) struct Query<'a> {
    pub(super) outlook: &'a Outlook,
    pub(super) view: &'a View,
    pub(super) doors: &'a Doors,
    pub(super) scratch: &'a mut Scratch,
    pub(super) seen: &'a mut Seen,
    pub(super) reach: Reach,
}

/// The zeroth method.
pub(super) fn all(outlook: &Outlook, view: &View, seen: &mut Seen) {
    seen.add_cells(outlook.cells.iter().copied());
    seen.add_objects(outlook.objects.iter().copied());
    let reach = view.reach(radius(&outlook.extent, view.eye));
    for cell in 0..outlook.cells.len() as u32 {
        for mirror in outlook.mirrors_of(cell) {
            reflect_whole(outlook, view, cell, mirror, &[], reach, seen);
        }
    }
}

impl<'a> Query<'a> {
    pub(super) fn new(
        outlook: &'a Outlook,
        view: &'a View,
        part: &ViewPart,
        doors: &'a Doors,
        scratch: &'a mut Scratch,
        seen: &'a mut Seen,
    ) -> Self {
        let reach = view.reach(radius(&outlook.extent, view.eye));
        scratch.view.clear();
        scratch.view.extend(part.sides(reach));
        scratch.cell_in_view.clear(outlook.cells.len());
        scratch.way_in_view.clear(outlook.ways.len());
        scratch.kept.clear(outlook.cells.len());
        scratch.object_in_view.clear(outlook.objects.len());
        Self { outlook, view, doors, scratch, seen, reach }
    }

    /// Whether the view may meet the box of a cell; the root's always does.
    #[inline]
    pub(super) fn cell_in_view(&mut self, cell: u32) -> bool {
        let (outlook, sides, eye) = (self.outlook, &self.scratch.view, self.view.eye);
        self.scratch
            .cell_in_view
            .get(cell, || cell == outlook.root || !excluded(sides, &outlook.bounds[cell as usize], eye))
    }

    /// Whether the view may meet a portal that is open and that the eye is not behind, and the cell that it leads to.
    #[inline]
    pub(super) fn way_in_view(&mut self, index: u32) -> bool {
        let (outlook, view) = (self.outlook, self.view);
        let way = &outlook.ways[index as usize];
        if !self.doors.is_open(way.portal) || !self.cell_in_view(way.to) {
            return false;
        }
        let sides = &self.scratch.view;
        self.scratch.way_in_view.get(index, || {
            way.front.facing(outlook.corners(way.first_corner, way.n_corners), view.eye, view.slack) != Facing::Behind
                && some_corner_inside_each(sides, outlook.corners(way.first_corner, way.n_corners), view.eye)
        })
    }

    /// The eye, for clipping.
    pub(super) fn eye(&self) -> Eye {
        Eye { planar: self.outlook.planar, at: self.view.eye, reach: self.reach }
    }

    pub(super) fn way(&self, index: u32) -> LocalWay {
        self.outlook.ways[index as usize]
    }

    /// Keeps a cell with all of it that the view may meet.
    pub(super) fn keep(&mut self, cell: u32) {
        if !self.scratch.kept.add(cell) {
            return;
        }
        self.seen.add_cell(self.outlook.cells[cell as usize]);
        for &object in self.outlook.objects_of(cell) {
            self.keep_object(object);
        }
        for mirror in self.outlook.mirrors_of(cell) {
            reflect_whole(self.outlook, self.view, cell, mirror, &self.scratch.view, self.reach, self.seen);
        }
    }

    /// Keeps those cells that no portal leads to, as far as the view may meet them.
    pub(super) fn keep_apart_cells(&mut self) {
        for &cell in &self.outlook.apart_cells {
            if self.cell_in_view(cell) {
                self.keep(cell);
            }
        }
    }

    /// Keeps those objects that touch no cell, as far as the view may meet them.
    pub(super) fn keep_loose_objects(&mut self) {
        for &object in &self.outlook.loose_objects {
            self.keep_object(object);
        }
    }

    fn keep_object(&mut self, object: u32) {
        let id = self.outlook.objects[object as usize];
        if !self.seen.has_object(id) && self.object_in_view(object) {
            self.seen.add_object(id);
        }
    }

    /// Whether the view may meet the box of an object.
    #[inline]
    pub(super) fn object_in_view(&mut self, object: u32) -> bool {
        let (outlook, eye) = (self.outlook, self.view.eye);
        let Scratch { object_in_view, view, .. } = &mut *self.scratch;
        object_in_view.get(object, || !excluded(view, &outlook.object_bounds[object as usize], eye))
    }

    /// Keeps the objects of a cell that is seen by a cone within the view.
    ///
    /// A cone has left out those sides of the view that its last portal makes needless, and a box may reach beyond the portal; so the
    /// view is asked as well.
    pub(super) fn keep_objects_in(&mut self, cell: u32, cone: &[Side]) {
        for &object in self.outlook.objects_of(cell) {
            let id = self.outlook.objects[object as usize];
            if !self.seen.has_object(id)
                && self.object_in_view(object)
                && !excluded(cone, &self.outlook.object_bounds[object as usize], self.view.eye)
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
    outlook: &Outlook,
    view: &View,
    cell: u32,
    mirror: &LocalMirror,
    sides: &[Side],
    reach: Reach,
    seen: &mut Seen,
) {
    let corners = outlook.corners(mirror.first_corner, mirror.n_corners);
    let facing = mirror.front.facing(corners, view.eye, view.slack);
    if facing == Facing::Behind || !some_corner_inside_each(sides, corners, view.eye) {
        return;
    }
    let mut frame: Vec<Side> = Vec::with_capacity(sides.len() + corners.len());
    if facing == Facing::Before && corners.len() <= MOST_SIDES {
        let eye = Eye { planar: outlook.planar, at: view.eye, reach };
        Clipper::default().narrow(eye, corners, &[], &mut frame);
    }
    frame.extend_from_slice(sides);
    seen.reflections.push(reflection(outlook, view, cell, mirror, &frame));
}

/// What is looked at in a mirror through a cone with these sides.
pub(super) fn reflection(outlook: &Outlook, view: &View, cell: u32, mirror: &LocalMirror, cone: &[Side]) -> Reflection {
    Reflection { face: mirror.face, cell: outlook.cells[cell as usize], view: view.mirrored(&mirror.front, cone) }
}
