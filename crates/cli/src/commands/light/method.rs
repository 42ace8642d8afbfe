//! The methods that find umbrae, as arguments: sheets alone, and each from-region method.

use crate::error::Result;
use sightlines::bake::methods::{BufferOptions, MethodError, OcclusionMethod, OcclusionMethodFactory};
use sightlines::cells::Scene;
use sightlines::multifocal::UnionMethod;

/// Occluders that are drawn on each side of the light.
const MOST_OCCLUDERS: u32 = 1024;

/// A method as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UmbraMethod {
    /// Sheets of the scene's mesh alone.
    Sheets,
    /// A from-region method alone; multifocal buffers without sheets.
    FromRegion(OcclusionMethod),
}

impl UmbraMethod {
    pub(super) fn all() -> Vec<Self> {
        std::iter::once(Self::Sheets).chain(OcclusionMethod::ALL.map(Self::FromRegion)).collect()
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sheets => "sheets",
            Self::FromRegion(method) => method.name(),
        }
    }

    pub(super) const fn about(self) -> &'static str {
        match self {
            Self::Sheets => "Surfaces that as a whole separate the light from a piece",
            Self::FromRegion(OcclusionMethod::Multifocal) => "Multifocal buffers around the light, without sheets",
            Self::FromRegion(method) => method.about(),
        }
    }

    fn prepared(self, scene: &Scene) -> Result<OcclusionMethodFactory, MethodError> {
        let buffers = BufferOptions { occluders: MOST_OCCLUDERS, ..BufferOptions::default() };
        let (method, buffers) = match self {
            Self::Sheets => (OcclusionMethod::Multifocal, BufferOptions { planes: 0, ..buffers }),
            Self::FromRegion(method) => (method, BufferOptions { sheets: 0, ..buffers }),
        };
        OcclusionMethodFactory::new(method, scene, &buffers)
    }
}

pub(super) fn union(methods: &[UmbraMethod], scene: &Scene) -> Result<UnionMethod, MethodError> {
    let is_first = |(k, method): &(usize, &UmbraMethod)| !methods[..*k].contains(method);
    let instance = |(_, method): (usize, &UmbraMethod)| Ok(method.prepared(scene)?.instance());
    let instances = methods.iter().enumerate().filter(is_first).map(instance);
    Ok(UnionMethod::for_polygons(instances.collect::<Result<_, MethodError>>()?))
}
