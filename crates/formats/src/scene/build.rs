//! From corners and triangles to the objects of a scene, the same way for all formats.

use super::role::Role;
use super::surface::{Classification, Classified, SceneReadOptions};
use super::{Axis, LengthUnit, SceneFile, SceneFormat, SceneInfo, Simplification};
use crate::error::{Malformed, counted, malformed};
use crate::point::are_collinear;
use sightlines_cells::closed::is_closed_outwards;
use sightlines_cells::{MovingObject, Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_pvs::ObjectSource;

/// What an object hides of whose triangles engines draw only the fronts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SingleSides {
    /// What is behind it, from all sides.
    Hide,
    /// The same if it is closed, else what is behind its fronts.
    HideFromFronts,
    /// The same if it is closed, else nothing.
    HideIfClosed,
    /// Nothing.
    Show,
}

/// A mesh of which every corner is used.
#[derive(Debug, Default)]
pub(super) struct Compact {
    pub(super) corners: Vec<usize>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Compact {
    /// Leaves out the corners that nothing uses: primitives often share one large list of corners.
    ///
    /// * `used`: indices of corners in the file, in any order and with repetitions.
    /// * `triangles`: indices of corners, each of them in `used`; fewer than 2^32 corners are used.
    pub(super) fn new(mut used: Vec<usize>, triangles: impl Iterator<Item = [usize; 3]>) -> Self {
        used.sort_unstable();
        used.dedup();
        used.shrink_to_fit();
        let place = |index: usize| used.partition_point(|&u| u < index) as u32;
        let triangles = triangles.map(|t| t.map(place)).collect();
        Self { corners: used, triangles }
    }
}

#[derive(Debug, Default)]
pub(super) struct Builder {
    objects: Vec<SceneObject>,
    mirrors: Vec<u32>,
    see_through: Vec<u32>,
    moving: Vec<MovingObject>,
    surfaces: Vec<Classified>,
    n_degenerate: usize,
    /// The object and the place of each triangle that was left out.
    left_out_triangles: Vec<[u32; 2]>,
    n_single_sided: usize,
    n_front_occluding: usize,
    fronts_only: Vec<u32>,
    /// Those that hide from the fronts of their triangles only.
    front_occluders: Vec<u32>,
    /// With the object of each; an empty box where it has no triangles.
    view_volumes: Vec<(u32, Aabb<3>)>,
    doors: Vec<u32>,
    /// Of all objects up to the last that has one.
    sources: Vec<Option<ObjectSource>>,
    /// Of all objects, or none.
    stored_sizes: Vec<f64>,
    simplified: Option<Simplification>,
    /// How many faces are invalid, and what is wrong with the first.
    left_out: Option<(usize, Malformed)>,
    pub(super) warnings: Vec<String>,
}

impl Builder {
    pub(super) fn saying(simplified: Option<Simplification>) -> Self {
        Self { simplified, ..Self::default() }
    }

    /// Adds an object, without those of its triangles that have no area. Of what moves, only those that have a corner twice are
    /// left out: others may have an area elsewhere.
    ///
    /// * `triangles`: and the places, among all that the file has, of those that are not among them
    /// * `mirrored`: turns every triangle round, so that fronts stay fronts
    pub(super) fn add(
        &mut self,
        name: String,
        vertices: Vec<Point3>,
        (triangles, missing): (impl Iterator<Item = [u32; 3]>, &[u32]),
        mirrored: bool,
        moves: bool,
    ) {
        let turned = triangles.map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
        let has_area = |t: &[u32; 3]| match moves {
            true => t[0] != t[1] && t[1] != t[2] && t[2] != t[0],
            false => !are_collinear(t.map(|i| vertices[i as usize])),
        };
        let object = self.objects.len() as u32;
        let (left_out, n_degenerate) = (&mut self.left_out_triangles, &mut self.n_degenerate);
        let (mut place, mut missing) = (0u32, missing.iter().peekable());
        let mut skip = |place: &mut u32, left_out: &mut Vec<[u32; 2]>| {
            while missing.next_if(|missing| **missing == *place).is_some() {
                left_out.push([object, *place]);
                *place += 1;
            }
        };
        let triangles = turned.filter(|t| {
            skip(&mut place, left_out);
            let has_area = has_area(t);
            if !has_area {
                left_out.push([object, place]);
                *n_degenerate += 1;
            }
            place += 1;
            has_area
        });
        let triangles = triangles.collect();
        skip(&mut place, left_out);
        self.objects.push(SceneObject { name, vertices, triangles });
    }

    /// Counts invalid faces, with what is wrong with one of them.
    pub(super) fn leave_out(&mut self, n: usize, why: Malformed) {
        self.left_out.get_or_insert((0, why)).0 += n;
    }

    fn last(&self) -> Option<u32> {
        self.objects.len().checked_sub(1).and_then(|last| u32::try_from(last).ok())
    }

    /// Notes which primitive of which node the object that was added last is. What 32 bits do not count is not noted.
    pub(super) fn note_source(&mut self, node: usize, primitive: usize) {
        let [node, primitive] =
            [node, primitive].map(|index| u32::try_from(index).ok().filter(|&index| index < u32::MAX));
        self.sources.resize(self.objects.len().saturating_sub(1), None);
        self.sources.push(node.zip(primitive).map(|(node, primitive)| ObjectSource { node, primitive }));
    }

    /// Notes how large the coordinates of the object that was added last are as they are stored; for each object, or for none.
    pub(super) fn note_stored_size(&mut self, size: f64) {
        self.stored_sizes.push(size);
    }

    pub(super) fn mark_mirror(&mut self) {
        self.mirrors.extend(self.last());
    }

    /// Marks the object that was added last as one that is seen from the fronts of its triangles only.
    pub(super) fn mark_fronts_only(&mut self) {
        self.fronts_only.extend(self.last());
    }

    /// Counts the triangles of the object that was added last as single-sided. Returns what it is instead if it hides nothing.
    pub(super) fn count_single_sided(&mut self, sides: SingleSides) -> Option<Classification> {
        let object = self.objects.last()?;
        let n = object.triangles.len();
        let is_open = || !is_closed_outwards(object);
        match sides {
            _ if n == 0 => {}
            SingleSides::HideFromFronts if is_open() => {
                self.n_front_occluding += n;
                self.front_occluders.extend(self.last());
            }
            SingleSides::HideIfClosed if !is_open() => {}
            SingleSides::HideIfClosed | SingleSides::Show => {
                return Some(Classification::see_through("single sides".to_owned()));
            }
            SingleSides::Hide | SingleSides::HideFromFronts => {}
        }
        self.n_single_sided += n;
        None
    }

    /// Marks the object that was added last as a door that hides what is behind it while it is shut, if it does so from all sides.
    pub(super) fn mark_door(&mut self, sides: SingleSides) {
        let shuts = |object: &SceneObject| match sides {
            SingleSides::Hide => true,
            SingleSides::HideFromFronts | SingleSides::HideIfClosed => is_closed_outwards(object),
            SingleSides::Show => false,
        };
        if self.objects.last().is_some_and(|object| !object.triangles.is_empty() && shuts(object)) {
            self.doors.extend(self.last());
        }
    }

    /// Notes how the object that was added last is classified. `within` is the box that it does not leave if it moves, `None` if
    /// it may be anywhere.
    pub(super) fn classify(&mut self, class: Classification, within: Option<Aabb<3>>) {
        let Some(object) = self.last() else { return };
        if !class.hides() {
            self.see_through.push(object);
        }
        let SceneObject { vertices, triangles, .. } = &mut self.objects[object as usize];
        if class.role == Role::ViewVolume {
            let corners = vertices.iter().copied().filter(|_| !triangles.is_empty());
            self.view_volumes.push((object, Aabb::around(corners)));
        }
        if !class.role.is_drawn() {
            triangles.clear();
        }
        // What has no triangles, such as points and lines, is nowhere drawn.
        if class.moves && !triangles.is_empty() {
            self.moving.push(MovingObject { object, within });
        }
        let Classification { role, moves, reason, .. } = class;
        self.surfaces.push(Classified { object, role, moves, reason });
    }

    /// The view volumes that are ignored, as viewers have no room in all of them together. A flat one beside others counts: the box around all
    /// holds it.
    fn ignored_view_volumes(&self) -> Vec<u32> {
        let volumes = || self.view_volumes.iter().filter(|(_, bounds)| !bounds.is_empty());
        let all = Aabb::around(volumes().flat_map(|(_, bounds)| [bounds.min, bounds.max]));
        let ignored = |bounds: &Aabb<3>| is_flat(&all) || bounds.is_empty();
        self.view_volumes.iter().filter(|(_, bounds)| ignored(bounds)).map(|(object, _)| *object).collect()
    }

    pub(super) fn finish(mut self, format: SceneFormat, read_with: &SceneReadOptions) -> Result<SceneFile, Malformed> {
        let ignored_view_volumes = self.ignored_view_volumes();
        if let Some(first) = ignored_view_volumes.first() {
            let n = ignored_view_volumes.len();
            let volumes = counted(n, "view volume is", "view volumes are");
            let name = &self.objects[*first as usize].name;
            self.warnings
                .push(format!("{volumes} flat and ignored, the first is called {name:?}: viewers have no room there"));
        }
        let (n_objects, n_degenerate, simplified) = (self.objects.len(), self.n_degenerate, self.simplified);
        let scene = Scene::new(self.objects)?.with_mirrors(self.mirrors)?;
        let scene = scene.with_see_through(self.see_through)?.with_moving(self.moving)?;
        let scene = scene.with_single_sided(self.fronts_only)?.with_front_occluders(self.front_occluders)?;
        let scene = scene.with_doors(self.doors)?.with_sources(self.sources)?;
        let n_triangles = scene.n_triangles();
        if let Some((n, first)) = self.left_out {
            if n_triangles == 0 {
                return Err(first);
            }
            let faces = counted(n, "face", "faces, the first of them");
            self.warnings.push(format!("left out {faces}: {first}"));
        }
        if n_triangles == 0 {
            let what = format_args!("{n_objects} objects, {n_degenerate} triangles without area");
            return Err(malformed!("no triangles ({what})"));
        }
        let says_more = format == SceneFormat::Gltf;
        let info = SceneInfo {
            format,
            up: Axis::Y,
            up_is_assumed: !says_more,
            unit: if says_more { LengthUnit::Metre } else { LengthUnit::Unknown },
            n_objects,
            n_objects_without_triangles: scene.objects().iter().filter(|o| o.triangles.is_empty()).count(),
            n_triangles,
            n_degenerate_triangles: n_degenerate,
            left_out_triangles: self.left_out_triangles,
            n_single_sided_triangles: self.n_single_sided,
            n_front_occluding_triangles: self.n_front_occluding,
            simplified,
            read_with: read_with.clone(),
            stored_sizes: self.stored_sizes,
            surfaces: self.surfaces,
            view_volumes: self.view_volumes.into_iter().map(|(_, b)| b).filter(|b| !b.is_empty()).collect(),
            ignored_view_volumes,
            warnings: self.warnings,
        };
        Ok(SceneFile { scene, info })
    }
}

pub(super) fn is_flat(b: &Aabb<3>) -> bool {
    (0..3).any(|axis| b.min[axis] >= b.max[axis])
}
