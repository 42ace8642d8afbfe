//! Triangles whose depths mislead: cyclic overlaps, and long triangles next to short ones.

use super::{Steps, Tile, object, scene};
use crate::error::{GenerateError, check_range};
use sightlines_cells::Scene;

/// Triangles in threes, each tile of the picture with three: the first covers a part of the second, that a part of the
/// third, and that a part of the first. No order of whole triangles is right. No two intersect. The last tile may have
/// fewer.
///
/// * `triangles`: their number, from 1 to 2^20
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn cycles(triangles: u32) -> Result<Scene, GenerateError> {
    check_range("triangles", triangles, 1, 1 << 20)?;
    let mut left = triangles as usize;
    let objects = Tile::all(triangles.div_ceil(3), 36).zip(0..).map(|(tile, k)| {
        let bars = [0, 1, 2].map(|turn| bar(&tile, turn));
        let n = left.min(3);
        left -= n;
        object(format!("cycle_{k}"), &bars[..n], tile.places)
    });
    Ok(scene(objects.collect()))
}

/// A triangle along a side of another triangle with corners 0, 1 and 2: from beyond corner `turn`, where it is far, to
/// beyond the next, where it is near.
fn bar(tile: &Tile, turn: usize) -> Steps {
    // Places in shares of the three corners, which add up to 8.
    let corners = [([12, -2, -2], 12), ([8, -2, 2], 12), ([-4, 12, 0], 6)];
    corners.map(|(shares, depth)| {
        let share = |corner: usize| shares[(corner + 3 - turn) % 3];
        // Corner 0 is at (9, 9), 1 is 16 to the right, 2 is 16 up.
        tile.at([9 + 2 * share(1), 9 + 2 * share(2)], depth)
    })
}

/// Triangles in pairs, each tile of the picture with one pair: a long one that leads away from the eye, and a short one
/// in front of its far part, whose midpoint is farther than that of the long one. Ordered by midpoints, each pair is
/// drawn in the wrong order. The long one has the lower id. If the number is odd, the last is a long one alone.
///
/// * `triangles`: their number, from 1 to 2^20
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn interleaved(triangles: u32) -> Result<Scene, GenerateError> {
    check_range("triangles", triangles, 1, 1 << 20)?;
    let mut left = triangles as usize;
    let objects = Tile::all(triangles.div_ceil(2), 32).zip(0..).map(|(tile, k)| {
        // The middle of the long one is at depth 80 / 3. Upwards in the picture the inverse of the depth is linear: at
        // height 20, where the short one begins, the long one is at depth 29.
        let long = [([2, 2], 20), ([30, 2], 20), ([16, 30], 40)];
        let short = [([12, 20], 28), ([20, 20], 28), ([16, 28], 28)];
        let pair = [long, short].map(|corners| corners.map(|(place, depth)| tile.at(place, depth)));
        let n = left.min(2);
        left -= n;
        object(format!("pair_{k}"), &pair[..n], tile.places)
    });
    Ok(scene(objects.collect()))
}
