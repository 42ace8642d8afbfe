//! Doom-like maps: rooms of many shapes on integer coordinates, passages, stairs, windows, pillars, platforms; every
//! line has the sectors on both of its sides.
//!
//! Rooms lie in square slots of side 512 with wide margins, passages only in the margins between two slots, pillars and
//! platforms only in the middle of a room: therefore nothing ever crosses.

use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use crate::spanning::Passages;
use sightlines_cells::{Plan, PlanLine};
use sightlines_geometry::Point2;
use std::collections::BTreeMap;

/// A line of a [`DoomLike`] map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DoomLikeLine {
    /// Index of the start vertex.
    pub start: u16,
    /// Index of the end vertex.
    pub end: u16,
    /// Sector on the right, going from start to end.
    pub right: u16,
    /// Sector on the left; a line without one is a wall.
    pub left: Option<u16>,
}

/// A generated map in the terms of a Doom map: the content of its vertices, lines and sectors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoomLike {
    /// Distinct points.
    pub vertices: Vec<[i16; 2]>,
    /// Lines between them; they meet in shared vertices only.
    pub lines: Vec<DoomLikeLine>,
    /// One more than the largest sector; every sector has a closed ring of sides.
    pub n_sectors: u16,
}

impl DoomLike {
    /// A map of `size` times `size` rooms, centred on the origin.
    ///
    /// # Errors
    /// [`GenerateError::OutOfRange`] unless `size` is from 1 to 40, so that all indices fit a Doom map.
    pub fn generate(seed: u64, size: u32) -> Result<Self, GenerateError> {
        check_range("size", size, 1, 40)?;
        let mut builder = Builder::new(seed, size as usize);
        builder.build();
        Ok(builder.map)
    }

    /// The same map as a plan: a line without a left sector is opaque, sectors are groups.
    pub fn plan(&self) -> Plan {
        let point = |v: u16| {
            let [x, y] = self.vertices[usize::from(v)];
            Point2::new(f64::from(x), f64::from(y))
        };
        let lines = self.lines.iter().map(|l| PlanLine {
            a: point(l.start),
            b: point(l.end),
            opaque: l.left.is_none(),
            left: l.left.map(u32::from),
            right: Some(u32::from(l.right)),
        });
        Plan::new(lines.collect(), Vec::new()).expect("lines between distinct 16-bit vertices make a plan")
    }
}

/// The plan of [`DoomLike::generate`]: non-axial, groups on both sides of every open line.
///
/// # Errors
/// As [`DoomLike::generate`].
pub fn doom_like(seed: u64, size: u32) -> Result<Plan, GenerateError> {
    DoomLike::generate(seed, size).map(|map| map.plan())
}

/// Side of a slot in map units.
const SLOT: i32 = 512;

/// The sides of a room.
const SOUTH: usize = 0;
const EAST: usize = 1;
const NORTH: usize = 2;
const WEST: usize = 3;

type Corner = [i32; 2];

/// A hole in the side of a room: its two ends, in the order of ascending coordinates, and the sector
/// beyond it.
#[derive(Debug, Clone, Copy)]
struct Opening {
    ends: [Corner; 2],
    beyond: u16,
}

#[derive(Debug, Clone)]
struct Room {
    /// South-west, south-east, north-east, north-west.
    corners: [Corner; 4],
    sides: [Vec<Opening>; 4],
}

impl Room {
    /// The side's corners in the order of ascending coordinates.
    fn side(&self, side: usize) -> [Corner; 2] {
        let c = &self.corners;
        [[c[0], c[1]], [c[1], c[2]], [c[3], c[2]], [c[0], c[3]]][side]
    }

    /// The two points at `sixteenths` of a side.
    fn ends(&self, side: usize, sixteenths: [i32; 2]) -> [Corner; 2] {
        let [a, b] = self.side(side);
        sixteenths.map(|k| between(a, b, k, 16))
    }
}

/// The point at `k / n` of the way, rounded down.
fn between(a: Corner, b: Corner, k: i32, n: i32) -> Corner {
    [0, 1].map(|i| a[i] + ((b[i] - a[i]) * k).div_euclid(n))
}

#[derive(Debug)]
struct Builder {
    rng: Rng,
    size: usize,
    rooms: Vec<Room>,
    index: BTreeMap<[i16; 2], u16>,
    map: DoomLike,
}

impl Builder {
    fn new(seed: u64, size: usize) -> Self {
        let map = DoomLike { vertices: Vec::new(), lines: Vec::new(), n_sectors: 0 };
        Self { rng: Rng::new(seed, 4), size, rooms: Vec::new(), index: BTreeMap::new(), map }
    }

    fn build(&mut self) {
        self.place_rooms();
        self.join_rooms();
        for room in 0..self.rooms.len() {
            let sector = u16::try_from(room).expect("at most 1600 rooms");
            self.draw_ring(room, sector);
            self.fill(room, sector);
        }
    }

    /// A quadrilateral in every slot, at least 64 - 16 from the slot's border; half of them upright.
    fn place_rooms(&mut self) {
        let half = i32::try_from(self.size).expect("at most 40") * SLOT / 2;
        for slot in 0..self.size * self.size {
            let place = |i: usize| i32::try_from(i).expect("at most 40") * SLOT - half;
            let (x, y) = (place(slot % self.size), place(slot / self.size));
            let mut margin = || 8 * self.rng.between(8, 16);
            let (x0, x1, y0, y1) = (x + margin(), x + SLOT - margin(), y + margin(), y + SLOT - margin());
            let tilt = if self.rng.one_in(2) { 16 } else { 0 };
            let mut moved = |x, y| [x + self.rng.between(-tilt, tilt), y + self.rng.between(-tilt, tilt)];
            let corners = [moved(x0, y0), moved(x1, y0), moved(x1, y1), moved(x0, y1)];
            self.rooms.push(Room { corners, sides: Default::default() });
        }
        self.map.n_sectors = u16::try_from(self.rooms.len()).expect("at most 1600 rooms");
    }

    fn join_rooms(&mut self) {
        let doors = Passages::random(&mut self.rng, self.size, self.size, 4);
        for y in 0..self.size {
            for x in 0..self.size {
                let room = y * self.size + x;
                if x + 1 < self.size {
                    self.join(room, room + 1, [EAST, WEST], doors.east(x, y));
                }
                if y + 1 < self.size {
                    self.join(room, room + self.size, [NORTH, SOUTH], doors.north(x, y));
                }
            }
        }
    }

    /// A passage (in the lower half of both sides), a window (in the upper half), both or none.
    fn join(&mut self, a: usize, b: usize, sides: [usize; 2], door: bool) {
        if door {
            let width = [self.rng.between(3, 5), self.rng.between(6, 7)];
            // Two in five passages are stairs of three to six steps.
            let steps = if self.rng.below(5) < 2 { self.rng.between(3, 6) } else { 1 };
            self.passage([a, b], sides, width, steps);
        }
        if self.rng.one_in(4) {
            self.passage([a, b], sides, [11, 12], 1);
        }
    }

    /// A row of `steps` sectors between two rooms, between the given sixteenths of their sides.
    fn passage(&mut self, rooms: [usize; 2], sides: [usize; 2], width: [i32; 2], steps: i32) {
        let first = self.map.n_sectors;
        self.map.n_sectors += u16::try_from(steps).expect("at most 6");
        let last = self.map.n_sectors - 1;
        let from = self.rooms[rooms[0]].ends(sides[0], width);
        let to = self.rooms[rooms[1]].ends(sides[1], width);
        self.rooms[rooms[0]].sides[sides[0]].push(Opening { ends: from, beyond: first });
        self.rooms[rooms[1]].sides[sides[1]].push(Opening { ends: to, beyond: last });
        // Going east, ascending ends have the passage on the left of the lower wall; going north, on
        // the right of it.
        let east = sides[0] == EAST;
        for (step, sector) in (0..steps).zip(first..) {
            let at = |end: usize, k: i32| between(from[end], to[end], k, steps);
            let [low, high] = [0, 1].map(|end| [at(end, step), at(end, step + 1)]);
            let (right_wall, left_wall) = if east { (low, high) } else { (high, low) };
            self.line(right_wall[1], right_wall[0], sector, None);
            self.line(left_wall[0], left_wall[1], sector, None);
            if step > 0 {
                let (a, b) = if east { (low[0], high[0]) } else { (high[0], low[0]) };
                self.line(a, b, sector, Some(sector - 1));
            }
        }
    }

    /// The boundary of a room, counter-clockwise: the room is on the left.
    fn draw_ring(&mut self, room: usize, sector: u16) {
        // Each point with the sector beyond the edge that leaves it.
        let mut ring: Vec<(Corner, Option<u16>)> = Vec::new();
        for side in [SOUTH, EAST, NORTH, WEST] {
            let mut openings = self.rooms[room].sides[side].clone();
            let ascending = side == SOUTH || side == EAST;
            if !ascending {
                openings.reverse();
                openings.iter_mut().for_each(|o| o.ends.reverse());
            }
            ring.extend(self.corner(room, side).into_iter().map(|c| (c, None)));
            for o in openings {
                ring.extend([(o.ends[0], Some(o.beyond)), (o.ends[1], None)]);
            }
        }
        for (i, &(a, beyond)) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()].0;
            match beyond {
                // In the other direction, the room is on the right.
                None => self.line(b, a, sector, None),
                Some(other) => self.line(a, b, other, Some(sector)),
            }
        }
    }

    /// The corner where `side` begins, counter-clockwise: whole, cut off, or notched inwards.
    fn corner(&mut self, room: usize, side: usize) -> Vec<Corner> {
        let c = self.rooms[room].corners;
        let (before, here, after) = (c[(side + 3) % 4], c[side], c[(side + 1) % 4]);
        // At most 3/16 of a side are used, and openings begin beyond that.
        let cut = self.rng.between(1, 2);
        let (p, q) = (between(here, before, cut, 16), between(here, after, cut, 16));
        match self.rng.below(4) {
            0 => vec![p, q],
            1 => vec![p, [p[0] + q[0] - here[0], p[1] + q[1] - here[1]], q],
            _ => vec![here],
        }
    }

    /// Nothing, pillars, or a platform in the middle of a room.
    fn fill(&mut self, room: usize, sector: u16) {
        let half = i32::try_from(self.size).expect("at most 40") * SLOT / 2;
        let place = |i: usize| i32::try_from(i).expect("at most 40") * SLOT - half + SLOT / 2;
        let middle = [place(room % self.size), place(room / self.size)];
        match self.rng.below(4) {
            0 => {
                for (dx, dy) in [(-40, -40), (40, -40), (40, 40), (-40, 40)] {
                    if !self.rng.one_in(3) {
                        self.inner_square([middle[0] + dx, middle[1] + dy], 16, sector, None);
                    }
                }
            }
            1 => {
                let platform = self.map.n_sectors;
                self.map.n_sectors += 1;
                self.inner_square(middle, 48, sector, Some(platform));
                if self.rng.one_in(2) {
                    // The platform's sides are 24 / sqrt(2) or more from its middle, the pillar ends
                    // at sqrt(12^2 + 6^2) or less.
                    self.inner_square(middle, 12, platform, None);
                }
            }
            _ => {}
        }
    }

    /// A turned square with half a diagonal of up to `reach`; no sector inside makes it a pillar.
    fn inner_square(&mut self, [x, y]: Corner, reach: i32, outside: u16, inside: Option<u16>) {
        let (a, b) = (self.rng.between(reach / 2, reach), self.rng.between(0, reach / 2));
        let corners = [[x + a, y + b], [x - b, y + a], [x - a, y - b], [x + b, y - a]];
        for i in 0..4 {
            // Counter-clockwise: the inside is on the left, the outside on the right.
            self.line(corners[i], corners[(i + 1) % 4], outside, inside);
        }
    }

    fn line(&mut self, a: Corner, b: Corner, right: u16, left: Option<u16>) {
        let (start, end) = (self.vertex(a), self.vertex(b));
        self.map.lines.push(DoomLikeLine { start, end, right, left });
    }

    fn vertex(&mut self, p: Corner) -> u16 {
        let p = p.map(|x| i16::try_from(x).expect("40 slots of 512 around the origin fit 16 bits"));
        let next = u16::try_from(self.map.vertices.len()).expect("at most 40 vertices for each of 1600 rooms");
        *self.index.entry(p).or_insert_with(|| {
            self.map.vertices.push(p);
            next
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{checksum, crossings};
    use proptest::prelude::*;

    #[test]
    fn doom_like_is_deterministic() {
        let plan = doom_like(1, 5).unwrap();
        assert_eq!(checksum(&plan), PINNED);
        assert_eq!(doom_like(1, 5).unwrap(), plan);
        assert_ne!(doom_like(2, 5).unwrap(), plan);
        assert!(!plan.is_axial() && plan.small_grid().is_some());
    }

    const PINNED: u64 = 11836011089471673866;

    /// Around every sector, sides lead into a vertex as often as out of it: all rings are closed.
    fn unclosed_sectors(map: &DoomLike) -> usize {
        let mut balance: BTreeMap<(u16, u16), i32> = BTreeMap::new();
        for l in &map.lines {
            let sides = [Some((l.right, 1)), l.left.map(|s| (s, -1))];
            for (sector, sign) in sides.into_iter().flatten() {
                *balance.entry((sector, l.start)).or_default() += sign;
                *balance.entry((sector, l.end)).or_default() -= sign;
            }
        }
        let mut bad: Vec<u16> = balance.iter().filter(|(_, b)| **b != 0).map(|((s, _), _)| *s).collect();
        bad.dedup();
        bad.len()
    }

    /// Twice the area that the sides of each sector go round; positive means sides that face inwards.
    fn areas(map: &DoomLike) -> Vec<i64> {
        let mut area = vec![0i64; usize::from(map.n_sectors)];
        for l in &map.lines {
            let [p, q] = [l.start, l.end].map(|v| map.vertices[usize::from(v)].map(i64::from));
            let cross = p[0] * q[1] - p[1] * q[0];
            area[usize::from(l.right)] -= cross;
            l.left.into_iter().for_each(|s| area[usize::from(s)] += cross);
        }
        area
    }

    proptest! {
        #[test]
        fn doom_like_is_well_formed(seed in any::<u64>(), size in 1u32..6) {
            let map = DoomLike::generate(seed, size).unwrap();
            prop_assert_eq!(unclosed_sectors(&map), 0);
            prop_assert!(areas(&map).iter().all(|&a| a > 0), "{:?}", areas(&map));
            prop_assert_eq!(crossings(&map.plan()), 0);
            prop_assert_eq!(map.plan().n_groups(), u32::from(map.n_sectors));
        }
    }

    /// The impostor: the checks above detect one wrong side.
    #[test]
    fn doom_like_checks_can_fail() {
        let mut map = DoomLike::generate(1, 3).unwrap();
        let line = map.lines.iter().position(|l| l.left.is_some()).unwrap();
        map.lines[line].left = Some(map.lines[line].right);
        assert!(unclosed_sectors(&map) > 0);
        let mut map = DoomLike::generate(1, 1).unwrap();
        map.lines.iter_mut().for_each(|l| std::mem::swap(&mut l.start, &mut l.end));
        assert!(areas(&map)[0] < 0);
    }

    #[test]
    fn doom_like_has_stairs_windows_pillars_and_platforms() {
        let map = DoomLike::generate(3, 12).unwrap();
        let n_rooms = 144;
        assert!(map.n_sectors > 2 * n_rooms);
        let walls = map.lines.iter().filter(|l| l.left.is_none()).count();
        assert!(walls > map.lines.len() / 2 && walls < map.lines.len() * 9 / 10, "{walls} of {}", map.lines.len());
        assert!(map.lines.iter().any(|l| l.right < n_rooms && l.left.is_some_and(|s| s >= n_rooms)));
    }

    #[test]
    fn doom_like_sizes_scale_and_are_checked() {
        let lines = |size| doom_like(1, size).unwrap().lines().len();
        assert!(lines(10) > 3 * lines(5));
        assert!(lines(1) >= 4);
        for seed in 0..3 {
            assert!(DoomLike::generate(seed, 40).unwrap().vertices.len() < 65_536);
        }
        assert_eq!(doom_like(1, 41).unwrap_err().to_string(), "size is 41, but must be from 1 to 40");
        assert!(DoomLike::generate(1, 0).is_err());
    }
}
