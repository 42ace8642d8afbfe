//! Scenes with boxes where an eye can be: generated ones, and real ones with the cells of a file.

use sightlines::cells::Scene;
use sightlines::formats::ViewCell;
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::formats::view_cells::read_view_cells;
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::Mesh;
use sightlines::scenes::{CityOptions, GenerateError, TowerOptions, city, city_crossings, tower, tower_rooms};
use std::error::Error;
use std::path::{Path, PathBuf};

/// A scene, and boxes where an eye can be.
#[derive(Debug)]
pub struct ViewedScene {
    /// A short name for tables.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// The boxes.
    pub cells: Vec<ViewCell>,
    /// The folder of a real scene.
    pub folder: Option<PathBuf>,
}

impl ViewedScene {
    fn new(name: String, scene: Scene, boxes: impl IntoIterator<Item = Aabb<3>>) -> Self {
        let cells = (0u32..).zip(boxes).map(|(i, bounds)| ViewCell { id: i.to_string(), bounds }).collect();
        Self { name, scene, cells, folder: None }
    }

    /// A generated city with the crossings of its streets.
    ///
    /// # Errors
    /// [`GenerateError`] for options out of range.
    pub fn city(options: CityOptions) -> Result<Self, GenerateError> {
        Ok(Self::new("city".to_owned(), city(options)?, city_crossings(options)?))
    }

    /// A generated tower with its rooms.
    ///
    /// # Errors
    /// [`GenerateError`] for options out of range.
    pub fn tower(options: TowerOptions) -> Result<Self, GenerateError> {
        let rooms = tower_rooms(options)?.into_iter().map(|room| room.bounds);
        Ok(Self::new("tower".to_owned(), tower(options)?, rooms))
    }

    /// A real scene of the folder that `SIGHTLINES_DATA` names, given as `SCENE:CELLS`, for engines that do this with backs. `None`, and a message, if the variable is not
    /// set.
    ///
    /// # Errors
    /// A name without a colon, and files that cannot be read.
    pub fn real(named: &str, backs: BackFaces) -> Result<Option<Self>, Box<dyn Error>> {
        let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
            eprintln!("!! SIGHTLINES_DATA is not set: {named} is left out");
            return Ok(None);
        };
        let (name, cells) = named.split_once(':').ok_or("a real scene and its cells, with a colon between")?;
        let folder = Path::new(&data).join("scenes").join(name);
        let scene = read_scene_with(folder.join(format!("{name}.glb")), &SceneReadOptions::with_backs(backs))?.scene;
        let cells = read_view_cells(folder.join(format!("{cells}.json")))?.cells;
        Ok(Some(Self { name: name.to_owned(), scene, cells, folder: Some(folder) }))
    }

    /// The boxes alone.
    pub fn boxes(&self) -> Vec<Aabb<3>> {
        self.cells.iter().map(|cell| cell.bounds).collect()
    }
}

/// The triangles of all objects that hide, with the sides that they hide from.
pub fn welded(scene: &Scene) -> Mesh {
    let [both_sides, fronts]: [Vec<[Point3; 3]>; 2] =
        [scene.occluding_triangles().collect(), scene.front_occluding_triangles().collect()];
    Mesh::weld_with_fronts(&both_sides, &fronts)
}

/// At most `n` of all, evenly chosen, the first among them.
pub fn evenly<T>(all: Vec<T>, n: usize) -> Vec<T> {
    let step = all.len().div_ceil(n.max(1)).max(1);
    all.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_even() {
        assert_eq!(evenly(vec![0, 1, 2, 3, 4], 2), [0, 3]);
        assert_eq!((evenly(vec![0, 1], 5), evenly(vec![0, 1], 0)), (vec![0, 1], vec![0]));
    }

    #[test]
    fn generated_scenes_have_boxes_inside() {
        let city = ViewedScene::city(CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() }).unwrap();
        let tower = ViewedScene::tower(TowerOptions { floors: 1, ..TowerOptions::default() }).unwrap();
        for viewed in [city, tower] {
            let bounds = viewed.scene.bounds();
            assert!(!viewed.cells.is_empty(), "{}", viewed.name);
            assert!(viewed.boxes().iter().any(|b| bounds.contains(b.min) || bounds.contains(b.max)), "{}", viewed.name);
        }
    }
}
