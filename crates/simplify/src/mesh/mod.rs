//! The triangles of a scene as one mesh: coincident corners are one place.
//!
//! Objects keep their own vertices, as they may differ in more than their position (texture coordinates, normals); the
//! mesh stores which vertex of its object each corner is.

mod apart;
mod change;
mod collapse;
mod flat;
mod quadric;

pub(crate) use change::Change;
pub(crate) use collapse::{Collapser, Policy, Weights};
pub(crate) use flat::merge;

use sightlines_cells::Scene;
use sightlines_geometry::Point3;
use std::collections::BTreeMap;

/// A triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Face {
    pub(crate) object: u32,
    /// Vertices of the object.
    pub(crate) wedges: [u32; 3],
    /// Places of the mesh.
    pub(crate) corners: [u32; 3],
    pub(crate) state: State,
}

/// The state of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum State {
    /// Unchanged.
    Kept,
    /// It covers a part of what kept faces in its plane covered: a new face of an old surface.
    Merged,
    /// Some corner has moved: a new face.
    New,
    /// Removed.
    Gone,
}

/// For each object the remaining triangles, and which triangle of the object each of them was.
#[derive(Debug, Clone, Default)]
pub(crate) struct Left {
    pub(crate) triangles: Vec<Vec<[u32; 3]>>,
    pub(crate) origin: Vec<Vec<Option<u32>>>,
}

/// Triangles with their adjacency.
#[derive(Debug, Clone)]
pub(crate) struct Mesh {
    places: Vec<Point3>,
    faces: Vec<Face>,
    /// For each place the faces at it that are not removed.
    at: Vec<Vec<u32>>,
    n_left: usize,
}

impl Mesh {
    /// All triangles of a scene, in the order of `Faces::of_scene`; coincident corners are one place, whichever objects
    /// they belong to. O(n log n).
    pub(crate) fn new(scene: &Scene) -> Self {
        Self::joined(scene, true)
    }

    /// The same, but objects share no places.
    pub(crate) fn of_objects(scene: &Scene) -> Self {
        Self::joined(scene, false)
    }

    fn joined(scene: &Scene, across_objects: bool) -> Self {
        let mut ids: BTreeMap<[u64; 3], u32> = BTreeMap::new();
        let mut places = Vec::new();
        let mut faces = Vec::with_capacity(scene.n_triangles());
        for (object, o) in (0..).zip(scene.objects()) {
            if !across_objects {
                ids.clear();
            }
            // Negative zero is zero.
            let mut place = |p: &Point3| {
                let p = p.map(|x| x + 0.0);
                *ids.entry(p.map(f64::to_bits)).or_insert_with(|| {
                    places.push(p);
                    (places.len() - 1) as u32
                })
            };
            let of_vertex: Vec<u32> = o.vertices.iter().map(&mut place).collect();
            faces.extend(o.triangles.iter().map(|&wedges| Face {
                object,
                wedges,
                corners: wedges.map(|v| of_vertex[v as usize]),
                state: State::Kept,
            }));
        }
        let mut at = vec![Vec::new(); places.len()];
        for (id, face) in (0..).zip(&faces) {
            for (k, &corner) in face.corners.iter().enumerate() {
                if !face.corners[..k].contains(&corner) {
                    at[corner as usize].push(id);
                }
            }
        }
        Self { places, n_left: faces.len(), faces, at }
    }

    pub(crate) fn faces(&self) -> &[Face] {
        &self.faces
    }

    pub(crate) fn face(&self, id: u32) -> &Face {
        &self.faces[id as usize]
    }

    /// Number of faces that are not removed.
    pub(crate) fn n_left(&self) -> usize {
        self.n_left
    }

    pub(crate) fn n_places(&self) -> usize {
        self.places.len()
    }

    pub(crate) fn place(&self, id: u32) -> Point3 {
        self.places[id as usize]
    }

    /// The faces at a place that are not removed.
    pub(crate) fn at(&self, place: u32) -> &[u32] {
        &self.at[place as usize]
    }

    pub(crate) fn corners(&self, face: u32) -> [Point3; 3] {
        self.face(face).corners.map(|c| self.place(c))
    }

    /// Removes a face.
    pub(crate) fn remove(&mut self, id: u32) {
        let face = &mut self.faces[id as usize];
        if std::mem::replace(&mut face.state, State::Gone) == State::Gone {
            return;
        }
        self.n_left -= 1;
        for corner in face.corners {
            self.at[corner as usize].retain(|&f| f != id);
        }
    }

    /// The neighbouring places, ascending, each with the number of faces at the edge between.
    pub(crate) fn around(&self, place: u32) -> Vec<(u32, u32)> {
        let mut others: Vec<u32> =
            self.at(place).iter().flat_map(|&f| self.face(f).corners).filter(|&c| c != place).collect();
        others.sort_unstable();
        let mut around: Vec<(u32, u32)> = Vec::new();
        for other in others {
            match around.last_mut().filter(|last| last.0 == other) {
                Some(last) => last.1 += 1,
                None => around.push((other, 1)),
            }
        }
        around
    }

    /// For each object the remaining triangles: kept ones first, then merged ones.
    pub(crate) fn left(&self, scene: &Scene) -> Left {
        let mut left = Left::default();
        let mut first = 0;
        for object in scene.objects() {
            let faces = &self.faces[first..first + object.triangles.len()];
            first += object.triangles.len();
            let of = |state: State| (0..).zip(faces).filter(move |(_, f)| f.state == state);
            let changed = || of(State::Merged).chain(of(State::New));
            left.triangles.push(of(State::Kept).chain(changed()).map(|(_, f)| f.wedges).collect());
            left.origin.push(of(State::Kept).map(|(k, _)| Some(k)).chain(changed().map(|_| None)).collect());
        }
        left
    }
}
