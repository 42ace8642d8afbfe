//! Several from-region methods as one, for pieces.

use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, Volume};

/// What any of several methods calls hidden is hidden. They are asked in order, so the quick one comes first; about pieces all of them are
/// asked, other than in [`sightlines_multifocal::Together`], where boxes come first. Without methods nothing is.
#[derive(Debug)]
pub struct AnyOf(Vec<Box<dyn FromRegion>>);

impl AnyOf {
    /// The methods, in the order in which they are asked.
    pub fn new(methods: Vec<Box<dyn FromRegion>>) -> Self {
        Self(methods)
    }
}

impl FromRegion for AnyOf {
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
        self.0.iter_mut().any(|umbra| umbra.hides_points(points))
    }
}
