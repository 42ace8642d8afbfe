//! The faces of a map's world: their corners, and which leafs list them.

use super::{Bsp, BspError, BspFormat, i32_at, u16_at, u32_at};
use crate::point::check_point;
use sightlines_geometry::Point3;
use std::ops::Range;

/// How often the records of a list may be named in all, in multiples of its length. Compilers name each once.
const MOST_SHARED: u64 = 4;

/// The faces of the world, without those of doors and the like: polygons, most of them convex, with corners that
/// predicates accept. May be empty; a face may have any number of corners.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldFaces {
    /// The first face, as an index of the file.
    first: u32,
    /// Where the corners of each face begin, and behind them their number.
    starts: Vec<u32>,
    corners: Vec<Point3>,
}

impl WorldFaces {
    /// Their indices in the file.
    pub fn range(&self) -> Range<u32> {
        self.first..self.first + self.n_faces() as u32
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.starts.len() - 1
    }

    /// The corners of the `k`-th face in turn, in scene units.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn corners(&self, k: usize) -> &[Point3] {
        &self.corners[self.starts[k] as usize..self.starts[k + 1] as usize]
    }
}

/// Which faces each visible leaf lists: those that engines draw when the leaf is seen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeafFaces {
    marks: Vec<u32>,
    ranges: Vec<Range<usize>>,
}

impl LeafFaces {
    /// The faces of a leaf, as indices of the file, in the order of the list. Leafs count from 0 as in portal files.
    ///
    /// # Panics
    /// If there are not so many visible leafs.
    pub fn of(&self, leaf: usize) -> &[u32] {
        &self.marks[self.ranges[leaf].clone()]
    }

    /// Number of leafs.
    pub fn n_leafs(&self) -> usize {
        self.ranges.len()
    }
}

/// Indices of the lumps that faces are read from.
struct Lumps {
    vertices: usize,
    faces: usize,
    marks: usize,
    edges: usize,
    surfedges: usize,
    models: usize,
}

impl Lumps {
    const fn of(format: BspFormat) -> Self {
        match format {
            BspFormat::Quake2 => Self { vertices: 2, faces: 6, marks: 9, edges: 11, surfedges: 12, models: 13 },
            _ => Self { vertices: 3, faces: 7, marks: 11, edges: 12, surfedges: 13, models: 14 },
        }
    }
}

impl Bsp {
    /// Whether indices of vertices and faces have 32 bits.
    fn is_wide(&self) -> bool {
        matches!(self.format(), BspFormat::Bsp2 | BspFormat::Bsp2Psb)
    }

    /// Reads the faces of the world with their corners. Time and memory in proportion to the file.
    ///
    /// # Errors
    /// [`BspError`] for lumps that are not a whole number of records, for a face, list, edge or vertex that is not there,
    /// for a vertex that is nowhere, and for faces that share more of the list of edges than their number explains.
    ///
    /// # Source
    /// As [`Bsp::parse`].
    pub fn world_faces(&self) -> Result<WorldFaces, BspError> {
        let lumps = Lumps::of(self.format());
        let (face_len, edge_len) = if self.is_wide() { (28, 8) } else { (20, 4) };
        let vertices = self.vertices(&lumps)?;
        let faces = self.records(lumps.faces, face_len)?;
        let edges = self.records(lumps.edges, edge_len)?;
        let listed = self.records(lumps.surfedges, 4)?;
        let (n_edges, n_listed) = (edges.len() / edge_len, listed.len() / 4);

        let model = self.world_model()?;
        // Behind floats and root, in Quake behind four roots and the number of visible leafs.
        let at = if self.format() == BspFormat::Quake2 { 40 } else { 56 };
        let run = [i32_at(model, at), i32_at(model, at + 4)].map(i64::from);
        let world = self.run((lumps.models, 0), run, lumps.faces, faces.len() / face_len)?;
        let (mut starts, mut corners) = (vec![0], Vec::new());
        for k in world.clone() {
            let face = &faces[k * face_len..][..face_len];
            let run = match self.is_wide() {
                true => [i64::from(i32_at(face, 8)), i64::from(u32_at(face, 12))],
                false => [i64::from(i32_at(face, 4)), i64::from(u16_at(face, 8))],
            };
            let run = self.run((lumps.faces, k), run, lumps.surfedges, n_listed)?;
            let n_named = corners.len() as u64 + run.len() as u64;
            self.refuse_shared(lumps.faces, n_named, lumps.surfedges, n_listed)?;
            for at in run {
                let edge = i64::from(i32_at(listed, 4 * at));
                let index = self.named((lumps.surfedges, at), edge.abs(), lumps.edges, n_edges)?;
                let end = usize::from(edge < 0);
                let record = &edges[index * edge_len..][..edge_len];
                let vertex = if self.is_wide() { u32_at(record, 4 * end) } else { u32::from(u16_at(record, 2 * end)) };
                let by = (lumps.edges, index);
                corners.push(vertices[self.named(by, i64::from(vertex), lumps.vertices, vertices.len())?]);
            }
            starts.push(corners.len() as u32);
        }
        Ok(WorldFaces { first: world.start as u32, starts, corners })
    }

    /// Reads which faces the visible leafs list. Time and memory in proportion to the file.
    ///
    /// # Errors
    /// [`BspError`] for lumps that are not a whole number of records, for a part of the list or a face that is not there,
    /// and for leafs that share more of the list than their number explains.
    pub fn leaf_faces(&self) -> Result<LeafFaces, BspError> {
        let lumps = Lumps::of(self.format());
        let (face_len, mark_len) = if self.is_wide() { (28, 4) } else { (20, 2) };
        let n_faces = self.records(lumps.faces, face_len)?.len() / face_len;
        let listed = self.records(lumps.marks, mark_len)?;
        let marks: Vec<u32> = match self.is_wide() {
            true => listed.chunks_exact(4).map(|mark| u32_at(mark, 0)).collect(),
            false => listed.chunks_exact(2).map(|mark| u32::from(u16_at(mark, 0))).collect(),
        };
        let mut n_named = 0;
        let range = |(leaf, record): (&super::BspLeaf, usize)| {
            let (first, count) = (leaf.first_face, leaf.n_faces);
            // Leafs without faces may point anywhere.
            if count == 0 {
                return Ok(0..0);
            }
            n_named += u64::from(count);
            self.refuse_shared(self.format().leaf_lump(), n_named, lumps.marks, marks.len())?;
            let run = [first, count].map(i64::from);
            let range = self.run((self.format().leaf_lump(), record), run, lumps.marks, marks.len())?;
            for at in range.clone() {
                self.named((lumps.marks, at), i64::from(marks[at]), lumps.faces, n_faces)?;
            }
            Ok(range)
        };
        let ranges = self.visible_leafs().iter().zip(1..).map(range).collect::<Result<_, BspError>>()?;
        Ok(LeafFaces { marks, ranges })
    }

    fn vertices(&self, lumps: &Lumps) -> Result<Vec<Point3>, BspError> {
        let records = self.records(lumps.vertices, 12)?.chunks_exact(12).enumerate();
        let lump = self.format().lump_id(lumps.vertices);
        let float = |record: &[u8], k: usize| f64::from(f32::from_bits(u32_at(record, 4 * k)));
        let vertex = |(vertex, record): (usize, &[u8])| {
            let point = std::array::from_fn(|k| float(record, k));
            // Floats are within the range of coordinates, if they are finite.
            check_point(point).map_err(|_| BspError::Vertex { lump, vertex })
        };
        records.map(vertex).collect()
    }

    /// A first record and a number of records that a record of a lump names, if the other lump has them.
    pub(super) fn run(
        &self,
        by: (usize, usize),
        [first, count]: [i64; 2],
        of: usize,
        n: usize,
    ) -> Result<Range<usize>, BspError> {
        let (lump, of) = (self.format().lump_id(by.0), self.format().lump_id(of));
        let error = BspError::Run { lump, record: by.1, first, count, of, n };
        let (Ok(start), Ok(len)) = (usize::try_from(first), usize::try_from(count)) else { return Err(error) };
        let end = start.checked_add(len).filter(|&end| end <= n);
        end.map(|end| start..end).ok_or(error)
    }

    /// Runs may share records, but not so often that a small file becomes a large map.
    fn refuse_shared(&self, lump: usize, n_named: u64, of: usize, n: usize) -> Result<(), BspError> {
        let [lump, of] = [lump, of].map(|k| self.format().lump_id(k));
        if n_named <= MOST_SHARED * n as u64 { Ok(()) } else { Err(BspError::SharedRuns { lump, n_named, of, n }) }
    }
}
