//! The layout of an office floor on a grid of eighths of a unit: walls, doors, rooms and desks.
//!
//! Rows of rooms lie in pairs, back to back, with a corridor along the front of each; corridors across
//! cut the rows into blocks. Generators turn a layout into a plan or into the floors of a tower.

use crate::rng::Rng;
use crate::stroke::{Rect, Stroke};

/// Grid steps per unit.
pub(crate) const STEPS: u32 = 8;
/// Width of corridors: 2 units.
pub(crate) const CORRIDOR: i32 = 16;
/// Width of doors: 1 unit.
pub(crate) const DOOR: i32 = 8;
/// Mean width of a room place: 4 units.
pub(crate) const PLACE: i32 = 32;
/// The dividing wall between two places is moved by at most this, so a room is at least 20 steps wide.
const JITTER: i32 = 6;

/// One row of rooms.
#[derive(Debug, Clone, Copy)]
struct Row {
    y0: i32,
    y1: i32,
    /// Whether its corridor runs along `y1` (otherwise along `y0`).
    corridor_above: bool,
}

/// The kind of a piece of furniture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PieceKind {
    /// A desk for one.
    Desk,
    /// A table of a meeting room.
    Table,
}

/// A piece of furniture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) kind: PieceKind,
    /// Index of the room that contains it.
    pub(crate) room: usize,
    pub(crate) rect: Rect,
}

/// A room or an open-plan area, up to the middle lines of its walls.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    pub(crate) rect: Rect,
    /// Whether its front, where the corridor is, is at `y1` (otherwise at `y0`).
    pub(crate) corridor_above: bool,
    /// The range of its door along the front; `None` for an open-plan area.
    pub(crate) door: Option<[i32; 2]>,
}

/// A block of rooms between two corridors across.
#[derive(Debug, Clone, Copy)]
struct Block {
    x0: i32,
    x1: i32,
    /// Number of room places.
    places: i32,
}

/// An office floor, during and after its construction.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    rng: Rng,
    blocks: Vec<Block>,
    rows: Vec<Row>,
    /// The start of the core.
    core: Option<i32>,
    /// Middle lines of the outer walls.
    pub(crate) outer: Rect,
    /// Middle lines of all walls, without the gaps of doors; some overlap.
    pub(crate) strokes: Vec<Stroke>,
    /// Gaps of doors and wider openings.
    pub(crate) doors: Vec<Stroke>,
    /// Square pillars.
    pub(crate) pillars: Vec<Rect>,
    pub(crate) rooms: Vec<Room>,
    pub(crate) pieces: Vec<Piece>,
}

impl Layout {
    /// Blocks and rows, and no walls yet: `rooms_x` places in each of `rooms_y` rows, corridors across
    /// after every `block` places.
    pub(crate) fn new(mut rng: Rng, rooms_x: u32, rooms_y: u32, block: u32) -> Self {
        let mut blocks = Vec::new();
        let (mut x, mut left) = (0, rooms_x);
        while left > 0 {
            // The last two blocks share the remaining places evenly.
            let n = if left <= block { left } else { block.min(left.div_ceil(2)) };
            let places = n.cast_signed();
            blocks.push(Block { x0: x, x1: x + places * PLACE, places });
            x += places * PLACE + CORRIDOR;
            left -= n;
        }
        let (mut y, mut rows) = (0, Vec::new());
        for row in 0..rooms_y {
            let corridor_above = row % 2 == 0;
            let depth = 4 * rng.between(9, 13);
            rows.push(Row { y0: y, y1: y + depth, corridor_above });
            y += depth + if corridor_above { CORRIDOR } else { 0 };
        }
        let outer = Rect { x0: 0, y0: 0, x1: x - CORRIDOR, y1: y };
        Self {
            rng,
            blocks,
            rows,
            core: None,
            outer,
            strokes: Vec::new(),
            doors: Vec::new(),
            pillars: Vec::new(),
            rooms: Vec::new(),
            pieces: Vec::new(),
        }
    }

    /// Adds a block of one place beyond a last corridor across: the core that holds the stairwells.
    pub(crate) fn add_core(&mut self) {
        let x0 = self.outer.x1 + CORRIDOR;
        self.blocks.push(Block { x0, x1: x0 + PLACE, places: 1 });
        self.outer.x1 = x0 + PLACE;
        self.core = Some(x0);
    }

    /// Whether a room is a stairwell: those of the core in every fourth row, once there is a core.
    pub(crate) fn is_stairwell(&self, room: &Room) -> bool {
        let core = self.core.is_some_and(|x| room.rect.x0 >= x);
        core && self.rows.iter().step_by(4).any(|row| row.y0 == room.rect.y0)
    }

    /// The same blocks and rows, to be built with other random numbers.
    pub(crate) fn with_rng(&self, rng: Rng) -> Self {
        Self { rng, ..self.clone() }
    }

    /// Places walls, doors and furniture.
    pub(crate) fn build(&mut self) {
        self.strokes.extend(Stroke::sides(self.outer));
        let open = self.choose_open_areas();
        for b in 0..self.blocks.len() {
            let mut r = 0;
            while r < self.rows.len() {
                if open.contains(&(b, r)) {
                    self.open_plan(b, r);
                    r += 2;
                } else {
                    self.row_of_rooms(b, r);
                    r += 1;
                }
            }
        }
    }

    /// One in eight of the places that can be an open-plan area: two rows that lie back to back, in a
    /// block of more than one room. Given by block and lower row.
    fn choose_open_areas(&mut self) -> Vec<(usize, usize)> {
        let rows = (1..self.rows.len().saturating_sub(1)).step_by(2);
        let blocks = (0..self.blocks.len()).filter(|&b| self.blocks[b].places > 1);
        let mut places: Vec<(usize, usize)> = blocks.flat_map(|b| rows.clone().map(move |r| (b, r))).collect();
        let n = places.len().div_ceil(8);
        for i in 0..n {
            let j = i + self.rng.below(places.len() - i);
            places.swap(i, j);
        }
        places.truncate(n);
        places
    }

    /// A row of rooms of block `b`, each with a door to the corridor.
    fn row_of_rooms(&mut self, b: usize, r: usize) {
        let (Block { x0, x1, places }, Row { y0, y1, corridor_above }) = (self.blocks[b], self.rows[r]);
        let mut cuts = vec![x0];
        for place in 1..places {
            // One dividing wall in six is left out: a meeting room for two places.
            let wide = x0 + place * PLACE - cuts[cuts.len() - 1] > PLACE + JITTER;
            if wide || !self.rng.one_in(6) {
                cuts.push(x0 + place * PLACE + self.rng.between(-JITTER, JITTER));
            }
        }
        cuts.push(x1);
        let (front, back) = if corridor_above { (y1, y0) } else { (y0, y1) };
        let mut doors = Vec::new();
        for room in cuts.windows(2) {
            let door = self.rng.between(room[0] + 3, room[1] - 3 - DOOR);
            doors.push([door, door + DOOR]);
            let rect = Rect { x0: room[0], y0, x1: room[1], y1 };
            self.furnish(Room { rect, corridor_above, door: Some([door, door + DOOR]) });
        }
        self.wall(Stroke::along_x(front, x0, x1), &doors);
        self.wall(Stroke::along_x(back, x0, x1), &[]);
        for &x in &cuts {
            let between = x != x0 && x != x1 && self.rng.one_in(8);
            let middle = (y0 + y1) / 2;
            let door = [[middle, middle + DOOR]];
            self.wall(Stroke::along_y(x, y0, y1), if between { &door } else { &[] });
        }
    }

    /// Desks along the back wall, or a table in the middle of a meeting room.
    fn furnish(&mut self, room: Room) {
        let Rect { x0, y0, x1, y1 } = room.rect;
        self.rooms.push(room);
        if x1 - x0 > PLACE + 2 * JITTER {
            let (x, y) = ((x0 + x1) / 2, (y0 + y1) / 2);
            self.piece(PieceKind::Table, Rect { x0: x - 14, y0: y - 5, x1: x + 14, y1: y + 5 });
            return;
        }
        let n = (x1 - x0 - 4) / 16;
        let y = if room.corridor_above { y0 + 4 } else { y1 - 10 };
        for i in 0..n {
            let x = x0 + 3 + 16 * i;
            self.piece(PieceKind::Desk, Rect { x0: x, y0: y, x1: x + 12, y1: y + 6 });
        }
    }

    /// One large area instead of rows `r` and `r + 1` of block `b`: wide openings, pillars, many desks.
    fn open_plan(&mut self, b: usize, r: usize) {
        let (Block { x0, x1, places }, y0, y1) = (self.blocks[b], self.rows[r].y0, self.rows[r + 1].y1);
        self.rooms.push(Room { rect: Rect { x0, y0, x1, y1 }, corridor_above: true, door: None });
        let openings: Vec<[i32; 2]> =
            (0..places).step_by(2).map(|i| x0 + i * PLACE + 4).map(|x| [x, x + 3 * DOOR]).collect();
        for y in [y0, y1] {
            self.wall(Stroke::along_x(y, x0, x1), &openings);
        }
        let middle = (y0 + y1) / 2;
        for x in [x0, x1] {
            let at_outer_wall = x == self.outer.x0 || x == self.outer.x1;
            let gap = [[middle - DOOR, middle + DOOR]];
            self.wall(Stroke::along_y(x, y0, y1), if at_outer_wall { &[] } else { &gap });
        }
        let desk_rows = (y1 - y0 - 16) / 20;
        for i in 0..places {
            let x = x0 + i * PLACE;
            if i > 0 {
                for y in [(3 * y0 + y1) / 4, (y0 + 3 * y1) / 4] {
                    self.pillars.push(Rect { x0: x - 2, y0: y - 2, x1: x + 2, y1: y + 2 });
                }
            }
            for j in 0..desk_rows {
                let y = y0 + 10 + 20 * j;
                self.piece(PieceKind::Desk, Rect { x0: x + 10, y0: y, x1: x + 22, y1: y + 6 });
            }
        }
    }

    /// A wall with gaps for doors.
    fn wall(&mut self, stroke: Stroke, doors: &[[i32; 2]]) {
        self.strokes.extend(stroke.without(doors));
        self.doors.extend(doors.iter().map(|&[lo, hi]| Stroke { lo, hi, ..stroke }));
    }

    /// A piece of furniture in the room that was added last.
    fn piece(&mut self, kind: PieceKind, rect: Rect) {
        self.pieces.push(Piece { kind, room: self.rooms.len() - 1, rect });
    }
}
