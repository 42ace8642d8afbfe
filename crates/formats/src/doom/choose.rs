//! Choosing a map by its name.

use super::MapLumps;

/// Why no map was chosen.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapChoiceError {
    /// There is nothing to choose from.
    #[error("there are no maps")]
    NoMaps,
    /// There are several maps, and no name was given.
    #[error("there are {} maps, and none was named: {}", names.len(), names.join(", "))]
    Which {
        /// The maps that there are.
        names: Vec<String>,
    },
    /// No map has that name.
    #[error("there is no map {name}; there are {}", names.join(", "))]
    NoSuchMap {
        /// The name that was given.
        name: String,
        /// The maps that there are.
        names: Vec<String>,
    },
}

/// The map of that name among `maps`; if there are several, the last one, as engines choose. Without a name, the only map.
///
/// Names are compared as engines do, without regard to case. O(maps).
///
/// # Errors
/// [`MapChoiceError`] if there is no such map, or no name and several maps.
pub fn choose_map<'m>(maps: &'m [MapLumps], name: Option<&str>) -> Result<&'m MapLumps, MapChoiceError> {
    let names = || maps.iter().map(|map| map.name().to_string()).collect();
    match (maps, name) {
        ([], _) => Err(MapChoiceError::NoMaps),
        (_, Some(name)) => {
            let found = maps.iter().rfind(|map| map.name().is(name));
            found.ok_or_else(|| MapChoiceError::NoSuchMap { name: name.to_owned(), names: names() })
        }
        ([map], None) => Ok(map),
        (_, None) => Err(MapChoiceError::Which { names: names() }),
    }
}
