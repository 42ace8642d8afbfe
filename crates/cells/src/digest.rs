//! Digests of what is cut into cells: they tell a scene that was changed since.
//!
//! Lines, triangles and portals are hashed one by one (XXH3, 128 bits) and the hashes are added, so that their order, and the
//! division of what hides into objects, make no difference. Objects are taken in their order, as tables number them.

use crate::graph::CellGraph;
use crate::plan::{LineId, Plan};
use crate::scene::{ANYWHERE, Scene};
use crate::{Convex, Point3};
use sightlines_geometry::Aabb;
use sightlines_pvs::GeometryDigest;
use xxhash_rust::xxh3::xxh3_128;

impl Plan {
    /// The digests of the plan. What hides: the opaque lines, whichever way they run. What is seen: all lines with the groups at their sides,
    /// mirrors, and the objects with their boxes. Not the names. O(size).
    pub fn digest(&self) -> GeometryDigest {
        let (mut hiding, mut lines) = (0u128, 0u128);
        for (id, line) in (0..).map(LineId).zip(self.lines()) {
            let (a, b) = (line.a.to_array(), line.b.to_array());
            let (from, to, sides) =
                if a <= b { (a, b, [line.left, line.right]) } else { (b, a, [line.right, line.left]) };
            let ends = || Bytes::default().numbers(&from).numbers(&to);
            if line.opaque {
                hiding = hiding.wrapping_add(ends().hash());
            }
            let flags = [u64::from(line.opaque), u64::from(self.mirrors().binary_search(&id).is_ok())];
            // No group is 0, group 0 is 1.
            let sides = sides.map(|group| group.map_or(0, |group| u64::from(group) + 1));
            lines = lines.wrapping_add(ends().integers(&flags).integers(&sides).hash());
        }
        let objects = self.objects().iter();
        let objects = objects.fold(Bytes::default(), |out, o| out.numbers(&o.bounds.min).numbers(&o.bounds.max));
        GeometryDigest { hiding, seen: objects.hashes(&[lines]).hash() }
    }
}

impl Scene {
    /// The digests of the scene. What hides: the triangles of the objects that are not see-through, whichever way round and however divided into
    /// objects, and those that hide from the front, with their fronts. What is seen: of each object its triangles, with their fronts, where it may move to, and whether it is see-through,
    /// single-sided, a mirror or a door. Not the names. O(size).
    pub fn digest(&self) -> GeometryDigest {
        let (mut hiding, mut objects) = (0u128, Bytes::default());
        for (id, object) in (0u32..).zip(self.objects()) {
            let mut seen = 0u128;
            for corners in object.corners() {
                let round = turned(corners);
                seen = seen.wrapping_add(triangle(&round));
                // As those that hide from both sides, but with their fronts, and told apart from them.
                if self.hides_from_front(id) {
                    hiding = hiding.wrapping_add(!triangle(&round));
                }
                if self.is_opaque(id) {
                    let mut corners = corners;
                    corners.sort_by(|p, q| p.partial_cmp(q).expect("coordinates are numbers"));
                    hiding = hiding.wrapping_add(triangle(&corners));
                }
            }
            let is_in = |list: &[u32]| u64::from(list.binary_search(&id).is_ok());
            let moving = self.moving().binary_search_by_key(&id, |moving| moving.object).ok();
            let within = moving.map(|k| self.moving()[k].within.unwrap_or(ANYWHERE)).unwrap_or(Aabb::EMPTY);
            let marks = [self.see_through(), self.single_sided(), self.mirrors(), self.doors()].map(is_in);
            objects = objects.hashes(&[seen]).integers(&marks).integers(&[u64::from(moving.is_some())]);
            objects = objects.numbers(&within.min).numbers(&within.max);
        }
        GeometryDigest { hiding, seen: objects.hash() }
    }
}

impl CellGraph<Convex> {
    /// The digests of cells that are given by their portals, which are all that is known: of the portals, with their cells, in any order. O(size).
    pub fn digest(&self) -> GeometryDigest {
        let portals = self.portals().iter().map(|portal| {
            let cells = portal.cells.map(|cell| u64::from(cell.0));
            Bytes::default().integers(&cells).numbers(portal.shape.corners().as_flattened()).hash()
        });
        let n_cells = self.n_cells() as u64;
        let hiding = portals.fold(u128::from(n_cells), u128::wrapping_add);
        GeometryDigest { hiding, seen: 0 }
    }
}

/// The same corners, in the same direction, from the least on.
fn turned(corners: [Point3; 3]) -> [Point3; 3] {
    let [p, q, r] = corners;
    let turns = [[p, q, r], [q, r, p], [r, p, q]];
    turns.into_iter().min_by(|a, b| a.partial_cmp(b).expect("coordinates are numbers")).expect("three turns")
}

fn triangle(corners: &[Point3; 3]) -> u128 {
    let mut bytes = [0; 72];
    let numbers = corners.as_flattened();
    bytes.chunks_exact_mut(8).zip(numbers).for_each(|(out, x)| out.copy_from_slice(&x.to_le_bytes()));
    xxh3_128(&bytes)
}

/// Numbers as little-endian bytes.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn numbers(mut self, numbers: &[f64]) -> Self {
        numbers.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
        self
    }

    fn integers(mut self, integers: &[u64]) -> Self {
        integers.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
        self
    }

    fn hashes(mut self, hashes: &[u128]) -> Self {
        hashes.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
        self
    }

    fn hash(&self) -> u128 {
        xxh3_128(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CellId, MovingObject, PlanLine, PlanObject, Portal3, SceneObject};

    fn object(vertices: &[Point3], triangles: &[[u32; 3]]) -> SceneObject {
        SceneObject { name: "o".to_owned(), vertices: vertices.to_vec(), triangles: triangles.to_vec() }
    }

    const SQUARE: [Point3; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];

    fn scene() -> Scene {
        let high = SQUARE.map(|[x, y, _]| [x, y, 2.]);
        Scene::new(vec![object(&SQUARE, &[[0, 1, 2], [0, 2, 3]]), object(&high, &[[0, 1, 2]])]).unwrap()
    }

    /// What an exporter may do to a file without a change of what is there.
    #[test]
    fn the_order_of_corners_and_triangles_makes_no_difference() {
        let [mut first, second] = [0, 1].map(|k| scene().objects()[k].clone());
        first.vertices.reverse();
        first.triangles = vec![[0, 3, 1], [2, 1, 3]];
        first.name = "other".to_owned();
        assert_eq!(Scene::new(vec![first, second]).unwrap().digest(), scene().digest());
        // Even if two corners are in one place, it makes no difference with which a triangle begins.
        let seen = |turn: [u32; 3]| {
            Scene::new(vec![object(&[SQUARE[0], SQUARE[0], SQUARE[1]], &[turn])]).unwrap().digest().seen
        };
        assert!(seen([0, 1, 2]) == seen([1, 2, 0]) && seen([0, 1, 2]) == seen([2, 0, 1]));
        let mixed =
            |[r, s]: [f64; 2]| Scene::new(vec![object(&[[0., r, s], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 2]])]);
        assert_eq!(mixed([0., 0.]).unwrap().digest(), mixed([-0., -0.]).unwrap().digest());
    }

    /// Whatever is changed is noticed, in the digest where it belongs and in no other.
    #[test]
    fn every_change_is_noticed() {
        let now = |scene: &Scene| {
            (scene.digest().hiding == self::scene().digest().hiding, scene.digest().seen == self::scene().digest().seen)
        };
        let with = |change: fn(&mut Vec<SceneObject>)| {
            let mut objects = scene().objects().to_vec();
            change(&mut objects);
            Scene::new(objects).unwrap()
        };
        let marked = |object: u32| MovingObject { object, within: Some(Aabb { min: [0.; 3], max: [3.; 3] }) };
        let cases = [
            (scene(), (true, true)),
            // By one bit.
            (with(|o| o[1].vertices[0][2] = 2f64.next_up()), (false, false)),
            (with(|o| o[0].triangles.truncate(1)), (false, false)),
            (with(|o| o[0].triangles.push([0, 1, 2])), (false, false)),
            // The other way round it hides the same, and shows its front elsewhere.
            (with(|o| o[0].triangles[0] = [0, 2, 1]), (true, false)),
            (with(|o| o.swap(0, 1)), (true, false)),
            (scene().with_see_through(vec![1]).unwrap(), (false, false)),
            (scene().with_single_sided(vec![1]).unwrap(), (true, false)),
            (scene().with_mirrors(vec![0]).unwrap(), (true, false)),
            (scene().with_doors(vec![0]).unwrap(), (true, false)),
            (scene().with_moving(vec![marked(1)]).unwrap(), (false, false)),
        ];
        for (k, (scene, expected)) in cases.iter().enumerate() {
            assert_eq!(now(scene), *expected, "case {k}");
        }
        let anywhere = scene().with_moving(vec![MovingObject { object: 1, within: None }]).unwrap();
        let somewhere = scene().with_moving(vec![marked(1)]).unwrap().digest();
        assert_eq!(anywhere.digest().hiding, somewhere.hiding);
        assert_ne!(anywhere.digest().seen, somewhere.seen);
    }

    #[test]
    fn plans_and_portals_have_digests() {
        let wall = |a: [f64; 2], b: [f64; 2]| PlanLine { left: Some(1), ..PlanLine::wall(a.into(), b.into()) };
        let lines = vec![wall([0., 0.], [1., 0.]), wall([1., 0.], [1., 5.])];
        let plan = |lines: &[PlanLine]| Plan::new(lines.to_vec(), Vec::new()).unwrap().digest();
        let digest = plan(&lines);
        let mut same = vec![lines[1], lines[0]];
        assert_eq!(plan(&same), digest);
        // Run the other way, with its sides exchanged.
        same[0] = PlanLine { right: Some(1), ..PlanLine::wall(same[0].b, same[0].a) };
        assert_eq!(plan(&same), digest);
        let mut groups = lines.clone();
        groups[0].left = None;
        assert!(plan(&groups).hiding == digest.hiding && plan(&groups).seen != digest.seen);
        let mut moved = lines.clone();
        moved[1].b[1] = 5f64.next_down();
        assert!(plan(&moved).hiding != digest.hiding && plan(&moved).seen != digest.seen);
        let lamp = PlanObject { name: String::new(), bounds: Aabb { min: [0.; 2], max: [1.; 2] } };
        let lit = Plan::new(lines, vec![lamp]).unwrap().digest();
        assert!(lit.hiding == digest.hiding && lit.seen != digest.seen);

        let graph = |x: f64, cells: [u32; 2]| {
            let points = SQUARE.map(|[y, z, _]| [x, y, z]);
            CellGraph::of_portals(3, vec![(cells.map(CellId), Portal3::around(&points).unwrap())]).digest()
        };
        assert_eq!(graph(1., [0, 1]), graph(1., [0, 1]));
        assert_ne!(graph(1., [0, 1]), graph(2., [0, 1]));
        assert_ne!(graph(1., [0, 1]), graph(1., [0, 2]));
    }
}
