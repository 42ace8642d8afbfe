//! Choosing a map by its name.

use super::MapLumps;

/// Why no map was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapChoiceError {
    /// There is nothing to choose from.
    #[error("there are no maps")]
    NoMaps,
    /// There are several maps, and no name was given.
    #[error("there are {n} maps, and none was named")]
    Which {
        /// How many maps there are.
        n: usize,
    },
    /// No map has that name.
    #[error("there is no map of that name")]
    NoSuchMap,
}

/// The map of that name among `maps`, which is the last one if there are several, as engines choose; without a name the only map.
///
/// Names are compared as engines do, without regard to case. O(maps).
///
/// # Errors
/// [`MapChoiceError`] if there is no such map, or no name and several maps.
pub fn choose_map<'m>(maps: &'m [MapLumps], name: Option<&str>) -> Result<&'m MapLumps, MapChoiceError> {
    match (maps, name) {
        ([], _) => Err(MapChoiceError::NoMaps),
        (_, Some(name)) => maps.iter().rfind(|map| map.name().is(name)).ok_or(MapChoiceError::NoSuchMap),
        ([map], None) => Ok(map),
        (_, None) => Err(MapChoiceError::Which { n: maps.len() }),
    }
}
