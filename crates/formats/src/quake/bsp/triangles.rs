//! Faces of Quake III: runs of vertices, as triangles or as the grid of a curved face.

use super::Bsp;
use super::world_faces::WorldFaces;
use crate::bytes::i32_at;
use crate::error::{Malformed, malformed};
use sightlines_geometry::Point3;
use std::ops::Range;

/// Where a face has its kind, its run of vertices, that of indices, and the size of its grid.
const KIND: usize = 8;
const VERTICES: usize = 12;
const INDICES: usize = 20;
const GRID: usize = 96;
/// The kind of curved faces; those of planes and of models have triangles, and flares nothing.
const CURVED: i32 = 2;

/// The faces of the world, from their records. Memory in proportion to the lumps, as runs may share little.
///
/// # Errors
/// [`Malformed`] for a run, an index or a grid that is not there.
///
/// # Source
/// The published tools and engine of Quake III for the records.
pub(super) fn faces(
    bsp: &Bsp,
    indices: usize,
    world: Range<usize>,
    faces: &[u8],
    vertices: &[Point3],
) -> Result<WorldFaces, Malformed> {
    let layout = bsp.format().layout();
    let (own, lump) = (layout.faces.lump, layout.vertices.lump);
    let listed = bsp.records(indices, 4)?;
    let n_listed = listed.len() / 4;
    let (mut n_controls, mut n_corners) = (0, 0);
    let mut found = WorldFaces::new(world.start as u32);
    for k in world {
        let face = &faces[k * layout.faces.len..][..layout.faces.len];
        let number = |at: usize| i64::from(i32_at(face, at));
        let run = bsp.run((own, k), [number(VERTICES), number(VERTICES + 4)], lump, vertices.len())?;
        if i32_at(face, KIND) == CURVED {
            n_controls += run.len() as u64;
            bsp.refuse_shared(own, n_controls, lump, vertices.len())?;
            let [width, height] = [number(GRID), number(GRID + 4)];
            let is_grid = width > 0 && height > 0 && width.checked_mul(height) == Some(run.len() as i64);
            if !is_grid {
                let (lump, n) = (bsp.format().label(own), run.len());
                return Err(malformed!("{lump}: face {k}: a grid of {width} by {height} has not its {n} points"));
            }
            grid(&vertices[run], width as usize, &mut found);
        } else {
            let named = bsp.run((own, k), [number(INDICES), number(INDICES + 4)], indices, n_listed)?;
            n_corners += named.len() as u64;
            bsp.refuse_shared(own, n_corners, indices, n_listed)?;
            for (at, k) in named.zip(1..) {
                let index = i64::from(i32_at(listed, 4 * at));
                let index = if index < 0 { index } else { run.start as i64 + index };
                found.corners.push(vertices[bsp.named((indices, at), index, lump, vertices.len())?]);
                if k % 3 == 0 {
                    found.end_polygon();
                }
            }
            // What is left of a run that is no whole number of triangles.
            if found.starts.last() != Some(&(found.corners.len() as u32)) {
                found.end_polygon();
            }
        }
        found.end_face();
    }
    Ok(found)
}

/// The quadrangles of a grid; the line of one that is only that.
fn grid(points: &[Point3], width: usize, found: &mut WorldFaces) {
    let height = points.len() / width;
    if width == 1 || height == 1 {
        found.corners.extend(points);
        return found.end_polygon();
    }
    for (x, y) in (1..height).flat_map(|y| (1..width).map(move |x| (x, y))) {
        let corners = [(x - 1, y - 1), (x, y - 1), (x, y), (x - 1, y)];
        found.corners.extend(corners.map(|(x, y)| points[y * width + x]));
        found.end_polygon();
    }
}
