//! Office floors: corridors, rooms of many sizes, meeting rooms, open-plan areas with pillars, desks.
//!
//! Everything is laid out on a grid of eighths of a unit (a unit is a metre). Rows of rooms lie in
//! pairs, back to back, with a corridor along the front of each; corridors across cut the rows into
//! blocks.

use crate::error::{SceneError, check_range};
use crate::rng::Rng;
use crate::stroke::{Rect, Stroke, merge, outline};
use sightlines_cells::{Plan, PlanLine, PlanObject};
use sightlines_geometry::Aabb;

/// What office to generate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfficeOptions {
    /// Every choice follows from it.
    pub seed: u64,
    /// Room places side by side in a row, from 1 to 128; some rooms take two places.
    pub rooms_x: u32,
    /// Rows of rooms, from 1 to 128.
    pub rooms_y: u32,
    /// Room places between two corridors that run across the rows, from 1 to 128.
    pub block: u32,
    /// Thickness of walls in units: 0 (a wall is a line), 0.25 or 0.5. Doors get narrower by it.
    pub wall_thickness: f64,
    /// Whether desks and tables are set up, as objects.
    pub furniture: bool,
}

impl Default for OfficeOptions {
    /// About 80 rooms with thin walls and furniture.
    fn default() -> Self {
        Self { seed: 1, rooms_x: 18, rooms_y: 6, block: 6, wall_thickness: 0.0, furniture: true }
    }
}

/// Grid steps per unit.
const STEPS: u32 = 8;
/// Width of corridors: 2 units.
const CORRIDOR: i32 = 16;
/// Width of doors: 1 unit.
const DOOR: i32 = 8;
/// Mean width of a room place: 4 units.
const PLACE: i32 = 32;
/// The dividing wall between two places is moved by up to this, so a room is at least 20 steps wide.
const JITTER: i32 = 6;

/// An office floor in metres with corner (0, 0), walls moved outwards by half their thickness. Axial,
/// coordinates are multiples of 1/8, the outer wall is closed, every room has a door to a corridor.
///
/// # Errors
/// [`SceneError`] for a count out of its range or an unknown thickness.
pub fn office(options: OfficeOptions) -> Result<Plan, SceneError> {
    let half = check(&options)?;
    let mut floor = Floor::new(&options);
    floor.build();
    let strokes = if half == 0 {
        merge(floor.strokes)
    } else {
        outline(&floor.strokes.iter().map(|s| s.thick(half)).collect::<Vec<_>>())
    };
    let lines: Vec<PlanLine> = strokes.into_iter().map(|s| s.wall(STEPS)).collect();
    let objects = if options.furniture { floor.objects } else { Vec::new() };
    Ok(Plan::new(lines, objects).expect("walls on a grid of eighths make a plan"))
}

/// Half the wall thickness in grid steps.
fn check(options: &OfficeOptions) -> Result<i32, SceneError> {
    check_range("rooms_x", options.rooms_x, 1, 128)?;
    check_range("rooms_y", options.rooms_y, 1, 128)?;
    check_range("block", options.block, 1, 128)?;
    [0.0, 0.25, 0.5]
        .iter()
        .zip(0..)
        .find_map(|(&t, half)| (t == options.wall_thickness).then_some(half))
        .ok_or(SceneError::WallThickness(options.wall_thickness))
}

/// One row of rooms.
#[derive(Debug, Clone, Copy)]
struct Row {
    y0: i32,
    y1: i32,
    /// Whether its corridor runs along `y1` (otherwise along `y0`).
    corridor_above: bool,
}

/// The floor while it is built.
#[derive(Debug)]
struct Floor {
    rng: Rng,
    /// Left side, right side and number of room places.
    blocks: Vec<(i32, i32, i32)>,
    rows: Vec<Row>,
    outer: Rect,
    strokes: Vec<Stroke>,
    objects: Vec<PlanObject>,
    n_rooms: usize,
}

impl Floor {
    fn new(options: &OfficeOptions) -> Self {
        let mut rng = Rng::new(options.seed, 3);
        let mut blocks = Vec::new();
        let (mut x, mut left) = (0, options.rooms_x);
        while left > 0 {
            // The last two blocks share what is left evenly.
            let n = if left <= options.block { left } else { options.block.min(left.div_ceil(2)) };
            blocks.push((x, x + n.cast_signed() * PLACE, n.cast_signed()));
            x += n.cast_signed() * PLACE + CORRIDOR;
            left -= n;
        }
        let (mut y, mut rows) = (0, Vec::new());
        for row in 0..options.rooms_y {
            let corridor_above = row % 2 == 0;
            let depth = 4 * rng.between(9, 13);
            rows.push(Row { y0: y, y1: y + depth, corridor_above });
            y += depth + if corridor_above { CORRIDOR } else { 0 };
        }
        let outer = Rect { x0: 0, y0: 0, x1: x - CORRIDOR, y1: y };
        Self { rng, blocks, rows, outer, strokes: Vec::new(), objects: Vec::new(), n_rooms: 0 }
    }

    fn build(&mut self) {
        self.strokes.extend(Stroke::sides(self.outer));
        let open = self.choose_open_areas();
        for b in 0..self.blocks.len() {
            let mut r = 0;
            while r < self.rows.len() {
                if open.contains(&(b, r)) {
                    self.open_plan(b, r);
                    r += 2;
                } else {
                    self.rooms(b, r);
                    r += 1;
                }
            }
        }
    }

    /// One in eight of the places that can be an open-plan area: two rows that lie back to back, in a
    /// block of more than one room. Given by block and lower row.
    fn choose_open_areas(&mut self) -> Vec<(usize, usize)> {
        let rows = (1..self.rows.len().saturating_sub(1)).step_by(2);
        let blocks = (0..self.blocks.len()).filter(|&b| self.blocks[b].2 > 1);
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
    fn rooms(&mut self, b: usize, r: usize) {
        let ((x0, x1, places), Row { y0, y1, corridor_above }) = (self.blocks[b], self.rows[r]);
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
            self.furnish(Rect { x0: room[0], y0, x1: room[1], y1 }, corridor_above);
        }
        self.strokes.extend(Stroke::along_x(front, x0, x1).without(&doors));
        self.strokes.push(Stroke::along_x(back, x0, x1));
        for &x in &cuts {
            let between = x != x0 && x != x1 && self.rng.one_in(8);
            let door = (y0 + y1) / 2;
            let gaps: &[[i32; 2]] = if between { &[[door, door + DOOR]] } else { &[] };
            self.strokes.extend(Stroke::along_y(x, y0, y1).without(gaps));
        }
    }

    /// Desks along the back wall, or a table in the middle of a meeting room.
    fn furnish(&mut self, room: Rect, corridor_above: bool) {
        self.n_rooms += 1;
        if room.x1 - room.x0 > PLACE + 2 * JITTER {
            let (x, y) = ((room.x0 + room.x1) / 2, (room.y0 + room.y1) / 2);
            self.object("table", Rect { x0: x - 14, y0: y - 5, x1: x + 14, y1: y + 5 });
            return;
        }
        let n = (room.x1 - room.x0 - 4) / 16;
        let y = if corridor_above { room.y0 + 4 } else { room.y1 - 10 };
        for i in 0..n {
            let x = room.x0 + 3 + 16 * i;
            self.object("desk", Rect { x0: x, y0: y, x1: x + 12, y1: y + 6 });
        }
    }

    /// One large area instead of rows `r` and `r + 1` of block `b`: wide openings, pillars, many desks.
    fn open_plan(&mut self, b: usize, r: usize) {
        let ((x0, x1, places), (y0, y1)) = (self.blocks[b], (self.rows[r].y0, self.rows[r + 1].y1));
        self.n_rooms += 1;
        let openings: Vec<[i32; 2]> =
            (0..places).step_by(2).map(|i| x0 + i * PLACE + 4).map(|x| [x, x + 3 * DOOR]).collect();
        for y in [y0, y1] {
            self.strokes.extend(Stroke::along_x(y, x0, x1).without(&openings));
        }
        let middle = (y0 + y1) / 2;
        for x in [x0, x1] {
            let at_outer_wall = x == self.outer.x0 || x == self.outer.x1;
            let gap = [[middle - DOOR, middle + DOOR]];
            self.strokes.extend(Stroke::along_y(x, y0, y1).without(if at_outer_wall { &[] } else { &gap }));
        }
        let desk_rows = (y1 - y0 - 16) / 20;
        for i in 0..places {
            let x = x0 + i * PLACE;
            if i > 0 {
                for y in [(3 * y0 + y1) / 4, (y0 + 3 * y1) / 4] {
                    self.strokes.extend(Stroke::sides(Rect { x0: x - 2, y0: y - 2, x1: x + 2, y1: y + 2 }));
                }
            }
            for j in 0..desk_rows {
                let y = y0 + 10 + 20 * j;
                self.object("desk", Rect { x0: x + 10, y0: y, x1: x + 22, y1: y + 6 });
            }
        }
    }

    fn object(&mut self, kind: &str, r: Rect) {
        let unit = |x: i32| f64::from(x) / f64::from(STEPS);
        let bounds = Aabb { min: [unit(r.x0), unit(r.y0)], max: [unit(r.x1), unit(r.y1)] };
        self.objects.push(PlanObject { name: format!("{kind}-{}", self.objects.len()), bounds });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{checksum, outer_boundary_is_closed};

    fn thick(seed: u64) -> OfficeOptions {
        OfficeOptions { seed, wall_thickness: 0.25, ..OfficeOptions::default() }
    }

    #[test]
    fn office_is_deterministic_closed_and_axial() {
        let plans = [office(OfficeOptions::default()).unwrap(), office(thick(2)).unwrap()];
        assert_eq!(plans.each_ref().map(checksum), PINNED);
        for plan in &plans {
            assert!(plan.is_axial() && outer_boundary_is_closed(plan));
            assert!(plan.points().all(|p| (p * 8.0).fract() == glam::DVec2::ZERO));
        }
        assert_ne!(office(OfficeOptions { seed: 9, ..Default::default() }).unwrap(), plans[0]);
    }

    const PINNED: [u64; 2] = [12329706014378933290, 10390705085092429357];

    #[test]
    fn office_default_has_the_rooms_of_a_demo() {
        for seed in 0..50 {
            let mut floor = Floor::new(&OfficeOptions { seed, ..Default::default() });
            floor.build();
            assert!((60..=100).contains(&floor.n_rooms), "{} rooms from seed {seed}", floor.n_rooms);
        }
    }

    /// Flood over squares of one grid step: all free space inside is one piece, so every room has a
    /// door, and the outside is another.
    fn free_pieces(options: &OfficeOptions) -> usize {
        let half = check(options).unwrap();
        let mut floor = Floor::new(options);
        floor.build();
        // Twice as fine, so that thin walls take squares too.
        let (w, h) = ((2 * floor.outer.x1 + 17) as usize, (2 * floor.outer.y1 + 17) as usize);
        let mut wall = vec![false; w * h];
        for s in &floor.strokes {
            let r = s.thick(half);
            for y in 2 * r.y0 + 8..=2 * r.y1 + 8 {
                let row = y as usize * w;
                wall[row + (2 * r.x0 + 8) as usize..=row + (2 * r.x1 + 8) as usize].fill(true);
            }
        }
        // Pillars are hollow in a plan of thin walls: their small insides are not counted.
        let mut pieces = 0;
        for start in 0..w * h {
            if wall[start] {
                continue;
            }
            let (mut stack, mut size) = (vec![start], 0);
            wall[start] = true;
            while let Some(c) = stack.pop() {
                size += 1;
                let beside = [(c % w > 0, c.wrapping_sub(1)), (c % w + 1 < w, c + 1)];
                let above = [(c >= w, c.wrapping_sub(w)), (c + w < w * h, c + w)];
                for (_, n) in beside.into_iter().chain(above).filter(|&(inside, _)| inside) {
                    if !std::mem::replace(&mut wall[n], true) {
                        stack.push(n);
                    }
                }
            }
            pieces += usize::from(size > 100);
        }
        pieces
    }

    #[test]
    fn office_rooms_are_all_connected() {
        for seed in 0..5 {
            assert_eq!(free_pieces(&OfficeOptions { seed, ..Default::default() }), 2, "seed {seed}");
            assert_eq!(free_pieces(&thick(seed)), 2, "seed {seed}, thick walls");
        }
        let odd = OfficeOptions { rooms_x: 3, rooms_y: 1, block: 1, wall_thickness: 0.5, ..Default::default() };
        assert_eq!(free_pieces(&odd), 2);
    }

    #[test]
    fn office_sizes_scale() {
        let at = |rooms_x, rooms_y| office(OfficeOptions { rooms_x, rooms_y, ..Default::default() }).unwrap();
        assert!(at(32, 12).lines().len() > 2 * at(16, 6).lines().len());
        assert!(at(1, 1).lines().len() >= 5 && outer_boundary_is_closed(&at(1, 1)));
        assert!(outer_boundary_is_closed(&at(128, 128)));
        let plan = at(18, 6);
        let b = plan.bounds();
        assert!(plan.objects().len() > 60);
        assert!(plan.objects().iter().all(|o| b.contains(o.bounds.min) && b.contains(o.bounds.max)));
        let bare = office(OfficeOptions { furniture: false, ..Default::default() }).unwrap();
        assert!(bare.objects().is_empty() && bare.lines() == plan.lines());
    }

    #[test]
    fn office_options_are_checked() {
        let bad = |o: OfficeOptions| office(o).unwrap_err().to_string();
        let d = OfficeOptions::default();
        assert_eq!(bad(OfficeOptions { rooms_x: 0, ..d }), "rooms_x is 0, but must be from 1 to 128");
        assert_eq!(bad(OfficeOptions { rooms_y: 129, ..d }), "rooms_y is 129, but must be from 1 to 128");
        assert_eq!(bad(OfficeOptions { block: 0, ..d }), "block is 0, but must be from 1 to 128");
        let message = "wall thickness NaN is not one of 0, 0.25 and 0.5";
        assert_eq!(bad(OfficeOptions { wall_thickness: f64::NAN, ..d }), message);
    }
}
