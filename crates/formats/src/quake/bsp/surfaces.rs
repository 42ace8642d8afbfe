//! The faces of a map's world: their corners, and which leafs list them.

use super::layout::{Edges, FaceForm};
use super::world_faces::WorldFaces;
use super::{Bsp, triangles};
use crate::bytes::{i32_at, u16_at, u32_at};
use crate::error::{Malformed, malformed};
use crate::point::check_point;
use sightlines_geometry::Point3;
use std::ops::Range;

/// How often the records of a list may be named in all, in multiples of its length. Compilers name each once.
const MOST_SHARED: u64 = 4;

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

impl Bsp {
    /// Reads the faces of the world with their corners. Time and memory in proportion to the file.
    ///
    /// # Errors
    /// [`Malformed`] for lumps that are not a whole number of records, for a face, list, edge or vertex that is not there,
    /// for a vertex that is nowhere, and for faces that share more of a list than their number explains.
    ///
    /// # Source
    /// As [`Bsp::parse`].
    pub fn world_faces(&self) -> Result<WorldFaces, Malformed> {
        let layout = self.format().layout();
        let vertices = self.vertices()?;
        let faces = self.records(layout.faces.lump, layout.faces.len)?;
        let world = self.world_face_run(faces.len() / layout.faces.len)?;
        match layout.face_form {
            FaceForm::Edges(edges) => self.faces_of_edges(edges, world, faces, &vertices),
            FaceForm::Vertices { indices } => triangles::faces(self, indices, world, faces, &vertices),
        }
    }

    /// The faces of the world, of so many in the file.
    pub(super) fn world_face_run(&self, n_faces: usize) -> Result<Range<usize>, Malformed> {
        let layout = self.format().layout();
        let (model, at) = (self.world_model()?, layout.model_faces);
        let run = [i32_at(model, at), i32_at(model, at + 4)].map(i64::from);
        self.run((layout.models.lump, 0), run, layout.faces.lump, n_faces)
    }

    fn faces_of_edges(
        &self,
        from: Edges,
        world: Range<usize>,
        faces: &[u8],
        vertices: &[Point3],
    ) -> Result<WorldFaces, Malformed> {
        let (layout, edge_len) = (self.format().layout(), from.edges.len);
        let edges = self.records(from.edges.lump, edge_len)?;
        let listed = self.records(from.surfedges, 4)?;
        let (n_edges, n_listed) = (edges.len() / edge_len, listed.len() / 4);
        let mut found = WorldFaces::new(world.start as u32);
        for k in world {
            let face = &faces[k * layout.faces.len..][..layout.faces.len];
            let run = [from.first.of(face), from.count.of(face)];
            let run = self.run((layout.faces.lump, k), run, from.surfedges, n_listed)?;
            let n_named = found.corners.len() as u64 + run.len() as u64;
            self.refuse_shared(layout.faces.lump, n_named, from.surfedges, n_listed)?;
            for at in run {
                let edge = i64::from(i32_at(listed, 4 * at));
                let index = self.named((from.surfedges, at), edge.abs(), from.edges.lump, n_edges)?;
                let end = usize::from(edge < 0);
                let record = &edges[index * edge_len..][..edge_len];
                let vertex = if edge_len == 8 { u32_at(record, 4 * end) } else { u32::from(u16_at(record, 2 * end)) };
                let by = (from.edges.lump, index);
                found.corners.push(vertices[self.named(by, i64::from(vertex), layout.vertices.lump, vertices.len())?]);
            }
            found.end_polygon();
            found.end_face();
        }
        Ok(found)
    }

    /// Reads which faces the visible leafs list. Time and memory in proportion to the file.
    ///
    /// # Errors
    /// [`Malformed`] for lumps that are not a whole number of records, for a part of the list or a face that is not there,
    /// and for leafs that share more of the list than their number explains.
    pub fn leaf_faces(&self) -> Result<LeafFaces, Malformed> {
        let layout = self.format().layout();
        let (list, leafs) = (layout.marks.lump, layout.leafs.lump);
        let n_faces = self.records(layout.faces.lump, layout.faces.len)?.len() / layout.faces.len;
        self.records(list, layout.marks.len)?;
        let marks = self.marks();
        let mut n_named = 0;
        let range = |(leaf, record): (&super::BspLeaf, usize)| {
            let (first, count) = (leaf.first_face, leaf.n_faces);
            // Leafs without faces may point anywhere.
            if count == 0 {
                return Ok(0..0);
            }
            n_named += u64::from(count);
            self.refuse_shared(leafs, n_named, list, marks.len())?;
            let range = self.run((leafs, record), [first, count].map(i64::from), list, marks.len())?;
            for at in range.clone() {
                self.named((list, at), i64::from(marks[at]), layout.faces.lump, n_faces)?;
            }
            Ok(range)
        };
        let ranges = self.visible_leafs().iter().zip(1..).map(range).collect::<Result<_, Malformed>>()?;
        Ok(LeafFaces { marks, ranges })
    }

    fn vertices(&self) -> Result<Vec<Point3>, Malformed> {
        let vertices = self.format().layout().vertices;
        let records = self.records(vertices.lump, vertices.len)?.chunks_exact(vertices.len).enumerate();
        let float = |record: &[u8], k: usize| f64::from(f32::from_bits(u32_at(record, 4 * k)));
        let vertex = |(vertex, record): (usize, &[u8])| {
            let point = std::array::from_fn(|k| float(record, k));
            // Floats are within the range of coordinates, if they are finite.
            check_point(point).map_err(|_| {
                let lump = self.format().label(vertices.lump);
                malformed!("{lump}: vertex {vertex} has a coordinate that is not a finite number")
            })
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
    ) -> Result<Range<usize>, Malformed> {
        let (start, len) = (usize::try_from(first).ok(), usize::try_from(count).ok());
        let run = start.zip(len).and_then(|(start, len)| Some(start..start.checked_add(len)?));
        run.filter(|run| run.end <= n).ok_or_else(|| {
            let [lump, of] = [by.0, of].map(|k| self.format().label(k));
            let what = format_args!("{count} records from {first} on of {of}, which has {n}");
            malformed!("{lump}: record {} names {what}", by.1)
        })
    }

    /// Runs may share records, but not so often that a small file becomes a large map.
    pub(super) fn refuse_shared(&self, lump: usize, n_named: u64, of: usize, n: usize) -> Result<(), Malformed> {
        if n_named <= MOST_SHARED * n as u64 {
            return Ok(());
        }
        let [lump, of] = [lump, of].map(|k| self.format().label(k));
        let what = format_args!("{n_named} records of {of}, which has {n}");
        Err(malformed!("{lump}: its records name {what}: they share more than is read"))
    }
}
