//! Two families of long triangles, each of which crosses all of the other family.

use super::{Steps, object, scene};
use crate::error::{GenerateError, check_range};
use sightlines_cells::Scene;

/// Strips in two parallel planes: those along x in front of those along y, each of which covers a part of each of the
/// others, all in overlapping ranges of depth: for `n` triangles `n^2 / 4` overlaps, and yet an order without splits.
///
/// * `triangles`: their number, from 2 to 2^14; half of them, rounded up, lie along x, and come first
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn lattice(triangles: u32) -> Result<Scene, GenerateError> {
    let n = check_range("triangles", triangles, 2, 1 << 14)?;
    let [along, across] = [n.div_ceil(2), n / 2].map(i64::from);
    // Strips are half as wide at their base as their pitch, and extend beyond the last one that they cross.
    let pitch = 16;
    let reach = (along / 2 + 2) * pitch;
    let strips = |count: i64, turned: bool| -> Vec<Steps> {
        let strip = |k: i64| {
            let at = (2 * k - count + 1) * pitch / 2;
            [(-reach, at - pitch / 4), (-reach, at + pitch / 4), (reach, at)].map(|(s, t)| {
                let ([x, y], behind) = if turned { ([t, s], pitch) } else { ([s, t], 0) };
                // Multiples of 4, so that a quarter is a whole number.
                [x, y, 3 * reach + behind + (x + y) / 4]
            })
        };
        (0..count).map(strip).collect()
    };
    let steps = reach.unsigned_abs().next_power_of_two().cast_signed();
    let objects = [("along", strips(along, false)), ("across", strips(across, true))];
    Ok(scene(objects.map(|(name, strips)| object(name.to_owned(), &strips, steps)).into()))
}

/// Triangles for which every BSP tree along their own planes has about `n^2 / 4` more pieces than triangles: each has
/// an edge on a hyperbolic paraboloid, a line of one of its two families; those of one family hang below it in parallel
/// planes, those of the other stand above it in planes across the first. No two meet; but the plane of each cuts all of
/// the other family, and no plane of any of them separates two that come close.
///
/// Source: Paterson and Yao, Discrete & Computational Geometry 5, 1990: with thin triangles along these lines any BSP
/// tree has that size.
///
/// * `triangles`: their number, from 2 to 2^14; half of them, rounded up, hang, and come first
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn split_worst(triangles: u32) -> Result<Scene, GenerateError> {
    let n = check_range("triangles", triangles, 2, 1 << 14)?;
    let [hanging, standing] = [n.div_ceil(2), n / 2].map(i64::from);
    let reach = hanging + 1;
    // Odd numbers around 0, so that lines are symmetric; 2 is the pitch.
    let line = |k: i64, count: i64| 2 * k - count + 1;
    // The lines are `scale` steps apart for each step that the paraboloid rises: where a and b count lines, it is at c
    // = a b.
    let scale = 4 * reach;
    let hang = |b: i64| {
        [[-reach * scale, b * scale, -reach * b], [reach * scale, b * scale, reach * b], [0, b * scale, -reach * scale]]
    };
    let stand = |a: i64| {
        [
            [a * scale, -reach * scale, 1 - a * reach],
            [a * scale, reach * scale, 1 + a * reach],
            [a * scale, 0, reach * scale],
        ]
    };
    // Three directions across each other, of length 3, and none along the view.
    let far = 12 * reach * scale;
    let placed = |[a, b, c]: [i64; 3]| [2 * a + 2 * b - c, -a + 2 * b + 2 * c, far + 2 * a - b + 2 * c];
    let hanging: Vec<Steps> = (0..hanging).map(|k| hang(line(k, hanging)).map(placed)).collect();
    let standing: Vec<Steps> = (0..standing).map(|k| stand(line(k, standing)).map(placed)).collect();
    let steps = (reach * scale).unsigned_abs().next_power_of_two().cast_signed();
    let objects = [("hanging", hanging), ("standing", standing)];
    Ok(scene(objects.map(|(name, triangles)| object(name.to_owned(), &triangles, steps)).into()))
}
