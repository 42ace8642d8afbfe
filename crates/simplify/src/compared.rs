//! A scene before and after, compared along the same rays.

use crate::estimate::EyeSampler;
use crate::rays::{FirstHits, Traced};
use crate::simplified::Simplified;
use crate::simplify::SimplifyError;
use crate::views::Views;
use sightlines_cells::Scene;
use sightlines_geometry::vector::{dot, normal, sub};
use sightlines_geometry::{Point3, Random, orient3d};
use sightlines_visible_surface::Faces;

/// Fresh eyes in views.
pub(crate) struct Eyes<'a> {
    views: &'a Views,
    places: EyeSampler<'a>,
    seed: u64,
}

impl<'a> Eyes<'a> {
    pub(crate) fn new(views: &'a Views, seed: u64) -> Self {
        Self { views, places: EyeSampler::new(views), seed }
    }

    /// The position of an eye, and the random numbers of its rays. Every other eye is in one part after the other, so
    /// that flat parts get some too.
    pub(crate) fn place(&self, eye: usize) -> (Point3, Random) {
        let mut random = Random::new(self.seed ^ (eye as u64).wrapping_mul(0x2545_f491_4f6c_dd1d));
        let part = self.views.parts()[eye / 2 % self.views.parts().len()].volume;
        let place = if eye.is_multiple_of(2) { self.places.any(&mut random) } else { random.point(part.bounds()) };
        (place, random)
    }
}

/// A triangle that was removed or added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cause {
    Gone(u32),
    New(u32),
}

/// The difference along a ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Difference {
    /// The triangle that was hit before and is gone; otherwise the new one that is hit now.
    pub(crate) cause: Cause,
    pub(crate) is_other_object: bool,
    /// Whether the hit is on another object, or at another depth by more than a hundredth.
    pub(crate) has_moved: bool,
}

/// A scene before and after.
pub(crate) struct Compared {
    before: Faces,
    after: Left,
    /// For each face of the original.
    is_kept: Vec<bool>,
    is_hidden: Vec<bool>,
    /// For each object.
    is_opaque: Vec<bool>,
}

impl Compared {
    pub(crate) fn new(scene: &Scene, simplified: &Simplified) -> Result<Self, SimplifyError> {
        let before = Faces::of_scene(scene)?;
        let after = Left::new(scene, simplified)?;
        let mut is_kept = vec![false; before.len()];
        after.origin.iter().flatten().for_each(|&face| is_kept[face as usize] = true);
        let mut is_hidden = vec![false; before.len()];
        let mut first = 0;
        for (object, hidden) in scene.objects().iter().zip(&simplified.hidden) {
            hidden.iter().for_each(|&k| is_hidden[first + k as usize] = true);
            first += object.triangles.len();
        }
        let is_opaque = (0u32..).zip(scene.objects()).map(|(object, _)| scene.is_opaque(object)).collect();
        Ok(Self { before, after, is_kept, is_hidden, is_opaque })
    }

    /// Both scenes, ready for rays; and once more without what is see-through, if there is any: what is behind it is seen too.
    pub(crate) fn traced(&self) -> Vec<[Traced<'_>; 2]> {
        let mut traced = vec![[Traced::new(&self.before), Traced::new(&self.after.faces)]];
        if !self.is_opaque.iter().all(|is_opaque| *is_opaque) {
            let before = Traced::of(&self.before, |face| self.is_opaque[self.before.object(face) as usize]);
            let is_opaque = |face: u32| self.is_opaque[self.after.object[face as usize] as usize];
            traced.push([before, Traced::of(&self.after.faces, is_opaque)]);
        }
        traced
    }

    /// The first difference along a ray, of those with and without what is see-through; of those that count.
    pub(crate) fn look_through(
        &self,
        rays: &mut [[FirstHits<'_>; 2]],
        eye: Point3,
        way: Point3,
        counts: impl Fn(&Difference) -> bool,
    ) -> Option<Difference> {
        rays.iter_mut().find_map(|rays| self.look(rays, eye, way).filter(&counts))
    }

    /// The triangles that may cause a difference: those with an area that were removed or added; and those that should
    /// not, because they are reported hidden.
    pub(crate) fn causes(&self) -> [Vec<Cause>; 2] {
        let gone = self.before.ids().filter(|&f| !self.is_kept[f as usize] && self.before.has_area(f));
        let (hidden, gone): (Vec<u32>, Vec<u32>) = gone.partition(|&f| self.is_hidden[f as usize]);
        let new = (0..).zip(&self.after.origin).filter(|(_, origin)| origin.is_none()).map(|(f, _)| Cause::New(f));
        [gone.into_iter().map(Cause::Gone).chain(new).collect(), hidden.into_iter().map(Cause::Gone).collect()]
    }

    pub(crate) fn corners(&self, cause: Cause) -> &[Point3; 3] {
        match cause {
            Cause::Gone(face) => self.before.of(face),
            Cause::New(face) => self.after.faces.of(face),
        }
    }

    /// The difference along a ray; `None` if both first hits are on the same triangle, or on triangles of the same
    /// object in the same plane.
    fn look(&self, [old, new]: &mut [FirstHits<'_>; 2], eye: Point3, way: Point3) -> Option<Difference> {
        let (a, b) = (old.of(eye, way), new.of(eye, way));
        let origin = b.and_then(|b| self.after.origin[b as usize]);
        if a.is_some() == b.is_some() && a == origin {
            return None;
        }
        let objects = [a.map(|a| self.before.object(a)), b.map(|b| self.after.object[b as usize])];
        let is_other_object = objects[0] != objects[1];
        let both = a.map(|a| self.before.of(a)).zip(b.map(|b| self.after.faces.of(b)));
        if !is_other_object && both.is_some_and(|(a, b)| in_one_plane(a, b)) {
            return None;
        }
        let cause = match (a, b) {
            (Some(a), _) if !self.is_kept[a as usize] => Cause::Gone(a),
            (_, Some(b)) => Cause::New(b),
            (a, None) => Cause::Gone(a.unwrap_or(0)),
        };
        let moved = |(a, b): (&[Point3; 3], &[Point3; 3])| {
            let [s, t] = [a, b].map(|face| depth(face, eye, way));
            (s - t).abs() > 0.01 * s.abs()
        };
        Some(Difference { cause, is_other_object, has_moved: is_other_object || both.is_some_and(moved) })
    }
}

/// The remaining triangles with their origins.
struct Left {
    faces: Faces,
    object: Vec<u32>,
    /// For each, the face of the original scene that it was.
    origin: Vec<Option<u32>>,
}

impl Left {
    fn new(scene: &Scene, simplified: &Simplified) -> Result<Self, SimplifyError> {
        let (mut corners, mut object, mut origin) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        let lists = simplified.triangles.iter().zip(&simplified.origin);
        for ((id, o), (triangles, origins)) in (0..).zip(scene.objects()).zip(lists) {
            for (triangle, of) in triangles.iter().zip(origins) {
                corners.push(triangle.map(|v| o.vertices[v as usize]));
                object.push(id);
                origin.push(of.map(|k| first + k));
            }
            first += o.triangles.len() as u32;
        }
        Ok(Self { faces: Faces::new(corners)?, object, origin })
    }
}

/// Whether two triangles lie in one plane, exactly.
fn in_one_plane([a, b, c]: &[Point3; 3], other: &[Point3; 3]) -> bool {
    other.iter().all(|p| orient3d(*a, *b, *c, *p) == 0.0)
}

/// The distance along a ray to the plane of a triangle, rounded.
fn depth(t: &[Point3; 3], eye: Point3, way: Point3) -> f64 {
    let n = normal(*t);
    dot(n, sub(t[0], eye)) / dot(n, way)
}
