//! Finding the maps of a WAD: a marker, and the lumps that follow it.

use super::{MapFormat, MapLump};
use crate::bytes::begins_with;
use crate::error::{Malformed, malformed};
use crate::wad::{LumpName, Wad};
use std::ops::Range;

/// Where the lumps of one map are in a WAD's directory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapLumps {
    name: LumpName,
    marker: usize,
    end: usize,
    format: MapFormat,
    lumps: [Option<usize>; MapLump::ALL.len()],
    endmap: Option<usize>,
    repeated: Option<(MapLump, [usize; 2])>,
}

impl MapLumps {
    /// The map's name, which is its marker's.
    pub fn name(&self) -> LumpName {
        self.name
    }

    /// Index of the marker.
    pub fn marker(&self) -> usize {
        self.marker
    }

    /// Indices of the marker and all lumps that belong to the map, those not read here included.
    pub fn range(&self) -> Range<usize> {
        self.marker..self.end
    }

    /// How the map is stored.
    pub fn format(&self) -> MapFormat {
        self.format
    }

    /// Index of one of its lumps, if the map has it; the first one, if it has several.
    pub fn lump(&self, lump: MapLump) -> Option<usize> {
        self.lumps[lump as usize]
    }

    /// Index of the map as text, if it is stored so.
    pub fn text(&self) -> Option<usize> {
        (self.format == MapFormat::Udmf).then_some(self.marker + 1)
    }

    /// Index of the lump behind which a REJECT lump is looked for: SECTORS; of a map as text the one before its ENDMAP, because the
    /// text has to be the first lump and ENDMAP the last.
    pub(super) fn before_reject(&self) -> Option<usize> {
        match self.format {
            MapFormat::Udmf => self.endmap.map(|k| k - 1),
            _ => self.lump(MapLump::Sectors),
        }
    }

    pub(super) fn require(&self, lump: MapLump) -> Result<usize, Malformed> {
        self.lump(lump).ok_or_else(|| malformed!("there is no such lump").within(lump))
    }

    /// Refuses formats that are not read here, and maps with a lump twice.
    pub(super) fn check_readable(&self) -> Result<(), Malformed> {
        match (self.format, self.repeated) {
            (MapFormat::Console, _) => Err(malformed!("maps in {} format are not supported", self.format)),
            (_, Some((lump, [first, second]))) => {
                Err(malformed!("there are two such lumps, {first} and {second}").within(lump))
            }
            (MapFormat::Udmf, _) if self.endmap.is_none() => {
                Err(malformed!("there is no such lump behind TEXTMAP").within("ENDMAP"))
            }
            _ => Ok(()),
        }
    }
}

/// The maps of a WAD, in the order of its directory. O(lumps).
///
/// A map is a lump of any name with map lumps behind it, in whatever order and however many; a lump
/// with the name of a map of Doom and no content is one even without any, so that an empty map is
/// not overlooked. GL nodes behind a map count as part of it.
pub fn list_maps(wad: &Wad) -> Vec<MapLumps> {
    let mut maps = Vec::new();
    let mut next = 0;
    while next < wad.lumps().len() {
        let found = map_at(wad, next);
        next = found.as_ref().map_or(next + 1, |map| map.end);
        maps.extend(found);
    }
    maps
}

fn map_at(wad: &Wad, marker: usize) -> Option<MapLumps> {
    let name = wad.lumps()[marker].name;
    if is_member(&name) {
        return None;
    }
    let named = |index: usize, name: &str| wad.lumps().get(index).is_some_and(|l| l.name.is(name));
    let (end, format) = if named(marker + 1, "TEXTMAP") {
        (end_of_text(wad, marker), MapFormat::Udmf)
    } else {
        let behind = &wad.lumps()[marker + 1..];
        let end = marker + 1 + behind.iter().take_while(|l| is_member(&l.name)).count();
        let with = |name: &str| (marker + 1..end).any(|k| named(k, name));
        let binary = if with("BEHAVIOR") { MapFormat::Hexen } else { MapFormat::Doom };
        (end, if with("LEAFS") { MapFormat::Console } else { binary })
    };
    let endmap = (format == MapFormat::Udmf && end > marker + 2).then(|| end - 1);
    let mut map = MapLumps { name, marker, end, format, lumps: Default::default(), endmap, repeated: None };
    for lump in MapLump::ALL {
        let mut found = (marker + 1..end).filter(|&k| named(k, lump.name()));
        map.lumps[lump as usize] = found.next();
        if let (None, Some(first), Some(second)) = (map.repeated, map.lump(lump), found.next()) {
            map.repeated = Some((lump, [first, second]));
        }
    }
    // A REJECT lump alone, or nodes alone, do not make the lump before them a map.
    let core = MapLump::ALL.iter().any(|&lump| lump != MapLump::Reject && map.lump(lump).is_some());
    let empty = wad.lumps()[marker].size() == 0 && is_doom_map_name(name.text());
    (core || format == MapFormat::Udmf || empty).then_some(map)
}

/// The end of a map as text: behind its ENDMAP, or behind its TEXTMAP if there is none before the next map.
fn end_of_text(wad: &Wad, marker: usize) -> usize {
    let behind = &wad.lumps()[marker + 2..];
    let mut own = behind.iter().take_while(|l| !l.name.is("TEXTMAP"));
    let endmap = own.position(|l| l.name.is("ENDMAP"));
    marker + 2 + endmap.map_or(0, |k| k + 1)
}

/// Whether a lump of this name belongs to the map before it.
fn is_member(name: &LumpName) -> bool {
    const OTHER: [&str; 9] =
        ["SEGS", "SSECTORS", "NODES", "BLOCKMAP", "BEHAVIOR", "SCRIPTS", "LEAFS", "LIGHTS", "MACROS"];
    begins_with(name.text(), "GL_")
        || MapLump::ALL.iter().any(|l| name.is(l.name()))
        || OTHER.iter().any(|other| name.is(other))
}

/// `MAP` and digits, or `E`, digits, `M`, digits.
pub(super) fn is_doom_map_name(name: &[u8]) -> bool {
    let name = name.to_ascii_uppercase();
    let number = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    let episode = |text: &[u8]| {
        let m = text.iter().position(|&b| b == b'M');
        m.is_some_and(|m| number(&text[..m]) && number(&text[m + 1..]))
    };
    name.strip_prefix(b"MAP").is_some_and(number) || name.strip_prefix(b"E").is_some_and(episode)
}

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
