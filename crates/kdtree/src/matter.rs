//! Boxes inside solid things, whatever the directions of their faces.
//!
//! The number of times that a closed piece winds around a point is found along a ray, as in [`solid`](crate::solid), for
//! triangles in any direction: seen along the ray a triangle winds around the point or not, and the point is before its
//! plane or behind it. Both are exact signs. A box that no triangle of an object enters has one such number for all of its points.

use crate::hollow::overlap;
use crate::mesh::Mesh;
use crate::solid::{middle, sums, winds};
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::{Aabb, BoxTree, Point2, orient3d};
use std::sync::OnceLock;

/// What is solid in a scene, for queries about boxes.
///
/// Solid is the inside of a closed piece of an object that hides: each of its edges is passed as often in one direction as
/// in the other, and it winds around what is inside counter-clockwise as seen from outside, less what hollows of the same object take
/// away. A piece is a house and no wall, and does not count, if a triangle of anything else, but for the same object's closed pieces and copies,
/// has a point in its box, or something that moves comes there.
#[derive(Debug)]
pub struct Matter {
    /// Triangles of closed pieces.
    triangles: Vec<[Point3; 3]>,
    /// The shell of each triangle.
    shell_of: Vec<u32>,
    tree: BoxTree<3>,
    shells: Vec<Shell>,
    things: Vec<Thing>,
    things_tree: BoxTree<3>,
}

/// A closed piece of an object.
#[derive(Debug)]
struct Shell {
    object: u32,
    bounds: Aabb<3>,
    /// The same piece among the things.
    thing: u32,
    /// Whether something lies in it; looked for when it is first asked.
    contains: OnceLock<bool>,
}

/// A piece of an object that may lie in a shell.
#[derive(Debug)]
struct Thing {
    object: u32,
    /// Around all places that it moves to.
    bounds: Aabb<3>,
    corners: Vec<Point3>,
    shell: Option<u32>,
    /// Whether it is closed, and its fronts look inwards.
    is_hollow: bool,
}

impl Matter {
    /// Finds the closed pieces. O(n log n).
    pub fn of(scene: &Scene) -> Self {
        let (mut triangles, mut shell_of) = (Vec::new(), Vec::new());
        let (mut shells, mut things): (Vec<Shell>, Vec<Thing>) = (Vec::new(), Vec::new());
        for (id, object) in (0u32..).zip(scene.objects()) {
            let mesh = Mesh::of(object);
            let mut corners: Vec<Vec<Point3>> = vec![Vec::new(); mesh.pieces.len()];
            let first = shells.len() as u32;
            let mut of_piece = Vec::with_capacity(mesh.pieces.len());
            for piece in &mesh.pieces {
                let is_shell = piece.closed && scene.is_opaque(id);
                of_piece.push(is_shell.then(|| first + of_piece.iter().flatten().count() as u32));
                if is_shell {
                    shells.push(Shell { object: id, bounds: piece.bounds, thing: 0, contains: OnceLock::new() });
                }
            }
            for (&piece, t) in mesh.piece_of.iter().zip(object.corners()) {
                corners[piece as usize].extend(t);
                if let Some(shell) = of_piece[piece as usize] {
                    triangles.push(t);
                    shell_of.push(shell);
                }
            }
            for ((piece, corners), shell) in mesh.pieces.iter().zip(corners).zip(of_piece) {
                let moves = scene.moving().iter().any(|moving| moving.object == id);
                let bounds = if moves { scene.extent(id) } else { piece.bounds };
                if let Some(shell) = shell {
                    shells[shell as usize].thing = things.len() as u32;
                }
                let is_hollow = piece.closed && piece.inverted;
                things.push(Thing { object: id, bounds, corners, shell, is_hollow });
            }
        }
        let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
        let of_things: Vec<Aabb<3>> = things.iter().map(|thing| thing.bounds).collect();
        let (tree, things_tree) = (BoxTree::build(&boxes, 4), BoxTree::build(&of_things, 4));
        Self { triangles, shell_of, tree, shells, things, things_tree }
    }

    /// Whether all of a box, its border perhaps excepted, is certainly inside of solid matter. Exact; errs towards "no".
    ///
    /// O(log n) where nothing closed is around its middle, as a rule.
    pub fn holds(&self, b: &Aabb<3>) -> bool {
        let Some(p) = middle(b) else { return false };
        let Some(around) = self.around(p) else { return false };
        let counted = around.iter().filter(|(shell, n)| *n < 0 || !self.contains(*shell));
        let of_objects = sums(counted.map(|&(shell, n)| (self.shells[shell as usize].object, n)));
        let inside: Vec<u32> = of_objects.iter().filter(|(_, n)| *n > 0).map(|(object, _)| *object).collect();
        inside.iter().any(|&object| !self.enters(object, b))
    }

    /// How often each shell winds around a point, for those that do; none for a point on a triangle.
    fn around(&self, p: Point3) -> Option<Vec<(u32, i32)>> {
        let (mut parts, mut on_surface) = (Vec::new(), false);
        let ahead = |b: &Aabb<3>| (1..3).all(|k| b.min[k] <= p[k] && p[k] <= b.max[k]) && p[0] <= b.max[0];
        self.tree.visit(ahead, |i| {
            let [a, b, c] = self.triangles[i as usize];
            // Along the ray, which is the first axis.
            let n = winds([a, b, c].map(|q| Point2::new(q[1], q[2])), Point2::new(p[1], p[2]));
            if n == 0 {
                return;
            }
            // The front of a triangle that winds once faces the way of the ray, so a point before it is behind its front.
            let side = orient3d(a, b, c, p);
            on_surface |= side == 0.0;
            if (side < 0.0) == (n > 0) {
                parts.push((self.shell_of[i as usize], n));
            }
        });
        (!on_surface).then(|| sums(parts.into_iter()))
    }

    /// Whether the box of another thing overlaps that of a shell: then it may lie in it. A copy in the same place is none, nor is a
    /// hollow of the same object, which is taken away.
    fn contains(&self, shell: u32) -> bool {
        let of = &self.shells[shell as usize];
        *of.contains.get_or_init(|| {
            let overlaps = |b: &Aabb<3>| (0..3).all(|k| b.min[k] < of.bounds.max[k] && of.bounds.min[k] < b.max[k]);
            let own = &self.things[of.thing as usize];
            let mut found = false;
            self.things_tree.visit(
                |b| (0..3).all(|k| b.min[k] <= of.bounds.max[k] && of.bounds.min[k] <= b.max[k]),
                |i| {
                    let thing = &self.things[i as usize];
                    let is_own = thing.shell == Some(shell) || thing.is_hollow && thing.object == of.object;
                    found |= !is_own && overlaps(&thing.bounds) && thing.corners != own.corners;
                },
            );
            found
        })
    }

    /// Whether a triangle of a closed piece of an object has a point in the inside of a box. Exact for triangles with an area.
    fn enters(&self, object: u32, b: &Aabb<3>) -> bool {
        let mut found = false;
        let meets = |of: &Aabb<3>| (0..3).all(|k| of.min[k] < b.max[k] && b.min[k] < of.max[k]);
        self.tree.visit(meets, |i| {
            let shell = self.shell_of[i as usize];
            if !found && self.shells[shell as usize].object == object {
                found = cuts(&self.triangles[i as usize], b);
            }
        });
        found
    }
}

/// Whether a triangle with an area has a point in the inside of a box: no plane of an edge and an axis separates the two, and
/// the box has corners on both sides of the triangle. Exact.
fn cuts(t: &[Point3; 3], b: &Aabb<3>) -> bool {
    let inside = |k: usize| t.iter().any(|p| p[k] > b.min[k]) && t.iter().any(|p| p[k] < b.max[k]);
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] }) };
    let side = |i: usize| orient3d(t[0], t[1], t[2], corner(i));
    (0..3).all(inside)
        && (0..3).all(|axis| overlap(t, b, axis))
        && (0..8).any(|i| side(i) > 0.0)
        && (0..8).any(|i| side(i) < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::SceneObject;

    fn unit(min: f64, max: f64) -> Aabb<3> {
        Aabb { min: [min; 3], max: [max; 3] }
    }

    /// A cube of side 8 at the origin, turned about z by a rotation with rational cosine or not, fronts outwards.
    fn cube(turned: bool) -> SceneObject {
        let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { 0.0 } else { 8.0 }) };
        let turn = |p: Point3| if turned { [0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1], p[2]] } else { p };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        SceneObject { name: String::new(), vertices: (0..8).map(|i| turn(corner(i))).collect(), triangles }
    }

    fn tiny(at: Point3) -> SceneObject {
        let vertices = (0..3).map(|i| std::array::from_fn(|k| at[k] + if i == k { 0.25 } else { 0.0 })).collect();
        SceneObject { name: String::new(), vertices, triangles: vec![[0, 1, 2]] }
    }

    fn matter(objects: Vec<SceneObject>) -> Matter {
        Matter::of(&Scene::new(objects).expect("a scene"))
    }

    #[test]
    fn boxes_inside_are_held_up_to_the_surface() {
        let solid = matter(vec![cube(false)]);
        assert!(solid.holds(&unit(0.0, 8.0)) && solid.holds(&unit(1.0, 2.0)) && !solid.holds(&unit(8.0, 9.0)));
        assert!(!solid.holds(&Aabb { min: [1.0; 3], max: [2.0, 2.0, 8.0f64.next_up()] }));
        assert!(!solid.holds(&unit(2.0, 2.0)));
        // The middle of the turned cube is at (0.8, 5.6, 4).
        let turned = matter(vec![cube(true)]);
        assert!(turned.holds(&Aabb { min: [0.0, 5.0, 0.0], max: [2.0, 6.0, 8.0] }));
        assert!(!turned.holds(&Aabb { min: [-4.0, 5.0, 0.0], max: [5.0, 6.0, 8.0] }));
        assert!(!turned.holds(&Aabb { min: [5.0, 9.0, 1.0], max: [6.0, 10.0, 2.0] }));
    }

    /// Each of these differs from a solid by one thing.
    #[test]
    fn what_is_not_certainly_solid_is_a_place() {
        let inner = unit(2.0, 3.0);
        let changed = |change: &dyn Fn(&mut SceneObject)| {
            let mut object = cube(false);
            change(&mut object);
            matter(vec![object]).holds(&inner)
        };
        assert!(changed(&|_| ()));
        (0..12).for_each(|i| assert!(!changed(&|o| _ = o.triangles.remove(i)), "without triangle {i}"));
        assert!(!changed(&|o| o.triangles.iter_mut().for_each(|t| t.swap(0, 1))), "a room, seen from inside");
        assert!(!changed(&|o| o.triangles[5].swap(0, 1)));
        let with = |other| matter(vec![cube(false), other]).holds(&inner);
        assert!(with(tiny([9.0; 3])) && with(cube(false)), "things outside and copies change nothing");
        assert!(!with(tiny([6.0; 3])), "a house with a thing in it");
        let mut wall = tiny([0.0; 3]);
        wall.vertices = vec![[4.0, 0.0, 0.0], [4.0, 8.0, 0.0], [4.0, 8.0, 8.0]];
        assert!(!with(wall.clone()), "a house with a wall from side to side");
        wall.vertices = vec![[0.0, 0.0, 0.0], [8.0, 8.0, 0.0], [8.0, 8.0, 8.0]];
        assert!(!with(wall), "a house with a thing as large as the house");
        let mut shaft = tiny([6.0; 3]);
        shaft.vertices[2] = [6.0, 6.0, 20.0];
        assert!(!with(shaft), "a house with a thing that leaves it");
        let mut room = cube(false);
        room.vertices.iter_mut().for_each(|p| *p = p.map(|x| x / 2.0 + 2.0));
        room.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!(!with(room), "a house with a room in it");
        let lift = Scene::new(vec![cube(false), tiny([20.0, 1.0, 1.0])]).expect("a scene");
        let moves = |within| sightlines_cells::MovingObject { object: 1, within: Some(within) };
        let within = Aabb { min: [20.0, 0.0, 0.0], max: [21.0, 2.0, 2.0] };
        assert!(Matter::of(&lift.clone().with_moving(vec![moves(within)]).expect("a scene")).holds(&inner));
        let within = Aabb { min: [1.0, 0.0, 0.0], ..within };
        assert!(!Matter::of(&lift.with_moving(vec![moves(within)]).expect("a scene")).holds(&inner), "a lift comes in");
        let scene = Scene::new(vec![cube(false)]).expect("a scene").with_see_through(vec![0]).expect("an object");
        assert!(!Matter::of(&scene).holds(&inner), "water");
    }

    #[test]
    fn hollows_are_taken_away() {
        let mut object = cube(false);
        let hollow = cube(false);
        object.vertices.extend(hollow.vertices.iter().map(|p| p.map(|x| x / 2.0 + 2.0)));
        object.triangles.extend(hollow.triangles.iter().map(|t| [t[0] + 8, t[2] + 8, t[1] + 8]));
        let shell = matter(vec![object]);
        assert!(!shell.holds(&unit(3.0, 4.0)) && !shell.holds(&unit(1.0, 3.0)));
        assert!(shell.holds(&unit(0.0, 2.0)));
    }
}
