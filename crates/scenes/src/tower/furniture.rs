//! Furniture as closed meshes: desks, chairs, tables, shelves, plants and lamps.
//!
//! Sizes are in mesh steps (64 to a unit). `sides` is the level of detail: round parts have at most that many sides,
//! and shelves and plants have parts in proportion.

use super::STEP;
use super::mesh::{Mesh, direction};
use super::walls::CEILING;
use crate::rng::Rng;
use crate::stroke::Rect;

/// Height of desks and tables.
const TOP: i32 = 48;

/// The position of a piece: the middle of its front edge, and whether its front faces larger z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) at: [i32; 2],
    pub(super) towards_z: bool,
}

impl Place {
    /// A point that lies `right` of the middle and `deep` behind the front edge.
    fn point(self, right: i32, deep: i32) -> [i32; 2] {
        let sign = if self.towards_z { 1 } else { -1 };
        [self.at[0] + sign * right, self.at[1] - sign * deep]
    }

    /// A vector, given in the same way.
    fn vector(self, right: i32, deep: i32) -> [i32; 2] {
        let sign = if self.towards_z { 1 } else { -1 };
        [sign * right, -sign * deep]
    }

    /// A box between two depths, widths and heights.
    fn block(self, mesh: &mut Mesh, right: [i32; 2], deep: [i32; 2], heights: [i32; 2]) {
        self.lean(mesh, right, deep, heights, 0);
    }

    /// A box whose top is moved back by `back`.
    fn lean(self, mesh: &mut Mesh, right: [i32; 2], deep: [i32; 2], heights: [i32; 2], back: i32) {
        let (a, b) = (self.point(right[0], deep[0]), self.point(right[1], deep[1]));
        let low = [a[0].min(b[0]), heights[0], a[1].min(b[1])];
        let high = [a[0].max(b[0]), heights[1], a[1].max(b[1])];
        mesh.leaning(low, high, self.vector(0, back));
    }
}

/// A desk of 1.5 by 0.75 units with legs, a drawer box, a screen and a keyboard; the screen is turned
/// to the front.
pub(super) fn desk(place: Place, sides: usize) -> Mesh {
    let mut mesh = Mesh::new(false);
    place.block(&mut mesh, [-48, 48], [0, 48], [TOP - 3, TOP]);
    for (right, deep) in [(-43, 5), (43, 5), (-43, 43), (43, 43)] {
        mesh.turned(place.point(right, deep), sides, &[[3, 0], [3, TOP - 3]]);
    }
    place.block(&mut mesh, [12, 36], [4, 44], [TOP - 27, TOP - 3]);
    mesh.turned(place.point(-12, 34), sides, &[[10, TOP], [8, TOP + 2], [3, TOP + 3], [3, TOP + 10]]);
    place.lean(&mut mesh, [-32, 8], [30, 33], [TOP + 8, TOP + 32], 4);
    place.block(&mut mesh, [-28, 4], [8, 18], [TOP, TOP + 2]);
    mesh
}

/// A chair with slanted legs and a slanted back, half a unit wide; a person on it faces the front.
pub(super) fn chair(place: Place, sides: usize) -> Mesh {
    let mut mesh = Mesh::new(true);
    place.block(&mut mesh, [-15, 15], [0, 28], [26, 30]);
    place.lean(&mut mesh, [-15, 15], [24, 28], [30, 60], 4);
    for (right, deep) in [(-11, 4), (11, 4), (-11, 24), (11, 24)] {
        mesh.turned(place.point(right, deep), sides, &[[4, 0], [3, 26]]);
    }
    for right in [-14, 11] {
        place.block(&mut mesh, [right, right + 3], [2, 24], [40, 42]);
        place.lean(&mut mesh, [right, right + 3], [6, 9], [30, 40], -3);
    }
    mesh
}

/// A table with a rectangular top on two turned feet; layout steps.
pub(super) fn table(rect: Rect, sides: usize) -> Mesh {
    let mut mesh = Mesh::new(false);
    let (z0, z1) = (rect.y0 * STEP, rect.y1 * STEP);
    mesh.cuboid([rect.x0 * STEP, TOP - 4, z0], [rect.x1 * STEP, TOP, z1]);
    for x in [rect.x0 + 6, rect.x1 - 6] {
        let profile = [[24, 0], [24, 2], [10, 6], [8, 20], [10, TOP - 10], [20, TOP - 4]];
        mesh.turned([x * STEP, (z0 + z1) / 2], sides, &profile);
    }
    mesh
}

/// A shelf against a wall at `x`, three quarters of a unit wide and `depth` deep (towards larger x if positive), with
/// books.
pub(super) fn shelf(x: i32, z: i32, depth: i32, sides: usize, rng: &mut Rng) -> Mesh {
    let mut mesh = Mesh::new(true);
    let mut block = |[a, b]: [i32; 2], heights: [i32; 2], [za, zb]: [i32; 2], lean: i32| {
        let (a, b) = (x + a * depth.signum(), x + b * depth.signum());
        mesh.leaning([a.min(b), heights[0], z + za], [a.max(b), heights[1], z + zb], [0, lean]);
    };
    let depth = depth.abs();
    block([0, 1], [0, 122], [0, 48], 0);
    for za in [0, 46] {
        block([1, depth], [0, 122], [za, za + 2], 0);
    }
    let n_books = i32::try_from(sides / 2).expect("a level of detail is small");
    for board in 0..5 {
        let y = 4 + 29 * board;
        block([1, depth], [y, y + 2], [2, 46], 0);
        // Books fill the board from one side; the last leans against its neighbour.
        for i in (0..n_books).filter(|_| board < 4) {
            let (width, height) = (40 / n_books, rng.between(14, 22));
            let lean = if i + 1 == n_books { -rng.between(1, 2) } else { 0 };
            let from = 3 + i * width + lean.abs();
            block([2, depth - rng.between(2, 6)], [y + 2, y + 2 + height], [from, from + width - 1], lean);
        }
    }
    mesh
}

/// A plant in a pot: a trunk and leaves in all directions.
pub(super) fn plant(at: [i32; 2], sides: usize, rng: &mut Rng) -> Mesh {
    let mut mesh = Mesh::new(false);
    mesh.turned(at, sides, &[[9, 0], [10, 2], [13, 26], [14, 26], [14, 30]]);
    mesh.turned(at, sides, &[[4, 30], [3, 60], [3, 84]]);
    for i in 0..sides {
        let turn = 16 / sides * i + rng.below(2);
        let ([dx, dz], y) = (direction(turn, rng.between(10, 14)), rng.between(44, 78));
        mesh.leaning([at[0] - 2, y, at[1] - 2], [at[0] + 2, y + rng.between(8, 20), at[1] + 2], [dx, dz]);
    }
    mesh
}

/// A lamp on a desk, with a slanted arm.
pub(super) fn desk_lamp(place: Place, sides: usize) -> Mesh {
    let mut mesh = Mesh::new(true);
    let foot = place.point(36, 36);
    mesh.turned(foot, sides, &[[7, TOP], [7, TOP + 1], [3, TOP + 3]]);
    let [dx, dz] = place.vector(-8, -6);
    mesh.leaning([foot[0] - 1, TOP + 3, foot[1] - 1], [foot[0] + 1, TOP + 24, foot[1] + 1], [dx, dz]);
    mesh.turned([foot[0] + dx, foot[1] + dz], sides, &[[9, TOP + 20], [8, TOP + 23], [4, TOP + 28], [2, TOP + 29]]);
    mesh
}

/// A lamp that hangs from the ceiling.
pub(super) fn ceiling_lamp(at: [i32; 2], sides: usize) -> Mesh {
    let mut mesh = Mesh::new(false);
    let top = CEILING * STEP;
    mesh.turned(at, sides, &[[2, top - 24], [2, top - 2], [6, top - 2], [6, top]]);
    let shade = [[10, top - 40], [20, top - 40], [19, top - 34], [14, top - 28], [6, top - 24], [4, top - 23]];
    mesh.turned(at, sides, &shade);
    mesh
}
