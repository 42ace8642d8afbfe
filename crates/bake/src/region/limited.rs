//! A from-region method that stops when its allowance is over: what is not asked by then counts as visible.

use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use sightlines_progress::Allowance;
use std::cell::Cell;

/// What one cell may spend.
#[derive(Debug)]
pub(super) struct Limit<'a> {
    now: Cell<Allowance<'a>>,
    refused: Cell<bool>,
}

impl<'a> Limit<'a> {
    pub(super) fn new(allowance: Allowance<'a>) -> Self {
        Self { now: Cell::new(allowance), refused: Cell::new(false) }
    }

    /// From now on this is what may be spent.
    pub(super) fn set(&self, allowance: Allowance<'a>) {
        self.now.set(allowance);
    }

    /// Whether a question was refused since the last call.
    pub(super) fn take_refused(&self) -> bool {
        self.refused.take()
    }

    /// Whether nothing is left; then a question is refused.
    pub(super) fn refuses(&self) -> bool {
        let over = self.now.get().is_over();
        self.refused.set(self.refused.get() || over);
        over
    }
}

/// A method within a limit.
#[derive(Debug)]
pub(super) struct Limited<'m, 'a> {
    pub(super) method: &'m mut dyn FromRegion,
    pub(super) limit: &'m Limit<'a>,
}

impl FromRegion for Limited<'_, '_> {
    fn name(&self) -> String {
        self.method.name()
    }

    fn guarantee(&self) -> Guarantee {
        self.method.guarantee()
    }

    fn only_in_air(&self) -> bool {
        self.method.only_in_air()
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        let inner = if self.limit.refuses() { None } else { Some(self.method.umbra(volume)?) };
        Ok(Box::new(LimitedUmbra { inner, limit: self.limit }))
    }
}

/// None if the limit was over before it was prepared: it hides nothing.
struct LimitedUmbra<'m, 'a> {
    inner: Option<Box<dyn Umbra + 'm>>,
    limit: &'m Limit<'a>,
}

impl Umbra for LimitedUmbra<'_, '_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        !self.limit.refuses() && self.inner.as_mut().is_some_and(|umbra| umbra.hides(target))
    }

    fn hides_box_of(&mut self, target: &Aabb<3>, n_triangles: usize) -> bool {
        !self.limit.refuses() && self.inner.as_mut().is_some_and(|umbra| umbra.hides_box_of(target, n_triangles))
    }

    fn forget(&mut self) {
        if let Some(umbra) = &mut self.inner {
            umbra.forget();
        }
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        !self.limit.refuses() && self.inner.as_mut().is_some_and(|umbra| umbra.hides_points(points))
    }

    fn hides_points_by_any(&mut self, points: &[Point3]) -> bool {
        !self.limit.refuses() && self.inner.as_mut().is_some_and(|umbra| umbra.hides_points_by_any(points))
    }
}
