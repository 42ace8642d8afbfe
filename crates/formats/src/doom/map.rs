//! One map: its lines, sides, sectors and things, checked, and the plan they make.

use super::content::{Content, LineDef, Thing};
use super::{Game, MAX_SECTORS, MapFormat, MapLump, MapLumps, engine, records, udmf};
use crate::error::{Malformed, Within, malformed};
use crate::wad::{LumpName, Wad};
use sightlines_cells::{Plan, PlanError, PlanLine, PlanObject};
use sightlines_geometry::{Aabb, Point2};

/// What sight depends on in one map, with every index checked.
#[derive(Debug, Clone, PartialEq)]
pub struct DoomMap {
    name: LumpName,
    format: MapFormat,
    content: Content,
    /// Lines of polyobjects.
    moving: Vec<bool>,
    n_sectors: u32,
    reject: Option<Vec<u8>>,
}

impl DoomMap {
    /// Reads a map. A map without THINGS has none. Vertices, sides and sectors that nothing uses are fine, and so are lines without
    /// sides, two-sided lines with only one, and lines of length zero next to others.
    ///
    /// A coordinate of a map as text is the double nearest to what the text says.
    ///
    /// # Errors
    /// [`Malformed`] with the map and the lump, for a format that is not read, a missing or repeated lump, a lump of odd size, a text that is wrong somewhere,
    /// no lines of any length or no sectors, an index out of range.
    ///
    /// # Panics
    /// If `lumps` were not listed from this `wad`.
    pub fn parse(wad: &Wad, lumps: &MapLumps) -> Result<Self, Malformed> {
        Self::try_parse(wad, lumps).within(format_args!("map {}", lumps.name()))
    }

    fn try_parse(wad: &Wad, lumps: &MapLumps) -> Result<Self, Malformed> {
        lumps.check_readable()?;
        let content = match lumps.text() {
            Some(text) => udmf::parse(wad.lump_bytes(text)).within("TEXTMAP")?,
            None => records::parse(wad, lumps)?,
        };
        let n_sectors = check(&content)?;
        let reject = lumps.lump(MapLump::Reject).map(|lump| wad.lump_bytes(lump).to_vec());
        let moving = engine::in_polyobjects(&content);
        Ok(Self { name: lumps.name(), format: lumps.format(), content, moving, n_sectors, reject })
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
    pub fn vertices(&self) -> &[[f64; 2]] {
        &self.content.vertices
    }

    /// The lines, those of length zero included.
    pub fn lines(&self) -> &[LineDef] {
        &self.content.lines
    }

    /// The sector that each side faces.
    pub fn side_sectors(&self) -> &[u32] {
        &self.content.side_sectors
    }

    /// Number of sectors, those that no side names included.
    pub fn n_sectors(&self) -> u32 {
        self.n_sectors
    }

    /// The things.
    pub fn things(&self) -> &[Thing] {
        &self.content.things
    }

    /// The bytes of the REJECT lump, of whatever length, if there is one.
    pub fn reject(&self) -> Option<&[u8]> {
        self.reject.as_deref()
    }

    /// The sector on the right hand of a line, and the one on its left, from its sides.
    pub fn sectors_of(&self, line: &LineDef) -> [Option<u32>; 2] {
        [line.right, line.left].map(|side| side.map(|s| self.content.side_sectors[s as usize]))
    }

    /// Number of lines whose ends are one point. They take no part in the plan. O(lines).
    pub fn n_lines_without_length(&self) -> usize {
        self.lines().iter().filter(|line| !self.content.has_length(line)).count()
    }

    /// The map as engines use REJECT: flat. The lines of the plan are those of the map that have length, in their order, from the
    /// first vertex to the second; a line blocks sight unless some engine looks through it ([`DoomMap::plan_for`]). Heights, doors and textures do not count, because they change during play. Groups are
    /// sectors; [`Plan::n_groups`] may be less than [`DoomMap::n_sectors`], as some may be unused.
    /// Things are objects without extent, called such as `thing 3001 #12`.
    ///
    /// # Errors
    /// None for a map that was read: its coordinates are 16-bit integers, or were checked.
    pub fn plan(&self) -> Result<Plan, PlanError> {
        self.plan_for(None)
    }

    /// As [`DoomMap::plan`], for the engines of one game. A line lets sight through if its flag [`ML_TWOSIDED`](super::ML_TWOSIDED) is
    /// set, whatever its sides; if it has a left side, unless the game is Doom; and if it is of a polyobject, because these move. What the
    /// format says counts more than `game`: BEHAVIOR, and the namespaces `hexen` and `heretic`, are of engines that look through every line with a left side.
    ///
    /// # Errors
    /// As [`DoomMap::plan`].
    pub fn plan_for(&self, game: Option<Game>) -> Result<Plan, PlanError> {
        let game = self.content.game.or(game);
        let point = |vertex: u32| {
            let [x, y] = self.content.vertices[vertex as usize];
            Point2::new(x, y)
        };
        let lines = self.lines().iter().zip(&self.moving).filter(|(line, _)| self.content.has_length(line));
        let lines = lines.map(|(l, moves)| {
            let [right, left] = self.sectors_of(l);
            PlanLine { a: point(l.v1), b: point(l.v2), opaque: !moves && !l.is_seen_through(game), left, right }
        });
        let objects = self.things().iter().enumerate().map(|(index, thing)| PlanObject {
            name: format!("thing {} #{index}", thing.kind),
            bounds: Aabb::around([[thing.x, thing.y]]),
        });
        // Vertices are where an editor put them: integers, and in texts what was meant.
        Ok(Plan::new(lines.collect(), objects.collect())?.with_precision(Some(0.0)))
    }
}

/// Refuses what no plan can be made from; returns the number of sectors.
fn check(content: &Content) -> Result<u32, Malformed> {
    if let Some((index, wrong)) = content.wrong_line("vertex", "side") {
        return Err(wrong.within(format_args!("LINEDEFS {index}")));
    }
    let empty = |lump: MapLump| Err(malformed!("the map is empty").within(lump));
    if !content.lines.iter().any(|line| content.has_length(line)) {
        return empty(MapLump::Linedefs);
    }
    if content.n_sectors == 0 {
        return empty(MapLump::Sectors);
    }
    let n = content.n_sectors;
    let n_sectors = u32::try_from(n).ok().filter(|&n| n <= MAX_SECTORS);
    let many = || malformed!("{n} sectors are more than the {MAX_SECTORS} that a map can have").within("SECTORS");
    let n_sectors = n_sectors.ok_or_else(many)?;
    match content.wrong_side() {
        Some((index, wrong)) => Err(wrong.within(format_args!("SIDEDEFS {index}"))),
        None => Ok(n_sectors),
    }
}
