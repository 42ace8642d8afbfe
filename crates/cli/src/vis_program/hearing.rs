//! What is heard in a map of Quake II, from the visibility that the map has.

use super::console::{Console, Kind};
use super::error::Error;
use crate::output::{self, bytes};
use sightlines::formats::quake::read_bsp;
use sightlines::formats::quake::visibility::lump_with_new_hearing;
use std::path::Path;

/// Writes anew what is heard in a map, and leaves what is visible as it is.
pub(super) fn renew(map: &Path, console: &Console) -> Result<(), Error> {
    output::check(&[], &[map])?;
    let bsp = read_bsp(map)?;
    let path = map.to_owned();
    if !bsp.format().has_clusters() {
        return Err(Error::NoHearing { path, format: bsp.format().name() });
    }
    console.say(Kind::Progress, &format!("map        {}: {}", map.display(), bsp.format().name()))?;
    let lump = match lump_with_new_hearing(&bsp) {
        Ok(Some(lump)) => lump,
        Ok(None) => return Err(Error::NoVisibility(path)),
        Err(source) => return Err(Error::Visibility { path, source }),
    };
    let written = bsp.with_visibility(&lump).map_err(|source| Error::Bsp { path, source })?;
    output::save(map, &written)?;
    Ok(console.say(Kind::Always, &format!("wrote      {}, {}", map.display(), bytes(written.len() as u64)))?)
}
