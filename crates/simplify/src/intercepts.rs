//! Bounds on what faces can intercept of the rays of a view.

use crate::bound;
use crate::hidden::{HiddenBy, Hider};
use crate::views::{ViewBox, Views};
use rayon::prelude::*;
use sightlines_multifocal::BackendError;
use sightlines_visible_surface::Faces;

/// For each part of the views and each face the largest share of the sphere of directions that the face intercepts for an eye of the
/// part: a proven bound, 0 for faces that are proven hidden.
#[derive(Debug, Clone, PartialEq)]
pub struct Intercepts {
    n_faces: usize,
    /// Part by part.
    bounds: Vec<f64>,
}

impl Intercepts {
    /// Bounds for all faces of a scene.
    ///
    /// * `by`: what proves faces hidden; a table has to be of the scene whose faces these are, by [`Faces::of_scene`]
    /// * `depth`: how often a triangle is split in four to bound its share, see [`bound::share`]
    ///
    /// # Panics
    /// If a view is of a cell that the table does not have, or a face of an object that it does not have.
    ///
    /// Errs upwards only. Costs what the method costs for each part, and O(4^depth) for each visible face near a part.
    ///
    /// # Errors
    /// [`BackendError`], from the method.
    pub fn new(faces: &Faces, views: &Views, by: &HiddenBy<'_>, depth: u32) -> Result<Self, BackendError> {
        Self::of_hider(faces, views, &Hider::new(faces, by), depth)
    }

    pub(crate) fn of_hider(faces: &Faces, views: &Views, hider: &Hider<'_>, depth: u32) -> Result<Self, BackendError> {
        Ok(Self::of_visible(faces, views, &hider.may_see(views)?, depth))
    }

    /// From the faces that may be visible in each part.
    pub(crate) fn of_visible(faces: &Faces, views: &Views, visible: &[Vec<bool>], depth: u32) -> Self {
        let of = |(view, visible): (&ViewBox, &Vec<bool>)| {
            let share = |face: u32| {
                if visible[face as usize] { bound::share(faces.of(face), view.volume.bounds(), depth) } else { 0.0 }
            };
            faces.ids().into_par_iter().map(share).collect::<Vec<f64>>()
        };
        let bounds: Vec<Vec<f64>> = views.parts().iter().zip(visible).map(of).collect();
        Self { n_faces: faces.len(), bounds: bounds.concat() }
    }

    /// From the faces that may be visible from any part, without looking at how much of the view they intercept: all parts as one.
    pub(crate) fn of_any(visible: &[bool]) -> Self {
        // No face takes up more than half of the sphere.
        Self {
            n_faces: visible.len(),
            bounds: visible.iter().map(|&visible| if visible { 0.5 } else { 0.0 }).collect(),
        }
    }

    /// Number of parts.
    pub fn n_parts(&self) -> usize {
        self.bounds.len() / self.n_faces.max(1)
    }

    /// Number of faces.
    pub const fn n_faces(&self) -> usize {
        self.n_faces
    }

    /// The largest share that a face can intercept for eyes of a part.
    ///
    /// # Panics
    /// If there is no such part or face.
    pub fn of(&self, part: usize, face: u32) -> f64 {
        self.bounds[part * self.n_faces + face as usize]
    }

    /// The largest share that it can intercept for any eye.
    pub fn largest(&self, face: u32) -> f64 {
        (0..self.n_parts()).map(|part| self.of(part, face)).fold(0.0, f64::max)
    }

    /// Whether a face is hidden from every eye.
    pub fn is_hidden(&self, face: u32) -> bool {
        self.largest(face) == 0.0
    }
}
