//! The portals of a Quake map: those that its compiler wrote, or those that its tree of planes has.

use crate::error::{Result, anyhow};
use crate::output::count;
use sightlines::bake::quake::{PortalsError, portals_of_map};
use sightlines::formats::ReadError;
use sightlines::formats::quake::prt::{line_of_portal, parse_prt, write_prt};
use sightlines::formats::quake::{Bsp, Prt, VisibilityError, portals_beside};
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
pub(crate) fn portals_for(bsp: &Bsp, map: &Path, named: Option<&Path>) -> Result<MapPortals> {
    let Some(path) = portal_file(map, named) else { return made(bsp, map) };
    let text = std::fs::read(&path).map_err(|error| ReadError::new(&path, error))?;
    let prt = parse_prt(&text).map_err(|error| ReadError::new(&path, error))?;
    Ok(MapPortals { prt, path, text, is_made: false })
}

pub(crate) fn made(bsp: &Bsp, map: &Path) -> Result<MapPortals> {
    let made = portals_of_map(bsp).map_err(|error| cannot_be_made(map, &error))?;
    let text = write_prt(&made.prt).into_bytes();
    Ok(MapPortals { prt: made.prt, path: map.to_owned(), text, is_made: true })
}

/// A map without a portal file beside it, of which no portals can be made either.
pub(crate) fn cannot_be_made(map: &Path, error: &PortalsError) -> anyhow::Error {
    let beside = map.with_extension("prt");
    let name = beside.file_name().unwrap_or_default().display();
    anyhow!("{}: there is no {name} beside it, and no portals can be made from the map: {error}", map.display())
}

/// Portals that do not go with a map.
pub(crate) fn do_not_fit(prt: &Path, bsp: &Path, error: &VisibilityError) -> anyhow::Error {
    if let VisibilityError::InsideOut { portal, .. } = error
        && let Some(line) = std::fs::read(prt).ok().and_then(|text| line_of_portal(&text, *portal))
    {
        return anyhow!("{}: line {line}: {error}", prt.display());
    }
    anyhow!("{}: does not go with {}: {error}", prt.display(), bsp.display())
}

impl MapPortals {
    /// What kind of file it is, as reports name it: none, if they were made.
    pub(crate) fn format(&self) -> &'static str {
        if self.is_made { MADE } else { self.prt.dialect().name() }
    }

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
