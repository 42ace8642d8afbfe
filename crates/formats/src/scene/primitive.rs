//! Primitives of a glTF: from accessors to corners and triangles.

use super::accessor::{AccessorRole, Elements};
use super::buffers::Buffers;
use super::build::Compact;
use super::json::{Document, Primitive, TRIANGLES};
use crate::error::{Malformed, Within, malformed};

/// Modes from here on make triangles; those before are points and lines.
pub(super) const FIRST_OF_TRIANGLES: u32 = TRIANGLES;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

#[derive(Debug)]
pub(super) struct LocalMesh {
    pub(super) mesh: Compact,
    /// Of each corner of `mesh`.
    pub(super) positions: Vec<[f64; 3]>,
    /// How many triangles have corners that are not there, and the first of these.
    pub(super) left_out: Option<(usize, Malformed)>,
    /// Their places among all triangles, ascending.
    pub(super) places_left_out: Vec<u32>,
}

impl LocalMesh {
    pub(super) fn read(document: &Document, buffers: &Buffers<'_>, primitive: &Primitive) -> Result<Self, Malformed> {
        let positions = primitive.attributes.position.ok_or_else(|| malformed!("no positions"))?;
        let read = |what: &str, accessor, role| {
            Elements::new(document, buffers, accessor, role).within(format_args!("{what} (accessor {accessor})"))
        };
        let positions = read("positions", positions, AccessorRole::Positions)?;
        let (mut corners, mut wrong) = ((0..positions.count).map(Some).collect::<Vec<_>>(), None);
        if let Some(accessor) = primitive.indices {
            let indices = read("indices", accessor, AccessorRole::Indices)?;
            let found = |k| read_index(&indices, positions.count, k);
            corners =
                (0..indices.count).map(|k| found(k).map_err(|what| wrong = wrong.take().or(Some(what))).ok()).collect();
        }
        check_mode(primitive.mode, corners.len())?;
        let n_triangles = n_triangles_of(primitive.mode, corners.len());
        let triangle = |k: usize| {
            let [a, b, c] = triangle_of(primitive.mode, k).map(|place| corners[place]);
            Some([a?, b?, c?])
        };
        let mut places_left_out = Vec::new();
        if wrong.is_some() {
            places_left_out.extend((0..n_triangles).filter(|&k| triangle(k).is_none()).map(|k| k as u32));
        }
        let triangles = (0..n_triangles).filter_map(triangle);
        let mut used: Vec<usize> = corners.iter().flatten().copied().collect();
        if used.is_empty() {
            // Without triangles, but somewhere.
            used.extend(0..positions.count);
        }
        let mesh = Compact::new(used, triangles);
        let positions = mesh.corners.iter().map(|&k| positions.position(k)).collect();
        let n_left_out = places_left_out.len();
        let left_out = wrong.filter(|_| n_left_out > 0).map(|what| (n_left_out, what));
        Ok(Self { mesh, positions, left_out, places_left_out })
    }
}

pub(super) fn read_indices(indices: &Elements<'_>, n_positions: usize) -> Result<Vec<usize>, Malformed> {
    (0..indices.count).map(|position| read_index(indices, n_positions, position)).collect()
}

fn read_index(indices: &Elements<'_>, n_positions: usize, position: usize) -> Result<usize, Malformed> {
    let index = indices.index(position);
    let found = usize::try_from(index).ok().filter(|&i| i < n_positions);
    found.ok_or_else(|| malformed!("index {position} is {index}, but there are {n_positions} positions"))
}

/// Refuses modes that do not exist, and lists of triangles that end in a part of one.
fn check_mode(mode: u32, n_corners: usize) -> Result<(), Malformed> {
    match mode {
        TRIANGLES if !n_corners.is_multiple_of(3) => Err(malformed!("{n_corners} corners are no list of triangles")),
        0..=TRIANGLE_FAN => Ok(()),
        _ => Err(malformed!("mode {mode} does not exist")),
    }
}

/// Triangles that `n` corners make; points and lines make none.
pub(super) fn n_triangles_of(mode: u32, n: usize) -> usize {
    match mode {
        TRIANGLES => n / 3,
        TRIANGLE_STRIP | TRIANGLE_FAN => n.saturating_sub(2),
        _ => 0,
    }
}

/// Which corners triangle `k` has, in the order of the specification (section 3.7.2.1).
fn triangle_of(mode: u32, k: usize) -> [usize; 3] {
    match mode {
        // Every other triangle of a strip runs the other way round.
        TRIANGLE_STRIP => [k, k + 1 + k % 2, k + 2 - k % 2],
        TRIANGLE_FAN => [k + 1, k + 2, 0],
        _ => [3 * k, 3 * k + 1, 3 * k + 2],
    }
}
