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
    /// All methods.
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

    /// The method for a scene.
    fn prepared(self, scene: &Scene) -> Result<OcclusionMethodFactory, MethodError> {
        let buffers = BufferOptions { occluders: MOST_OCCLUDERS, ..BufferOptions::default() };
        match self {
            Self::Sheets => {
                let sheets = BufferOptions { planes: 0, ..buffers };
                OcclusionMethodFactory::new(OcclusionMethod::Multifocal, scene, &sheets)
            }
            Self::FromRegion(method) => {
                OcclusionMethodFactory::new(method, scene, &BufferOptions { sheets: 0, ..buffers })
            }
        }
    }
}

/// What any of these methods hides, each used once.
pub(super) fn union(methods: &[UmbraMethod], scene: &Scene) -> Result<UnionMethod, MethodError> {
    let mut different: Vec<UmbraMethod> = Vec::new();
    methods.iter().for_each(|method| {
        if !different.contains(method) {
            different.push(*method)
        }
    });
    let instance = |method: &UmbraMethod| Ok(method.prepared(scene)?.instance());
    Ok(UnionMethod::for_polygons(different.iter().map(instance).collect::<Result<_, MethodError>>()?))
}
