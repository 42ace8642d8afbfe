//! Furnished office towers: floors of offices one above the other, joined by stairwells.
//!
//! The setting for which cell-and-portal visibility was invented (Teller and Séquin, SIGGRAPH 1991). The floors share
//! their corridors, outer walls and stairwells; rooms, doors and furniture differ.

mod furniture;
mod mesh;
mod room;
mod stairs;
#[cfg(test)]
mod tests;
mod walls;

use crate::error::{GenerateError, check_range};
use crate::layout::{Layout, STEPS};
use crate::office::half_thickness;
use crate::rng::Rng;
use crate::stroke::Rect;
use mesh::{Mesh, STEP};
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Aabb;
use walls::{CEILING, WallPart, wall_parts};

/// Options of [`tower`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TowerOptions {
    /// Determines every random choice. The lower floors of a higher tower are the same.
    pub seed: u64,
    /// Floors, from 1 to 256.
    pub floors: u32,
    /// Room places side by side in a row, from 1 to 128, besides the core with the stairwells.
    pub rooms_x: u32,
    /// Rows of rooms, from 1 to 128. There is a stairwell for every four.
    pub rooms_y: u32,
    /// Level of detail of furniture. 0: none. 1, 2, 3: round parts have 4, 8, 16 sides, and a piece has
    /// about 110, 180, 210 triangles.
    pub furniture: u32,
    /// Whether there are windows: holes in the outer walls.
    pub windows: bool,
    /// Thickness of walls in units: 0 (a wall is a pair of rectangles, one for each side), 0.25 or 0.5.
    pub wall_thickness: f64,
}

impl Default for TowerOptions {
    /// 16 floors of about 15 rooms each, with windows, furniture and walls of a quarter of a unit: over
    /// 400,000 triangles.
    fn default() -> Self {
        Self { seed: 1, floors: 16, rooms_x: 6, rooms_y: 4, furniture: 2, windows: true, wall_thickness: 0.25 }
    }
}

/// A room of a tower, where a viewer can be.
#[derive(Debug, Clone, PartialEq)]
pub struct TowerRoom {
    /// Its name, as in the names of the objects in it, such as `floor3/room_07`.
    pub name: String,
    /// Its clear space, from wall to wall and from floor to ceiling.
    pub bounds: Aabb<3>,
}

/// Thickness of slabs, in layout steps: 0.25 units.
const SLAB: i32 = 2;
/// From one floor to the next, in layout steps: 3 units.
const STOREY: i32 = CEILING + SLAB;
/// Room places between two corridors across.
const BLOCK: u32 = 6;
/// Most room places of a tower: about 40 million triangles with the finest furniture.
const MAX_PLACES: u32 = 1 << 15;

/// A tower in metres, y up: the floor of the lowest storey is at height 0, and one corner of the outer
/// walls' middle lines at x = z = 0.
///
/// Objects are closed and face outwards: `floor3/slab` (with holes for stairs), `floor3/wall_12`,
/// `floor3/lintel_4` above doors and windows, `floor3/sill_2` below windows, `floor3/pillar_1`,
/// `floor3/stairs_0`, and furniture such as `floor3/room_07/desk_2`; the roof is `roof/slab`. Walls,
/// slabs, pillars and steps are axial and do not overlap each other; much of the furniture is not
/// axial. Coordinates are multiples of 1/64; of walls and slabs, multiples of 1/8. Every room has a
/// door to a corridor, and every corridor leads to a stairwell.
///
/// # Errors
/// [`GenerateError`] for a count out of its range, more than 32768 room places (`floors` times `rooms_x`
/// times `rooms_y`), or an unknown thickness.
pub fn tower(options: TowerOptions) -> Result<Scene, GenerateError> {
    let plan = TowerPlan::new(&options)?;
    let mut objects = Vec::new();
    for (i, floor) in plan.floors.iter().enumerate() {
        plan.build_floor(i, floor, &mut objects);
    }
    let height = height_of(plan.floors.len());
    objects.push(plan.slab(false).object("roof/slab".to_owned(), height));
    Ok(Scene::new(objects).expect("corners on a grid of 64ths make a scene"))
}

/// The rooms of the tower that [`tower`] makes from the same options, floor by floor; stairwells are
/// rooms, corridors are not.
///
/// # Errors
/// As [`tower`].
pub fn tower_rooms(options: TowerOptions) -> Result<Vec<TowerRoom>, GenerateError> {
    let plan = TowerPlan::new(&options)?;
    let unit = |x: i32| f64::from(x) / f64::from(STEPS);
    let mut rooms = Vec::new();
    for (i, floor) in plan.floors.iter().enumerate() {
        let [low, high] = [height_of(i), height_of(i) + CEILING * STEP].map(|y| unit(y / STEP));
        rooms.extend(floor.layout.rooms.iter().enumerate().map(|(k, room)| {
            let Rect { x0, y0, x1, y1 } = room.rect;
            let min = [unit(x0 + plan.half), low, unit(y0 + plan.half)];
            let max = [unit(x1 - plan.half), high, unit(y1 - plan.half)];
            TowerRoom { name: room_name(i, k), bounds: Aabb { min, max } }
        }));
    }
    Ok(rooms)
}

/// Height of a floor in mesh steps.
fn height_of(floor: usize) -> i32 {
    i32::try_from(floor).expect("floors are few") * STOREY * STEP
}

fn room_name(floor: usize, room: usize) -> String {
    format!("floor{floor}/room_{room:02}")
}

/// A floor, with the random numbers of its furniture.
#[derive(Debug)]
struct Floor {
    layout: Layout,
    rng: Rng,
}

/// A tower before it is made of triangles.
#[derive(Debug)]
struct TowerPlan {
    floors: Vec<Floor>,
    /// The holes in the slabs for stairs, the same on every floor, ascending in z.
    holes: Vec<Rect>,
    half: i32,
    windows: bool,
    /// Sides of round parts; `None` for a tower without furniture.
    sides: Option<usize>,
}

impl TowerPlan {
    fn new(options: &TowerOptions) -> Result<Self, GenerateError> {
        let n_floors = check_range("floors", options.floors, 1, 256)?;
        let rooms_x = check_range("rooms_x", options.rooms_x, 1, 128)?;
        let rooms_y = check_range("rooms_y", options.rooms_y, 1, 128)?;
        check_range("floors * rooms_x * rooms_y", n_floors * rooms_x * rooms_y, 1, MAX_PLACES)?;
        let level = check_range("furniture", options.furniture, 0, 3)?;
        let half = half_thickness(options.wall_thickness)?;
        let mut rng = Rng::new(options.seed, 5);
        let mut shared = Layout::new(Rng::new(rng.next(), 0), rooms_x, rooms_y, BLOCK);
        shared.add_core();
        let mut floor = || {
            let mut layout = shared.with_rng(Rng::new(rng.next(), 0));
            layout.build();
            Floor { layout, rng: Rng::new(rng.next(), 0) }
        };
        let floors: Vec<Floor> = (0..n_floors).map(|_| floor()).collect();
        let layout = &floors[0].layout;
        let holes = layout.rooms.iter().filter(|r| layout.is_stairwell(r)).map(stairs::hole).collect();
        let sides = [None, Some(4), Some(8), Some(16)][level as usize];
        Ok(Self { floors, holes, half, windows: options.windows, sides })
    }

    /// The slab below a floor, or the roof.
    fn slab(&self, holes: bool) -> Mesh {
        let (Rect { x0, y0, x1, y1 }, half) = (self.floors[0].layout.outer, self.half);
        let outer = Rect { x0: x0 - half, y0: y0 - half, x1: x1 + half, y1: y1 + half };
        let mut mesh = Mesh::new(false);
        mesh.plate(outer, if holes { &self.holes } else { &[] }, [-SLAB * STEP, 0]);
        mesh
    }

    fn build_floor(&self, i: usize, floor: &Floor, objects: &mut Vec<SceneObject>) {
        let (layout, height) = (&floor.layout, height_of(i));
        let mut add = |name: String, mesh: Mesh| objects.push(mesh.object(format!("floor{i}/{name}"), height));
        add("slab".to_owned(), self.slab(i > 0));
        let parts = wall_parts(layout, self.half, self.windows);
        for kind in ["wall", "lintel", "sill"] {
            for (k, part) in parts.iter().filter(|p| p.kind == kind).enumerate() {
                add(format!("{kind}_{k}"), wall_mesh(part, k % 2 == 1));
            }
        }
        for (k, &Rect { x0, y0, x1, y1 }) in layout.pillars.iter().enumerate() {
            let mut mesh = Mesh::new(k % 2 == 1);
            mesh.cuboid([x0 * STEP, 0, y0 * STEP], [x1 * STEP, CEILING * STEP, y1 * STEP]);
            add(format!("pillar_{k}"), mesh);
        }
        if i + 1 < self.floors.len() {
            for (k, well) in layout.rooms.iter().filter(|r| layout.is_stairwell(r)).enumerate() {
                add(format!("stairs_{k}"), stairs::stairs(well));
            }
        }
        let Some(sides) = self.sides else { return };
        let mut rng = floor.rng.clone();
        for (k, room) in layout.rooms.iter().enumerate() {
            let own = Rng::new(rng.next(), 0);
            if !layout.is_stairwell(room) {
                for (name, mesh) in room::furnish(layout, k, self.half, sides, own) {
                    objects.push(mesh.object(format!("{}/{name}", room_name(i, k)), height));
                }
            }
        }
    }
}

/// A box, or a pair of rectangles if it is flat.
fn wall_mesh(part: &WallPart, flip: bool) -> Mesh {
    let Rect { x0, y0, x1, y1 } = part.rect;
    let ([x0, z0, x1, z1], heights) = ([x0, y0, x1, y1].map(|t| t * STEP), part.heights.map(|t| t * STEP));
    let mut mesh = Mesh::new(flip);
    if x0 == x1 || z0 == z1 {
        mesh.sheet([x0, z0], [x1, z1], heights);
    } else {
        mesh.cuboid([x0, heights[0], z0], [x1, heights[1], z1]);
    }
    mesh
}
