//! From which value on an occluder blocks a texel.
//!
//! The value is the least measure of the points where segments from the texel to the volume meet the occluder. It is
//! computed only for texels that [`Hiding::hides`] blocks: so on every segment there is a point of the occluder on the
//! plane of one of its facets, with the eye strictly in front of all their planes and the point of the texel behind or
//! on them. Such a point lies between the eye and the texel, in front of the buffer's plane or on it.
//!
//! * Heights therefore are at least 0, however far an occluder reaches behind the plane: that part is met by no segment.
//!   They are at least that of the occluder's lowest corner, being heights of points of it.
//! * [`Measure::SectionHeight`]: let `f` be the distance of an eye at height `H` from a facet's plane and `b` that of a
//!   point of the texel, in any common unit; the segment crosses the plane at height `H b / (f + b)`. The section of that
//!   plane with the hull of volume and texel is a polygon whose corners are such crossings of corners, so the lowest
//!   of the 8 · 4 crossings is the lowest of all. Of a flat occluder that is the answer. Of a bent one it is not known
//!   which facet is met, so the lowest of all facets counts; where that is below the lowest corner, the corner counts.
//! * [`Measure::Euclid`]: of a flat occluder, the distance between the texel and its triangles. They are taken as a fan
//!   from the first corner of the outline: a polygon winds around each of its points, so some triangle of the fan
//!   does too, and a convex polygon is the same as its fan.
//! * [`Measure::ClippedEuclid`]: the distance between the texel and the section. Of a flat occluder the section is a
//!   part of it, as every segment is blocked.
//! * Of bent occluders, both distances are that to the nearest facet's section, or the height of the lowest corner
//!   if that is more: no distance is less than the height.

use super::distance::{Rational3, hull, polygon, square_of_distance};
use super::grid::Integer3;
use super::umbra::Hiding;
use num_traits::{ToPrimitive, Zero};
use sightlines_exact::vector::{dot, normal, sub};
use sightlines_exact::{BigInt, Fraction, Grid};
use sightlines_geometry::Point3;
use sightlines_multifocal::{BufferJob, BufferPlane, Measure, Occluder};

/// The values of one occluder on one plane.
pub(super) struct Values {
    grid: Grid,
    measure: Measure,
    is_flat: bool,
    unit: BigInt,
    eyes: [Integer3; 8],
    /// Of the eyes above the plane; positive.
    heights: [BigInt; 8],
    /// Of the occluder's lowest corner, or 0.
    lowest: BigInt,
    facets: Vec<Facet>,
    outline: Vec<Integer3>,
}

/// The plane of a facet, its normal turned to the eyes.
struct Facet {
    normal: Integer3,
    on: Integer3,
    /// Distances of the eyes, times the length of the normal; positive.
    in_front: [BigInt; 8],
}

impl Facet {
    fn new(corners: [Integer3; 3], is_in_front: bool, eyes: &[Integer3; 8]) -> Self {
        let normal = normal(&corners);
        let normal = if is_in_front { normal } else { normal.map(|x| -x) };
        let [on, ..] = corners;
        let in_front = eyes.each_ref().map(|v| dot(&normal, &sub(v, &on)));
        Self { normal, on, in_front }
    }

    /// Distance of a point of a blocked texel behind the plane, times the length of the normal; not negative.
    fn behind(&self, p: &Integer3) -> BigInt {
        dot(&self.normal, &sub(&self.on, p))
    }

    /// The section of the plane with the hull of the eyes and a texel.
    fn section(&self, eyes: &[Integer3; 8], texel: &[Integer3; 4]) -> Vec<Rational3> {
        let mut crossings = Vec::with_capacity(32);
        for p in texel {
            let b = self.behind(p);
            for (v, f) in eyes.iter().zip(&self.in_front) {
                let x = [0, 1, 2].map(|k| f * &p[k] + &b * &v[k]);
                crossings.push(Rational3 { x, w: f + &b });
            }
        }
        hull(crossings, &self.normal)
    }
}

impl Values {
    pub(super) fn new(job: &BufferJob<'_>, grid: Grid, plane: &BufferPlane, hiding: &Hiding<'_>) -> Self {
        let occluder = hiding.occluder();
        let eyes = hiding.eyes().map(|v| grid.vector(v));
        let height = |x: f64| {
            let h = grid.integer(plane.at()) - grid.integer(x);
            if plane.positive() { h } else { -h }
        };
        let facets = occluder.facets().iter().map(|f| f.map(|p| grid.vector(p)));
        Self {
            grid,
            measure: job.measure(),
            is_flat: occluder.is_flat(),
            unit: grid.integer(job.unit()),
            heights: hiding.eyes().map(|v| height(v[plane.axis()])),
            lowest: lowest(occluder, plane, height),
            facets: facets.map(|f| Facet::new(f, hiding.is_in_front(), &eyes)).collect(),
            eyes,
            outline: occluder.outline().iter().map(|&p| grid.vector(p)).collect(),
        }
    }

    /// What is stored for a texel, of which the corners are given, that the occluder blocks.
    pub(super) fn at(&self, texel: &[Point3; 4]) -> u32 {
        let texel = texel.map(|p| self.grid.vector(p));
        let lowest = || Fraction::from(self.lowest.clone());
        match (self.measure, self.is_flat) {
            (Measure::VertexHeight, _) => self.encode_height(&lowest()),
            (Measure::SectionHeight, _) => self.encode_height(&self.lowest_crossing(&texel).max(lowest())),
            (Measure::Euclid, true) => self.encode_square(&self.to_outline(&texel)),
            (Measure::ClippedEuclid, true) => self.encode_square(&self.to_sections(&texel)),
            (Measure::Euclid | Measure::ClippedEuclid, false) => {
                let square = Fraction::from(&self.lowest * &self.lowest);
                self.encode_square(&self.to_sections(&texel).max(square))
            }
        }
    }

    fn lowest_crossing(&self, texel: &[Integer3; 4]) -> Fraction {
        let of_facet = |facet: &Facet| {
            let at = |b: &BigInt, (f, h): (&BigInt, &BigInt)| Fraction::new(h * b, f + b);
            let behind = texel.each_ref().map(|p| facet.behind(p));
            let eyes = || facet.in_front.iter().zip(&self.heights);
            least(behind.iter().flat_map(|b| eyes().map(move |eye| at(b, eye))))
        };
        least(self.facets.iter().map(of_facet))
    }

    fn to_outline(&self, texel: &[Integer3; 4]) -> Fraction {
        let texel = polygon(texel);
        let first = &self.outline[0];
        let fan = self.outline[1..].windows(2).map(|pair| polygon([first, &pair[0], &pair[1]]));
        least(fan.map(|triangle| square_of_distance(&texel, &triangle)))
    }

    fn to_sections(&self, texel: &[Integer3; 4]) -> Fraction {
        let corners = polygon(texel);
        let section = |facet: &Facet| square_of_distance(&corners, &facet.section(&self.eyes, texel));
        least(self.facets.iter().map(section))
    }

    fn encode_height(&self, height: &Fraction) -> u32 {
        self.encode(height.numerator() / (height.denominator() * &self.unit))
    }

    /// The root of the whole part is the whole part of the root.
    fn encode_square(&self, square: &Fraction) -> u32 {
        self.encode((square.numerator() / (square.denominator() * &self.unit * &self.unit)).sqrt())
    }

    fn encode(&self, units: BigInt) -> u32 {
        units.to_u32().and_then(|u| u.checked_add(1)).expect("values of a job are less than 2^28")
    }
}

fn least(mut of: impl Iterator<Item = Fraction>) -> Fraction {
    let first = of.next().expect("an occluder has corners and facets");
    of.fold(first, Fraction::min)
}

fn lowest(occluder: &Occluder, plane: &BufferPlane, height: impl Fn(f64) -> BigInt) -> BigInt {
    let b = occluder.bounds();
    let farthest = if plane.positive() { b.max } else { b.min };
    height(farthest[plane.axis()]).max(BigInt::zero())
}
