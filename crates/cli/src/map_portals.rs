//! The portals of a Quake map: those that its compiler wrote, or those that its tree of planes has.

use crate::error::InputError;
use crate::output::count;
use sightlines::bake::quake::portals_of_map;
use sightlines::formats::ReadError;
use sightlines::formats::quake::prt::{parse_prt, write_prt};
use sightlines::formats::quake::{Bsp, Prt, portals_beside};
use std::path::{Path, PathBuf};

/// Portals of a map, and where they come from.
#[derive(Debug)]
pub(crate) struct MapPortals {
    pub(crate) prt: Prt,
    /// The file that has them; the map itself, if they were made of it.
    pub(crate) path: PathBuf,
    /// That file; if they were made, what `sightlines portals` would write.
    pub(crate) text: Vec<u8>,
    pub(crate) is_made: bool,
}

/// The portal file of a map: the one that was named, or the one beside it, if there is one.
pub(crate) fn portal_file(map: &Path, named: Option<&Path>) -> Option<PathBuf> {
    named.map(Path::to_owned).or_else(|| Some(portals_beside(map)).filter(|path| path.exists()))
}

/// Reads the portal file of a map; makes the portals where there is none.
pub(crate) fn portals_for(bsp: &Bsp, map: &Path, named: Option<&Path>) -> Result<MapPortals, InputError> {
    let Some(path) = portal_file(map, named) else { return made(bsp, map) };
    let text = std::fs::read(&path).map_err(|error| ReadError::new(&path, error))?;
    let prt = parse_prt(&text).map_err(|error| ReadError::new(&path, error))?;
    Ok(MapPortals { prt, path, text, is_made: false })
}

/// Makes the portals of a map.
pub(crate) fn made(bsp: &Bsp, map: &Path) -> Result<MapPortals, InputError> {
    let made = portals_of_map(bsp);
    let made = made.map_err(|source| InputError::MadePortals { path: map.to_owned(), source: Box::new(source) })?;
    let text = write_prt(&made.prt).into_bytes();
    Ok(MapPortals { prt: made.prt, path: map.to_owned(), text, is_made: true })
}

impl MapPortals {
    /// What kind of file it is, as reports name it: none, if they were made.
    pub(crate) fn format(&self) -> &'static str {
        if self.is_made { MADE } else { self.prt.dialect().name() }
    }

    /// Says on standard error that there was no portal file.
    pub(crate) fn announce(&self) {
        if self.is_made {
            let n = count(self.prt.n_portals() as u64, "portal");
            let file = portals_beside(&self.path);
            eprintln!("note: {}: there is no {}; made {n} from the map's tree", self.path.display(), file.display());
        }
    }
}

/// In place of the format of a portal file.
pub(crate) const MADE: &str = "made from the map";
