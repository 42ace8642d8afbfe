//! What a viewer sees, for a picture.

use super::{DrawArgs, Error};
use crate::output::count;
use crate::place::Point;
use crate::sight::{self, Sight, SightError, seen};
use crate::tables::Cells;
use crate::view::{Methods, lifted};
use sightlines::eye_to_cell::{Doors, Method, TableCells, VisibleSet};
use sightlines::pvs::{CellId, Table};
use sightlines::report;
use std::path::Path;
use std::sync::Arc;

/// Refuses options of a view where there is no eye.
pub(super) fn refuse_without_eye(args: &DrawArgs) -> Result<(), Error> {
    let sight::SightArgs { dir, lens, method, closed } = &args.sight;
    if args.eye.is_some() {
        return if dir.is_none() && lens.has_angles() {
            Err(SightError::LensWithoutDirection("--fov and --aspect").into())
        } else {
            Ok(())
        };
    }
    let given = [
        ("--dir", dir.is_some()),
        ("--fov or --aspect", lens.has_angles()),
        ("--method", method.is_some()),
        ("--closed", !closed.is_empty()),
    ];
    given.iter().find(|(_, is_given)| *is_given).map_or(Ok(()), |(option, _)| Err(Error::SightWithoutEye(option)))
}

/// The viewer of a picture.
pub(super) struct Viewer<'a> {
    path: &'a Path,
    cells: TableCells<Arc<Table>>,
    /// None outside every cell.
    at: Vec<CellId>,
    sight: Sight,
    doors: Doors,
    methods: Methods,
}

impl<'a> Viewer<'a> {
    pub(super) fn new(args: &'a DrawArgs, eye: &Point, table: &Arc<Table>) -> Result<Self, Error> {
        let (path, cells) = (args.table.as_path(), TableCells::new(Arc::clone(table)));
        let eye = eye.coordinates(cells.n_dimensions(), path)?;
        let at = table.place_at(lifted(eye)).cells().to_vec();
        let sight = args.sight.sight(&cells, path, eye)?;
        let doors = args.sight.doors(&cells, path)?;
        let methods = args.sight.method.unwrap_or(Methods::One(Method::Exact));
        Ok(Self { path, cells, at, sight, doors, methods })
    }

    pub(super) fn is_outside(&self) -> bool {
        self.at.is_empty()
    }

    /// One picture for each, the widest answer first.
    pub(super) fn methods(&self) -> Vec<Method> {
        self.methods.list()
    }

    /// Whether there are several pictures.
    pub(super) fn has_panels(&self) -> bool {
        self.methods == Methods::All
    }

    /// What is seen by a method.
    pub(super) fn shown(&self, method: Method) -> Result<Shown<'_>, Error> {
        let seen = seen(method, &self.cells, &self.at, &self.sight.view, &self.doors);
        let seen = seen.map_err(|error| <TableCells<Arc<Table>> as Cells>::fail(self.path, error))?;
        Ok(Shown { seen, sight: &self.sight })
    }
}

/// What a picture shows of a viewer.
pub(super) struct Shown<'a> {
    seen: VisibleSet,
    sight: &'a Sight,
}

impl Shown<'_> {
    /// How much is seen, in words.
    pub(super) fn counts(&self) -> String {
        let [cells, objects] = [(self.seen.cells().len(), "cell"), (self.seen.objects().len(), "object")];
        let objects = if objects.0 > 0 { format!(", {}", count(objects.0 as u64, objects.1)) } else { String::new() };
        count(cells.0 as u64, cells.1) + &objects
    }

    /// The same for the crate that draws; `point` makes a direction of three coordinates one of the picture's.
    pub(super) fn sight<P>(&self, point: impl Fn([f64; 3]) -> P) -> report::Sight<'_, P> {
        let looks = self.sight.looks.as_ref().map(|(dir, fov)| (point(lifted(dir)), fov.to_radians()));
        report::Sight { cells: self.seen.cells(), objects: self.seen.objects(), looks }
    }
}
