//! Maps: their leafs and their visibility lump, and on demand the tree and the faces of their world
//! ([`Bsp::world_tree`], [`Bsp::world_faces`]). Everything else is carried along as bytes.
//!
//! All numbers are little-endian. A header, and in it a directory of lumps (i32 place, i32 length):
//!
//! | begins with | lumps | leaf | face | node |
//! | --- | --- | --- | --- | --- |
//! | i32 29 (Quake) | 15 | 28 bytes, 16-bit bounds and indices | 20 bytes | 24 bytes, 16-bit children |
//! | `BSP2` | 15 | 44 bytes, bounds as floats, 32-bit indices | 28 bytes | 44 bytes |
//! | `2PSB` | 15 | 32 bytes, 16-bit bounds, 32-bit indices | 28 bytes | 32 bytes |
//! | i32 30 (Half-Life) | as version 29 | | | |
//! | i32 29 (Hexen II) | as Quake's but for models, of 80 bytes | | | |
//! | `IBSP`, i32 38 (Quake II) | 19 | 28 bytes, names its cluster | 20 bytes | 28 bytes |
//! | `QBSP`, i32 38 (Qbism) | 19 | 52 bytes, bounds as floats | 28 bytes | 44 bytes |
//! | `IBSP`, i32 46 or 47 (Quake III, Wolfenstein) | 17 | 48 bytes, names its cluster | 104 bytes, with triangles | 36 bytes |

mod covers;
mod faces;
mod family;
mod layout;
mod leaf;
mod places;
mod records;
mod rewrite;
mod surfaces;
mod tree;
mod triangles;
mod world;

pub use covers::FaceCover;
pub use faces::{AmbientKind, AmbientTexture, AmbientTextures};
pub(in crate::quake) use layout::RowForm;
pub use leaf::{BspLeaf, LeafKind, LeafRow};
pub use places::ClusterPlaces;
pub use rewrite::VisibilityLump;
pub use surfaces::LeafFaces;
pub use tree::{BspChild, BspNode, BspTree};
pub use world::WorldFaces;

use crate::bytes::{i32_at, u32_at};
use crate::error::{Malformed, malformed};
use std::ops::Range;

/// How many steps a leaf may be below the root. Maps that were examined have 22 to 127.
pub const MAX_TREE_DEPTH: usize = 1024;

/// A version of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BspFormat {
    /// Version 29, of Quake.
    Bsp29,
    /// `BSP2`: version 29 with wider numbers.
    Bsp2,
    /// `2PSB`: version 29 with wider indices.
    Bsp2Psb,
    /// `IBSP`, version 38, of Quake II.
    Quake2,
    /// Version 30, of Half-Life: version 29 with other light and textures.
    HalfLife,
    /// Version 29 of Hexen II: with models of 80 bytes.
    Hexen2,
    /// `QBSP`, version 38, of Qbism: Quake II's with wider numbers.
    Qbism,
    /// `IBSP`, version 46, of Quake III Arena.
    Quake3,
    /// `IBSP`, version 47, of Return to Castle Wolfenstein: the same records as version 46.
    Wolfenstein,
}

impl BspFormat {
    /// All that are read. Hexen II's begins as Quake's does; all others differ in their first bytes.
    pub const ALL: [Self; 9] = [
        Self::Bsp29,
        Self::Bsp2,
        Self::Bsp2Psb,
        Self::Quake2,
        Self::HalfLife,
        Self::Hexen2,
        Self::Qbism,
        Self::Quake3,
        Self::Wolfenstein,
    ];

    /// The first bytes of files of each.
    pub(crate) const MAGICS: [&'static [u8]; 9] = {
        let mut magics: [&[u8]; 9] = [b""; 9];
        let mut k = 0;
        while k < magics.len() {
            magics[k] = Self::ALL[k].magic();
            k += 1;
        }
        magics
    };

    /// The first bytes of a file.
    pub const fn magic(self) -> &'static [u8] {
        self.layout().magic
    }

    /// Its name, as users know it.
    pub const fn name(self) -> &'static str {
        self.layout().name
    }

    /// The game that it is of.
    pub const fn game(self) -> &'static str {
        self.layout().game
    }

    /// What its lumps hold, in the order of the directory.
    pub const fn lump_names(self) -> &'static [&'static str] {
        self.layout().lump_names
    }

    /// Whether rows are for clusters that leafs name, rather than for leafs that name rows.
    pub const fn has_clusters(self) -> bool {
        !matches!(self.layout().row_form, RowForm::OfLeafs)
    }

    /// Whether leafs have a loudness that goes with visibility: in Quake and Hexen II. In Half-Life they have one too, which its
    /// compilers leave at zero.
    pub const fn has_sounds(self) -> bool {
        self.layout().has_sounds
    }

    /// Bytes of magic and directory.
    pub const fn header_len(self) -> usize {
        self.magic().len() + 8 * self.lump_names().len()
    }

    /// Index of the visibility lump.
    pub const fn visibility_lump(self) -> usize {
        self.layout().visibility
    }

    /// Index of the lump of leafs.
    pub const fn leaf_lump(self) -> usize {
        self.layout().leafs.lump
    }

    fn label(self, index: usize) -> String {
        format!("lump {index} ({})", self.lump_names()[index])
    }

    fn whole_records(self, lump: usize, record: usize, bytes: &[u8]) -> Result<&[u8], Malformed> {
        if bytes.len().is_multiple_of(record) {
            return Ok(bytes);
        }
        let (lump, len) = (self.label(lump), bytes.len());
        Err(malformed!("{lump}: {len} bytes are no whole number of records of {record}"))
    }
}

/// A map in memory, checked as far as visibility needs it: lumps are inside the file and not over its
/// header, leafs make sense, there are as many as can be seen. Lumps may overlap each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Bsp {
    bytes: Vec<u8>,
    format: BspFormat,
    lumps: Vec<Range<usize>>,
    bspx: Option<Bspx>,
    leafs: Vec<BspLeaf>,
    n_visible_leafs: usize,
    n_clusters: usize,
}

/// The directory of additional lumps behind the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Bspx {
    at: usize,
    n_lumps: usize,
}

/// How maps begin.
const KNOWN: &str = "version 29 or 30, BSP2, 2PSB, IBSP and version 38, 46 or 47, or QBSP and version 38";
/// Bytes of an entry of the BSPX directory: 24 of name, u32 place, u32 length.
const BSPX_ENTRY: usize = 32;
const BSPX_HEADER: usize = 8;

impl Bsp {
    /// Checks a whole map. Time and memory in proportion to the bytes, whatever counts they claim.
    ///
    /// # Errors
    /// [`Malformed`] with the lump and the leaf concerned.
    ///
    /// # Source
    /// Quake's specifications 3.4 (Girlich and others), and id Software's published tools of Quake II and Quake III for the
    /// layout of versions 38 and 46; the wide formats and BSPX as current engines read them. Half-Life's, Hexen II's, Wolfenstein's
    /// and Qbism's are by their public descriptions.
    pub fn parse(bytes: Vec<u8>) -> Result<Self, Malformed> {
        let short =
            |needed: usize| Err(malformed!("not a map: {} bytes are less than a header of {needed}", bytes.len()));
        let Some(start) = bytes.first_chunk::<8>() else { return short(BspFormat::Bsp29.header_len()) };
        let Some(begins) = BspFormat::ALL.into_iter().find(|f| start.starts_with(f.magic())) else {
            return Err(malformed!("not a map: it begins with \"{}\", not with {KNOWN}", start.escape_ascii()));
        };
        if bytes.len() < begins.header_len() {
            return short(begins.header_len());
        }
        let format = family::told_apart(begins, &bytes)?;
        let n_lumps = format.lump_names().len();
        let lumps = (0..n_lumps).map(|k| lump_range(format, &bytes, k)).collect::<Result<Vec<_>, _>>()?;
        let bspx = find_bspx(&bytes, &lumps)?;
        let records = |lump: usize, record: usize| format.whole_records(lump, record, &bytes[lumps[lump].clone()]);
        let layout = format.layout();
        let leafs = leaf::parse_leafs(layout, records(layout.leafs.lump, layout.leafs.len)?)?;
        let n_visible_leafs = match layout.model_leafs {
            // Leaf 0 is what is solid. The clusters of the others determine which are visible.
            None => leafs.len().saturating_sub(1),
            Some(at) => leaf::visible_leafs(records(layout.models.lump, layout.models.len)?, at, leafs.len())?,
        };
        let clusters = leafs.iter().filter_map(|leaf| leaf.cluster());
        let n_clusters = clusters.max().map_or(0, |last| usize::from(last) + 1);
        Ok(Self { format, lumps, bspx, leafs, n_visible_leafs, n_clusters, bytes })
    }

    /// The version of the format.
    pub fn format(&self) -> BspFormat {
        self.format
    }

    /// How its visibility is stored.
    pub(in crate::quake) fn row_form(&self) -> RowForm {
        self.format.layout().row_form
    }

    /// The whole file.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The places of the lumps in the file, in the order of the directory; 0..0 for empty lumps.
    pub fn lumps(&self) -> &[Range<usize>] {
        &self.lumps
    }

    /// The bytes of a lump.
    ///
    /// # Panics
    /// If there is no lump of that index.
    pub fn lump_bytes(&self, lump: usize) -> &[u8] {
        &self.bytes[self.lumps[lump].clone()]
    }

    /// The visibility lump; empty in maps for which visibility has not been computed yet.
    pub fn visibility(&self) -> &[u8] {
        self.lump_bytes(self.format.visibility_lump())
    }

    /// All leafs. The first is what is solid; leafs of doors and the like come after those that can be seen.
    pub fn leafs(&self) -> &[BspLeaf] {
        &self.leafs
    }

    /// Number of leafs that can be seen: leafs 1 to this one. In Quake II and III those among them that have a cluster.
    pub fn n_visible_leafs(&self) -> usize {
        self.n_visible_leafs
    }

    /// The leafs that can be seen, from the map's leaf 1 on: the leaf 0 of portal files.
    pub fn visible_leafs(&self) -> &[BspLeaf] {
        self.leafs.get(1..=self.n_visible_leafs).unwrap_or_default()
    }

    /// Number of clusters that leafs name (Quake II and III), else 0.
    pub fn n_clusters(&self) -> usize {
        self.n_clusters
    }

    /// The names and places of the additional lumps that some compilers put behind the others (BSPX).
    pub fn extra_lumps(&self) -> Vec<(&[u8], Range<usize>)> {
        let Some(bspx) = self.bspx else { return Vec::new() };
        let entry = |k: usize| {
            let at = bspx.at + BSPX_HEADER + k * BSPX_ENTRY;
            let (start, len) = (u32_at(&self.bytes, at + 24) as usize, u32_at(&self.bytes, at + 28) as usize);
            let name = &self.bytes[at..at + 24];
            let range = if len == 0 { 0..0 } else { start..start + len };
            (name.split(|&b| b == 0).next().unwrap_or_default(), range)
        };
        (0..bspx.n_lumps).map(entry).collect()
    }
}

fn lump_range(format: BspFormat, bytes: &[u8], lump: usize) -> Result<Range<usize>, Malformed> {
    let at = format.magic().len() + 8 * lump;
    let (offset, len) = (i32_at(bytes, at), i32_at(bytes, at + 4));
    // An empty lump may claim any place.
    if len == 0 {
        return Ok(0..0);
    }
    let start = usize::try_from(offset).ok();
    let range = start.zip(usize::try_from(len).ok()).and_then(|(start, len)| Some(start..start.checked_add(len)?));
    let Some(range) = range.filter(|range| range.end <= bytes.len()) else {
        let what = format_args!("{len} bytes at byte {offset}");
        return Err(malformed!("{}: {what} are not inside the file of {} bytes", format.label(lump), bytes.len()));
    };
    if range.start < format.header_len() {
        return Err(malformed!("{} overlaps the header", format.label(lump)));
    }
    Ok(range)
}

/// Looks for more lumps where they may be: behind all others, at a multiple of four.
fn find_bspx(bytes: &[u8], lumps: &[Range<usize>]) -> Result<Option<Bspx>, Malformed> {
    let at = lumps.iter().map(|l| l.end).max().unwrap_or(0).next_multiple_of(4);
    if at == 0 || !bytes.get(at..at + BSPX_HEADER).is_some_and(|header| header.starts_with(b"BSPX")) {
        return Ok(None);
    }
    let n_lumps = u32_at(bytes, at + 4);
    let unsound = |bad: usize| {
        let what = format_args!("{n_lumps} lumps, the first bad one is {bad}");
        Err(malformed!("the BSPX directory at byte {at} is not sound: {what}"))
    };
    let entries = &bytes[at + BSPX_HEADER..];
    if entries.len() as u64 / (BSPX_ENTRY as u64) < u64::from(n_lumps) {
        return unsound(0);
    }
    // They begin behind their directory; otherwise moving them would change what they contain.
    let behind = (at + BSPX_HEADER) as u64 + u64::from(n_lumps) * BSPX_ENTRY as u64;
    let outside = |entry: &[u8]| {
        let (start, len) = (u64::from(u32_at(entry, 24)), u64::from(u32_at(entry, 28)));
        len > 0 && (start < behind || start + len > bytes.len() as u64)
    };
    match entries.chunks_exact(BSPX_ENTRY).take(n_lumps as usize).position(outside) {
        Some(bad) => unsound(bad),
        None => Ok(Some(Bspx { at, n_lumps: n_lumps as usize })),
    }
}
