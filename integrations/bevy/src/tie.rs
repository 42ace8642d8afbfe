//! Which object of a table a mesh of a scene is.
//!
//! A table says of which node and primitive of its file each object is. A scene fits if it has all of them, with the same names, in the same
//! places. Older tables only list one object for each node and primitive, in the order of the file: then a scene has to have as many.

use crate::asset::{PvsTable, TableObject};
use crate::gltf::{PvsScene, PvsSource};
use crate::space::{around, corners};
use sightlines_pvs::{Frame, ObjectId};
use std::collections::BTreeMap;
use std::fmt;

/// For each source of a scene its object in a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Tie {
    objects: Vec<Option<ObjectId>>,
}

/// Why a scene is not the one that a table was made of.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PvsMisfit {
    /// They do not have as many objects.
    Count {
        /// Objects of the table.
        table: usize,
        /// Meshes of the scene.
        scene: usize,
    },
    /// An object has another name.
    Name {
        /// Index of the object, in the order of the file.
        object: usize,
        /// Its name in the table.
        table: String,
        /// The name of the mesh in its place.
        scene: String,
    },
    /// An object is not in the scene.
    Missing {
        /// Index of the object, in the order of the table.
        object: usize,
        /// Its name.
        name: String,
    },
    /// An object is somewhere else.
    Place {
        /// Index of the object, in the order of the file.
        object: usize,
        /// Its name.
        name: String,
    },
    /// The table cannot be read.
    Read {
        /// Why.
        error: String,
    },
}

impl fmt::Display for PvsMisfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { table, scene } => write!(f, "the table has {table} objects, the scene {scene} meshes"),
            Self::Name { object, table, scene } => {
                write!(f, "object {object} is {table:?} in the table and {scene:?} in the scene")
            }
            Self::Missing { object, name } => write!(f, "object {object}, {name:?}, is not in the scene"),
            Self::Place { object, name } => write!(f, "object {object}, {name:?}, is elsewhere in the scene"),
            Self::Read { error } => write!(f, "the table cannot be read: {error}"),
        }
    }
}

impl Tie {
    /// Compares the objects of a table with the sources of a scene. O(objects · log objects).
    pub(crate) fn new(table: &PvsTable, scene: &PvsScene) -> Result<Self, PvsMisfit> {
        let read = |error| PvsMisfit::Read { error };
        let (objects, in_cells) = (table.objects().map_err(read)?, table.in_cells().map_err(read)?);
        let places = places(&objects, scene)?;
        let mut tied = vec![None; scene.sources.len()];
        for (k, (object, place)) in objects.iter().zip(&places).enumerate() {
            let Some(place) = *place else { continue };
            let source = &scene.sources[place];
            if object.name != source.name {
                let (table, scene) = (object.name.clone(), source.name.clone());
                return Err(PvsMisfit::Name { object: k, table, scene });
            }
            // What touches no cell is not drawn by those who made the table, or not known: that is left to Bevy.
            if in_cells[k] {
                if !is_there((object.min, object.max), source, table.frame()) {
                    return Err(PvsMisfit::Place { object: k, name: object.name.clone() });
                }
                tied[place] = Some(ObjectId(k as u32));
            }
        }
        Ok(Self { objects: tied })
    }

    /// The object of a source; `None` if nothing is known of it.
    #[inline]
    pub(crate) fn object(&self, source: u32) -> Option<ObjectId> {
        self.objects.get(source as usize).copied().flatten()
    }

    /// Number of sources with an object.
    pub(crate) fn n_tied(&self) -> usize {
        self.objects.iter().flatten().count()
    }
}

/// For each object of a table its place among the sources of a scene; `None` for one that is nowhere in the file, or one of several
/// instances of a mesh, which Bevy draws as one.
fn places(objects: &[TableObject], scene: &PvsScene) -> Result<Vec<Option<usize>>, PvsMisfit> {
    let (n_table, n_scene) = (objects.len(), scene.sources.len());
    if objects.iter().all(|object| object.source.is_none()) {
        // An older table: its objects are in the order of the file.
        return match n_table == n_scene {
            true => Ok((0..n_scene).map(Some).collect()),
            false => Err(PvsMisfit::Count { table: n_table, scene: n_scene }),
        };
    }
    let there: BTreeMap<(u32, u32), usize> =
        (0..).zip(&scene.sources).map(|(place, source)| ((source.node, source.primitive), place)).collect();
    let mut n_of = BTreeMap::<(u32, u32), usize>::new();
    objects.iter().filter_map(|object| object.source).for_each(|source| *n_of.entry(source).or_default() += 1);
    let place = |(k, object): (usize, &TableObject)| match object.source {
        None => Ok(None),
        Some(source) => match there.get(&source) {
            Some(&place) => Ok((n_of[&source] == 1).then_some(place)),
            None if k + 1 > n_scene => Err(PvsMisfit::Count { table: n_table, scene: n_scene }),
            None => Err(PvsMisfit::Missing { object: k, name: object.name.clone() }),
        },
    };
    objects.iter().enumerate().map(place).collect()
}

/// Whether the box of an object may be around the same mesh as that of a source: one of the two contains the other.
///
/// The box of a source is that around the turned box of its mesh, so the object's is within it, unless the object moves: then it is within
/// the object's. They are compared to within what single precision makes of them, for which 256 units of 2^-24 leave room:
/// this finds tables that do not belong to a level, and decides nothing about what is seen.
fn is_there((min, max): ([f64; 3], [f64; 3]), source: &PvsSource, frame: Option<&Frame>) -> bool {
    let here = match frame {
        Some(frame) => around(corners(source.min, source.max).map(|corner| frame.to_frame(corner))),
        None => (source.min, source.max),
    };
    let size = (0..3).map(|k| here.0[k].abs().max(here.1[k].abs())).fold(0.0, f64::max);
    let slack = size * 256.0 / f64::from(1u32 << 24) + frame.map_or(0.0, Frame::gap);
    let within = |inner: ([f64; 3], [f64; 3]), outer: ([f64; 3], [f64; 3])| {
        (0..3).all(|k| outer.0[k] - slack <= inner.0[k] && inner.1[k] <= outer.1[k] + slack)
    };
    within((min, max), here) || within(here, (min, max))
}
