//! What a single convex occluder hides, texel by texel, by signs in whole numbers.

use super::scene::{Gap, Scene};
use crate::stability::predicates::exact;
use sightlines::geometry::Point3;
use sightlines::multifocal::{BufferPlane, Volume};

/// 1 or -1: the side of the plane of three corners on which all eyes are strictly; nothing if there is none.
fn side_of(outline: &[Point3], volume: &Volume) -> Option<i32> {
    let mut sides = volume.corners().into_iter().map(|v| exact::side([outline[0], outline[1], outline[2], v]));
    let first = sides.next().filter(|&s| s != 0)?;
    sides.all(|s| s == first).then_some(first)
}

/// For each corner of the grid of texels whether all segments from eyes to it are blocked by a flat, convex occluder.
fn blocked_corners(outline: &[Point3], volume: &Volume, plane: &BufferPlane) -> Vec<bool> {
    let [w, h] = plane.texels();
    let row = w + 1;
    let Some(sign) = side_of(outline, volume) else { return vec![false; (row * (h + 1)) as usize] };
    let n = outline.len();
    let eyes = volume.corners();
    (0..row * (h + 1))
        .map(|i| {
            let p = plane.corner(i % row, i / row);
            let is_behind = sign * exact::side([outline[0], outline[1], outline[2], p]) <= 0;
            let inner =
                |k: usize| eyes.iter().all(|&v| sign * exact::side([v, outline[k], outline[(k + 1) % n], p]) <= 0);
            is_behind && (0..n).all(inner)
        })
        .collect()
}

/// The corners of a texel among those of the grid.
pub(crate) fn grid_corners(texel: usize, width: usize) -> [usize; 4] {
    let at = texel / width * (width + 1) + texel % width;
    [at, at + 1, at + width + 1, at + width + 2]
}

fn texels(corners: &[bool], plane: &BufferPlane) -> Vec<bool> {
    let [w, h] = plane.texels().map(|n| n as usize);
    (0..w * h).map(|i| grid_corners(i, w).iter().all(|&k| corners[k])).collect()
}

/// For each texel whether the only occluder of a scene blocks all segments from eyes to it. Of a flat and convex one these are
/// all texels that are hidden: each segment meets its plane once.
pub(crate) fn hidden(scene: &Scene) -> Vec<bool> {
    let outline = scene.occluders[0].outline();
    texels(&blocked_corners(outline, &scene.volume, &scene.plane), &scene.plane)
}

/// For each texel whether two rectangles with a gap between hide it.
///
/// The places where segments from eyes to a texel pass the plane of both are convex. So if they all lie in the outline of
/// both and the gap, some pass the gap unless all pass on one side of it.
pub(crate) fn hidden_with_gap(gap: &Gap) -> Vec<bool> {
    let Gap { scene: Scene { volume, plane, .. }, edges, whole, .. } = gap;
    let inside = texels(&blocked_corners(whole, volume, plane), plane);
    let Some(sign) = side_of(whole, volume) else { return vec![false; inside.len()] };
    let width = plane.texels()[0] as usize;
    let row = plane.texels()[0] + 1;
    let eyes = volume.corners();
    inside
        .into_iter()
        .enumerate()
        .map(|(texel, inside)| {
            let pairs = || {
                let corners = grid_corners(texel, width).map(|k| plane.corner(k as u32 % row, k as u32 / row));
                corners.into_iter().flat_map(move |p| eyes.map(|v| (v, p)))
            };
            // The left edge of the gap is the right one of a rectangle, which goes up there; the other the other way round.
            let on_left = || pairs().all(|(v, p)| sign * exact::side([v, edges[0][0], edges[0][1], p]) <= 0);
            let on_right = || pairs().all(|(v, p)| sign * exact::side([v, edges[1][1], edges[1][0], p]) <= 0);
            inside && (edges[0] == edges[1] || on_left() || on_right())
        })
        .collect()
}
