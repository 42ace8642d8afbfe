//! Ray casting: for each pixel the face that its ray meets first. The ground truth of this crate.
//!
//! Faces lie in a tree of boxes. A box is left out only if the ray misses it, or meets it behind what it has met, by bounds of
//! rounding; whether the ray meets a face, and which of two it meets first, is decided exactly.
//!
//! Source: Appel, "Some techniques for shading machine renderings of solids", AFIPS SJCC 1968; boxes with bounds: Ize, "Robust BVH
//! ray traversal", JCGT 2(2), 2013, for the idea.

use crate::camera::{Camera, U};
use crate::counters::Counters;
use crate::face_mask::FaceMask;
use crate::faces::{Faces, NOTHING};
use crate::fragment::{Fragment, facing};
use crate::image::Image;
use crate::method::{RenderInput, RenderOutput, VisibleSurface};
use crate::nearness::{DepthComparator, Nearness};
use crate::vector::{cross, cross_size, dot, dot_size, sub};
use sightlines_geometry::{Aabb, BoxTree, Point3};

/// Casts a ray through the centre of each pixel.
#[derive(Debug, Clone)]
pub struct RayCaster {
    n_faces: usize,
    /// Those that have an area.
    ids: Vec<u32>,
    tree: BoxTree<3>,
}

/// Faces in a leaf.
const PER_LEAF: usize = 4;

impl RayCaster {
    /// The tree of the faces of a scene. O(n log² n).
    pub fn build(faces: &Faces) -> Self {
        let ids: Vec<u32> = faces.ids().filter(|&f| faces.has_area(f)).collect();
        let boxes: Vec<Aabb<3>> = ids.iter().map(|&f| faces.bounds(f)).collect();
        Self { n_faces: faces.len(), ids, tree: BoxTree::build(&boxes, PER_LEAF) }
    }

    /// Rays one by one, from any eyes: what is learnt about faces is kept from one to the next.
    ///
    /// # Panics
    /// If the faces are not as many as those that the tree was built of.
    pub fn rays<'a>(&'a self, faces: &'a Faces, chosen: &'a FaceMask) -> Rays<'a> {
        assert_eq!(self.n_faces, faces.len(), "a tree serves the faces that it was built of");
        Rays {
            caster: self,
            faces,
            chosen,
            comparator: DepthComparator::default(),
            camera: None,
            n_boxes: 0,
            n_faces: 0,
            n_doubts: 0,
            stack: Vec::new(),
        }
    }
}

impl VisibleSurface for RayCaster {
    fn name(&self) -> &'static str {
        "raycast"
    }

    /// # Panics
    /// If the faces are not as many as those that the tree was built of.
    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        let [width, height] = input.camera.size();
        let mut image = Image::new([width, height]);
        let mut rays = self.rays(input.faces, input.mask);
        for y in 0..height {
            for x in 0..width {
                let face = rays.first(input.camera, x, y);
                image.span_mut(y, x, x + 1)[0] = face;
                counters.written += u64::from(face != NOTHING);
            }
        }
        counters.polygons = input.mask.len() as u64;
        counters.exact += rays.comparator.n_exact + rays.n_doubts;
        counters.tested("boxes", rays.n_boxes);
        counters.tested("faces", rays.n_faces);
        RenderOutput::Picture(image)
    }
}

/// Rays through a scene. Holds room to work in; use one for each thread.
#[derive(Debug)]
pub struct Rays<'a> {
    caster: &'a RayCaster,
    faces: &'a Faces,
    chosen: &'a FaceMask,
    comparator: DepthComparator,
    /// Of the last ray.
    camera: Option<Camera>,
    n_boxes: u64,
    n_faces: u64,
    n_doubts: u64,
    stack: Vec<(f64, u32)>,
}

/// A ray with bounds of its rounding, which `geometry::ray_box` and `geometry::ray_triangle` do not have; so its tests are its own.
struct Ray {
    eye: Point3,
    way: Point3,
    /// What rounding in `way` is measured by.
    size: Point3,
    inverse: Point3,
    /// For each axis how much a quotient by `way` may be off, as a part of itself; infinite if nothing can be said.
    off: Point3,
}

impl Ray {
    fn new(camera: &Camera, x: u32, y: u32) -> Self {
        let [px, py] = [x, y].map(|n| f64::from(n) + 0.5);
        let way = camera.ray(px, py);
        let [corner, across, down] = camera.rays();
        let size = [0, 1, 2].map(|k| corner[k].abs() + px * across[k].abs() + py * down[k].abs());
        let off = [0, 1, 2].map(|k| {
            let error = 4.0 * U * size[k];
            // Rounding of the difference, the inverse and the product come on top; twice for the quotient by what is off.
            if way[k].abs() > 16.0 * error { 2.0 * error / way[k].abs() + 8.0 * U } else { f64::INFINITY }
        });
        Self { eye: camera.eye(), way, size, inverse: way.map(|x| 1.0 / x), off }
    }

    /// From which depth on the ray may be in a box; infinite if it surely misses it.
    #[inline]
    fn enters(&self, b: &Aabb<3>) -> f64 {
        let (mut from, mut to) = (0.0f64, f64::INFINITY);
        for k in 0..3 {
            if self.off[k] == f64::INFINITY {
                continue;
            }
            let (s, t) = ((b.min[k] - self.eye[k]) * self.inverse[k], (b.max[k] - self.eye[k]) * self.inverse[k]);
            let (s, t) = (s.min(t), s.max(t));
            from = from.max(s - s.abs() * self.off[k]);
            to = to.min(t + t.abs() * self.off[k]);
        }
        if from <= to { from } else { f64::INFINITY }
    }
}

impl Rays<'_> {
    /// The face that the ray of a pixel meets first, exactly as [`RayCaster`] has it; [`NOTHING`] if there is none.
    pub fn first(&mut self, camera: &Camera, x: u32, y: u32) -> u32 {
        if self.camera.as_ref() != Some(camera) {
            self.comparator.look_from_elsewhere();
            self.camera = Some(*camera);
        }
        let (faces, chosen) = (self.faces, self.chosen);
        let tree = &self.caster.tree;
        let ray = Ray::new(camera, x, y);
        // The nearest face, one over its depth, how much that may be off, and a depth that it surely does not exceed.
        let (mut best, mut nearness, mut error, mut limit) = (NOTHING, 0.0f64, 0.0f64, f64::INFINITY);
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        stack.push((ray.enters(&tree.nodes()[0].bounds), 0));
        while let Some((from, n)) = stack.pop() {
            self.n_boxes += 1;
            if from == f64::INFINITY || from > limit {
                continue;
            }
            let node = &tree.nodes()[n as usize];
            if !node.is_leaf() {
                let [a, b] = tree.children(n).map(|c| (ray.enters(&tree.nodes()[c as usize].bounds), c));
                stack.extend(if a.0 <= b.0 { [b, a] } else { [a, b] });
                continue;
            }
            for &i in &tree.order()[node.start as usize..node.end as usize] {
                let face = self.caster.ids[i as usize];
                self.n_faces += 1;
                if !chosen.has(face) || !self.meets(camera, &ray, face, x, y) {
                    continue;
                }
                let plane = Nearness::of(camera, faces, face);
                let at = plane.at(x, y);
                let wins = if best == NOTHING {
                    true
                } else if (at - nearness).abs() > plane.error + error {
                    at > nearness
                } else {
                    self.comparator.is_nearer(camera, faces, face, best, x, y)
                };
                if wins {
                    (best, nearness, error) = (face, at, plane.error);
                    let surely = at - plane.error;
                    limit = if surely > 0.0 { (1.0 / surely) * (1.0 + 4.0 * U) } else { f64::INFINITY };
                }
            }
        }
        self.stack = stack;
        best
    }

    /// Whether the ray of a pixel meets a face, at a depth that the camera sees.
    #[inline]
    fn meets(&mut self, camera: &Camera, ray: &Ray, face: u32, x: u32, y: u32) -> bool {
        let faces = self.faces;
        let corners = faces.of(face).map(|p| sub(p, ray.eye));
        let (mut positive, mut negative, mut doubt) = (false, false, false);
        for (p, q) in [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])] {
            let value = dot(cross(p, q), ray.way);
            // Two differences, a product, a difference, a product and two sums, and up to four in the ray.
            let error = 24.0 * U * dot_size(cross_size(p, q), ray.size);
            positive |= value > error;
            negative |= value < -error;
            doubt |= value.abs() <= error;
        }
        if positive && negative {
            return false;
        }
        let [near, far] = camera.depths();
        if !doubt && near == 0.0 && far == f64::INFINITY {
            // The line passes the triangle; the ray does if it is in front of the eye.
            return facing(camera, faces, face) == Some(if positive { 1 } else { -1 });
        }
        self.n_doubts += u64::from(doubt);
        covers(camera, faces, face, x, y)
    }
}

/// Whether the ray through the centre of a pixel meets a face, by the rule of [`Fragment::spans`], at a depth that the camera sees.
pub(crate) fn covers(camera: &Camera, faces: &Faces, face: u32, x: u32, y: u32) -> bool {
    facing(camera, faces, face).is_some()
        && Fragment::whole(face).sides(camera, faces).iter().all(|side| side.has(camera, faces, x, y))
}
