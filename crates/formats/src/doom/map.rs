//! One map: its lines, sides, sectors and things, checked, and the plan they make.

use super::{DoomError, DoomErrorKind, MAX_SECTORS, ML_TWOSIDED, MapFormat, MapLump, MapLumps};
use crate::wad::{LumpName, Wad};
use sightlines_cells::{Plan, PlanError, PlanLine, PlanObject};
use sightlines_geometry::{Aabb, Point2};

/// A line from one vertex to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineDef {
    /// Index of the vertex it starts at.
    pub v1: u32,
    /// Index of the vertex it ends at.
    pub v2: u32,
    /// Flags; see [`ML_TWOSIDED`].
    pub flags: u16,
    /// Index of the side on the right hand going from `v1` to `v2`, if it has one.
    pub right: Option<u32>,
    /// Index of the side on the left hand, if it has one.
    pub left: Option<u32>,
}

impl LineDef {
    /// Whether the line lets sight through. Its sides do not matter.
    pub fn is_two_sided(&self) -> bool {
        self.flags & ML_TWOSIDED != 0
    }
}

/// A monster, player, item or lamp.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Thing {
    /// Where it stands, in map units.
    pub x: i16,
    /// Where it stands, in map units.
    pub y: i16,
    /// Its number among the things of its game, such as 3001 for an imp.
    pub kind: u16,
}

/// What sight depends on in one map, with every index checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoomMap {
    name: LumpName,
    format: MapFormat,
    vertices: Vec<[i16; 2]>,
    lines: Vec<LineDef>,
    side_sectors: Vec<u32>,
    n_sectors: u32,
    things: Vec<Thing>,
    reject: Option<Vec<u8>>,
}

impl DoomMap {
    /// Reads a map. A map without THINGS has none. Vertices, sides and sectors that nothing uses are fine,
    /// and so are lines without sides and two-sided lines with only one.
    ///
    /// # Errors
    /// [`DoomError`] for a format that is not read, a missing or repeated lump, a lump of odd size, no
    /// lines or sectors, an index out of range, a line of length zero.
    ///
    /// # Panics
    /// If `lumps` were not listed from this `wad`.
    pub fn parse(wad: &Wad, lumps: &MapLumps) -> Result<Self, DoomError> {
        lumps.check_readable()?;
        let read = Records { wad, lumps };
        let hexen = lumps.format() == MapFormat::Hexen;
        let vertices: Vec<_> = read.of(MapLump::Vertexes, 4)?.map(|r| [i16_at(r, 0), i16_at(r, 2)]).collect();
        let lines: Vec<_> = read.of(MapLump::Linedefs, if hexen { 16 } else { 14 })?.map(line_def).collect();
        let side_sectors: Vec<_> = read.of(MapLump::Sidedefs, 30)?.map(|r| u32::from(u16_at(r, 28))).collect();
        let n_sectors = read.of(MapLump::Sectors, 26)?.len();
        let things = match (lumps.lump(MapLump::Things), hexen) {
            (None, _) => Vec::new(),
            (Some(_), false) => read.of(MapLump::Things, 10)?.map(|r| thing(r, 0, 6)).collect(),
            (Some(_), true) => read.of(MapLump::Things, 20)?.map(|r| thing(r, 2, 10)).collect(),
        };
        for (lump, n) in [(MapLump::Linedefs, lines.len()), (MapLump::Sectors, n_sectors)] {
            if n == 0 {
                return Err(lumps.error(DoomErrorKind::Empty(lump)));
            }
        }
        let n_sectors = u32::try_from(n_sectors)
            .ok()
            .filter(|&n| n <= MAX_SECTORS)
            .ok_or_else(|| lumps.error(DoomErrorKind::TooManySectors(n_sectors)))?;
        let reject = lumps.lump(MapLump::Reject).map(|lump| wad.lump_bytes(lump).to_vec());
        let (name, format) = (lumps.name(), lumps.format());
        let map = Self { name, format, vertices, lines, side_sectors, n_sectors, things, reject };
        map.check().map_err(|kind| lumps.error(kind))?;
        Ok(map)
    }

    fn check(&self) -> Result<(), DoomErrorKind> {
        for (line, l) in self.lines.iter().enumerate() {
            let vertex = |vertex: u32| {
                let n_vertices = self.vertices.len();
                let found = self.vertices.get(vertex as usize).copied();
                found.ok_or(DoomErrorKind::Vertex { line, vertex, n_vertices })
            };
            let (a, b) = (vertex(l.v1)?, vertex(l.v2)?);
            if a == b {
                return Err(DoomErrorKind::ZeroLength { line, x: a[0], y: a[1] });
            }
            let n_sides = self.side_sectors.len();
            if let Some(side) = [l.right, l.left].into_iter().flatten().find(|&s| s as usize >= n_sides) {
                return Err(DoomErrorKind::Side { line, side, n_sides });
            }
        }
        match self.side_sectors.iter().enumerate().find(|&(_, &sector)| sector >= self.n_sectors) {
            Some((side, &sector)) => Err(DoomErrorKind::Sector { side, sector, n_sectors: self.n_sectors }),
            None => Ok(()),
        }
    }

    /// The map's name.
    pub fn name(&self) -> LumpName {
        self.name
    }

    /// How it is stored.
    pub fn format(&self) -> MapFormat {
        self.format
    }

    /// Points x, y in map units, y up; those that node builders append included.
    pub fn vertices(&self) -> &[[i16; 2]] {
        &self.vertices
    }

    /// The lines.
    pub fn lines(&self) -> &[LineDef] {
        &self.lines
    }

    /// The sector that each side faces.
    pub fn side_sectors(&self) -> &[u32] {
        &self.side_sectors
    }

    /// Number of sectors, those that no side names included.
    pub fn n_sectors(&self) -> u32 {
        self.n_sectors
    }

    /// The things.
    pub fn things(&self) -> &[Thing] {
        &self.things
    }

    /// The bytes of the REJECT lump, of whatever length, if there is one.
    pub fn reject(&self) -> Option<&[u8]> {
        self.reject.as_deref()
    }

    /// The sector on the right hand of a line, and the one on its left, from its sides.
    pub fn sectors_of(&self, line: &LineDef) -> [Option<u32>; 2] {
        [line.right, line.left].map(|side| side.map(|s| self.side_sectors[s as usize]))
    }

    /// The map as engines use REJECT: flat. Line `k` of the plan is line `k` of the
    /// map, from its first vertex to its second; it blocks sight unless its flag [`ML_TWOSIDED`] is
    /// set. Heights, doors and textures do not count, because they change during play. Groups are
    /// sectors; [`Plan::n_groups`] may be less than [`DoomMap::n_sectors`], as some may be unused.
    /// Things are objects without extent, called such as `thing 3001 #12`.
    ///
    /// # Errors
    /// None for a map that was read: its lines have length and its coordinates are 16-bit integers.
    pub fn plan(&self) -> Result<Plan, PlanError> {
        let point = |vertex: u32| {
            let [x, y] = self.vertices[vertex as usize].map(f64::from);
            Point2::new(x, y)
        };
        let lines = self.lines.iter().map(|l| {
            let [right, left] = self.sectors_of(l);
            PlanLine { a: point(l.v1), b: point(l.v2), opaque: !l.is_two_sided(), left, right }
        });
        let objects = self.things.iter().enumerate().map(|(index, thing)| PlanObject {
            name: format!("thing {} #{index}", thing.kind),
            bounds: Aabb::around([[f64::from(thing.x), f64::from(thing.y)]]),
        });
        Plan::new(lines.collect(), objects.collect())
    }
}

/// Access to the records of a map's lumps.
struct Records<'w> {
    wad: &'w Wad,
    lumps: &'w MapLumps,
}

impl<'w> Records<'w> {
    /// The records of a lump, each of `record` bytes.
    fn of(&self, lump: MapLump, record: usize) -> Result<std::slice::ChunksExact<'w, u8>, DoomError> {
        let bytes = self.wad.lump_bytes(self.lumps.require(lump)?);
        let (size, index) = (bytes.len(), bytes.len() / record);
        if size % record != 0 {
            return Err(self.lumps.error(DoomErrorKind::RecordSize { lump, size, record, index }));
        }
        Ok(bytes.chunks_exact(record))
    }
}

/// A line of either format: vertices and flags come first, sides last.
fn line_def(record: &[u8]) -> LineDef {
    let side = |at: usize| Some(u32::from(u16_at(record, at))).filter(|&s| s != 0xFFFF);
    LineDef {
        v1: u16_at(record, 0).into(),
        v2: u16_at(record, 2).into(),
        flags: u16_at(record, 4),
        right: side(record.len() - 4),
        left: side(record.len() - 2),
    }
}

fn thing(record: &[u8], place_at: usize, kind_at: usize) -> Thing {
    Thing { x: i16_at(record, place_at), y: i16_at(record, place_at + 2), kind: u16_at(record, kind_at) }
}

/// The little-endian u16 at `at`, which the caller knows to be inside.
fn u16_at(record: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([record[at], record[at + 1]])
}

/// The little-endian i16 at `at`, which the caller knows to be inside.
fn i16_at(record: &[u8], at: usize) -> i16 {
    i16::from_le_bytes([record[at], record[at + 1]])
}
