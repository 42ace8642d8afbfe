//! Where eyes are: everywhere outside of a scene, in boxes, or wherever a way leads from boxes.

use crate::space::Stations;
use sightlines_cells::{Scene, Unlike, unlike};
use sightlines_geometry::{Aabb, Point3, Random, check_coordinate};
use sightlines_line_space::FaceExit;
use sightlines_multifocal::{Volume, VolumeError};
use sightlines_pvs::{CellId, Table};
use std::convert::Infallible;

/// How much larger the box is from which a scene is looked at from outside, as a share of its longest side, on each side.
const AROUND: f64 = 1.0 / 16.0;

/// How thick a slab of eyes is, as a share of the longest side of the scene.
const THIN: f64 = 1.0 / (1u64 << 20) as f64;

/// All places of the eye.
#[derive(Debug, Clone, PartialEq)]
pub struct Eyes {
    places: Places,
    /// For each object whether a table hides it from all of its cells; empty without a table.
    hidden_by_table: Vec<bool>,
}

#[derive(Debug, Clone, PartialEq)]
enum Places {
    Outside,
    Boxes(Vec<Volume>),
    /// All that is joined to boxes, and points of it, once a scene was searched for some.
    Joined(Vec<Volume>, Stations),
}

/// Why eyes are invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EyesError {
    /// No box.
    #[error("there is no place for the eye: no box is given")]
    None,
    /// A table whose cells are no boxes, or are along axes of their own.
    #[error("the cells of the table are no boxes along the axes of the scene")]
    NoBoxes,
    /// A table of another scene.
    #[error("the table is of another scene: {0}")]
    OtherScene(#[from] Unlike),
    /// A cell that is not a valid volume.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

impl Eyes {
    /// Eyes everywhere outside of the box around a scene.
    pub const fn outside() -> Self {
        Self { places: Places::Outside, hidden_by_table: Vec::new() }
    }

    /// Eyes in closed boxes.
    ///
    /// # Errors
    /// [`EyesError::None`] for an empty list.
    pub fn in_boxes(boxes: impl IntoIterator<Item = Volume>) -> Result<Self, EyesError> {
        Ok(Self { places: Places::Boxes(some(boxes)?), hidden_by_table: Vec::new() })
    }

    /// Eyes that walk, or fly: in closed boxes, and wherever a way leads from there that no surface bars which hides from both sides. Glass, what moves and what
    /// hides from its front only bar no way. With a [gap](crate::StripOptions::gap), openings through which no ball of that diameter fits bar it, too.
    ///
    /// # Errors
    /// [`EyesError::None`] for an empty list.
    pub fn joined_to(boxes: impl IntoIterator<Item = Volume>) -> Result<Self, EyesError> {
        Ok(Self { places: Places::Joined(some(boxes)?, Stations::default()), hidden_by_table: Vec::new() })
    }

    /// Eyes in all cells of a table of the scene. What the table hides from all of them is hidden; so the answer is no better than the table is.
    ///
    /// # Errors
    /// [`EyesError`] for a table of another scene, and for one whose cells are no boxes along the axes of the scene.
    pub fn in_cells_of(table: &Table, scene: &Scene) -> Result<Self, EyesError> {
        let object = |k: u32| -> Result<_, Infallible> {
            let of = &table.objects()[k as usize];
            Ok((of.name.clone(), Aabb { min: of.min, max: of.max }))
        };
        let Ok(other) = unlike(scene, table.dimension(), table.frame(), table.objects().len(), object);
        let has_changed = table.digest().is_some_and(|digest| digest != scene.digest());
        if let Some(other) = other.or(has_changed.then_some(Unlike::Changed)) {
            return Err(other.into());
        }
        if table.planes().is_some() || !table.kind().has_box_cells() || table.frame().is_some() {
            return Err(EyesError::NoBoxes);
        }
        let boxes = table.cells().iter().map(|cell| Volume::new(Aabb { min: cell.min, max: cell.max }));
        let eyes = Self::in_boxes(boxes.collect::<Result<Vec<_>, _>>()?)?;
        let mut hidden_by_table = vec![true; table.objects().len()];
        for cell in 0..table.n_cells() as u32 {
            table.visible_objects(CellId(cell)).into_iter().for_each(|o| hidden_by_table[o.idx()] = false);
        }
        Ok(Self { hidden_by_table, ..eyes })
    }

    /// The boxes, which ways lead on from if [they do](Self::are_joined); none if eyes are everywhere outside.
    pub fn boxes(&self) -> Option<&[Volume]> {
        match &self.places {
            Places::Outside => None,
            Places::Boxes(boxes) | Places::Joined(boxes, _) => Some(boxes),
        }
    }

    /// Whether one of the boxes meets another box.
    pub(crate) fn meet(&self, b: &Aabb<3>) -> bool {
        let is_met = |eyes: &Aabb<3>| (0..3).all(|k| eyes.min[k] <= b.max[k] && b.min[k] <= eyes.max[k]);
        self.boxes().unwrap_or_default().iter().any(|eyes| is_met(eyes.bounds()))
    }

    /// Whether eyes are wherever a way leads from the boxes.
    pub const fn are_joined(&self) -> bool {
        matches!(self.places, Places::Joined(..))
    }

    /// The same eyes with points that ways were found to.
    pub(crate) fn with_stations(&self, find: impl FnOnce(&[Volume]) -> Stations) -> Self {
        let mut eyes = self.clone();
        if let Places::Joined(boxes, stations) = &mut eyes.places {
            *stations = find(boxes);
        }
        eyes
    }

    /// Points that ways were found to, the nearest to a point first.
    pub(crate) fn stations_near(&self, point: Point3) -> Vec<Point3> {
        match &self.places {
            Places::Joined(_, stations) => stations.near(point),
            _ => Vec::new(),
        }
    }

    pub(crate) fn is_hidden_by_table(&self, object: u32) -> bool {
        self.hidden_by_table.get(object as usize) == Some(&true)
    }

    /// The sides through which lines leave the places of the eye, for a scene in this box.
    ///
    /// Everything outside of a box around the scene sees the scene through the sides of that box, and nothing is outside of it that hides: so the eyes
    /// are those in a thin slab on each side, and their lines leave it inwards. For a box of eyes, all of its sides. One that is flat is made a little
    /// thicker: there are more eyes then, not fewer.
    pub(crate) fn exits(&self, bounds: &Aabb<3>) -> Vec<FaceExit> {
        let size = longest(bounds);
        let thin = size.max(f64::MIN_POSITIVE) * THIN;
        match &self.places {
            Places::Outside => {
                let around = around(bounds);
                let slab = |i: usize| {
                    let (axis, is_high) = (i / 2, i % 2 == 1);
                    let (mut volume, mut part) = (around, around);
                    let at = if is_high { around.max[axis] } else { around.min[axis] };
                    (volume.min[axis], volume.max[axis]) = if is_high { (at, at + thin) } else { (at - thin, at) };
                    (part.min[axis], part.max[axis]) = (at, at);
                    FaceExit { volume, axis, upward: !is_high, part }
                };
                (0..6).map(slab).collect()
            }
            Places::Boxes(boxes) => boxes.iter().flat_map(|eyes| sides(&thick(eyes.bounds(), thin))).collect(),
            // They may be anywhere: in a box with all that is asked about.
            Places::Joined(..) => sides(&around(bounds)).collect(),
        }
    }

    /// A point where an eye can be, from which to look at a point in a direction.
    ///
    /// * `towards`: from the point to the eye, if the eye is anywhere outside
    pub(crate) fn any(&self, bounds: &Aabb<3>, point: Point3, towards: Point3, random: &mut Random) -> Point3 {
        match &self.places {
            Places::Outside => {
                let around = around(bounds);
                // Where the ray leaves the box, and a little farther.
                let leaves = |k: usize| {
                    let side = if towards[k] > 0.0 { around.max[k] } else { around.min[k] };
                    if towards[k] == 0.0 { f64::INFINITY } else { (side - point[k]) / towards[k] }
                };
                let far = (0..3).map(leaves).fold(f64::INFINITY, f64::min) * 1.01;
                std::array::from_fn(|k| point[k] + far * towards[k])
            }
            Places::Boxes(boxes) => {
                let any = random.below(boxes.len());
                random.point(boxes[any].bounds())
            }
            Places::Joined(_, stations) => stations.any(random),
        }
    }

    /// Whether an eye can be at a point.
    pub(crate) fn holds(&self, bounds: &Aabb<3>, point: Point3) -> bool {
        match &self.places {
            Places::Outside => point.iter().all(|&x| check_coordinate(x).is_ok()) && !bounds.contains(point),
            Places::Boxes(boxes) => boxes.iter().any(|eyes| eyes.bounds().contains(point)),
            Places::Joined(boxes, stations) => {
                stations.has(point) || boxes.iter().any(|eyes| eyes.bounds().contains(point))
            }
        }
    }
}

fn some(boxes: impl IntoIterator<Item = Volume>) -> Result<Vec<Volume>, EyesError> {
    let boxes: Vec<Volume> = boxes.into_iter().collect();
    if boxes.is_empty() { Err(EyesError::None) } else { Ok(boxes) }
}

/// The box from which a scene is looked at from outside.
pub(crate) fn around(bounds: &Aabb<3>) -> Aabb<3> {
    larger(bounds, longest(bounds) * AROUND)
}

fn longest(b: &Aabb<3>) -> f64 {
    (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max)
}

fn larger(b: &Aabb<3>, by: f64) -> Aabb<3> {
    Aabb { min: b.min.map(|x| x - by), max: b.max.map(|x| x + by) }
}

/// A box that is thick along all axes. Where the thickness is lost in the size of coordinates it stays flat, and hides nothing.
fn thick(b: &Aabb<3>, thin: f64) -> Aabb<3> {
    let mut thick = *b;
    for k in (0..3).filter(|&k| b.min[k] == b.max[k]) {
        (thick.min[k], thick.max[k]) = (b.min[k] - thin, b.max[k] + thin);
    }
    thick
}

fn sides(b: &Aabb<3>) -> impl Iterator<Item = FaceExit> + use<> {
    let volume = *b;
    (0..6).map(move |i| {
        let (axis, upward) = (i / 2, i % 2 == 1);
        let mut part = volume;
        let at = if upward { volume.max[axis] } else { volume.min[axis] };
        (part.min[axis], part.max[axis]) = (at, at);
        FaceExit { volume, axis, upward, part }
    })
}
