//! One tile of a world: what decides it, and its files.

use super::WorldBakeError;
use super::input::TileInput;
use super::scenes::{Ready, Scenes};
use crate::request::{BakeRequest, Runtime};
use crate::tile::{NearTile, Tile, bake_far, bake_tile};
use sightlines_checkpoint::KeyHasher;
use sightlines_geometry::Aabb;
use sightlines_progress::Kept;
use sightlines_tiles::{TilePart, far_bytes, near_bytes, table_bytes};
use std::path::Path;
use std::sync::Arc;

/// The keys of a tile, and what they are of.
#[derive(Debug)]
pub(super) struct TileKeys {
    pub(super) near: Vec<u32>,
    /// Those farther away that may be seen.
    pub(super) far: Vec<u32>,
    pub(super) key: [u8; 16],
    pub(super) far_key: [u8; 16],
}

/// The keys of all tiles.
///
/// * `near`: for each tile those nearby
/// * `reached`: for each tile those within reach of viewers; `None` for all
pub(super) fn keys(
    inputs: &[TileInput],
    near: Vec<Vec<u32>>,
    reached: Option<Vec<Vec<u32>>>,
    options: &KeyHasher,
) -> Vec<TileKeys> {
    let all = || (0..inputs.len() as u32).collect::<Vec<u32>>();
    let of = |(tile, near): (usize, Vec<u32>)| {
        let mut hasher = options.clone();
        hasher.value("tile", &inputs[tile].key.0);
        for &other in &near {
            hasher.value("near", inputs[other as usize].plan.name.as_bytes());
            hasher.value("near", &inputs[other as usize].key.0);
        }
        let key = hasher.finish().0;
        let mut far = reached.as_ref().map_or_else(all, |reached| reached[tile].clone());
        far.retain(|&other| other as usize != tile && near.binary_search(&other).is_err());
        for &other in &far {
            let Aabb { min, max } = inputs[other as usize].bounds.extent;
            hasher.value("far", inputs[other as usize].plan.name.as_bytes());
            min.into_iter().chain(max).for_each(|x| hasher.value("far", &x.to_le_bytes()));
        }
        TileKeys { near, far, key, far_key: hasher.finish().0 }
    };
    near.into_iter().enumerate().map(of).collect()
}

/// The files of a tile that were made: all, or the last one alone.
pub(super) struct Files(Vec<(TilePart, Vec<u8>)>);

impl Files {
    /// Each with what it is.
    pub(super) fn iter(&self) -> impl Iterator<Item = (TilePart, &[u8])> {
        self.0.iter().map(|(part, bytes)| (*part, &**bytes))
    }

    /// As bytes, for a store: of each file the place in the list of parts and the content.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        for (part, bytes) in &self.0 {
            let place = TilePart::ALL.iter().position(|other| other == part).unwrap_or_default();
            place.write(&mut out);
            bytes.write(&mut out);
        }
        out
    }

    /// `None` if these are no bytes of files.
    pub(super) fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let mut files = Vec::new();
        while !bytes.is_empty() {
            let (place, content) = <(usize, Vec<u8>)>::read(&mut bytes)?;
            files.push((*TilePart::ALL.get(place)?, content));
        }
        Some(Self(files))
    }
}

/// Bakes a tile; only what it sees far away, if that is all that is missing.
pub(super) fn bake(
    tile: usize,
    (inputs, keys): (&[TileInput], &TileKeys),
    scenes: &Scenes<'_>,
    (request, runtime): (&BakeRequest, &Runtime<'_>),
    only_far: bool,
) -> Result<Files, WorldBakeError> {
    let input = &inputs[tile];
    let own = scenes.get(tile)?;
    let near: Vec<Arc<Ready>> = keys.near.iter().map(|&k| scenes.get(k as usize)).collect::<Result<_, _>>()?;
    let of_near: Vec<NearTile<'_>> =
        near.iter().map(|near| NearTile { scene: &near.loaded.scene, cells: &near.cells }).collect();
    let of_far: Vec<Aabb<3>> = keys.far.iter().map(|&k| inputs[k as usize].bounds.extent).collect();
    let (scene, file) = (&own.loaded.scene, Some(&own.loaded.info));
    let parts = Tile { scene, file, cells: &own.cells, near: &of_near, far: &of_far };
    let failed = |source| WorldBakeError::scene(&input.scene, source);
    let names = keys.far.iter().map(|&k| inputs[k as usize].plan.name.clone()).collect();
    let write = |error| WorldBakeError::file(Path::new(&format!("tile {:?}", input.plan.name)), error);
    if only_far {
        let rows = bake_far(&parts, request, runtime).map_err(failed)?;
        return Ok(Files(vec![(TilePart::Far, far_bytes(keys.far_key, names, &rows).map_err(write)?)]));
    }
    let baked = bake_tile(&parts, request, runtime).map_err(failed)?;
    let sizes = keys.near.iter().zip(&near).map(|(&k, near)| {
        let n_objects = near.loaded.scene.objects().len();
        (inputs[k as usize].plan.name.clone(), [near.cells.len() as u32, n_objects as u32])
    });
    Ok(Files(vec![
        (TilePart::Table, table_bytes(baked.table, keys.key).map_err(write)?),
        (TilePart::Near, near_bytes(keys.key, sizes, &baked.near).map_err(write)?),
        (TilePart::Far, far_bytes(keys.far_key, names, &baked.far).map_err(write)?),
    ]))
}
