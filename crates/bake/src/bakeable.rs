//! From what a file holds to the input of a bake.

use crate::input::BakeInput;
use crate::quake::{PortalsError, portals_of_map};
use sightlines_cells::{Plan, PlanError};
use sightlines_formats::doom::{MapChoiceError, choose_map, list_maps};
use sightlines_formats::quake::{Bsp, Prt};
use sightlines_formats::{DoomMap, Input, LumpName, Malformed, ReadError, SceneFile, Simplification, Source, Wad};

/// What was read from a file and can be baked. Owns what a [`BakeInput`] borrows: [`bake`](fn@crate::bake) takes a reference.
#[derive(Debug)]
pub enum Bakeable {
    /// A floor plan, or a map of a WAD.
    Plan {
        /// The plan.
        plan: Plan,
        /// The name of the map in its WAD.
        map: Option<LumpName>,
    },
    /// A scene in space.
    Scene(SceneFile),
    /// The portal file of a Quake map alone.
    Portals(Prt),
    /// A Quake map with its portals.
    Map(Bsp, Prt),
}

/// Why what was read cannot be baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeableError {
    /// The file, or one that belongs to it, cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No format recognises the file, or it holds something else, such as a table.
    #[error("this is nothing from which a table can be baked")]
    Kind,
    /// It is not clear which map of a WAD is meant.
    #[error(transparent)]
    Choice(#[from] MapChoiceError),
    /// The map of a WAD is damaged, or in a format that is not read.
    #[error(transparent)]
    Doom(#[from] Malformed),
    /// The lines of a map do not make a plan.
    #[error("map {map}: {source}")]
    Plan {
        /// The map.
        map: LumpName,
        /// What is wrong with its lines.
        source: PlanError,
    },
    /// A simplified scene whose triangles were moved. It may hide what can be seen, so no table is made of it.
    #[error("the triangles of the scene were moved when it was simplified, so it may hide what can be seen")]
    Moved,
    /// A Quake map without a portal file, of which no portals can be made either.
    #[error("the map has no portal file, and no portals can be made from it: {0}")]
    Portals(#[from] PortalsError),
}

impl Bakeable {
    /// Detects the format of a source, reads it, and the portal file beside it if it is a Quake map; without one, portals are made
    /// from the map.
    ///
    /// * `map`: which map of a WAD; may be left out if there is only one. Other files ignore it.
    ///
    /// # Errors
    /// [`BakeableError`]
    pub fn read(source: &Source<'_>, map: Option<&str>) -> Result<Self, BakeableError> {
        let input = source.read()?.ok_or(BakeableError::Kind)?;
        let portals = if matches!(input, Input::Bsp(_)) { source.portals()? } else { None };
        Self::new(input, map, portals)
    }

    /// Makes of an input, and what belongs to it, what can be baked.
    ///
    /// * `map`: as for [`Bakeable::read`]
    /// * `portals`: those of a Quake map, which are made from the map if there are none; other inputs ignore them
    ///
    /// # Errors
    /// [`BakeableError`]
    pub fn new(input: Input, map: Option<&str>, portals: Option<Prt>) -> Result<Self, BakeableError> {
        match input {
            Input::Plan(file) => Ok(Self::Plan { plan: file.plan, map: None }),
            Input::Wad(wad) => Self::of_wad(&wad, map),
            Input::Scene(file) => match file.info.simplified {
                Some(Simplification { occluder: false }) => Err(BakeableError::Moved),
                _ => Ok(Self::Scene(file)),
            },
            Input::Prt(prt) => Ok(Self::Portals(prt)),
            Input::Bsp(bsp) => {
                let portals = portals.map_or_else(|| Ok(portals_of_map(&bsp)?.prt), Ok::<_, PortalsError>)?;
                Ok(Self::Map(bsp, portals))
            }
            _ => Err(BakeableError::Kind),
        }
    }

    fn of_wad(wad: &Wad, name: Option<&str>) -> Result<Self, BakeableError> {
        let map = DoomMap::parse(wad, choose_map(&list_maps(wad), name)?)?;
        let plan = map.plan().map_err(|source| BakeableError::Plan { map: map.name(), source })?;
        Ok(Self::Plan { plan, map: Some(map.name()) })
    }
}

impl<'a> From<&'a Bakeable> for BakeInput<'a> {
    fn from(bakeable: &'a Bakeable) -> Self {
        match bakeable {
            Bakeable::Plan { plan, .. } => plan.into(),
            Bakeable::Scene(file) => file.into(),
            Bakeable::Portals(prt) => prt.into(),
            Bakeable::Map(bsp, prt) => (bsp, prt).into(),
        }
    }
}
