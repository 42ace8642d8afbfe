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
mod error;
mod faces;
mod family;
mod kind;
mod layout;
mod leaf;
mod places;
mod rewrite;
mod surfaces;
mod tree;
mod triangles;
mod world_faces;

pub use covers::FaceCover;
pub use error::{BspError, BspLumpId};
pub use faces::{AmbientKind, AmbientTexture, AmbientTextures};
pub use kind::LeafKind;
pub(in crate::quake) use layout::RowForm;
pub use leaf::{BspLeaf, LeafRow};
pub use places::ClusterPlaces;
pub(in crate::quake) use rewrite::NewVisibility;
pub use surfaces::LeafFaces;
pub use tree::{BspChild, BspNode, BspTree};
pub use world_faces::WorldFaces;

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
    pub const MAGICS: [&'static [u8]; 9] = [
        Self::ALL[0].magic(),
        Self::ALL[1].magic(),
        Self::ALL[2].magic(),
        Self::ALL[3].magic(),
        Self::ALL[4].magic(),
        Self::ALL[5].magic(),
        Self::ALL[6].magic(),
        Self::ALL[7].magic(),
        Self::ALL[8].magic(),
    ];

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

    /// A lump as errors name it.
    fn lump_id(self, index: usize) -> BspLumpId {
        BspLumpId { index, name: self.lump_names()[index] }
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

/// Bytes of an entry of the BSPX directory: 24 of name, u32 place, u32 length.
const BSPX_ENTRY: usize = 32;
/// Bytes before the entries: `BSPX`, u32 number of lumps.
const BSPX_HEADER: usize = 8;

impl Bsp {
    /// Checks a whole map. Time and memory in proportion to the bytes, whatever counts they claim.
    ///
    /// # Errors
    /// [`BspError`] with the lump and the leaf concerned.
    ///
    /// # Source
    /// Quake's specifications 3.4 (Girlich and others), and id Software's published tools of Quake II and Quake III for the
    /// layout of versions 38 and 46; the wide formats and BSPX as current engines read them. Half-Life's, Hexen II's, Wolfenstein's
    /// and Qbism's are by their public descriptions.
    pub fn parse(bytes: Vec<u8>) -> Result<Self, BspError> {
        let Some(start) = bytes.first_chunk::<8>() else {
            return Err(BspError::NoHeader { len: bytes.len(), needed: BspFormat::Bsp29.header_len() });
        };
        let begins = BspFormat::ALL.into_iter().find(|f| start.starts_with(f.magic()));
        let begins = begins.ok_or(BspError::Version { found: *start })?;
        let needed = begins.header_len();
        if bytes.len() < needed {
            return Err(BspError::NoHeader { len: bytes.len(), needed });
        }
        let format = family::told_apart(begins, &bytes)?;
        let n_lumps = format.lump_names().len();
        let lumps = (0..n_lumps).map(|k| lump_range(format, &bytes, k)).collect::<Result<Vec<_>, _>>()?;
        let bspx = find_bspx(&bytes, &lumps)?;
        let records = |lump: usize, record: usize| -> Result<&[u8], BspError> {
            let range = lumps[lump].clone();
            let whole = range.len().is_multiple_of(record);
            let error = BspError::LumpLength { lump: format.lump_id(lump), len: range.len(), record };
            if whole { Ok(&bytes[range]) } else { Err(error) }
        };
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

fn lump_range(format: BspFormat, bytes: &[u8], lump: usize) -> Result<Range<usize>, BspError> {
    let at = format.magic().len() + 8 * lump;
    let (offset, len) = (i32_at(bytes, at), i32_at(bytes, at + 4));
    // An empty lump may claim any place.
    if len == 0 {
        return Ok(0..0);
    }
    let id = format.lump_id(lump);
    let error = BspError::LumpRange { lump: id, offset, len, file_len: bytes.len() };
    let (Ok(start), Ok(n_bytes)) = (usize::try_from(offset), usize::try_from(len)) else { return Err(error) };
    match start.checked_add(n_bytes) {
        Some(end) if end <= bytes.len() && start >= format.header_len() => Ok(start..end),
        Some(end) if end <= bytes.len() => Err(BspError::OverlapsHeader { lump: id }),
        _ => Err(error),
    }
}

/// Looks for more lumps where they may be: behind all others, at a multiple of four.
fn find_bspx(bytes: &[u8], lumps: &[Range<usize>]) -> Result<Option<Bspx>, BspError> {
    let at = lumps.iter().map(|l| l.end).max().unwrap_or(0).next_multiple_of(4);
    if at == 0 || !bytes.get(at..at + BSPX_HEADER).is_some_and(|header| header.starts_with(b"BSPX")) {
        return Ok(None);
    }
    let n_lumps = u32_at(bytes, at + 4);
    let entries = &bytes[at + BSPX_HEADER..];
    if entries.len() as u64 / (BSPX_ENTRY as u64) < u64::from(n_lumps) {
        return Err(BspError::Bspx { at, n_lumps, bad: 0 });
    }
    // They begin behind their directory; otherwise moving them would change what they contain.
    let behind = (at + BSPX_HEADER) as u64 + u64::from(n_lumps) * BSPX_ENTRY as u64;
    let outside = |entry: &[u8]| {
        let (start, len) = (u64::from(u32_at(entry, 24)), u64::from(u32_at(entry, 28)));
        len > 0 && (start < behind || start + len > bytes.len() as u64)
    };
    match entries.chunks_exact(BSPX_ENTRY).take(n_lumps as usize).position(outside) {
        Some(bad) => Err(BspError::Bspx { at, n_lumps, bad }),
        None => Ok(Some(Bspx { at, n_lumps: n_lumps as usize })),
    }
}

/// The bytes at `at`, which the caller knows to be inside.
fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[at..at + N]);
    out
}

fn i32_at(bytes: &[u8], at: usize) -> i32 {
    i32::from_le_bytes(bytes_at(bytes, at))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes_at(bytes, at))
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(bytes_at(bytes, at))
}

fn i16_at(bytes: &[u8], at: usize) -> i16 {
    i16::from_le_bytes(bytes_at(bytes, at))
}
