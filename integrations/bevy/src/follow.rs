//! One camera's walk through a table, whatever the form of the table.

use crate::space::Point;
use sightlines_eye_to_cell::{CellSource, Method, View};
use sightlines_geometry::Aabb;
use sightlines_pvs::PortalId;
use sightlines_walkthrough::{CellLocator, CoarseVisibility, DrawList, MoverOptions, Movers, WalkOptions, Walkthrough};
use std::collections::BTreeSet;

/// Whether a box of the scene meets a cell that is seen.
pub(crate) type SeesBox<'a> = dyn FnMut(Point, Point) -> bool + 'a;

/// What a camera needs of a walk.
pub(crate) trait Follow: Send {
    /// Passes what the eye of `view` sees, by `method`, to `answer`.
    fn look(&mut self, view: &View, method: Method, answer: &mut dyn FnMut(&DrawList<'_>, &mut SeesBox<'_>));

    /// Closes these portals, and opens all others.
    fn close(&mut self, closed: &BTreeSet<PortalId>);

    /// The last error of reading the table, as text.
    fn take_error(&mut self) -> Option<String>;
}

/// A walk, and the places of the cells for what moves.
pub(crate) struct Follower<R, S, P>
where
    R: CoarseVisibility,
    S: CellSource<Error: Send + 'static> + Send + 'static,
{
    walk: Walkthrough<R, S>,
    movers: Movers<P>,
}

impl<R, S, P> Follower<R, S, P>
where
    R: CoarseVisibility,
    S: CellSource<Error: Send + 'static> + Send + 'static,
    P: CellLocator,
{
    pub(crate) fn new(resident: R, source: S, places: P, options: WalkOptions) -> Self {
        Self { walk: Walkthrough::new(resident, source, options), movers: Movers::new(places, MoverOptions::default()) }
    }
}

impl<R, S, P> Follow for Follower<R, S, P>
where
    R: CoarseVisibility<PlaceError: Send + std::fmt::Display> + Send,
    S: CellSource<Error: Send + std::fmt::Display + 'static> + Send + 'static,
    P: CellLocator + Send,
{
    fn look(&mut self, view: &View, method: Method, answer: &mut dyn FnMut(&DrawList<'_>, &mut SeesBox<'_>)) {
        let frame = self.walk.frame(view, method);
        let movers = &mut self.movers;
        answer(&frame, &mut |min, max| movers.sees(&frame, &Aabb { min, max }));
    }

    fn close(&mut self, closed: &BTreeSet<PortalId>) {
        let before: Vec<PortalId> = self.walk.doors().closed().collect();
        for portal in before.into_iter().filter(|portal| !closed.contains(portal)) {
            self.walk.open(portal);
        }
        for &portal in closed {
            self.walk.close(portal);
        }
    }

    fn take_error(&mut self) -> Option<String> {
        let of_cell = self.walk.take_error().map(|(cell, error)| format!("cell {cell}: {error}"));
        of_cell.or_else(|| self.walk.take_place_error().map(|error| format!("locating the eye: {error}")))
    }
}
