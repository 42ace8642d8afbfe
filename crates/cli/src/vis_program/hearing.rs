//! What is heard in a map of Quake II, from the visibility that the map has.

use super::console::{Console, Kind};
use crate::error::{ErrorAbout, Result, bail};
use crate::output::{self, bytes};
use sightlines::formats::quake::visibility::lump_with_new_hearing;
use sightlines::formats::quake::{BspFormat, read_bsp};
use std::path::Path;

/// Writes anew what is heard in a map, and leaves what is visible as it is.
pub(super) fn renew(map: &Path, console: &Console) -> Result<()> {
    output::check(&[], &[map])?;
    let bsp = read_bsp(map)?;
    let path = map.to_owned();
    if bsp.format() != BspFormat::Quake2 {
        bail!("{}: this is a map of {format}: -phsonly is for Quake II", path.display(), format = bsp.format().name());
    }
    console.say(Kind::Progress, &format!("map        {}: {}", map.display(), bsp.format().name()))?;
    let Some(lump) = lump_with_new_hearing(&bsp).in_file(&path)? else {
        bail!(
            "{}: the map has no visibility yet, of which -phsonly makes what is heard: run it without that option first",
            path.display()
        );
    };
    let written = bsp.with_visibility(&lump).in_file(&path)?;
    output::save(map, &written)?;
    console.say(Kind::Always, &format!("wrote      {}, {}", map.display(), bytes(written.len() as u64)))
}
