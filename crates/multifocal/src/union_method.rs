//! Several methods as one.

use crate::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use sightlines_geometry::{Aabb, Point3};

/// Combines several methods: what any of them reports hidden is hidden. They run in order, so the fastest should come
/// first.
#[derive(Debug)]
pub struct UnionMethod {
    methods: Vec<Box<dyn FromRegion + Send>>,
    n_about_points: usize,
}

impl UnionMethod {
    /// The methods, in the order in which they run. Without methods nothing is hidden.
    ///
    /// Only the first method tests single polygons: after the tests of boxes, most hidden ones are already known.
    pub fn new(methods: Vec<Box<dyn FromRegion + Send>>) -> Self {
        Self { methods, n_about_points: 1 }
    }

    /// The same, but all methods test single polygons too, for callers that test nothing else.
    pub fn for_polygons(methods: Vec<Box<dyn FromRegion + Send>>) -> Self {
        Self { n_about_points: methods.len(), methods }
    }
}

impl FromRegion for UnionMethod {
    fn name(&self) -> String {
        self.methods.iter().map(|m| m.name()).collect::<Vec<_>>().join("+")
    }

    fn guarantee(&self) -> Guarantee {
        let conditional = self.methods.iter().map(|m| m.guarantee()).find(|g| *g != Guarantee::Conservative);
        conditional.unwrap_or(Guarantee::Conservative)
    }

    fn only_in_air(&self) -> bool {
        self.methods.iter().any(|m| m.only_in_air())
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        let umbrae = self.methods.iter_mut().map(|method| method.umbra(volume)).collect::<Result<_, _>>()?;
        Ok(Box::new(AnyUmbra { umbrae, n_about_points: self.n_about_points }))
    }
}

struct AnyUmbra<'a> {
    umbrae: Vec<Box<dyn Umbra + 'a>>,
    n_about_points: usize,
}

impl Umbra for AnyUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        self.umbrae.iter_mut().any(|umbra| umbra.hides(target))
    }

    fn hides_box_of(&mut self, target: &Aabb<3>, n_triangles: usize) -> bool {
        self.umbrae.iter_mut().any(|umbra| umbra.hides_box_of(target, n_triangles))
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        self.umbrae.iter_mut().take(self.n_about_points).any(|umbra| umbra.hides_points(points))
    }

    fn forget(&mut self) {
        self.umbrae.iter_mut().for_each(|umbra| umbra.forget());
    }

    fn hides_points_by_any(&mut self, points: &[Point3]) -> bool {
        self.umbrae.iter_mut().any(|umbra| umbra.hides_points(points))
    }
}
