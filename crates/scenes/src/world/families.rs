//! Small worlds of hard cases: portals in a long row, portals that only touch, extremely thin portals, paths around a
//! pillar, winding stairs, disconnected parts.

use super::brushes::{Brush, world_of_brushes};
use super::plane::WorldPlane;
use super::{BspWorldOptions, World, bsp_world};
use crate::error::{GenerateError, check_range};

/// Length of a box of a row, in scene units.
const LENGTH: i32 = 32;

/// Boxes in a row along the first axis; portal `k` (from 0), at `x = 32 k`, has `y` from `bend_y k²` to
/// `bend_y k² + width`, and `z` alike. Box `k` lies before portal `k`; there is one more behind the last.
///
/// The answer is known: boxes `i < j` are joined by the portals `i..j`. The first and the last of these are `m = j - i
/// - 1` apart, and the best line for all of them deviates from a parabola by `bend ⌊m² / 4⌋`. So the boxes see each
/// other if and only if that is below `width` for both bends; if it is equal, lines graze ([`corridor_sees`]).
///
/// # Errors
/// [`GenerateError::OutOfRange`] unless there are 1 to 200 portals, bends up to 16 and a width from 1 to 1024.
pub fn corridor(n_portals: u32, bends: [u32; 2], width: u32) -> Result<World, GenerateError> {
    let n = check_range("n_portals", n_portals, 1, 200)?.cast_signed();
    check_range("bends", bends[0].max(bends[1]), 0, 16)?;
    let width = check_range("width", width, 1, 1024)?.cast_signed();
    let bends = bends.map(u32::cast_signed);
    let low = |k: i32| bends.map(|bend| bend * k * k);
    let boxes: Vec<Brush> = (0..=n)
        .map(|k| {
            let (from, to) = (low((k - 1).max(0)), low(k.min(n - 1)));
            Brush::empty([(k - 1) * LENGTH, from[0], from[1]], [k * LENGTH, to[0] + width, to[1] + width])
        })
        .collect();
    let high = low(n - 1).map(|x| x + width + 8);
    Ok(world_of_brushes([-LENGTH - 8, -8, -8], [n * LENGTH + 8, high[0], high[1]], &boxes))
}

/// Whether boxes `i` and `j` of a [`corridor`] see each other through an open set of lines.
pub fn corridor_sees(bends: [u32; 2], width: u32, [i, j]: [u32; 2]) -> bool {
    let m = u64::from(i.abs_diff(j)).saturating_sub(1);
    bends.iter().all(|&bend| u64::from(bend) * (m * m / 4) < u64::from(width))
}

/// Rooms in a row behind walls with windows; of each window the ranges of `y` and `z`, within 0 to 64.
fn windows(ranges: &[[[f64; 2]; 2]]) -> World {
    let n = i32::try_from(ranges.len()).expect("few windows");
    let room = |k: i32| Brush::empty([k * LENGTH, 0, 0], [k * LENGTH + LENGTH - 4, 64, 64]);
    let window = |(k, [y, z]): (i32, &[[f64; 2]; 2])| {
        let x = [k * LENGTH + LENGTH - 4, (k + 1) * LENGTH].map(f64::from);
        let sides = [x, *y, *z].into_iter().zip(0..);
        let planes = sides
            .flat_map(|([low, high], axis)| [WorldPlane::axial(axis, low).flipped(), WorldPlane::axial(axis, high)]);
        Brush { planes: planes.collect(), is_solid: false }
    };
    let brushes: Vec<Brush> = (0..=n).map(room).chain((0..).zip(ranges).map(window)).collect();
    world_of_brushes([-8, -8, -8], [(n + 1) * LENGTH + 8, 72, 72], &brushes)
}

/// Rooms in a row whose windows share an edge or only a corner with the next ones: only grazing lines pass three of
/// them. Neighbours, and rooms with one room between them, do see each other.
pub fn grazing() -> World {
    let (a, b) = ([16.0, 32.0], [32.0, 48.0]);
    windows(&[[a, a], [b, b], [a, a], [b, a], [a, a], [a, b], [b, b]])
}

/// Rooms in a row, with ever thinner windows: 2^-10 to 2^-27 of a unit.
pub fn slivers() -> World {
    let thin = |k: i32| [32.0, 32.0 + 2f64.powi(-k)];
    let wide = [16.0, 48.0];
    windows(&[[thin(10), wide], [wide, thin(15)], [thin(20), wide], [thin(24), thin(24)], [thin(27), wide]])
}

/// A room around a pillar with eight sides: walking around it leads back to the start.
pub fn pillar_ring() -> World {
    let pillar = Brush::solid([-48, -48, 0], [48, 48, 96]);
    let corners = [[1, 1], [-1, 1], [1, -1], [-1, -1]];
    let pillar = corners.iter().fold(pillar, |b, &[sx, sy]| b.cut([sx, sy, 0], [sx * 48, sy * 20, 0]));
    world_of_brushes([-136, -136, -8], [136, 136, 104], &[Brush::empty([-128, -128, 0], [128, 128, 96]), pillar])
}

/// Stairs that wind `turns` times around a pillar, 8 steps in each turn.
///
/// # Errors
/// [`GenerateError::OutOfRange`] unless there are 1 to 8 turns.
pub fn spiral_stairs(turns: u32) -> Result<World, GenerateError> {
    let turns = check_range("turns", turns, 1, 8)?.cast_signed();
    let top = turns * 128 + 128;
    let mut brushes = vec![Brush::empty([-96, -96, 0], [96, 96, top]), Brush::solid([-24, -24, 0], [24, 24, top])];
    // The directions that bound the eight sectors, counter-clockwise.
    let rays = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];
    for step in 0..turns * 8 {
        let sector = (step % 8) as usize;
        let ([ax, ay], [bx, by]) = (rays[sector], rays[(sector + 1) % 8]);
        let slab = Brush::solid([-96, -96, step * 16], [96, 96, step * 16 + 16]);
        // Left of the first direction, right of the second.
        brushes.push(slab.cut([ay, -ax, 0], [0, 0, 0]).cut([-by, bx, 0], [0, 0, 0]));
    }
    Ok(world_of_brushes([-104, -104, -8], [104, 104, top + 8], &brushes))
}

/// Three pairs of rooms, and a room alone; nothing leads from one to the other.
pub fn separate_rooms() -> World {
    let mut brushes = vec![Brush::empty([0, 200, 0], [64, 264, 64])];
    for k in 0..3 {
        let x = k * 100;
        brushes.push(Brush::empty([x, 0, 0], [x + 64, 64, 64]));
        brushes.push(Brush::empty([x + 16, 64, 16], [x + 48, 80, 48]));
        brushes.push(Brush::empty([x, 80, 0], [x + 64, 144, 64]).cut([1, 0, 2], [x + 64, 0, 32]));
    }
    world_of_brushes([-8, -8, -8], [300, 300, 72], &brushes)
}

/// All of them, by name, each small enough for complete tests; and some of them translated, scaled, sheared, and with
/// noise.
pub fn world_families() -> Vec<(&'static str, World)> {
    let fits = "the options are within their ranges";
    let random = |seed, leafs| bsp_world(BspWorldOptions { seed, leafs, ..BspWorldOptions::default() }).expect(fits);
    let bent = corridor(9, [1, 0], 9).expect(fits);
    let stairs = spiral_stairs(1).expect(fits);
    vec![
        ("one-room", random(5, 1)),
        ("corridor", corridor(12, [0, 0], 16).expect(fits)),
        ("bent-corridor", bent.clone()),
        ("twice-bent-corridor", corridor(9, [1, 2], 13).expect(fits)),
        ("sheared-corridor", bent.sheared([[1, 2, 0], [1, 3, 0], [1, 0, 1]])),
        ("far-corridor", bent.moved([1e6, -1e6, 1e6])),
        ("grazing", grazing()),
        ("grazing-with-noise", grazing().jittered(7, 1e-13)),
        ("sheared-grazing", grazing().sheared([[1, 1, 0], [1, 2, 1], [0, 1, 2]])),
        ("slivers", slivers()),
        ("pillar-ring", pillar_ring()),
        ("spiral-stairs", stairs.clone()),
        ("far-stairs-with-noise", stairs.moved([1e6; 3]).jittered(3, 1e-10)),
        ("small-stairs", stairs.scaled(2f64.powi(-20))),
        ("separate-rooms", separate_rooms()),
        ("random", random(1, 40)),
        ("random-with-noise", random(2, 40).jittered(1, 1e-13)),
    ]
}
