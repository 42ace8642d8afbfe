//! The vertices of a map, and the polygons of the faces of its world.

use super::Bsp;
use super::records::{By, Records};
use crate::bytes::u32_at;
use crate::error::{Malformed, malformed};
use crate::point::check_point;
use sightlines_geometry::Point3;
use std::ops::Range;

pub(super) struct Vertices<'b> {
    pub(super) records: Records<'b>,
    pub(super) points: Vec<Point3>,
}

impl<'b> Vertices<'b> {
    pub(super) fn of(bsp: &'b Bsp) -> Result<Self, Malformed> {
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
