//! Several methods as one.

use crate::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use sightlines_geometry::{Aabb, Point3};

/// What any of several methods calls hidden is hidden. They are asked in order, so the quick one comes first. About single
/// polygons only the first is asked: by then most that is hidden is known to be, from boxes.
#[derive(Debug)]
pub struct Together(Vec<Box<dyn FromRegion + Send>>);

impl Together {
    /// The methods, in the order in which they are asked.
    pub fn new(methods: Vec<Box<dyn FromRegion + Send>>) -> Self {
        Self(methods)
    }
}

impl FromRegion for Together {
    fn name(&self) -> String {
        self.0.iter().map(|m| m.name()).collect::<Vec<_>>().join("+")
    }

    fn guarantee(&self) -> Guarantee {
        let conditional = self.0.iter().map(|m| m.guarantee()).find(|g| *g != Guarantee::Conservative);
        conditional.unwrap_or(Guarantee::Conservative)
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        let umbrae = self.0.iter_mut().map(|method| method.umbra(volume)).collect::<Result<_, _>>()?;
        Ok(Box::new(AnyUmbra(umbrae)))
    }
}

struct AnyUmbra<'a>(Vec<Box<dyn Umbra + 'a>>);

impl Umbra for AnyUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        self.0.iter_mut().any(|umbra| umbra.hides(target))
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        self.0.first_mut().is_some_and(|umbra| umbra.hides_points(points))
    }
}
