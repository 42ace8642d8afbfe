//! What a viewer sees, for a picture.

use super::DrawArgs;
use crate::error::{Result, anyhow};
use crate::output::count;
use crate::place::Point;
use crate::sight::{self, Sight, without_direction};
use crate::tables::Cells;
use crate::view::{Methods, lifted};
use sightlines::eye_to_cell::{Method, StepBudget, VisibleSet};
use sightlines::pvs::Table;
use sightlines::{report, walkthrough};
use std::sync::Arc;

pub(super) fn refuse_without_eye(args: &DrawArgs) -> Result<()> {
    let sight::SightArgs { dir, lens, method, closed } = &args.sight;
    if args.eye.is_some() {
        return if dir.is_none() && lens.has_angles() { Err(without_direction("--fov and --aspect")) } else { Ok(()) };
    }
    let given = [
        ("--dir", dir.is_some()),
        ("--fov or --aspect", lens.has_angles()),
        ("--method", method.is_some()),
        ("--closed", !closed.is_empty()),
    ];
    given
        .iter()
        .find(|(_, is_given)| *is_given)
        .map_or(Ok(()), |(option, _)| Err(anyhow!("{option} is of a viewer: give --eye")))
}

/// The viewer of a picture.
pub(super) struct Viewer {
    looks: walkthrough::Viewer,
    is_outside: bool,
    sight: Sight,
    methods: Methods,
}

impl Viewer {
    pub(super) fn new(args: &DrawArgs, eye: &Point, table: &Arc<Table>) -> Result<Self> {
        let (path, mut looks) = (args.table.as_path(), walkthrough::Viewer::new(Arc::clone(table)));
        let cells = Arc::clone(looks.cells());
        let eye = eye.coordinates(cells.n_dimensions(), path)?;
        let is_outside = table.place_at(lifted(eye)).is_outside();
        let sight = args.sight.sight(&*cells, path, eye)?;
        *looks.doors_mut() = args.sight.doors(&*cells, path)?;
        looks.set_budget(StepBudget::UNLIMITED);
        let methods = args.sight.method.unwrap_or(Methods::One(Method::Exact));
        Ok(Self { looks, is_outside, sight, methods })
    }

    pub(super) fn is_outside(&self) -> bool {
        self.is_outside
    }

    /// One picture for each, the widest answer first.
    pub(super) fn methods(&self) -> Vec<Method> {
        self.methods.list()
    }

    pub(super) fn has_panels(&self) -> bool {
        self.methods == Methods::All
    }

    pub(super) fn shown(&mut self, method: Method) -> Shown<'_> {
        self.looks.set_method(method);
        Shown { seen: self.looks.look(&self.sight.view).seen, sight: &self.sight }
    }
}

/// What a picture shows of a viewer.
pub(super) struct Shown<'a> {
    seen: &'a VisibleSet,
    sight: &'a Sight,
}

impl Shown<'_> {
    pub(super) fn counts(&self) -> String {
        let [cells, objects] = [(self.seen.cells().len(), "cell"), (self.seen.objects().len(), "object")];
        let objects = if objects.0 > 0 { format!(", {}", count(objects.0 as u64, objects.1)) } else { String::new() };
        count(cells.0 as u64, cells.1) + &objects
    }

    /// The same for the crate that draws; `point` makes a direction of three coordinates one of the picture's.
    pub(super) fn sight<P>(&self, point: impl Fn([f64; 3]) -> P) -> report::SeenFromEye<'_, P> {
        let looks = self.sight.looks.as_ref().map(|(dir, fov)| (point(lifted(dir)), fov.to_radians()));
        report::SeenFromEye { cells: self.seen.cells(), objects: self.seen.objects(), looks }
    }
}
