//! Stairwells: two flights of steps around a hole in the floors, the same on every floor.

use super::mesh::{Mesh, STEP};
use crate::layout::Room;
use crate::stroke::Rect;

/// Steps of a flight; two flights and the landing between them climb one storey.
const FLIGHT: i32 = 8;
/// Height of a step, in mesh steps: a sixteenth of a storey of 3 units.
const RISE: i32 = 12;
/// Depth of a step, in layout steps.
const TREAD: i32 = 2;
/// Width of a flight, in layout steps.
const WIDTH: i32 = 12;
/// Depth of the landing between the flights, in layout steps.
const LANDING: i32 = 10;
/// Distance from the middle line of a wall to the hole: more than half the thickness of any wall.
const MARGIN: i32 = 2;

/// The hole in the floor of a stairwell, in layout steps. In front of it, at the door, there is a landing.
pub(super) fn hole(stairwell: &Room) -> Rect {
    let Rect { x0, y0, x1, .. } = stairwell.rect;
    let depth = LANDING + FLIGHT * TREAD;
    Rect { x0: x0 + MARGIN, y0: y0 + MARGIN, x1: x1 - MARGIN, y1: y0 + MARGIN + depth }
}

/// The stairs from one floor to the next, as boxes and a slanted rail.
pub(super) fn stairs(stairwell: &Room) -> Mesh {
    let Rect { x0, y0: back, x1, y1: front } = hole(stairwell);
    let mut mesh = Mesh::new(false);
    let mut block = |[xa, xb]: [i32; 2], [za, zb]: [i32; 2], [low, high]: [i32; 2]| {
        mesh.cuboid([xa * STEP, low, za * STEP], [xb * STEP, high, zb * STEP]);
    };
    let middle = back + LANDING;
    for i in 0..FLIGHT {
        // Each step is two rises thick, so that it touches the next one along a face.
        let top = RISE * (i + 1);
        block([x0, x0 + WIDTH], [front - TREAD * (i + 1), front - TREAD * i], [(top - 2 * RISE).max(0), top]);
        let above = RISE * FLIGHT;
        block([x1 - WIDTH, x1], [middle + TREAD * i, middle + TREAD * (i + 1)], [above + top - 2 * RISE, above + top]);
    }
    block([x0, x1], [back, middle], [RISE * (FLIGHT - 1), RISE * FLIGHT]);
    // A rail one unit above the first flight: its section stays horizontal while it climbs back.
    let rail = [(x0 + WIDTH) * STEP, RISE + 64, (front - 1) * STEP];
    let climb = RISE * FLIGHT;
    mesh.leaning(rail, [rail[0] + 4, rail[1] + climb, rail[2] + 6], [0, -(FLIGHT * TREAD - 1) * STEP]);
    mesh
}
