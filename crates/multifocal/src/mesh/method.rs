//! Sheets as a from-region method.

use super::{SheetTester, Sheets};
use crate::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use sightlines_geometry::{Aabb, Point3};
use std::sync::Arc;

/// Hides what one sheet of the mesh separates from the volume.
#[derive(Debug)]
pub struct SheetMethod {
    sheets: Arc<Sheets>,
    limit: usize,
}

impl SheetMethod {
    /// Default number of triangle sides that a walk visits for one target.
    pub const DEFAULT_LIMIT: usize = 1024;

    /// For a scene of triangles, with [`Self::DEFAULT_LIMIT`]. O(n log² n).
    pub fn new(triangles: &[[Point3; 3]]) -> Self {
        Self::shared(Arc::new(Sheets::new(triangles)))
    }

    /// For shared sheets, with [`Self::DEFAULT_LIMIT`].
    pub const fn shared(sheets: Arc<Sheets>) -> Self {
        Self { sheets, limit: Self::DEFAULT_LIMIT }
    }

    /// With another limit.
    #[must_use]
    pub fn with_limit(mut self, limit: usize) -> Self {
        self.limit = limit;
        self
    }

    /// The sheets.
    pub fn sheets(&self) -> &Sheets {
        &self.sheets
    }
}

impl FromRegion for SheetMethod {
    fn name(&self) -> String {
        "sheets".to_owned()
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        Ok(Box::new(SheetUmbra { tester: self.sheets.tester(), volume: *volume.bounds(), limit: self.limit }))
    }
}

#[derive(Debug)]
struct SheetUmbra<'a> {
    tester: SheetTester<'a>,
    volume: Aabb<3>,
    limit: usize,
}

impl Umbra for SheetUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        self.tester.hides(&self.volume, target, self.limit)
    }
}
