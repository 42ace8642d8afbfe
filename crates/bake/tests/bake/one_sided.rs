//! A thousand halls with walls of one side, and a thousand things that cross themselves, against segments that are decided exactly, triangle by
//! triangle: what an engine shows past a back is listed.

use crate::places::{block, scene};
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::{BakeRequest, CellsFrom, Runtime, SceneMethod};
use sightlines_cells::{CellId, Point3, Scene, SceneObject};
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::{Aabb, Random};
use sightlines_pvs::{ObjectId, Table};
use sightlines_testkit::fronts::Mixed;
use sightlines_testkit::siblings;

/// The table of a scene for these cells, by line space or by what is chosen.
fn table(scene: &Scene, cells: &[Aabb<3>], by_line_space: bool) -> Table {
    let cells = cells.iter().enumerate().map(|(k, &bounds)| ViewCell { id: k.to_string(), bounds }).collect();
    let cells = Some(CellsFrom::Boxes(ViewCells { cells, axes: None }));
    let method = by_line_space.then_some(SceneMethod::FromRegion(OcclusionMethod::LineSpace));
    let request = BakeRequest { cells, method, ..BakeRequest::default() };
    Runtime { threads: 1, ..Runtime::default() }.bake(scene, &request).expect("a table").table
}

fn lists(table: &Table, cell: usize, object: u32) -> bool {
    table.visible_objects(CellId(cell as u32)).contains(&ObjectId(object))
}

/// All that hides but for one object, as an engine draws it that leaves out the backs of these.
fn others(scene: &Scene, but: Option<u32>, one_sided: &[u32]) -> Mixed {
    let mut found = Mixed { both_sides: Vec::new(), fronts: Vec::new() };
    for (k, object) in (0u32..).zip(scene.objects()).filter(|(k, _)| Some(*k) != but) {
        let to = if one_sided.contains(&k) { &mut found.fronts } else { &mut found.both_sides };
        to.extend(object.corners());
    }
    found
}

/// How wide a room is.
const WIDE: f64 = 3.0;

/// A wall between two rooms: from y = 0 on, with its front towards lower x, towards higher x, or with both sides.
#[derive(Debug, Clone, Copy)]
struct Wall {
    ends: [f64; 2],
    /// How far it goes; the hall is 4 wide.
    to: f64,
    front: Option<bool>,
}

impl Wall {
    fn any(k: usize, random: &mut Random) -> Self {
        let is_straight = random.below(2) == 0;
        let shift = |random: &mut Random| (random.below(5) as f64 - 2.0) / 4.0;
        let first = shift(random);
        let ends = [first, if is_straight { first } else { shift(random) }].map(|d| WIDE * (k + 1) as f64 + d);
        let to = if random.below(3) > 0 { 4.0 } else { 1.0 + 0.5 * random.below(6) as f64 };
        Self { ends, to, front: [Some(true), Some(false), Some(true), Some(false), None][random.below(5)] }
    }

    fn object(&self) -> SceneObject {
        let [from, to] = self.ends;
        let to = from + (to - from) * self.to / 4.0;
        let vertices = vec![[from, 0.0, 0.0], [from, 0.0, 3.0], [to, self.to, 3.0], [to, self.to, 0.0]];
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        if self.front == Some(false) {
            triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        SceneObject { name: String::new(), vertices, triangles }
    }

    /// Whether it hides all that is behind it from lower x, or from higher x.
    fn hides(&self, from_low: bool) -> bool {
        self.to == 4.0 && self.front.is_none_or(|towards_low| towards_low == from_low)
    }
}

/// What an engine shows past the back of a wall is listed, by what is chosen and by line space, whether backs are drawn or not. The twin is what is behind
/// the front of a wall across the hall, which is hidden; the impostor takes walls for such of two sides.
#[test]
fn what_is_seen_past_backs_is_listed_and_what_is_behind_fronts_is_not() {
    let [mut n, mut n_past, mut n_behind, mut n_hidden, mut n_tried, mut n_wrong] = [0; 6];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let n_rooms = 2 + random.below(2);
        let walls: Vec<Wall> = (0..n_rooms - 1).map(|k| Wall::any(k, &mut random)).collect();
        let mut shell = block(&Aabb { min: [0.0; 3], max: [WIDE * n_rooms as f64, 4.0, 3.0] }, false);
        shell.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let things: Vec<Aabb<3>> = (0..n_rooms)
            .map(|room| {
                let min = [WIDE * room as f64 + 1.25, 0.5 + 0.25 * random.below(10) as f64, 0.5];
                Aabb { min, max: [min[0] + 0.5, min[1] + 0.5, 1.0 + 0.25 * random.below(6) as f64] }
            })
            .collect();
        let objects = std::iter::once(shell).chain(things.iter().map(|b| block(b, false)));
        let both_sides = scene(objects.chain(walls.iter().map(Wall::object)).collect());
        let cells: Vec<Aabb<3>> = (0..n_rooms)
            .map(|room| {
                let x = WIDE * room as f64;
                let y = 0.25 + 0.25 * random.below(6) as f64;
                Aabb { min: [x + 0.75, y, 0.25], max: [x + 2.25, y + 1.0 + 0.25 * random.below(4) as f64, 2.75] }
            })
            .collect();
        let first_wall = 1 + n_rooms as u32;
        let one_sided = |k: u32| k < first_wall || walls[(k - first_wall) as usize].front.is_some();
        let one_sided: Vec<u32> = (0..both_sides.objects().len() as u32).filter(|&k| one_sided(k)).collect();
        // Backs are not drawn; or nobody knows, and whoever is closed hides from both sides.
        let is_culled = random.below(2) == 0;
        let plain = both_sides.clone();
        let of_one_side = if is_culled {
            plain.with_backs_culled(one_sided.clone())
        } else {
            let open = one_sided.iter().copied().filter(|&k| k == 0 || k >= first_wall).collect();
            plain.with_front_occluders(open)
        };
        let of_one_side = of_one_side.expect("objects");
        let by_line_space = random.below(2) == 0;
        let found = table(&of_one_side, &cells, by_line_space);
        let impostor = (n % 8 == 0).then(|| table(&both_sides, &cells, by_line_space));
        let (mut is_wrong, mut is_past) = (false, false);
        for target in 1..both_sides.objects().len() as u32 {
            let rest = others(&both_sides, Some(target), &one_sided);
            let wall = target.checked_sub(first_wall).map(|k| walls[k as usize]);
            for (room, cell) in cells.iter().enumerate() {
                let segment = |random: &mut Random| {
                    let p = random.point(cell);
                    let q = match wall {
                        None => random.point(&things[target as usize - 1]),
                        Some(wall) => {
                            let y = wall.to * random.open_unit();
                            [wall.ends[0] + (wall.ends[1] - wall.ends[0]) * y / 4.0, y, 3.0 * random.open_unit()]
                        }
                    };
                    [p, q]
                };
                // Its back is seen unless backs are culled.
                let from_low = wall.is_some_and(|wall| cell.max[0] < wall.ends[0].min(wall.ends[1]));
                let is_shown = wall.is_none_or(|wall| !is_culled || wall.front.is_none_or(|low| low == from_low));
                let free = (0..10).map(|_| segment(&mut random)).find(|&s| is_shown && rest.is_free(s));
                let is_listed = lists(&found, room, target);
                assert!(is_listed || free.is_none(), "{seed}: room {room}, object {target}, {free:?}, {walls:?}");
                is_wrong |= free.is_some() && impostor.as_ref().is_some_and(|table| !lists(table, room, target));
                if let (None, true) = (wall, target as usize != room + 1) {
                    let to = target as usize - 1;
                    let mut between = walls[room.min(to)..room.max(to)].iter();
                    is_past |= free.is_some() && between.clone().any(|wall| wall.hides(room > to));
                    if between.any(|wall| wall.hides(room < to)) {
                        n_behind += 1;
                        n_hidden += usize::from(!is_listed);
                    }
                }
            }
        }
        n_tried += usize::from(impostor.is_some());
        n_wrong += usize::from(is_wrong);
        n_past += usize::from(is_past);
        n += 1;
    }
    eprintln!(
        "{n} halls, {n_past} with something seen past a back; {n_hidden} of {n_behind} pairs behind fronts hidden; two sides wrong in {n_wrong} of {n_tried}"
    );
    assert!(n == siblings().len() && 4 * n_past > n && 2 * n_behind > n, "{n_past} {n_behind} of {n}");
    assert!(n_hidden == n_behind && 2 * n_wrong > n_tried, "{n_hidden} of {n_behind}; {n_wrong} of {n_tried}");
}

/// A prism over an outline, closed edge by edge, with floor and ceiling cut into a fan.
fn prism(outline: &[[i32; 2]]) -> SceneObject {
    let n = outline.len() as u32;
    let at = |z: f64| outline.iter().map(move |p| [f64::from(p[0]), f64::from(p[1]), z]);
    let vertices: Vec<Point3> = at(0.0).chain(at(3.0)).collect();
    let fan = (1..n - 1).flat_map(|k| [[0, k + 1, k], [n, n + k, n + k + 1]]);
    let walls = (0..n).flat_map(|k| [[k, (k + 1) % n, (k + 1) % n + n], [k, (k + 1) % n + n, k + n]]);
    SceneObject { name: String::new(), vertices, triangles: fan.chain(walls).collect() }
}

/// Twice the area that an outline winds around counter-clockwise.
fn doubled([a, b, c]: [[i32; 2]; 3]) -> i32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The corners of a thing around its middle.
const SMALL: [[f64; 2]; 4] = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]];

/// How often an outline winds around a point, by counting what it crosses of a ray.
fn winding(outline: &[[i32; 2]], [x, y]: [f64; 2]) -> i32 {
    let sides = (0..outline.len()).map(|k| [outline[k], outline[(k + 1) % outline.len()]].map(|p| p.map(f64::from)));
    let turn = |[a, b]: [[f64; 2]; 2]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    sides
        .map(|side| match (side[0][1] <= y, side[1][1] <= y) {
            (true, false) => i32::from(turn(side) > 0.0),
            (false, true) => -i32::from(turn(side) < 0.0),
            _ => 0,
        })
        .sum()
}

fn is_convex(outline: &[[i32; 2]]) -> bool {
    let sides = (0..outline.len()).map(|k| [outline[k], outline[(k + 1) % outline.len()]]);
    sides.into_iter().all(|[a, b]| outline.iter().all(|&c| doubled([a, b, c]) >= 0))
}

/// What stands in a lobe that is inside out is listed, as its near faces show their backs. The twin is what stands in a prism that does not cross itself, which
/// is hidden; the impostor takes whatever is closed edge by edge, with a positive volume, for solid.
#[test]
fn what_is_in_a_lobe_inside_out_is_listed() {
    let [mut n, mut n_in_lobes, mut n_in, mut n_hidden, mut n_tried, mut n_wrong] = [0; 6];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let is_twin = random.below(4) == 0;
        let (outline, [x, y]) = loop {
            let corners = if is_twin { 4 } else { 4 + random.below(3) };
            let outline: Vec<[i32; 2]> = (0..corners).map(|_| [(); 2].map(|()| random.below(9) as i32 - 4)).collect();
            // Of a volume that is not positive no impostor would take it for solid.
            let fan = || (1..corners - 1).map(|k| doubled([outline[0], outline[k], outline[k + 1]]));
            let is_bent = |k: usize| doubled([outline[k], outline[(k + 1) % corners], outline[(k + 2) % corners]]) != 0;
            if !fan().all(|area| area != 0) || fan().sum::<i32>() <= 0 || !(0..corners).all(is_bent) {
                continue;
            }
            let at = [(); 2].map(|()| 8.0 * random.unit() - 4.0);
            let around = SMALL.map(|d| winding(&outline, [at[0] + d[0], at[1] + d[1]]));
            let is_right = match is_twin {
                true => is_convex(&outline) && around == [1; 4],
                // In a lobe that is inside out, or anywhere.
                false => around == [-1; 4] || random.below(1000) == 0,
            };
            if is_right {
                break (outline, at);
            }
        };
        let thing = Aabb { min: [x - 0.1, y - 0.1, 1.0], max: [x + 0.1, y + 0.1, 1.5] };
        let plain = scene(vec![prism(&outline), block(&thing, false)]);
        let cells = [0, 1].map(|k| {
            let side = if random.below(2) == 0 { -8.0 } else { 6.0 };
            let (mut min, z) = ([8.0 * random.unit() - 5.0; 3], random.unit());
            (min[k], min[2]) = (side, z);
            Aabb { min, max: min.map(|x| x + 1.5) }
        });
        let by_line_space = random.below(2) == 0;
        let found = table(&plain.clone().with_backs_culled(vec![0, 1]).expect("objects"), &cells, by_line_space);
        let impostor = table(&plain, &cells, by_line_space);
        let rest = others(&plain, Some(1), &[0]);
        let mut is_wrong = false;
        for (k, cell) in cells.iter().enumerate() {
            let free = rest.free_segment(cell, &thing, random.bits(), 60);
            let is_listed = lists(&found, k, 1);
            assert!(is_listed || free.is_none(), "{seed}: {outline:?} {thing:?} {cell:?} {free:?}");
            if is_twin {
                n_in += 1;
                n_hidden += usize::from(!is_listed);
            }
            if free.is_some() && !lists(&impostor, k, 1) {
                is_wrong = true;
            }
            n_tried += usize::from(free.is_some());
        }
        n_in_lobes += usize::from(SMALL.iter().all(|d| winding(&outline, [x + d[0], y + d[1]]) == -1));
        n_wrong += usize::from(is_wrong);
        n += 1;
    }
    eprintln!(
        "{n} prisms, {n_in_lobes} things in lobes inside out; {n_tried} pairs seen, taken for solid {n_wrong} hide one; {n_hidden} of {n_in} hidden in convex ones"
    );
    assert!(n == siblings().len() && 3 * n_in_lobes > n && 2 * n_tried > n, "{n_in_lobes} {n_tried} of {n}");
    assert!(n_hidden == n_in && 4 * n_in > n && 4 * n_wrong > n, "{n_hidden} of {n_in}; {n_wrong}");
}
