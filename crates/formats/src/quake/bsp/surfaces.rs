//! The faces of a map's world: their corners, and which leafs list them.

use super::layout::{self, Edges, FaceForm};
use super::records::Records;
use super::world::{Vertices, WorldFaces};
use super::{Bsp, triangles};
use crate::bytes::{i32_at, u16_at, u32_at};
use crate::error::Malformed;
use std::ops::Range;

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
        let vertices = Vertices::of(self)?;
        let faces = self.records(layout.faces)?;
        let world = self.world_face_run(&faces)?;
        match layout.face_form {
            FaceForm::Edges(edges) => self.faces_of_edges(edges, world, &faces, &vertices),
            FaceForm::Vertices { indices } => triangles::faces(self, indices, world, &faces, &vertices),
        }
    }

    /// Those of the faces in the file that are of the world.
    pub(super) fn world_face_run(&self, faces: &Records<'_>) -> Result<Range<usize>, Malformed> {
        let layout = self.format().layout();
        let (model, at) = (self.world_model()?, layout.model_faces);
        faces.run((layout.models.lump, 0), [i32_at(model, at), i32_at(model, at + 4)].map(i64::from))
    }

    fn faces_of_edges(
        &self,
        from: Edges,
        world: Range<usize>,
        faces: &Records<'_>,
        vertices: &Vertices<'_>,
    ) -> Result<WorldFaces, Malformed> {
        let edges = self.records(from.edges)?;
        let listed = self.records(layout::Records { lump: from.surfedges, len: 4 })?;
        let mut found = WorldFaces::new(world.start as u32);
        for k in world {
            let face = faces.get(k);
            let run = listed.run((faces.lump, k), [from.first.of(face), from.count.of(face)])?;
            listed.refuse_shared(faces.lump, found.corners.len() as u64 + run.len() as u64)?;
            for at in run {
                let edge = i64::from(i32_at(listed.get(at), 0));
                let index = edges.named((listed.lump, at), edge.abs())?;
                let (record, end) = (edges.get(index), usize::from(edge < 0));
                let is_wide = from.edges.len == 8;
                let vertex = if is_wide { u32_at(record, 4 * end) } else { u32::from(u16_at(record, 2 * end)) };
                found.corners.push(vertices.named((edges.lump, index), i64::from(vertex))?);
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
        let (faces, list, marks) = (self.records(layout.faces)?, self.records(layout.marks)?, self.marks());
        let mut n_named = 0;
        let range = |(leaf, record): (&super::BspLeaf, usize)| {
            let (first, count) = (leaf.first_face, leaf.n_faces);
            // Leafs without faces may point anywhere.
            if count == 0 {
                return Ok(0..0);
            }
            n_named += u64::from(count);
            list.refuse_shared(layout.leafs.lump, n_named)?;
            let range = list.run((layout.leafs.lump, record), [first, count].map(i64::from))?;
            for at in range.clone() {
                faces.named((list.lump, at), i64::from(marks[at]))?;
            }
            Ok(range)
        };
        let ranges = self.visible_leafs().iter().zip(1..).map(range).collect::<Result<_, Malformed>>()?;
        Ok(LeafFaces { marks, ranges })
    }
}
