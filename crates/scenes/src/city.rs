//! Cities: boxes along straight streets, of many triangles.
//!
//! The setting of from-region visibility: nearly all of a city is hidden from a box in a street, mostly by the next few
//! houses. Every wall is a grid of bays and storeys, so there are many triangles in few planes.

use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Aabb;
use std::collections::BTreeMap;

/// Options of [`city`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CityOptions {
    /// Determines every random choice.
    pub seed: u64,
    /// Blocks along x, from 1 to 64.
    pub blocks_x: u32,
    /// Blocks along z, from 1 to 64.
    pub blocks_z: u32,
    /// Cuts of a bay of 4 metres and of a storey along each side, from 1 to 8.
    pub detail: u32,
}

impl Default for CityOptions {
    /// 6 by 6 blocks of 4 houses, about 60,000 triangles.
    fn default() -> Self {
        Self { seed: 1, blocks_x: 6, blocks_z: 6, detail: 1 }
    }
}

/// Side of a bay and height of a storey, in metres.
const BAY: i32 = 4;
/// Bays along a side of a lot: a house stands on it, or on a part of it.
const LOT: i32 = 5;
/// Bays from one block to the next: two lots and a street of 12 m.
const PITCH: i32 = 2 * LOT + 3;
/// Height of eyes, in metres, lowest and highest: from pedestrians to passengers on a bus.
const EYES: [f64; 2] = [1.25, 2.25];

/// A city in metres, y up: the first block has a corner at x = z = 0, the ground is at height 0.
///
/// Objects are closed boxes that face outwards and do not overlap: `ground`, and houses such as
/// `block_2_0/house_3`. Every block has four lots with a house each, which may stand back from the street; houses
/// that do not, touch. Coordinates are multiples of 1/2 if `detail` is 1, 2, 4 or 8, else they are rounded.
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn city(options: CityOptions) -> Result<Scene, GenerateError> {
    let [n_x, n_z, detail] = checked(&options)?;
    let mut rng = Rng::new(options.seed, 12);
    let wide = |n: i32| n * PITCH + 3;
    // The ground is not cut into bays: no eye sees it from below.
    let mut objects = vec![cuboid("ground".to_owned(), [-3, -1, -3], [wide(n_x), 1, wide(n_z)], [1; 3])];
    for (bz, bx) in (0..n_z).flat_map(|z| (0..n_x).map(move |x| (z, x))) {
        for lot in 0..4 {
            let (dx, dz) = (lot % 2, lot / 2);
            // Set back from the street by a bay, or not; towards the middle of the block.
            let back = |rng: &mut Rng| i32::from(rng.one_in(4));
            let (off_x, off_z) = (back(&mut rng), back(&mut rng));
            let storeys = rng.between(2, 6) + if rng.one_in(6) { rng.between(4, 10) } else { 0 };
            let min = [bx * PITCH + dx * LOT + (1 - dx) * off_x, 0, bz * PITCH + dz * LOT + (1 - dz) * off_z];
            let size = [LOT - off_x, storeys, LOT - off_z];
            let name = format!("block_{bx}_{bz}/house_{lot}");
            objects.push(cuboid(name, min, size, size.map(|n| n * detail)));
        }
    }
    Ok(Scene::new(objects).expect("corners of bays make a scene"))
}

/// The crossings of streets in the city that [`city`] makes from the same options: a cube of one metre in the middle of
/// each, at eye height, none on the outer streets; along x first.
///
/// # Errors
/// As [`city`].
pub fn city_crossings(options: CityOptions) -> Result<Vec<Aabb<3>>, GenerateError> {
    let [n_x, n_z, _] = checked(&options)?;
    // The middle of the street before a block.
    let street = |i: i32| f64::from((2 * i * PITCH - 3) * BAY) / 2.0;
    let at = |x: i32, z: i32| Aabb {
        min: [street(x) - 0.5, EYES[0], street(z) - 0.5],
        max: [street(x) + 0.5, EYES[1], street(z) + 0.5],
    };
    Ok((1..n_z).flat_map(|z| (1..n_x).map(move |x| at(x, z))).collect())
}

/// A part of a city.
#[derive(Debug, Clone, PartialEq)]
pub struct CityTile {
    /// `0_0`, `1_0` and so on: its place along x and along z.
    pub name: String,
    /// Its houses, and the ground below them.
    pub scene: Scene,
    /// Boxes of a bay where eyes can be, in its streets: block by block.
    pub cells: Vec<Aabb<3>>,
}

/// The city that [`city`] makes from the same options, in tiles of so many blocks along each side, along x first. Its ground is cut along the tiles, and has
/// no margin.
///
/// # Errors
/// As [`city`]; [`GenerateError::OutOfRange`] for no blocks in a tile.
pub fn city_tiles(options: CityOptions, per_tile: u32) -> Result<Vec<CityTile>, GenerateError> {
    let [n_x, n_z, _] = checked(&options)?;
    let per_tile = i32::try_from(check_range("per_tile", per_tile, 1, 64)?).expect("a small number");
    let whole = city(options)?;
    let mut houses = whole.objects()[1..].iter().cloned();
    let mut of_blocks: BTreeMap<[i32; 2], Vec<SceneObject>> = BTreeMap::new();
    for (z, x) in (0..n_z).flat_map(|z| (0..n_x).map(move |x| (z, x))) {
        of_blocks.insert([z, x], houses.by_ref().take(4).collect());
    }
    let mut tile = |z: i32, x: i32| {
        let [x0, z0] = [x, z].map(|k| k * per_tile);
        let [x1, z1] = [(x0 + per_tile).min(n_x), (z0 + per_tile).min(n_z)];
        let size = [(x1 - x0) * PITCH, 1, (z1 - z0) * PITCH];
        let mut objects = vec![cuboid("ground".to_owned(), [x0 * PITCH, -1, z0 * PITCH], size, [1; 3])];
        let mut cells = Vec::new();
        for block in (z0..z1).flat_map(|z| (x0..x1).map(move |x| [z, x])) {
            objects.append(of_blocks.get_mut(&block).expect("a block of the city"));
            // The street beyond the second lot, on both sides.
            for (i, j) in (0..PITCH).flat_map(|j| (0..PITCH).map(move |i| (i, j))) {
                if i >= 2 * LOT || j >= 2 * LOT {
                    let at = |k: i32, block: i32| f64::from((block * PITCH + k) * BAY);
                    let [x, z] = [at(i, block[1]), at(j, block[0])];
                    let side = f64::from(BAY);
                    cells.push(Aabb { min: [x, EYES[0], z], max: [x + side, EYES[1], z + side] });
                }
            }
        }
        let scene = Scene::new(objects).expect("corners of bays make a scene");
        CityTile { name: format!("{x}_{z}"), scene, cells }
    };
    let n = |blocks: i32| (blocks + per_tile - 1) / per_tile;
    let mut tiles = Vec::new();
    for (z, x) in (0..n(n_z)).flat_map(|z| (0..n(n_x)).map(move |x| (z, x))) {
        tiles.push(tile(z, x));
    }
    Ok(tiles)
}

fn checked(options: &CityOptions) -> Result<[i32; 3], GenerateError> {
    let x = check_range("blocks_x", options.blocks_x, 1, 64)?;
    let z = check_range("blocks_z", options.blocks_z, 1, 64)?;
    let detail = check_range("detail", options.detail, 1, 8)?;
    Ok([x, z, detail].map(|n| i32::try_from(n).expect("a small number")))
}

/// A closed box whose sides are grids of `n` quadrilaterals along each axis; `min` and `size` in bays.
fn cuboid(name: String, min: [i32; 3], size: [i32; 3], n: [i32; 3]) -> SceneObject {
    let mut mesh = Grid { min, size, n, ids: BTreeMap::new(), vertices: Vec::new() };
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (j, i, upper) in (0..n[v]).flat_map(|j| (0..n[u]).flat_map(move |i| [(j, i, false), (j, i, true)])) {
            let mut at = |di: i32, dj: i32| {
                let mut place = [0; 3];
                (place[axis], place[u], place[v]) = (if upper { n[axis] } else { 0 }, i + di, j + dj);
                mesh.id(place)
            };
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            // Counter-clockwise from outside: u, v, axis are right-handed.
            triangles.extend(if upper { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    SceneObject { name, vertices: mesh.vertices, triangles }
}

/// The requested corners of a box's grid.
struct Grid {
    min: [i32; 3],
    size: [i32; 3],
    n: [i32; 3],
    ids: BTreeMap<[i32; 3], u32>,
    vertices: Vec<[f64; 3]>,
}

impl Grid {
    fn id(&mut self, place: [i32; 3]) -> u32 {
        let Self { min, size, n, vertices, .. } = self;
        *self.ids.entry(place).or_insert_with(|| {
            let at = |k: usize| f64::from(BAY * (min[k] * n[k] + size[k] * place[k])) / f64::from(n[k]);
            vertices.push([at(0), at(1), at(2)]);
            u32::try_from(vertices.len() - 1).expect("a house has few corners")
        })
    }
}

#[cfg(test)]
mod tests;
