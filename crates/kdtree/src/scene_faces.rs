//! From triangles to faces: which parts of a scene hide, and which are only drawn.

use crate::cache::{FaceCache, PlaneFaces, Shape, total_order};
use crate::coplanar::{FlatRect, inner_rectangles};
use crate::face::AxialFace;
use crate::flat::{common, large_regions, united, without};
use crate::mesh::{FlatTriangle, Mesh, others};
use crate::scene_options::SceneOptions;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point2};
use std::sync::Arc;

/// What a k-d tree can follow of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneFaces {
    /// Disjoint rectangles inside the triangles that hide, plane by plane.
    pub faces: Vec<AxialFace<3>>,
    /// Rectangles inside the triangles that hide from their front only, and whether that is towards larger coordinates: disjoint, and where two would be back to
    /// back in [`Self::faces`] instead.
    pub fronts: Vec<(AxialFace<3>, bool)>,
    /// Triangles of all objects with an area that are perpendicular to an axis.
    pub n_axial_triangles: usize,
    /// Triangles perpendicular to an axis that have no area.
    pub n_empty_triangles: usize,
    /// All other triangles. They divide nothing and hide nothing.
    pub n_other_triangles: usize,
    /// How many objects are detail.
    pub n_detail_objects: usize,
    /// How many flat regions were left out because they are small.
    pub n_small_regions: usize,
    /// For each object whether it is detail, or see-through.
    pub detail: Vec<bool>,
    /// Size below which things are detail, in scene units.
    pub detail_below: f64,
}

/// Finds the faces of a scene: the rectangles inside of the union of its axis-parallel triangles.
///
/// A triangle counts if all its corners have the same coordinate on an axis, to the last bit. The
/// triangles of a plane are united, whichever way they face: all are opaque from both sides. Where the union has
/// slanted borders, rectangles inside it are taken that end at coordinates of its corners; where all borders are
/// axis-parallel, the rectangles are the whole union. So, by exact predicates, faces never hide more than triangles do.
///
/// Objects that are [see-through](Scene::see_through) divide nothing and hide nothing, but for those that
/// [hide from the front](Scene::front_occluders): their faces are listed apart.
///
/// Left out as detail are, with [`SceneOptions::detail_below`] as the size:
/// * objects whose box is smaller in every direction;
/// * closed pieces of larger objects that are smaller in every direction (furniture in one mesh with
///   the house);
/// * flat regions that are smaller in both directions, unless they belong to a larger closed piece: a
///   wall must not lose the narrow sides of its windows.
///
/// Leaving out faces only shows more. O(n log n) for n triangles of ordinary meshes.
pub fn scene_faces(scene: &Scene, options: &SceneOptions) -> SceneFaces {
    let mut cache = FaceCache::default();
    Survey::of(scene, options, &mut cache).faces(&mut cache)
}

/// A size below which things are detail, from the scene alone. Only objects count half of whose triangles lie across an axis, if they meet the box around those
/// that have some across two axes, if there are such objects: a building that is turned about the vertical has little but floors here. It is the smaller of
/// * a twentieth of the middle one of the three sides of that box (1.5 m for a floor or a tower
///   30 m wide and 50 m long), which keeps it below the size of rooms;
/// * the largest size such that smaller objects make up at most a quarter of what can hide, counting for
///   each object the largest side of its box, and no object that is half as long as the middle one of the
///   three sides (grounds, slabs); so most walls stay, in scenes much larger than rooms too.
///
/// 0 for a scene without corners. Computed in rounded arithmetic, the same on every machine; no choice of
/// it is unsound. O(n log n) for n objects.
pub fn default_detail_below(scene: &Scene) -> f64 {
    let shapes: Vec<Shape> = scene.occluders().chain(scene.fronts()).map(|(_, object)| Shape::of(object)).collect();
    detail_below_of(&shapes.iter().collect::<Vec<_>>())
}

/// The same from the shapes of all objects that hide.
fn detail_below_of(shapes: &[&Shape]) -> f64 {
    let around =
        |shapes: &mut dyn Iterator<Item = &&Shape>| shapes.fold(Aabb::EMPTY, |b, shape| b.united(shape.bounds));
    let across = around(&mut shapes.iter().filter(|shape| shape.stands_along_axes()));
    let (bounds, objects): (Aabb<3>, Vec<Aabb<3>>) = if across.is_empty() {
        (around(&mut shapes.iter()), shapes.iter().map(|shape| shape.bounds).collect())
    } else {
        let meets = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= across.max[k] && across.min[k] <= b.max[k]);
        let counts = |shape: &&&Shape| shape.is_mostly_flat() && meets(&shape.bounds);
        (across, shapes.iter().filter(counts).map(|shape| shape.bounds).collect())
    };
    if bounds.is_empty() {
        return 0.0;
    }
    let extents = |b: &Aabb<3>| {
        let mut extents: [f64; 3] = std::array::from_fn(|k| (b.max[k] - b.min[k]).max(0.0));
        extents.sort_unstable_by(f64::total_cmp);
        extents
    };
    let middle = extents(&bounds)[1];
    let mut boxes: Vec<[f64; 3]> = objects.iter().map(extents).filter(|b| b[2] < middle / 2.0).collect();
    boxes.sort_unstable_by(|a, b| a[2].total_cmp(&b[2]).then(a[1].total_cmp(&b[1])));
    let most = boxes.iter().map(|b| b[1] * b[2]).sum::<f64>() / 4.0;
    let mut below = 0.0;
    let first_beyond = boxes.iter().find(|b| {
        below += b[1] * b[2];
        below > most
    });
    first_beyond.map_or(f64::INFINITY, |b| b[2]).min(middle / 20.0)
}

fn largest_side(b: &Aabb<3>) -> f64 {
    (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max)
}

/// A scene sorted into what hides and what is detail.
#[derive(Debug)]
pub(crate) struct Survey {
    pub(crate) detail_below: f64,
    /// For each object whether it is detail, or see-through.
    pub(crate) detail: Vec<bool>,
    /// How many objects are detail because they are small.
    n_detail: usize,
    /// The box around all objects, wherever they move.
    bounds: Aabb<3>,
    /// The objects in pieces; empty for those that are detail.
    pub(crate) meshes: Vec<Arc<Mesh>>,
    /// The triangles of the objects.
    pub(crate) shapes: Vec<Arc<Shape>>,
    /// The objects that hide from their front, and are no detail.
    fronts: Vec<u32>,
}

impl Survey {
    /// Classifies a scene. Equal objects of the last scene are taken from the cache, which is then replaced.
    pub(crate) fn of(scene: &Scene, options: &SceneOptions, cache: &mut FaceCache) -> Self {
        let shapes = cache.shapes_of(scene);
        let of_shapes = (0u32..).zip(&shapes).map(|(object, shape)| (scene.is_opaque(object), shape.bounds));
        let hides = |object: u32| scene.is_opaque(object) || scene.hides_from_front(object);
        let that_hide = || (0u32..).zip(&shapes).filter(|(object, _)| hides(*object)).map(|(_, shape)| &**shape);
        let detail_below = options.detail_below.unwrap_or_else(|| detail_below_of(&that_hide().collect::<Vec<_>>()));
        let n_detail = that_hide().filter(|shape| largest_side(&shape.bounds) < detail_below).count();
        let detail: Vec<bool> = of_shapes.map(|(hides, b)| !hides || largest_side(&b) < detail_below).collect();
        let moving = scene.moving().iter().filter_map(|moving| moving.within);
        let bounds = shapes.iter().map(|shape| shape.bounds).chain(moving).fold(Aabb::EMPTY, Aabb::united);
        let nothing = Arc::new(Mesh::default());
        let objects = scene.objects().iter().zip(&shapes).zip(&detail);
        let mesh = |((object, shape), is_detail): ((&SceneObject, &Arc<Shape>), &bool)| match is_detail {
            true => Arc::clone(&nothing),
            false => Arc::clone(shape.mesh.get_or_init(|| Arc::new(Mesh::of(object)))),
        };
        let meshes = objects.map(mesh).collect();
        let is_large = |object: &u32| largest_side(&shapes[*object as usize].bounds) >= detail_below;
        let fronts = scene.front_occluders().iter().copied().filter(is_large).collect();
        Self { detail_below, meshes, detail, n_detail, bounds, shapes, fronts }
    }

    /// The box around all objects, wherever they move.
    pub(crate) const fn bounds(&self) -> Aabb<3> {
        self.bounds
    }

    /// Whether a piece is detail although its object is not.
    pub(crate) fn is_small_thing(&self, object: usize, piece: u32) -> bool {
        let p = &self.meshes[object].pieces[piece as usize];
        p.closed && largest_side(&p.bounds) < self.detail_below
    }

    /// Whether a piece of an object may hide.
    fn hides(&self, object: usize, piece: u32) -> bool {
        !self.detail[object] && !self.is_small_thing(object, piece)
    }

    /// The faces; those of planes with the same triangles as in the last scene are taken from there.
    pub(crate) fn faces(&self, cache: &mut FaceCache) -> SceneFaces {
        let mut out = SceneFaces {
            n_axial_triangles: self.shapes.iter().map(|shape| shape.flat.len()).sum(),
            n_empty_triangles: self.shapes.iter().map(|shape| shape.n_empty).sum(),
            n_other_triangles: self.shapes.iter().map(|shape| shape.n_other).sum(),
            n_detail_objects: self.n_detail,
            detail: self.detail.clone(),
            detail_below: self.detail_below,
            ..SceneFaces::default()
        };
        let hiding = self.hiding_triangles();
        // By plane, and in each plane in their order.
        let key = |(i, (flat, _)): (u32, &(&FlatTriangle, bool))| (flat.axis, total_order(flat.at), i);
        let mut order: Vec<(usize, u64, u32)> = (0u32..).zip(&hiding).map(key).collect();
        order.sort_unstable();
        let flat = |i: u32| hiding[i as usize].0;
        let mut planes = cache.take_planes(self.detail_below);
        for group in order.chunk_by(|a, b| (a.0, flat(a.2).at) == (b.0, flat(b.2).at)) {
            let (axis, at) = (group[0].0, flat(group[0].2).at);
            let triangles = group.iter().map(|&(.., i)| (*hiding[i as usize].0, hiding[i as usize].1));
            let plane = match planes.remove(&(axis, group[0].1)) {
                Some(plane) if triangles.clone().eq(plane.triangles.iter().copied()) => plane,
                _ => {
                    let triangles: Vec<(FlatTriangle, bool)> = triangles.collect();
                    let (rects, n_small) = self.rectangles(&triangles);
                    PlaneFaces { triangles, rects: united(&rects), n_small }
                }
            };
            out.n_small_regions += plane.n_small;
            out.faces.extend(plane.rects.iter().map(|r| on_plane(r, axis, at)));
            cache.planes.insert((axis, group[0].1), plane);
        }
        self.add_fronts(&mut out);
        out
    }

    /// Adds the faces of what hides from its front: of each plane and direction the large regions, and where two of them stand back to back walls
    /// with two sides, as nothing passes.
    fn add_fronts(&self, out: &mut SceneFaces) {
        let of = |&object: &u32| self.shapes[object as usize].flat.iter().map(|(_, flat)| flat);
        let mut all: Vec<&FlatTriangle> = self.fronts.iter().flat_map(of).collect();
        all.sort_by_key(|flat| (flat.axis, total_order(flat.at)));
        let n_walls = out.faces.len();
        for plane in all.chunk_by(|a, b| (a.axis, a.at) == (b.axis, b.at)) {
            let FlatTriangle { axis, at, .. } = *plane[0];
            let [up, down] = [true, false].map(|up| {
                let corners: Vec<[Point2; 3]> = plane.iter().filter(|f| f.up == up).map(|f| f.corners).collect();
                let (rects, n_small) = large_regions(inner_rectangles(&corners), self.detail_below);
                out.n_small_regions += n_small;
                united(&rects)
            });
            for (rects, others, is_up) in [(&up, &down, true), (&down, &up, false)] {
                out.fronts.extend(without(rects, others).iter().map(|r| (on_plane(r, axis, at), is_up)));
            }
            out.faces.extend(common(&up, &down).iter().map(|r| on_plane(r, axis, at)));
        }
        if out.faces.len() > n_walls {
            out.faces.sort_by_key(|face| (face.axis, total_order(face.at)));
            let planes = out.faces.chunk_by(|a, b| (a.axis, a.at) == (b.axis, b.at));
            let walls = planes.flat_map(|plane| {
                let rects: Vec<FlatRect> = plane.iter().map(flat).collect();
                united(&rects).into_iter().map(|r| on_plane(&r, plane[0].axis, plane[0].at))
            });
            out.faces = walls.collect();
        }
    }

    /// The axis-parallel triangles that may hide, and whether they are of a closed piece.
    fn hiding_triangles(&self) -> Vec<(&FlatTriangle, bool)> {
        let mut hiding = Vec::new();
        for (object, (shape, mesh)) in self.shapes.iter().zip(&self.meshes).enumerate() {
            if self.detail[object] {
                continue;
            }
            let hides: Vec<bool> = (0..mesh.pieces.len() as u32).map(|piece| self.hides(object, piece)).collect();
            for (triangle, flat) in &shape.flat {
                let piece = mesh.piece_of[*triangle as usize] as usize;
                if hides[piece] {
                    hiding.push((flat, mesh.pieces[piece].closed));
                }
            }
        }
        hiding
    }

    /// Rectangles of one plane: all of closed pieces, and the large regions of the others.
    fn rectangles(&self, plane: &[(FlatTriangle, bool)]) -> (Vec<FlatRect>, usize) {
        let of = |closed: bool| -> Vec<FlatRect> {
            let corners: Vec<[Point2; 3]> = plane.iter().filter(|t| t.1 == closed).map(|t| t.0.corners).collect();
            inner_rectangles(&corners)
        };
        let (mut rects, n_small) = large_regions(of(false), self.detail_below);
        rects.extend(of(true));
        (rects, n_small)
    }
}

/// The extent of a face on its plane: the reverse of [`on_plane`].
pub(crate) fn flat(face: &AxialFace<3>) -> FlatRect {
    let [u, v] = others(face.axis).map(|k| [face.min[k], face.max[k]]);
    FlatRect { u, v }
}

fn on_plane(rect: &FlatRect, axis: usize, at: f64) -> AxialFace<3> {
    let (mut min, mut max) = ([at; 3], [at; 3]);
    for (k, [lo, hi]) in others(axis).into_iter().zip([rect.u, rect.v]) {
        (min[k], max[k]) = (lo, hi);
    }
    AxialFace::new(axis, min, max)
}
