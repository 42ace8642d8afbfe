//! Which edges a budget allows to be collapsed.

use crate::bound;
use crate::intercepts::Intercepts;
use crate::mesh::{Change, Mesh, Policy, State};
use crate::options::SimplifyOptions;
use crate::select::{Account, kept_faces, least_visible};
use crate::views::{ViewBox, Views};
use sightlines_geometry::{Aabb, Point3};
use sightlines_visible_surface::Faces;
use std::collections::BTreeMap;

/// Accepts changes of the mesh as long as the change of the view that they may cause stays within the budget.
pub(crate) struct CollapseBudget<'a> {
    faces: &'a Faces,
    views: &'a Views,
    intercepts: &'a Intercepts,
    depth: u32,
    budget: f64,
    most_shift: f64,
    /// The largest shift so far.
    pub(crate) shift: f64,
    account: Account,
    /// Faces whose change is within the budget already.
    may_go: Vec<bool>,
    /// The shares of new faces, part by part.
    charges: BTreeMap<u32, Vec<f64>>,
}

impl<'a> CollapseBudget<'a> {
    pub(crate) fn choose(
        faces: &'a Faces,
        views: &'a Views,
        intercepts: &'a Intercepts,
        mesh: &Mesh,
        options: &SimplifyOptions,
        mut account: Account,
    ) -> Self {
        let budget = options.budget;
        let mut may_go = vec![false; faces.len()];
        let limit = budget - budget * options.collapse / 2.0;
        least_visible(intercepts, kept_faces(mesh, faces), limit, &mut account, |face| may_go[face as usize] = true);
        let (depth, most_shift) = (options.depth, options.shift);
        Self {
            faces,
            views,
            intercepts,
            depth,
            budget,
            most_shift,
            shift: 0.0,
            account,
            may_go,
            charges: BTreeMap::new(),
        }
    }

    /// An upper bound of the share of a triangle, in each part.
    fn shares(&self, corners: &[Point3; 3]) -> Vec<f64> {
        self.views.parts().iter().map(|v| bound::share(corners, v.volume.bounds(), self.depth)).collect()
    }

    /// A lower bound of the distance of any eye from the faces of a change, before and after.
    fn nearest(&self, mesh: &Mesh, change: &Change) -> f64 {
        let changed = change.lost.iter().chain(change.moved.iter().map(|(f, _)| f));
        let corners = changed.flat_map(|&f| mesh.corners(f)).chain([mesh.place(change.to)]);
        let around = Aabb::<3>::around(corners);
        let to = |view: &ViewBox| bound::distance(&around, view.volume.bounds());
        self.views.parts().iter().map(to).fold(f64::INFINITY, f64::min)
    }

    /// Refunds what was not changed after all.
    pub(crate) fn settle(mut self, mesh: &Mesh) -> Account {
        for face in self.faces.ids().filter(|&f| self.may_go[f as usize] && mesh.face(f).state == State::Kept) {
            self.account.refund(|part| self.intercepts.of(part, face));
        }
        self.account
    }
}

impl Policy for CollapseBudget<'_> {
    fn may_touch(&self, _: &Mesh, face: u32) -> bool {
        self.may_go[face as usize]
    }

    fn accepts(&mut self, mesh: &Mesh, change: &Change, moved: f64) -> bool {
        if change.lost.iter().chain(change.moved.iter().map(|(f, _)| f)).any(|&f| !self.may_go[f as usize]) {
            return false;
        }
        // The original surface may be nearer by as much as the surface has moved.
        let shift = (moved / (self.nearest(mesh, change) - moved).next_down().max(0.0)).next_up();
        // If both are 0, the quotient is NaN.
        if shift.is_nan() || shift > self.most_shift {
            return false;
        }
        let new: Vec<(u32, Vec<f64>)> =
            change.moved.iter().map(|&(f, _)| (f, self.shares(&change.corners(mesh, f)))).collect();
        let mut account = self.account.clone();
        for face in change.lost.iter().chain(change.moved.iter().map(|(f, _)| f)) {
            if let Some(charge) = self.charges.get(face) {
                account.refund(|part| charge[part]);
            }
        }
        if !new.iter().all(|(_, charge)| account.spend(self.budget, |part| charge[part])) {
            return false;
        }
        self.account = account;
        self.shift = self.shift.max(shift);
        change.lost.iter().for_each(|face| drop(self.charges.remove(face)));
        self.charges.extend(new);
        true
    }

    fn is_done(&self, _: &Mesh) -> bool {
        false
    }
}
