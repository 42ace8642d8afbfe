//! What maps of all formats hold: lines, things, and the lists of them.

use super::ML_TWOSIDED;
use crate::error::{Malformed, malformed};

/// The game whose engines read a REJECT lump.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Game {
    /// Its engines look through lines whose flag [`ML_TWOSIDED`](super::ML_TWOSIDED) is set.
    Doom,
    /// Its engines look through every line with a left side, whatever its flags.
    Heretic,
    /// As [`Game::Heretic`].
    Hexen,
}

/// A line from one vertex to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineDef {
    /// Index of the vertex it starts at.
    pub v1: u32,
    /// Index of the vertex it ends at.
    pub v2: u32,
    /// Flags; see [`ML_TWOSIDED`]. Of a map as text no other is read.
    pub flags: u16,
    /// Index of the side on the right hand going from `v1` to `v2`, if it has one.
    pub right: Option<u32>,
    /// Index of the side on the left hand, if it has one.
    pub left: Option<u32>,
}

impl LineDef {
    /// Whether its flag lets sight through, whatever its sides. Engines may look through others too: [`DoomMap::plan_for`](super::DoomMap::plan_for).
    pub fn is_two_sided(&self) -> bool {
        self.flags & ML_TWOSIDED != 0
    }
}

/// A monster, player, item or lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thing {
    /// Where it stands, in map units.
    pub x: f64,
    /// Where it stands, in map units.
    pub y: f64,
    /// Its number among the things of its game, such as 3001 for an imp.
    pub kind: i32,
}

/// Whose numbers the specials of lines are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Numbering {
    /// Of Doom, and of what its ports added.
    #[default]
    Doom,
    /// Of Hexen, and of all engines that number as it does.
    Hexen,
    /// Of Sonic Robo Blast 2.
    Srb2,
}

/// What is read from a map in any format; of a map as text with every index checked.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Content {
    pub(super) vertices: Vec<[f64; 2]>,
    pub(super) lines: Vec<LineDef>,
    pub(super) side_sectors: Vec<u32>,
    pub(super) n_sectors: usize,
    pub(super) things: Vec<Thing>,
    /// What each line does, by the numbers of `numbering`.
    pub(super) specials: Vec<i32>,
    /// Whose numbers these are.
    pub(super) numbering: Numbering,
    /// The game that the format is of.
    pub(super) game: Option<Game>,
}

impl Content {
    /// Whether the ends of a line are two points.
    pub(super) fn has_length(&self, line: &LineDef) -> bool {
        self.vertices[line.v1 as usize] != self.vertices[line.v2 as usize]
    }

    /// The first line with a vertex or a side that is not there, and what is wrong with it, by what these are called.
    pub(super) fn wrong_line(&self, vertex: &str, side: &str) -> Option<(usize, Malformed)> {
        let (n_vertices, n_sides) = (self.vertices.len(), self.side_sectors.len());
        self.lines.iter().enumerate().find_map(|(index, line)| {
            let wrong = not_there(vertex, [Some(line.v1), Some(line.v2)], n_vertices);
            Some((index, wrong.or_else(|| not_there(side, [line.right, line.left], n_sides))?))
        })
    }

    /// The first side with a sector that is not there, and what is wrong with it.
    pub(super) fn wrong_side(&self) -> Option<(usize, Malformed)> {
        let wrong = |&sector: &u32| not_there("sector", [Some(sector)], self.n_sectors);
        self.side_sectors.iter().enumerate().find_map(|(index, sector)| Some((index, wrong(sector)?)))
    }
}

fn not_there<const N: usize>(what: &str, numbers: [Option<u32>; N], n: usize) -> Option<Malformed> {
    let number = numbers.into_iter().flatten().find(|&number| number as usize >= n)?;
    Some(malformed!("{what} {number} is not among the {n} there are"))
}
