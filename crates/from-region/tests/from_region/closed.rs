//! Closed surfaces against a flood of the cells of a lattice: what they hide is never joined to the eye, and if nothing is missing,
//! what is not joined is hidden. What hides from its front only is compared with exact segments.

use crate::common::{block, cuboid};
use proptest::prelude::*;
use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::{ClosedSurfaces, EyeSides};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_testkit::fronts::Mixed;
use std::collections::{BTreeMap, BTreeSet};

/// Cells of the lattice along each axis; those at its border are air.
const N: i32 = 5;

type Cell = [i32; 3];

/// Some cells of the lattice are solid; their sides are walls, but for some that are missing.
#[derive(Debug, Clone)]
struct Lattice {
    solid: BTreeSet<Cell>,
    /// The sides that are missing: a cell, and the next one along an axis.
    missing: BTreeSet<(Cell, usize)>,
    /// To how many objects the sides go in turn.
    n_objects: usize,
    scale: f64,
    shift: f64,
}

fn cells() -> impl Iterator<Item = Cell> {
    (0..N * N * N).map(|i| [i / (N * N), i / N % N, i % N])
}

fn next(mut cell: Cell, axis: usize) -> Cell {
    cell[axis] += 1;
    cell
}

impl Lattice {
    fn new(solid: BTreeSet<Cell>) -> Self {
        Self { solid, missing: BTreeSet::new(), n_objects: 1, scale: 1.0, shift: 0.0 }
    }

    fn is_wall(&self, cell: Cell, axis: usize) -> bool {
        self.solid.contains(&cell) != self.solid.contains(&next(cell, axis)) && !self.missing.contains(&(cell, axis))
    }

    fn at(&self, p: Point3) -> Point3 {
        p.map(|x| x * self.scale + self.shift)
    }

    /// The sides, facing away from what is solid.
    fn objects(&self) -> Vec<SceneObject> {
        let mut objects: Vec<SceneObject> = (0..self.n_objects)
            .map(|k| SceneObject { name: k.to_string(), vertices: Vec::new(), triangles: Vec::new() })
            .collect();
        let sides = cells().flat_map(|cell| (0..3).map(move |axis| (cell, axis)));
        for (k, (cell, axis)) in sides.filter(|&(cell, axis)| self.is_wall(cell, axis)).enumerate() {
            let corner = |u: i32, v: i32| {
                let mut p = next(cell, axis);
                p[(axis + 1) % 3] += u;
                p[(axis + 2) % 3] += v;
                self.at(p.map(f64::from))
            };
            let of = &mut objects[k % self.n_objects];
            let first = of.vertices.len() as u32;
            of.vertices.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
            let turn = |[a, b, c]: [u32; 3]| if self.solid.contains(&cell) { [a, b, c] } else { [a, c, b] };
            of.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| turn(t).map(|i| first + i)));
        }
        objects
    }

    fn scene(&self) -> Scene {
        Scene::new(self.objects()).expect("a scene")
    }

    /// A box, or a triangle, within a cell.
    fn inside(&self, cell: Cell) -> (Aabb<3>, [Point3; 3]) {
        let at = |part: Point3| self.at([0, 1, 2].map(|k| f64::from(cell[k]) + part[k]));
        (block(at([0.3; 3]), at([0.6; 3])), [at([0.2, 0.3, 0.7]), at([0.7, 0.4, 0.3]), at([0.4, 0.8, 0.5])])
    }

    /// For each cell the lowest one that a path joins to it.
    fn flood(&self) -> BTreeMap<Cell, Cell> {
        let mut found = BTreeMap::new();
        for start in cells() {
            let mut pending = vec![start];
            while let Some(cell) = pending.pop() {
                if found.contains_key(&cell) {
                    continue;
                }
                found.insert(cell, start);
                for axis in 0..3 {
                    let (after, mut before) = (next(cell, axis), cell);
                    before[axis] -= 1;
                    let ways = [(after, self.is_wall(cell, axis)), (before, self.is_wall(before, axis))];
                    let is_cell = |cell: &Cell| cell.iter().all(|x| (0..N).contains(x));
                    pending.extend(ways.iter().filter(|(to, wall)| !wall && is_cell(to)).map(|(to, _)| *to));
                }
            }
        }
        found
    }

    /// How many pairs of cells are apart by the flood, and how many of them are found hidden; and one that is found hidden and is not apart.
    fn judge(&self, closed: &ClosedSurfaces) -> (usize, usize, Option<[Cell; 2]>) {
        let flood = self.flood();
        let (mut n_apart, mut n_found, mut wrong) = (0, 0, None);
        for eye in cells().step_by(13).chain([[0; 3]]) {
            let sides = [closed.sides_of(&self.inside(eye).0)];
            let from_outside = [EyeSides::OUTSIDE];
            for target in cells() {
                let is_apart = flood[&eye] != flood[&target];
                let mut is_hidden = closed.hide(&sides, &self.inside(target).1);
                if flood[&eye] == flood[&[0; 3]] {
                    // The border of the lattice is joined to all that is outside.
                    is_hidden |= closed.hide(&from_outside, &self.inside(target).1);
                }
                n_apart += usize::from(is_apart);
                n_found += usize::from(is_apart && is_hidden);
                if is_hidden && !is_apart {
                    wrong = Some([eye, target]);
                }
            }
        }
        (n_apart, n_found, wrong)
    }
}

fn lattices(most_missing: usize) -> impl Strategy<Value = Lattice> {
    let inner = || (1..N - 1, 1..N - 1, 1..N - 1).prop_map(|(x, y, z)| [x, y, z]);
    // Mostly solid, with voids; or mostly air.
    let solid = prop_oneof![
        prop::collection::btree_set(inner(), 0..5).prop_map(|voids| {
            let is_inner = |cell: &Cell| cell.iter().all(|x| (1..N - 1).contains(x)) && !voids.contains(cell);
            cells().filter(is_inner).collect()
        }),
        prop::collection::btree_set(inner(), 1..12),
    ];
    let missing = prop::collection::btree_set((inner(), 0usize..3), 0..=most_missing);
    let place = prop_oneof![Just((1.0, 0.0)), Just((0.1, 1e3)), Just((1e-7, -3.0)), Just((7e5, 1.0 / 3.0))];
    (solid, missing, 1usize..4, place).prop_map(|(solid, missing, n_objects, (scale, shift))| Lattice {
        missing,
        n_objects,
        scale,
        shift,
        ..Lattice::new(solid)
    })
}

proptest! {
    /// Invariant: no path through the lattice joins the eye to what closed surfaces hide, whichever sides are missing.
    #[test]
    fn what_closed_surfaces_hide_is_not_joined_to_the_eye(of in lattices(6)) {
        let (_, _, wrong) = of.judge(&ClosedSurfaces::new(&of.scene()));
        prop_assert!(wrong.is_none(), "{wrong:?}");
    }

    /// Invariant: from outside, no exact segment reaches what is hidden by surfaces of which some hide from their fronts only, and some of those are turned.
    #[test]
    fn what_fronts_hide_is_not_seen_from_outside(of in lattices(4), one_sided in any::<u8>(), turned in any::<u8>()) {
        let mut objects = of.objects();
        let has = |bits: u8, k: usize| bits >> k & 1 == 1;
        let is_front = |k: usize| has(one_sided, k);
        for (_, of) in objects.iter_mut().enumerate().filter(|(k, _)| has(turned, *k) && has(turned, 7)) {
            of.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        let part = |fronts: bool| {
            let those = objects.iter().enumerate().filter(|(k, _)| is_front(*k) == fronts);
            those.flat_map(|(_, of)| of.corners().collect::<Vec<_>>()).collect()
        };
        let walls = Mixed { both_sides: part(false), fronts: part(true) };
        let fronts = (0..objects.len() as u32).filter(|&k| is_front(k as usize)).collect();
        let scene = Scene::new(objects).expect("a scene").with_front_occluders(fronts).expect("objects");
        let closed = ClosedSurfaces::new(&scene);
        let mut random = Random::new(u64::from(one_sided));
        for cell in cells() {
            let target = of.inside(cell).1;
            if closed.hide(&[EyeSides::OUTSIDE], &target) {
                for point in target {
                    let way = random.direction();
                    let eye = [0, 1, 2].map(|k| point[k] + way[k] * 20.0 * of.scale);
                    prop_assert!(!walls.is_free([eye, point]), "{cell:?} from {eye:?}");
                }
            }
        }
    }
}

/// The twin: where no side is missing, nearly all that is apart is hidden. What is left are voids that touch another air along an edge: surfaces of both
/// hang together there, and have the void on no side of its own.
#[test]
fn what_is_apart_is_found_hidden_if_nothing_is_missing() {
    let (mut n_apart, mut n_found) = (0, 0);
    for of in sightlines_testkit::draw(&lattices(0), 120) {
        let (apart, found, wrong) = of.judge(&ClosedSurfaces::new(&of.scene()));
        assert_eq!(wrong, None);
        (n_apart, n_found) = (n_apart + apart, n_found + found);
    }
    assert!(n_apart > 5_000 && n_found * 100 > n_apart * 95, "{n_found} of {n_apart}");
}

/// The comparison notices surfaces that are taken to be closed though a side is missing.
#[test]
fn impostor_a_missing_side_that_is_overlooked_is_noticed() {
    let all = sightlines_testkit::draw(&lattices(6), 60);
    let has_lost = |of: &&Lattice| of.objects().iter().any(|o| !o.triangles.is_empty()) && !of.missing.is_empty();
    let overlooks = |of: &Lattice| {
        let whole = Lattice { missing: BTreeSet::new(), ..of.clone() };
        of.judge(&ClosedSurfaces::new(&whole.scene())).2.is_some()
    };
    let n = all.iter().filter(has_lost).filter(|of| overlooks(of)).count();
    assert!(n > 5, "{n}");
}

/// A shell of the inner cells, with what is in it.
fn shell(more: &[Cell]) -> BTreeSet<Cell> {
    let is_shell = |cell: &Cell| {
        cell.iter().all(|x| (1..N - 1).contains(x)) && cell.iter().any(|x| *x == 1 || *x == N - 2)
            || more.contains(cell)
    };
    cells().filter(is_shell).collect()
}

/// A window in a closed hull is none of its surfaces, as it lets light through; with the pane opaque, the hull is closed by it.
#[test]
fn a_window_of_glass_opens_a_hull() {
    let mut of = Lattice::new(shell(&[]));
    let pane: Cell = [0, 2, 2];
    let objects = |of: &Lattice| of.objects();
    let whole = objects(&of);
    of.missing.insert((pane, 0));
    let mut parts = objects(&of);
    let glass: Vec<[u32; 3]> = whole[0]
        .triangles
        .iter()
        .copied()
        .filter(|t| {
            t.iter().all(|&i| {
                let p = whole[0].vertices[i as usize];
                p[0] == 1.0 && (2.0..=3.0).contains(&p[1]) && (2.0..=3.0).contains(&p[2])
            })
        })
        .collect();
    assert_eq!(glass.len(), 2);
    parts.push(SceneObject { name: "Pane".into(), vertices: whole[0].vertices.clone(), triangles: glass });
    let scene = Scene::new(parts).expect("a scene");
    let target = of.inside([2; 3]).1;
    let is_hidden = |scene: &Scene| ClosedSurfaces::new(scene).hide(&[EyeSides::OUTSIDE], &target);
    // The solid of the shell is behind its outer surface, of which the pane is a part; the void is within the inner one.
    let within = of.inside([1, 2, 2]).1;
    let shows = |scene: &Scene| !ClosedSurfaces::new(scene).hide(&[EyeSides::OUTSIDE], &within);
    assert!(is_hidden(&scene) && !shows(&scene));
    let with_glass = scene.with_see_through(vec![1]).expect("the pane");
    assert!(shows(&with_glass), "glass");
    // Nor does a hull hide that is all of glass.
    assert!(!is_hidden(&Scene::new(whole).expect("a scene").with_see_through(vec![0]).expect("the hull")));
}

/// What touches the hull from inside is not in a surface's inside, as far as that one is asked; one that is a whole wall away is.
#[test]
fn what_touches_the_hull_is_not_hidden_by_it() {
    let hull = cuboid(&block([0.0; 3], [4.0; 3]), &[]);
    let closed = ClosedSurfaces::new(&Scene::new(vec![hull.clone()]).expect("a scene"));
    let is_hidden = |closed: &ClosedSurfaces, z: f64| {
        closed.hide(&[EyeSides::OUTSIDE], &[[1.0, 1.0, z], [2.0, 1.0, z], [1.0, 2.0, z]])
    };
    assert!(is_hidden(&closed, 4f64.next_down()) && !is_hidden(&closed, 4.0) && !is_hidden(&closed, 4f64.next_up()));
    // A corner in the hull is enough; and a second hull around all hides it again.
    assert!(!closed.hide(&[EyeSides::OUTSIDE], &[[1.0, 1.0, 1.0], [2.0, 1.0, 4.0], [1.0, 2.0, 2.0]]));
    let around = cuboid(&block([-1.0; 3], [5.0; 3]), &[]);
    let twice = ClosedSurfaces::new(&Scene::new(vec![hull, around]).expect("a scene"));
    assert!(is_hidden(&twice, 4.0) && twice.len() == 2);
}

/// Boxes around triangles of a turned hull are larger than the triangles: what is near a side, and does not touch it, is hidden all the same.
#[test]
fn a_turned_hull_hides_what_is_near_its_sides() {
    let turned = |[x, y, z]: Point3| {
        let [x, y] = [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y];
        [x, 0.6 * y - 0.8 * z, 0.8 * y + 0.6 * z]
    };
    let mut hull = cuboid(&block([0.0; 3], [4.0; 3]), &[]);
    hull.vertices.iter_mut().for_each(|p| *p = turned(*p));
    let closed = ClosedSurfaces::new(&Scene::new(vec![hull]).expect("a scene"));
    let is_hidden = |z: f64| {
        let plate = [[0.1, 0.1, z], [3.9, 0.1, z], [0.1, 3.9, z]];
        closed.hide(&[EyeSides::OUTSIDE], &plate.map(turned))
    };
    assert!(is_hidden(0.1) && is_hidden(2.0) && is_hidden(3.9) && is_hidden(1e-6));
    assert!(!is_hidden(-0.1) && !is_hidden(-1e-6) && !is_hidden(4.1));
}

/// Corners are equal if their numbers are: negative zeros, which mirrored nodes have, are zeros.
#[test]
fn corners_at_negative_zero_hang_together() {
    let whole = cuboid(&block([0.0; 3], [4.0; 3]), &[]);
    let (mut low, mut high) = (whole.clone(), whole);
    high.triangles = low.triangles.split_off(6);
    high.vertices.iter_mut().flatten().filter(|x| **x == 0.0).for_each(|x| *x = -0.0);
    let closed = ClosedSurfaces::new(&Scene::new(vec![low, high]).expect("a scene"));
    assert!(closed.hide(&[EyeSides::OUTSIDE], &[[1.0; 3], [2.0, 1.0, 1.0], [1.0, 2.0, 1.0]]));
}
