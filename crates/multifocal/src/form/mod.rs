//! The integer form of umbrae: what fast backends draw, the same bits on every device.
//!
//! The umbra of an [`Occluder`] on a plane is where certain affine functions of the place are not negative: one for
//! each edge of its outline, one for each of its facets. The functions are computed in doubles with a bound of
//! their error, and each is replaced by one with integer coefficients that is nowhere larger within the rectangle of
//! texels that is drawn. Values are replaced in the same way: by constants and by affine functions that are nowhere
//! larger than the exact value. What a backend does with these integers is the same on every machine, and errs
//! towards visible because the integers do.
//!
//! # Magnitudes
//! Coefficients `A` and `B` of an edge are at most 2^28 over the longer side of the plane in texels, so that `A * x` and
//! `B * y` are at most 2^28 each; an edge that is not superfluous is negative somewhere within the bounds, so `C` is
//! at most 2^29, and below -2^30 the occluder is left out. So the sum stays within 32 bits, in any order.

mod affine;
mod edges;
mod value;

use crate::{BufferJob, BufferPlane, Measure, Occluder, Volume};
use affine::Window;
use sightlines_geometry::Point3;
use std::ops::Range;

/// Where an occluder hides everything, and from which value on.
///
/// Texel `(x, y)` is blocked if it is within `bounds` and `A * x + B * y + C >= 0` for each of its edges; its
/// value is then the largest of `floor` and, for each of its slopes, `R + P * (x - x0) + Q * (y - y0)`, in the code of
/// [`Buffer`](crate::Buffer).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// `x0, y0, x1, y1`: texels from `(x0, y0)` to before `(x1, y1)`.
    pub bounds: [i32; 4],
    /// The first of its edges in [`Forms::edges`].
    pub first_edge: u32,
    /// How many edges.
    pub n_edges: u32,
    /// The least value, at least 1.
    pub floor: u32,
    /// The first of its slopes in [`Forms::slopes`].
    pub first_slope: u32,
    /// How many slopes.
    pub n_slopes: u32,
}

/// The integer forms of the occluders of a job on one plane.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Forms {
    /// One for each occluder that hides anything.
    pub forms: Vec<Form>,
    /// `A, B, C` of all edges.
    pub edges: Vec<[i32; 3]>,
    /// `P, Q, R` of all slopes.
    pub slopes: Vec<[i32; 3]>,
}

impl Forms {
    /// The forms of all occluders of a job on one of its planes. O(occluders · corners).
    ///
    /// Each value is a lower bound of the exact one, and `measure` [`Measure::ClippedEuclid`] has no such form: it is
    /// bounded by [`Measure::Euclid`].
    ///
    /// # Panics
    /// If the job has no plane `plane`.
    pub fn of(job: &BufferJob<'_>, plane: usize) -> Self {
        let mut forms = Self::default();
        forms.extend(job, &Outlines::of(job), plane);
        forms
    }

    /// Appends the forms of all occluders of a job on one of its planes, as [`Self::of`].
    ///
    /// * `outlines`: those of the same job
    ///
    /// # Panics
    /// If the job has no plane `plane`.
    pub fn extend(&mut self, job: &BufferJob<'_>, outlines: &Outlines, plane: usize) {
        let builder = FormBuilder::new(job.volume(), &job.planes()[plane], job.measure(), job.unit());
        for of in &outlines.of_occluders {
            builder.add(job.occluders()[of.occluder], of.n_facets, &outlines.sides[of.sides.clone()], self);
        }
    }

    /// Removes all forms, but keeps their memory.
    pub fn clear(&mut self) {
        self.forms.clear();
        self.edges.clear();
        self.slopes.clear();
    }

    /// Edges of a form.
    pub fn edges_of(&self, form: &Form) -> &[[i32; 3]] {
        &self.edges[form.first_edge as usize..][..form.n_edges as usize]
    }

    /// Slopes of a form.
    pub fn slopes_of(&self, form: &Form) -> &[[i32; 3]] {
        &self.slopes[form.first_slope as usize..][..form.n_slopes as usize]
    }
}

/// The planes in space that bound the umbrae of the occluders of a job: the same for all of its planes.
#[derive(Debug, Clone, Default)]
pub struct Outlines {
    of_occluders: Vec<Outline>,
    sides: Vec<edges::Side>,
}

/// Those of an occluder that can hide something.
#[derive(Debug, Clone)]
struct Outline {
    occluder: usize,
    /// The first sides are those of its facets.
    n_facets: usize,
    sides: Range<usize>,
}

impl Outlines {
    /// Those of all occluders of a job. O(corners).
    pub fn of(job: &BufferJob<'_>) -> Self {
        let mut outlines = Self::default();
        outlines.refill(job);
        outlines
    }

    /// Replaces them by those of another job, but keeps their memory.
    pub fn refill(&mut self, job: &BufferJob<'_>) {
        self.of_occluders.clear();
        self.sides.clear();
        let corners = job.volume().corners();
        for (occluder, o) in job.occluders().iter().enumerate() {
            let first = self.sides.len();
            if edges::sides(o, &corners, &mut self.sides) {
                let sides = first..self.sides.len();
                self.of_occluders.push(Outline { occluder, n_facets: o.facets().len(), sides });
            }
        }
    }
}

/// The data that all occluders on a plane share.
struct FormBuilder<'a> {
    window: Window<'a>,
    corners: [Point3; 8],
    measure: Measure,
    unit: f64,
}

impl<'a> FormBuilder<'a> {
    fn new(volume: &Volume, plane: &'a BufferPlane, measure: Measure, unit: f64) -> Self {
        Self { window: Window::new(plane), corners: volume.corners(), measure, unit }
    }

    fn add(&self, occluder: &Occluder, n_facets: usize, sides: &[edges::Side], out: &mut Forms) {
        let Some(bounds) = edges::bounds(sides, &self.window) else { return };
        let (first_edge, first_slope) = (out.edges.len(), out.slopes.len());
        if !edges::push_edges(sides, &self.window, bounds, &mut out.edges) {
            out.edges.truncate(first_edge);
            return;
        }
        let facets = &sides[..n_facets];
        let floor = match self.measure {
            Measure::VertexHeight | Measure::SectionHeight => {
                value::heights(self, occluder, facets, bounds, &mut out.slopes)
            }
            Measure::Euclid | Measure::ClippedEuclid => {
                value::distances(self, occluder, facets, bounds, &mut out.slopes)
            }
        };
        out.forms.push(Form {
            bounds,
            first_edge: first_edge as u32,
            n_edges: (out.edges.len() - first_edge) as u32,
            floor,
            first_slope: first_slope as u32,
            n_slopes: (out.slopes.len() - first_slope) as u32,
        });
    }
}
