//! The furniture of each room of a tower.

use super::STEP;
use super::furniture::{Place, ceiling_lamp, chair, desk, desk_lamp, plant, shelf, table};
use super::mesh::Mesh;
use crate::layout::{Layout, Piece, PieceKind, Room};
use crate::rng::Rng;
use crate::stroke::Rect;
use std::collections::BTreeMap;

/// The furniture of a room while it is placed.
#[derive(Debug)]
struct Furniture {
    sides: usize,
    rng: Rng,
    counts: BTreeMap<&'static str, usize>,
    meshes: Vec<(String, Mesh)>,
}

/// Meshes, and names without the room's, for room `room` of `floor`; `half` is half the thickness of its walls in layout steps.
pub(super) fn furnish(floor: &Layout, room: usize, half: i32, sides: usize, rng: Rng) -> Vec<(String, Mesh)> {
    let mut furniture = Furniture { sides, rng, counts: BTreeMap::new(), meshes: Vec::new() };
    let the_room = &floor.rooms[room];
    for piece in floor.pieces.iter().filter(|p| p.room == room) {
        match piece.kind {
            PieceKind::Desk => furniture.work_place(piece, the_room),
            PieceKind::Table => furniture.meeting(piece),
        }
    }
    furniture.corner(the_room, half);
    furniture.lamps(the_room);
    furniture.meshes
}

impl Furniture {
    /// Random numbers for the shape of one piece: how many are drawn depends on the level of detail, and must not
    /// affect the other furniture of the room.
    fn own_rng(&mut self) -> Rng {
        Rng::new(self.rng.next(), 0)
    }

    fn add(&mut self, kind: &'static str, mesh: Mesh) {
        let count = self.counts.entry(kind).or_default();
        self.meshes.push((format!("{kind}_{count}"), mesh));
        *count += 1;
    }

    /// A desk with its back to the wall, a chair in front of it, now and then a lamp on it.
    fn work_place(&mut self, piece: &Piece, room: &Room) {
        let r = piece.rect;
        let towards_z = room.corridor_above;
        let middle = (r.x0 + r.x1) * STEP / 2;
        let place = Place { at: [middle, STEP * if towards_z { r.y1 } else { r.y0 }], towards_z };
        self.add("desk", desk(place, self.sides));
        // The chair faces the desk, slightly to one side.
        let gap = if towards_z { 4 } else { -4 };
        let seat = Place { at: [middle + self.rng.between(-8, 8), place.at[1] + gap], towards_z: !towards_z };
        self.add("chair", chair(seat, self.sides));
        if self.rng.one_in(2) {
            self.add("desk_lamp", desk_lamp(place, self.sides));
        }
    }

    /// A table with three chairs on each long side.
    fn meeting(&mut self, piece: &Piece) {
        let r = piece.rect;
        self.add("table", table(r, self.sides));
        for i in 0..3 {
            let x = (r.x0 + 5 + 9 * i) * STEP;
            self.add("chair", chair(Place { at: [x, r.y0 * STEP - 4], towards_z: true }, self.sides));
            self.add("chair", chair(Place { at: [x, r.y1 * STEP + 4], towards_z: false }, self.sides));
        }
    }

    /// In the front corner away from the door: a shelf on the side wall, and a plant beside it.
    fn corner(&mut self, room: &Room, half: i32) {
        let Rect { x0, y0, x1, y1 } = room.rect;
        let Some([lo, hi]) = room.door else { return self.plants_of_open_area(room) };
        let z = if room.corridor_above { y1 - half - 7 } else { y0 + half + 1 };
        let at_low_x = lo + hi > x0 + x1;
        let (wall, depth) = if at_low_x { (x0 + half, 20) } else { (x1 - half, -20) };
        let mesh = shelf(wall * STEP, z * STEP, depth, self.sides, &mut self.own_rng());
        self.add("shelf", mesh);
        if self.rng.one_in(2) {
            let x = wall * STEP + if depth > 0 { 18 } else { -18 };
            let beside = if room.corridor_above { z * STEP - 18 } else { (z + 6) * STEP + 18 };
            let mesh = plant([x, beside], self.sides, &mut self.own_rng());
            self.add("plant", mesh);
        }
    }

    /// A plant in each corner.
    fn plants_of_open_area(&mut self, room: &Room) {
        let Rect { x0, y0, x1, y1 } = room.rect;
        for [x, z] in [[x0 + 5, y0 + 5], [x1 - 5, y0 + 5], [x0 + 5, y1 - 5], [x1 - 5, y1 - 5]] {
            let mesh = plant([x * STEP, z * STEP], self.sides, &mut self.own_rng());
            self.add("plant", mesh);
        }
    }

    /// A lamp for every four units of width, in the middle of each part.
    fn lamps(&mut self, room: &Room) {
        let Rect { x0, y0, x1, y1 } = room.rect;
        let n = ((x1 - x0) / 32).max(1);
        for i in 0..n {
            let x = (x0 * (2 * n - 2 * i - 1) + x1 * (2 * i + 1)) * STEP / (2 * n);
            self.add("lamp", ceiling_lamp([x, (y0 + y1) / 2 * STEP], self.sides));
        }
    }
}
