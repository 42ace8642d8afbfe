//! Levels like Quake's: rooms on several heights, corridors with stairs and ramps, pillars, windows, shafts.

use super::World;
use super::brushes::{Brush, world_of_brushes};
use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use crate::spanning::Passages;

/// Options of [`quake_like`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QuakeLikeOptions {
    /// Different seeds give different levels.
    pub seed: u64,
    /// Rooms from west to east, 1 to 16.
    pub rooms_x: u32,
    /// Rooms from south to north, 1 to 16.
    pub rooms_y: u32,
    /// Floors above each other, 1 to 4.
    pub floors: u32,
}

impl Default for QuakeLikeOptions {
    fn default() -> Self {
        Self { seed: 1, rooms_x: 4, rooms_y: 3, floors: 2 }
    }
}

/// Distance between neighbouring rooms' places, in scene units: a player is 56 high.
const PLACE: i32 = 512;
/// Height of a floor with everything above it.
const FLOOR: i32 = 320;
/// Height of a stair's step.
const STEP: i32 = 16;
/// Half the width of a corridor.
const CORRIDOR: i32 = 32;

/// A room, without its content.
#[derive(Debug, Clone, Copy)]
struct Room {
    min: [i32; 3],
    max: [i32; 3],
}

/// A level: about 14 cells for each room, and as many solid leafs or some more. All corners of brushes are integers; roofs, ramps,
/// pillars and some windows are tilted. Some rooms are closed off, and some pockets belong to none.
///
/// # Errors
/// [`GenerateError::OutOfRange`].
pub fn quake_like(options: QuakeLikeOptions) -> Result<World, GenerateError> {
    let [w, h] = [("rooms_x", options.rooms_x), ("rooms_y", options.rooms_y)];
    let w = check_range(w.0, w.1, 1, 16)?.cast_signed();
    let h = check_range(h.0, h.1, 1, 16)?.cast_signed();
    let floors = check_range("floors", options.floors, 1, 4)?.cast_signed();
    let mut rng = Rng::new(options.seed, 0x9A4E);
    let mut level = Level::default();
    let (n_x, n_y) = (w as usize, h as usize);
    let mut below: Vec<Room> = Vec::new();
    for floor in 0..floors {
        let rooms: Vec<Room> = (0..w * h).map(|k| room(&mut rng, [k % w, k / w, floor])).collect();
        for &room in &rooms {
            level.add_room(&mut rng, room);
        }
        let passages = Passages::random(&mut rng, n_x, n_y, 4);
        for k in 0..rooms.len() {
            let (x, y) = (k % n_x, k / n_x);
            for (axis, other, joined) in [
                (0, (x + 1 < n_x).then_some(k + 1), x + 1 < n_x && passages.east(x, y)),
                (1, (y + 1 < n_y).then_some(k + n_x), y + 1 < n_y && passages.north(x, y)),
            ] {
                let Some(other) = other else { continue };
                if joined {
                    level.add_corridor(&mut rng, axis, rooms[k], rooms[other]);
                } else if rng.one_in(2) {
                    level.add_window(&mut rng, axis, rooms[k], rooms[other]);
                }
            }
        }
        for (&low, &high) in below.iter().zip(&rooms).filter(|_| floor > 0) {
            if rng.one_in(3) {
                let [x, y] = [0, 1].map(|k| (low.min[k].max(high.min[k]) + low.max[k].min(high.max[k])) / 2);
                let shaft = Brush::empty([x - 32, y - 32, low.max[2]], [x + 32, y + 32, high.min[2]]);
                level.carved.push(if rng.one_in(2) { eight_sided(shaft, [x, y], 32) } else { shaft });
            }
        }
        below = rooms;
    }
    let brushes: Vec<Brush> = level.carved.into_iter().chain(level.filled).chain(level.windows).collect();
    Ok(world_of_brushes([0, 0, -16], [w * PLACE, h * PLACE, floors * FLOOR], &brushes))
}

/// A room in its place: at least 48 from the border of the place, and over its middle.
fn room(rng: &mut Rng, place: [i32; 3]) -> Room {
    let mut low = || 48 + 16 * rng.between(0, 5);
    let (margin_low, margin_high) = ([low(), low()], [low(), low()]);
    let floor = place[2] * FLOOR + STEP * rng.between(0, 4);
    let mut min = [0, 1].map(|k| place[k] * PLACE + margin_low[k]).to_vec();
    let mut max = [0, 1].map(|k| (place[k] + 1) * PLACE - margin_high[k]).to_vec();
    min.push(floor);
    max.push(floor + 128 + 16 * rng.between(0, 4));
    Room { min: [min[0], min[1], min[2]], max: [max[0], max[1], max[2]] }
}

/// Brushes in order of precedence.
#[derive(Debug, Default)]
struct Level {
    carved: Vec<Brush>,
    filled: Vec<Brush>,
    windows: Vec<Brush>,
}

impl Level {
    fn add_room(&mut self, rng: &mut Rng, Room { min, max }: Room) {
        self.carved.push(Brush::empty(min, max));
        let [x, y] = [0, 1].map(|k| (min[k] + max[k]) / 2);
        if rng.one_in(3) {
            // A roof of two slopes.
            let top = max[2] + 48;
            let half = (max[0] - min[0]) / 2;
            let roof = Brush::empty([min[0], min[1], max[2]], [max[0], max[1], top]);
            let roof = roof.cut([48, 0, half], [min[0] + half, min[1], top]);
            self.carved.push(roof.cut([-48, 0, half], [max[0] - half, min[1], top]));
        }
        match rng.below(5) {
            0 => {
                // Two rows of pillars, some with eight sides.
                for dx in [-80, 80] {
                    for dy in [-80, 80] {
                        self.filled.push(pillar(rng, [x + dx, y + dy], min[2], max[2]));
                    }
                }
            }
            1 => self.filled.push(pillar(rng, [x, y], min[2], max[2])),
            2 => {
                // A platform with a ramp.
                self.filled.push(Brush::solid([x - 48, y - 48, min[2]], [x + 48, y + 48, min[2] + 48]));
                let ramp = Brush::solid([x + 48, y - 32, min[2]], [x + 112, y + 32, min[2] + 48]);
                self.filled.push(ramp.cut([3, 0, 4], [x + 112, y, min[2]]));
            }
            3 => {
                // A pillar that leans.
                let lean = rng.between(1, 2);
                let beam = Brush::solid([x - 128, y - 16, min[2]], [x + 128, y + 16, max[2]]);
                let beam = beam.cut([4, 0, -lean], [x + 16, y, min[2]]);
                self.filled.push(beam.cut([-4, 0, lean], [x - 16, y, min[2]]));
            }
            _ => {
                let at = rng.between(-4, 4) * 16;
                let crate_ = Brush::solid([x + at - 64, y - 64, min[2]], [x + at + 64, y + 64, min[2] + 40]);
                let crate_ = crate_.cut([1, 1, 0], [x + at + 32, y, 0]).cut([-1, 1, 0], [x + at, y + 32, 0]);
                self.filled.push(crate_.cut([1, -1, 0], [x + at + 32, y, 0]).cut([-1, -1, 0], [x + at - 32, y, 0]));
            }
        }
        if rng.one_in(6) {
            // A pocket in the corner of the place, which nothing leads to.
            let corner = [min[0] / PLACE * PLACE + 8, min[1] / PLACE * PLACE + 8];
            self.carved
                .push(Brush::empty([corner[0], corner[1], min[2]], [corner[0] + 24, corner[1] + 24, min[2] + 64]));
        }
    }

    /// A corridor from one room to the next along an axis, with stairs or a ramp if their heights differ.
    fn add_corridor(&mut self, rng: &mut Rng, axis: usize, from: Room, to: Room) {
        let across = 1 - axis;
        let middle = from.min[across] / PLACE * PLACE + PLACE / 2 + 16 * rng.between(-4, 4);
        let (low, high) = (from.min[2].min(to.min[2]), from.min[2].max(to.min[2]));
        let (start, end) = (from.max[axis], to.min[axis]);
        let corner = |along: i32, side: i32, z: i32| {
            let mut p = [0, 0, z];
            (p[axis], p[across]) = (along, middle + side * CORRIDOR);
            p
        };
        self.carved.push(Brush::empty(corner(start, -1, low), corner(end, 1, high + 96)));
        let rise = high - low;
        if rise == 0 {
            return;
        }
        let goes_up = to.min[2] == high;
        if rng.one_in(2) {
            let ramp = Brush::solid(corner(start, -1, low), corner(end, 1, high));
            let mut normal = [0, 0, end - start];
            normal[axis] = if goes_up { -rise } else { rise };
            self.filled.push(ramp.cut(normal, corner(if goes_up { start } else { end }, 0, low)));
        } else {
            let n = rise / STEP;
            for k in 0..n {
                // Step k reaches from where it begins to the high end.
                let begin = (end - start) * k / n;
                let (a, b) = if goes_up { (start + begin, end) } else { (start, end - begin) };
                self.filled.push(Brush::solid(corner(a, -1, low + k * STEP), corner(b, 1, low + (k + 1) * STEP)));
            }
        }
    }

    /// An opening through the wall between two rooms, too high to walk through; some have a slanted sill.
    fn add_window(&mut self, rng: &mut Rng, axis: usize, from: Room, to: Room) {
        let across = 1 - axis;
        let middle = from.min[across] / PLACE * PLACE + PLACE / 2 + 16 * rng.between(-6, 6);
        let sill = from.min[2].max(to.min[2]) + 40;
        let (start, end) = (from.max[axis], to.min[axis]);
        let corner = |along: i32, side: i32, z: i32| {
            let mut p = [0, 0, z];
            (p[axis], p[across]) = (along, middle + side);
            p
        };
        let half = rng.between(1, 3) * 8;
        let window = Brush::empty(corner(start, -half, sill), corner(end, half, sill + 40));
        self.windows.push(if rng.one_in(2) {
            let mut normal = [0, 0, -(end - start)];
            normal[axis] = 16;
            window.cut(normal, corner(start, 0, sill))
        } else {
            window
        });
    }
}

/// From floor to ceiling, with four sides or eight.
fn pillar(rng: &mut Rng, [x, y]: [i32; 2], bottom: i32, top: i32) -> Brush {
    let square = Brush::solid([x - 24, y - 24, bottom], [x + 24, y + 24, top]);
    if rng.one_in(2) { square } else { eight_sided(square, [x, y], 24) }
}

/// An upright brush round a middle without its four edges.
fn eight_sided(brush: Brush, [x, y]: [i32; 2], half: i32) -> Brush {
    let corners = [[1, 1], [-1, 1], [1, -1], [-1, -1]];
    corners.iter().fold(brush, |b, &[sx, sy]| b.cut([sx, sy, 0], [x + sx * half, y + sy * (half / 2 - 2), 0]))
}
