//! Faces of Quake III: runs of vertices, as triangles or as the grid of a curved face.

use super::records::Records;
use super::world::{Vertices, WorldFaces};
use super::{Bsp, layout};
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
/// # Source
/// The published tools and engine of Quake III for the records.
pub(super) fn faces(
    bsp: &Bsp,
    indices: usize,
    world: Range<usize>,
    faces: &Records<'_>,
    vertices: &Vertices<'_>,
) -> Result<WorldFaces, Malformed> {
    let listed = bsp.records(layout::Records { lump: indices, len: 4 })?;
    let (mut n_controls, mut n_corners) = (0, 0);
    let mut found = WorldFaces::new(world.start as u32);
    for k in world {
        let (face, by) = (faces.get(k), (faces.lump, k));
        let pair = |at: usize| [i32_at(face, at), i32_at(face, at + 4)].map(i64::from);
        let run = vertices.records.run(by, pair(VERTICES))?;
        if i32_at(face, KIND) == CURVED {
            n_controls += run.len() as u64;
            vertices.records.refuse_shared(faces.lump, n_controls)?;
            let [width, height] = pair(GRID);
            let is_grid = width > 0 && height > 0 && width.checked_mul(height) == Some(run.len() as i64);
            if !is_grid {
                let (lump, n) = (faces.label(), run.len());
                return Err(malformed!("{lump}: face {k}: a grid of {width} by {height} has not its {n} points"));
            }
            grid(&vertices.points[run], width as usize, &mut found);
        } else {
            let named = listed.run(by, pair(INDICES))?;
            n_corners += named.len() as u64;
            listed.refuse_shared(faces.lump, n_corners)?;
            for (at, k) in named.zip(1..) {
                let index = i64::from(i32_at(listed.get(at), 0));
                let index = if index < 0 { index } else { run.start as i64 + index };
                found.corners.push(vertices.named((listed.lump, at), index)?);
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
