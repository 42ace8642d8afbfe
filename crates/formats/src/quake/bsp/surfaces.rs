//! The faces of a map's world: their corners, and which leafs list them.

use super::layout::{self, Edges, FaceForm};
use super::records::{By, Records};
use super::{Bsp, triangles};
use crate::bytes::{i32_at, u16_at, u32_at};
use crate::error::{Malformed, malformed};
use crate::point::check_point;
use sightlines_geometry::Point3;
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

pub(super) struct Vertices<'b> {
    pub(super) records: Records<'b>,
    pub(super) points: Vec<Point3>,
}

impl<'b> Vertices<'b> {
    fn of(bsp: &'b Bsp) -> Result<Self, Malformed> {
        let records = bsp.records(bsp.format().layout().vertices)?;
        let vertex = |(vertex, record): (usize, &[u8])| {
            let point = std::array::from_fn(|k| f64::from(f32::from_bits(u32_at(record, 4 * k))));
            // Floats are within the range of coordinates, if they are finite.
            check_point(point).map_err(|_| {
                malformed!("{}: vertex {vertex} has a coordinate that is not a finite number", records.label())
            })
        };
        Ok(Self { records, points: records.iter().enumerate().map(vertex).collect::<Result<_, _>>()? })
    }

    pub(super) fn named(&self, by: By, found: i64) -> Result<Point3, Malformed> {
        Ok(self.points[self.records.named(by, found)?])
    }
}

/// The faces of the world, without those of doors and the like: polygons, most of them convex, with corners that
/// predicates accept. May be empty; a face may have any number of corners.
///
/// A face of Quake III is several polygons: its triangles, or the quadrangles of the grid that controls a curved one, which lies
/// in the convex hull of the grid but beside these.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldFaces {
    /// The first face, as an index of the file.
    pub(super) first: u32,
    /// Where the polygons of each face begin, and behind them their number.
    pub(super) faces: Vec<u32>,
    /// Where the corners of each polygon begin, and behind them their number.
    pub(super) starts: Vec<u32>,
    pub(super) corners: Vec<Point3>,
}

impl WorldFaces {
    pub(super) fn new(first: u32) -> Self {
        Self { first, faces: vec![0], starts: vec![0], corners: Vec::new() }
    }

    /// Ends a polygon, which has the corners behind those of the one before.
    pub(super) fn end_polygon(&mut self) {
        self.starts.push(self.corners.len() as u32);
    }

    /// Ends a face, which has the polygons behind those of the one before.
    pub(super) fn end_face(&mut self) {
        self.faces.push(self.starts.len() as u32 - 1);
    }

    /// Their indices in the file.
    pub fn range(&self) -> Range<u32> {
        self.first..self.first + self.n_faces() as u32
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.faces.len() - 1
    }

    /// The corners of the `k`-th face in turn, in scene units; those of all of its polygons, if it is not one.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn corners(&self, k: usize) -> &[Point3] {
        let [start, end] = [k, k + 1].map(|k| self.starts[self.faces[k] as usize] as usize);
        &self.corners[start..end]
    }

    /// The polygons of the `k`-th face, each with its corners in turn, in scene units.
    ///
    /// # Panics
    /// If there are not so many faces.
    pub fn polygons(&self, k: usize) -> impl ExactSizeIterator<Item = &[Point3]> {
        let polygons = self.faces[k] as usize..self.faces[k + 1] as usize;
        polygons.map(|p| &self.corners[self.starts[p] as usize..self.starts[p + 1] as usize])
    }
}
