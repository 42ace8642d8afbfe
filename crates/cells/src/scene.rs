//! Scenes in space: objects made of triangles.

mod checksum;

use sightlines_geometry::coordinate::MAX_MAGNITUDE;
use sightlines_geometry::{Aabb, CoordinateError, Point3, check_coordinate};
use sightlines_pvs::ObjectSource;
use std::borrow::Cow;
use std::ops::Range;

/// Something that is seen or not as a whole: a mesh of triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneObject {
    /// What users call it.
    pub name: String,
    /// Corners, in world coordinates and scene units.
    pub vertices: Vec<Point3>,
    /// Triangles as indices of corners, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl SceneObject {
    /// Smallest box around the corners; empty if there are none.
    pub fn bounds(&self) -> Aabb<3> {
        Aabb::around(self.vertices.iter().copied())
    }

    /// The corners of each triangle.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = [Point3; 3]> + '_ {
        self.corners_of(0..self.triangles.len())
    }

    /// The same of some triangles that follow each other.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn corners_of(&self, triangles: Range<usize>) -> impl ExactSizeIterator<Item = [Point3; 3]> + '_ {
        self.triangles[triangles].iter().map(|t| t.map(|i| self.vertices[i as usize]))
    }
}

/// A scene in space, checked: coordinates that the predicates accept, indices in range.
///
/// Every object is seen. An object hides what is behind it, from both sides, unless it is [see-through](Self::see_through):
/// glass, leaves, and everything that [moves](Self::moving). Whoever looks for occluders takes [`Self::occluders`] or
/// [`Self::occluding_triangles`]; whoever asks where an object can be seen takes [`Self::extent`]. Objects may be
/// [single-sided](Self::is_single_sided): nobody sees the backs of their triangles. Some of those that are see-through
/// [hide from the front](Self::front_occluders): from eyes in front of a triangle, not from eyes behind it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    objects: Vec<SceneObject>,
    mirrors: Vec<u32>,
    /// Ascending.
    see_through: Vec<u32>,
    /// By object, ascending; all of them are see-through.
    moving: Vec<MovingObject>,
    /// Ascending.
    single_sided: Vec<u32>,
    /// Ascending; all of them are see-through and stand still.
    front_occluders: Vec<u32>,
    /// Ascending.
    doors: Vec<u32>,
    /// One for each object, or none at all.
    sources: Vec<Option<ObjectSource>>,
}

/// The places that the triangles of an object have among all that its file has of it: for those of the scene, in order, and then for the end of all.
///
/// * `left_out`: triangles of the file that the scene does not have, ascending: the object, and the place among its triangles
/// * `n`: how many triangles the object has in the scene
pub fn places_of_triangles(left_out: &[[u32; 2]], object: u32, n: usize) -> Vec<u32> {
    let first = left_out.partition_point(|&[of, _]| of < object);
    let mut left_out = left_out[first..].iter().take_while(|&&[of, _]| of == object).peekable();
    let mut places = Vec::with_capacity(n + 1);
    for place in 0.. {
        if left_out.next_if(|&&[_, at]| at == place).is_none() {
            places.push(place);
        }
        if places.len() > n {
            break;
        }
    }
    places
}

/// An object that moves or changes its shape at run time. It is drawn, even if none of its triangles has an area at rest, and if
/// it has none there: what is never drawn is not listed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingObject {
    /// Its index.
    pub object: u32,
    /// A box that it never leaves, in scene units, around its triangles at rest too; `None` if it may be anywhere.
    pub within: Option<Aabb<3>>,
}

/// The box of an object that may be anywhere: wherever an eye or a cell is, it is in this box.
pub const ANYWHERE: Aabb<3> = Aabb { min: [-MAX_MAGNITUDE; 3], max: [MAX_MAGNITUDE; 3] };

/// Why objects do not make a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A coordinate cannot be used.
    #[error("object {object}, vertex {vertex}: {kind}")]
    Vertex {
        /// Index of the object.
        object: usize,
        /// Index of the vertex in it.
        vertex: usize,
        /// What is wrong with it.
        #[source]
        kind: CoordinateError,
    },
    /// A triangle names a corner that does not exist.
    #[error("object {object}, triangle {triangle}: there is no vertex {vertex}")]
    Index {
        /// Index of the object.
        object: usize,
        /// Index of the triangle in it.
        triangle: usize,
        /// The corner that it names.
        vertex: u32,
    },
    /// What is marked as a mirror is no object.
    #[error("object {object} cannot be a mirror: there is no such object")]
    Mirror {
        /// Index of the object.
        object: usize,
    },
    /// What is marked as see-through is no object.
    #[error("object {object} cannot be see-through: there is no such object")]
    SeeThrough {
        /// Index of the object.
        object: usize,
    },
    /// What is marked as single-sided is no object.
    #[error("object {object} cannot be single-sided: there is no such object")]
    SingleSided {
        /// Index of the object.
        object: usize,
    },
    /// Sources of objects, but not one for each object.
    #[error("{n} sources of objects do not fit {n_objects} objects")]
    Sources {
        /// Number of sources.
        n: usize,
        /// Number of objects.
        n_objects: usize,
    },
    /// What is marked as a door is no object.
    #[error("object {object} cannot be a door: there is no such object")]
    Door {
        /// Index of the object.
        object: usize,
    },
    /// What is marked as moving is no object.
    #[error("object {object} cannot move: there is no such object")]
    Moving {
        /// Index of the object.
        object: usize,
    },
    /// The box that a moving object does not leave has a coordinate that cannot be used.
    #[error("object {object}, the box of its motion: {kind}")]
    Motion {
        /// Index of the object.
        object: usize,
        /// What is wrong with it.
        #[source]
        kind: CoordinateError,
    },
}

impl Scene {
    /// Checks `objects`; their order gives them their ids. Negative zeros become zeros.
    ///
    /// # Errors
    /// [`SceneError`] with the place of the first offender.
    pub fn new(objects: Vec<SceneObject>) -> Result<Self, SceneError> {
        let mut objects = objects;
        for (object, o) in objects.iter_mut().enumerate() {
            for (vertex, p) in o.vertices.iter_mut().enumerate() {
                for x in p {
                    *x = check_coordinate(*x).map_err(|kind| SceneError::Vertex { object, vertex, kind })?;
                }
            }
            for (triangle, t) in o.triangles.iter().enumerate() {
                if let Some(&vertex) = t.iter().find(|&&i| i as usize >= o.vertices.len()) {
                    return Err(SceneError::Index { object, triangle, vertex });
                }
            }
        }
        Ok(Self { objects, ..Self::default() })
    }

    /// The same scene, with the faces of these objects as mirrors, and no others.
    ///
    /// # Errors
    /// [`SceneError::Mirror`] for an object that does not exist.
    pub fn with_mirrors(mut self, mirrors: Vec<u32>) -> Result<Self, SceneError> {
        self.mirrors = self.ascending(mirrors, |object| SceneError::Mirror { object })?;
        Ok(self)
    }

    /// Marked objects in ascending order, each once; an error for the first that does not exist.
    fn ascending(&self, mut marked: Vec<u32>, error: fn(usize) -> SceneError) -> Result<Vec<u32>, SceneError> {
        marked.sort_unstable();
        marked.dedup();
        match marked.iter().find(|&&object| object as usize >= self.objects.len()) {
            Some(&object) => Err(error(object as usize)),
            None => Ok(marked),
        }
    }

    /// The same scene, moved: each coordinate is rounded once. Boxes of what moves are widened to contain what was in them.
    ///
    /// # Errors
    /// [`SceneError::Vertex`], [`SceneError::Motion`] if a coordinate becomes too large.
    pub fn translated(&self, by: Point3) -> Result<Self, SceneError> {
        if by == [0.0; 3] {
            return Ok(self.clone());
        }
        let moved = |p: Point3| -> Point3 { std::array::from_fn(|k| p[k] + by[k]) };
        let objects = self.objects.iter().map(|object| SceneObject {
            vertices: object.vertices.iter().copied().map(moved).collect(),
            ..object.clone()
        });
        let around = |b: Aabb<3>| Aabb { min: moved(b.min).map(f64::next_down), max: moved(b.max).map(f64::next_up) };
        let motion = |m: &MovingObject| MovingObject {
            object: m.object,
            within: m.within.map(|within| if within.is_empty() { within } else { around(within) }),
        };
        let moving = self.moving.iter().map(motion).collect();
        Self { moving: Vec::new(), objects: Self::new(objects.collect())?.objects, ..self.clone() }.with_moving(moving)
    }

    /// The objects that are mirrors, ascending.
    pub fn mirrors(&self) -> &[u32] {
        &self.mirrors
    }

    /// The same scene, in which these objects are seen and hide nothing; and those that move, and those that hide from the front, but no others.
    ///
    /// # Errors
    /// [`SceneError::SeeThrough`] for an object that does not exist.
    pub fn with_see_through(mut self, mut see_through: Vec<u32>) -> Result<Self, SceneError> {
        let moves = |object: u32| self.moving.binary_search_by_key(&object, |moving| moving.object).is_ok();
        let mut front_occluders = std::mem::take(&mut self.front_occluders);
        front_occluders.retain(|&object| !moves(object));
        see_through.extend(self.moving.iter().map(|moving| moving.object));
        see_through.extend(&front_occluders);
        self.see_through = self.ascending(see_through, |object| SceneError::SeeThrough { object })?;
        self.front_occluders = front_occluders;
        Ok(self)
    }

    /// The same scene, in which these objects move, and no others. They hide nothing. Boxes are widened to what the objects
    /// have at rest; of several entries for an object, all hold.
    ///
    /// # Errors
    /// [`SceneError::Moving`] for an object that does not exist, [`SceneError::Motion`] for a box with coordinates that are
    /// none.
    pub fn with_moving(mut self, mut moving: Vec<MovingObject>) -> Result<Self, SceneError> {
        moving.sort_by_key(|moving| moving.object);
        self.moving.clear();
        for MovingObject { object, within } in moving {
            let o = self.objects.get(object as usize).ok_or(SceneError::Moving { object: object as usize })?;
            let invalid = |kind| SceneError::Motion { object: object as usize, kind };
            let mut within = within;
            for x in within.iter_mut().filter(|b| !b.is_empty()).flat_map(|b| b.min.iter_mut().chain(&mut b.max)) {
                *x = check_coordinate(*x).map_err(invalid)?;
            }
            let within = within.map(|within| within.united(Aabb::around(o.corners().flatten())));
            match self.moving.last_mut().filter(|last| last.object == object) {
                Some(last) => last.within = last.within.zip(within).map(|(a, b)| a.united(b)),
                None => self.moving.push(MovingObject { object, within }),
            }
        }
        let see_through = std::mem::take(&mut self.see_through);
        self.with_see_through(see_through)
    }

    /// The same scene, in which these objects are seen from the fronts of their triangles only, and no others. They hide from both
    /// sides all the same.
    ///
    /// # Errors
    /// [`SceneError::SingleSided`] for an object that does not exist.
    pub fn with_single_sided(mut self, single_sided: Vec<u32>) -> Result<Self, SceneError> {
        self.single_sided = self.ascending(single_sided, |object| SceneError::SingleSided { object })?;
        Ok(self)
    }

    /// The same scene, in which these objects hide from eyes in front of their triangles only, and no others do; but for those that
    /// [move](Self::moving). The front is where the corners go around counterclockwise. They are [see-through](Self::see_through), for who knows
    /// of two sides only.
    ///
    /// # Errors
    /// [`SceneError::SingleSided`] for an object that does not exist.
    pub fn with_front_occluders(mut self, front_occluders: Vec<u32>) -> Result<Self, SceneError> {
        self.front_occluders = self.ascending(front_occluders, |object| SceneError::SingleSided { object })?;
        let see_through = std::mem::take(&mut self.see_through);
        self.with_see_through(see_through)
    }

    /// The objects that hide from eyes in front of their triangles only, ascending.
    pub fn front_occluders(&self) -> &[u32] {
        &self.front_occluders
    }

    /// The same, as [`Self::occluders`] gives those that hide from both sides.
    pub fn fronts(&self) -> impl Iterator<Item = (u32, &SceneObject)> {
        self.front_occluders.iter().map(|&object| (object, &self.objects[object as usize]))
    }

    /// Whether an object hides from eyes in front of its triangles only.
    pub fn hides_from_front(&self, object: u32) -> bool {
        self.front_occluders.binary_search(&object).is_ok()
    }

    /// The corners of all triangles that hide from the front only, object by object.
    pub fn front_occluding_triangles(&self) -> impl Iterator<Item = [Point3; 3]> + '_ {
        self.front_occluders.iter().flat_map(|&object| self.objects[object as usize].corners())
    }

    /// The same scene, in which these objects are doors that stand shut, and no others. That alone changes nothing of what they hide: they
    /// are open for who asks what is seen, and shut where the run time shuts them.
    ///
    /// # Errors
    /// [`SceneError::Door`] for an object that does not exist.
    pub fn with_doors(mut self, doors: Vec<u32>) -> Result<Self, SceneError> {
        self.doors = self.ascending(doors, |object| SceneError::Door { object })?;
        Ok(self)
    }

    /// The objects that are doors, ascending.
    pub fn doors(&self) -> &[u32] {
        &self.doors
    }

    /// The same scene, with where each of its objects is in the file that it was read from, in their order; none at all if that is not
    /// known. That changes nothing of what is seen.
    ///
    /// # Errors
    /// [`SceneError::Sources`] for another number than there are objects.
    pub fn with_sources(mut self, sources: Vec<Option<ObjectSource>>) -> Result<Self, SceneError> {
        let n_objects = self.objects.len();
        if !sources.is_empty() && sources.len() != n_objects {
            return Err(SceneError::Sources { n: sources.len(), n_objects });
        }
        self.sources = sources;
        Ok(self)
    }

    /// Where each object is in the file that the scene was read from, in the order of the objects; empty if that is not known.
    pub fn sources(&self) -> &[Option<ObjectSource>] {
        &self.sources
    }

    /// The objects that were marked as seen from the fronts of their triangles only, ascending, whether they move or not.
    pub fn single_sided(&self) -> &[u32] {
        &self.single_sided
    }

    /// Whether an object is seen from the fronts of its triangles only. What [moves](Self::moving) is not: the box that it does not leave
    /// stands for it.
    pub fn is_single_sided(&self, object: u32) -> bool {
        self.single_sided.binary_search(&object).is_ok()
            && self.moving.binary_search_by_key(&object, |moving| moving.object).is_err()
    }

    /// The objects that are seen and hide nothing, but for those that hide [from the front](Self::front_occluders), ascending.
    pub fn see_through(&self) -> &[u32] {
        &self.see_through
    }

    /// The objects that move, ascending; all of them are see-through.
    pub fn moving(&self) -> &[MovingObject] {
        &self.moving
    }

    /// Whether an object hides what is behind it.
    pub fn is_opaque(&self, object: u32) -> bool {
        self.see_through.binary_search(&object).is_err()
    }

    /// The objects that hide what is behind them, with their ids.
    pub fn occluders(&self) -> impl Iterator<Item = (u32, &SceneObject)> {
        (0..).zip(&self.objects).filter(|(object, _)| self.is_opaque(*object))
    }

    /// The scene of other objects, each in the place of one of this scene, and as that: a mirror, see-through, moving, single-sided. It has no doors and no sources.
    ///
    /// # Errors
    /// Those of [`Scene::new`].
    pub fn replaced(&self, objects: impl IntoIterator<Item = (u32, SceneObject)>) -> Result<Self, SceneError> {
        let (of, objects): (Vec<u32>, Vec<SceneObject>) = objects.into_iter().unzip();
        let places =
            |all: &[u32]| (0u32..).zip(&of).filter(|(_, of)| all.binary_search(of).is_ok()).map(|(k, _)| k).collect();
        let moving = |(object, of): (u32, &u32)| {
            let found = self.moving.binary_search_by_key(of, |moving| moving.object).ok()?;
            Some(MovingObject { object, ..self.moving[found] })
        };
        let scene = Self::new(objects)?.with_mirrors(places(&self.mirrors))?;
        let scene = scene.with_see_through(places(&self.see_through))?;
        let scene = scene.with_moving((0u32..).zip(&of).filter_map(moving).collect())?;
        scene.with_single_sided(places(&self.single_sided))?.with_front_occluders(places(&self.front_occluders))
    }

    /// The scene of what hides: the same objects, of which those that are see-through have neither corners nor triangles.
    pub fn opaque_part(&self) -> Cow<'_, Self> {
        if self.see_through.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut objects = self.objects.clone();
        for &object in &self.see_through {
            let object = &mut objects[object as usize];
            (object.vertices, object.triangles) = (Vec::new(), Vec::new());
        }
        Cow::Owned(Self { objects, mirrors: self.mirrors.clone(), ..Self::default() })
    }

    /// The scene of what does not move: the same objects, of which those that move have no triangles.
    pub fn still_part(&self) -> Cow<'_, Self> {
        if self.moving.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut still = Self { moving: Vec::new(), ..self.clone() };
        self.moving.iter().for_each(|moving| still.objects[moving.object as usize].triangles.clear());
        Cow::Owned(still)
    }

    /// The scene without some of its objects: these have neither corners nor triangles, and all keep their indices.
    #[must_use]
    pub fn without(&self, objects: &[u32]) -> Self {
        let mut rest = self.clone();
        for &object in objects {
            let object = &mut rest.objects[object as usize];
            (object.vertices, object.triangles) = (Vec::new(), Vec::new());
        }
        rest
    }

    /// The corners of all triangles that hide what is behind them, object by object.
    pub fn occluding_triangles(&self) -> impl Iterator<Item = [Point3; 3]> + '_ {
        self.occluders().flat_map(|(_, object)| object.corners())
    }

    /// The box outside of which nothing of an object is ever drawn, in scene units: around its triangles, and around all
    /// places that it moves to, whatever it is at rest. Empty if it has no triangles and does not move.
    pub fn extent(&self, object: u32) -> Aabb<3> {
        match self.moving.binary_search_by_key(&object, |moving| moving.object) {
            Ok(k) => self.moving[k].within.unwrap_or(ANYWHERE),
            Err(_) => Aabb::around(self.objects[object as usize].corners().flatten()),
        }
    }

    /// Triangles that hide an object if they are hidden: its own; of one that moves, the faces of the box that it does not
    /// leave.
    pub fn covering_triangles(&self, object: u32) -> Vec<[Point3; 3]> {
        let extent = self.extent(object);
        match self.moving.binary_search_by_key(&object, |moving| moving.object) {
            Ok(_) if !extent.is_empty() => faces_of(&extent),
            _ => self.objects[object as usize].corners().collect(),
        }
    }

    /// The objects, by id.
    pub fn objects(&self) -> &[SceneObject] {
        &self.objects
    }

    /// Number of triangles of all objects.
    pub fn n_triangles(&self) -> usize {
        self.objects.iter().map(|o| o.triangles.len()).sum()
    }

    /// Smallest box around everything, and around all places that objects move to, but for those that may be anywhere;
    /// empty for a scene without vertices.
    pub fn bounds(&self) -> Aabb<3> {
        let moving = self.moving.iter().filter_map(|moving| moving.within).filter(|within| !within.is_empty());
        let at_rest = self.objects.iter().flat_map(|o| o.vertices.iter().copied());
        Aabb::around(at_rest.chain(moving.flat_map(|within| [within.min, within.max])))
    }
}

/// The six sides of a box, two triangles each, with their fronts outwards.
fn faces_of(b: &Aabb<3>) -> Vec<[Point3; 3]> {
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] }) };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]]);
    triangles.map(|t| t.map(corner)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(corners: [Point3; 3], indices: [u32; 3]) -> SceneObject {
        SceneObject { name: "t".to_owned(), vertices: corners.to_vec(), triangles: vec![indices] }
    }

    #[test]
    fn scenes_are_checked() {
        let good = triangle([[0., 0., 0.], [1., 0., 0.], [0., 2., -0.]], [0, 1, 2]);
        let scene = Scene::new(vec![good.clone()]).unwrap();
        assert_eq!((scene.n_triangles(), scene.bounds().max), (1, [1., 2., 0.]));
        assert_eq!(scene.objects()[0].corners().next(), Some([[0., 0., 0.], [1., 0., 0.], [0., 2., 0.]]));
        let bad = triangle([[0., 0., 0.], [1., f64::INFINITY, 0.], [0., 2., 0.]], [0, 1, 2]);
        let error = Scene::new(vec![good.clone(), bad]).unwrap_err();
        assert_eq!(error.to_string(), "object 1, vertex 1: coordinate inf is not a finite number");
        let bad = SceneObject { triangles: vec![[0, 1, 2], [0, 3, 1]], ..good };
        assert_eq!(Scene::new(vec![bad]).unwrap_err().to_string(), "object 0, triangle 1: there is no vertex 3");
        assert_eq!(scene.clone().with_mirrors(vec![0, 0]).unwrap().mirrors(), [0]);
        let error = scene.clone().with_single_sided(vec![1]).unwrap_err().to_string();
        assert_eq!(error, "object 1 cannot be single-sided: there is no such object");
        let error = scene.clone().with_doors(vec![0, 1]).unwrap_err().to_string();
        assert_eq!(error, "object 1 cannot be a door: there is no such object");
        let error = scene.clone().with_sources(vec![None; 2]).unwrap_err().to_string();
        assert_eq!(error, "2 sources of objects do not fit 1 objects");
        let source = Some(ObjectSource { node: 3, primitive: 1 });
        assert_eq!(scene.clone().with_sources(vec![source]).unwrap().sources(), [source]);
        let door = scene.clone().with_doors(vec![0, 0]).unwrap();
        assert!(door.doors() == [0] && door.is_opaque(0) && scene.doors().is_empty());
        // What hides from the front alone does not hide from both sides; what moves hides nothing.
        let fronts = |scene: &Scene| scene.clone().with_front_occluders(vec![0]).unwrap();
        let seen = fronts(&scene.clone().with_see_through(vec![0]).unwrap());
        assert!(seen.hides_from_front(0) && seen.front_occluding_triangles().count() == 1);
        assert!(seen.occluding_triangles().count() == 0 && !fronts(&scene).is_opaque(0));
        let moving = |scene: Scene| scene.with_moving(vec![MovingObject { object: 0, within: None }]).unwrap();
        assert!(!moving(seen.clone()).hides_from_front(0) && !fronts(&moving(scene.clone())).hides_from_front(0));
        let still = seen.with_see_through(Vec::new()).unwrap();
        assert!(still.hides_from_front(0) && !still.is_opaque(0));
        let single = scene.clone().with_single_sided(vec![0]).unwrap();
        assert!(single.is_single_sided(0) && !scene.is_single_sided(0));
        let moving = single.with_moving(vec![MovingObject { object: 0, within: None }]).unwrap();
        assert!(!moving.is_single_sided(0), "a box is seen from everywhere");
        let error = scene.with_mirrors(vec![1]).unwrap_err().to_string();
        assert_eq!(error, "object 1 cannot be a mirror: there is no such object");
    }

    #[test]
    fn what_is_see_through_hides_nothing_and_what_moves_is_where_it_may_be() {
        let at = |z: f64| triangle([[0., 0., z], [1., 0., z], [0., 2., z]], [0, 1, 2]);
        let scene = Scene::new(vec![at(0.0), at(1.0), at(2.0), at(3.0)]).unwrap();
        assert_eq!(scene.occluding_triangles().count(), 4);
        let glass = scene.clone().with_see_through(vec![1, 1]).unwrap();
        assert_eq!(glass.occluders().map(|(k, _)| k).collect::<Vec<_>>(), [0, 2, 3]);
        assert_eq!((glass.bounds(), glass.extent(1)), (scene.bounds(), scene.extent(1)));
        let within = Some(Aabb { min: [5., 0., 2.], max: [6., 1., 9.] });
        let moves = |object, within| MovingObject { object, within };
        let moving = glass.with_moving(vec![moves(3, None), moves(2, within)]).unwrap();
        assert_eq!(moving.see_through(), [1, 2, 3]);
        assert!(moving.is_opaque(0) && !moving.is_opaque(3));
        assert_eq!(moving.extent(2), Aabb { min: [0., 0., 2.], max: [6., 2., 9.] });
        assert_eq!((moving.extent(3), moving.bounds().max), (ANYWHERE, [6., 2., 9.]));
        assert_eq!((moving.covering_triangles(2).len(), moving.covering_triangles(1).len()), (12, 1));
        assert_eq!(Aabb::around(moving.covering_triangles(2).into_iter().flatten()), moving.extent(2));
        // What has no triangles at rest is seen where it may be; negative zeros become zeros.
        let flat = triangle([[0., 0., 0.], [0., 0., 0.], [0., 0., 0.]], [0, 1, 2]);
        let bare = SceneObject { triangles: Vec::new(), ..flat.clone() };
        let risen = Aabb { min: [-0., 0., 2.], max: [3., 1., 9.] };
        let both =
            Scene::new(vec![flat, bare]).unwrap().with_moving(vec![moves(0, None), moves(1, Some(risen))]).unwrap();
        assert_eq!((both.extent(0), both.extent(1)), (ANYWHERE, risen));
        assert_eq!(both.extent(1).min[0].to_bits(), 0);
        // Marks may come in any order; what no longer moves may still be see-through.
        let still = moving.with_moving(Vec::new()).unwrap();
        assert_eq!((still.see_through(), still.extent(3)), (&[1, 2, 3][..], scene.extent(3)));
        let error = scene.clone().with_see_through(vec![4]).unwrap_err().to_string();
        assert_eq!(error, "object 4 cannot be see-through: there is no such object");
        let error = scene.clone().with_moving(vec![moves(4, None)]).unwrap_err().to_string();
        assert_eq!(error, "object 4 cannot move: there is no such object");
        let nowhere = Aabb { min: [f64::NAN; 3], max: [1.; 3] };
        let error = scene.with_moving(vec![moves(0, Some(nowhere))]).unwrap_err().to_string();
        assert_eq!(error, "object 0, the box of its motion: coordinate NaN is not a finite number");
    }
}
