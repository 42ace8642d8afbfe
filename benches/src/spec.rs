//! Scenes as they are named on a command line: a file, or `tower:16`.

use sightlines::cells::Scene;
use sightlines::formats::scene::read_scene;
use sightlines::scenes::{TowerOptions, tower};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// A scene that can be loaded by its name, by another process too.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneSpec {
    /// A glTF or OBJ file.
    File(PathBuf),
    /// `tower:FLOORS`, or `tower:FLOORS:ROOMS_X:ROOMS_Y:FURNITURE`; the rest is as by default.
    Tower(TowerOptions),
}

/// Why a scene cannot be named or loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpecError {
    /// A tower with something else than one or four numbers.
    #[error("'{0}': a tower is tower:FLOORS or tower:FLOORS:ROOMS_X:ROOMS_Y:FURNITURE")]
    Tower(String),
    /// A file that cannot be read.
    #[error(transparent)]
    Read(#[from] sightlines::formats::ReadError),
    /// A tower that cannot be generated.
    #[error("{spec}: {source}")]
    Generate {
        /// Its name.
        spec: String,
        /// What is wrong with its options.
        source: sightlines::scenes::GenerateError,
    },
}

impl FromStr for SceneSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let Some(numbers) = text.strip_prefix("tower:") else { return Ok(Self::File(text.into())) };
        let wrong = |_| SpecError::Tower(text.to_owned());
        let numbers: Vec<u32> = numbers.split(':').map(str::parse).collect::<Result<_, _>>().map_err(wrong)?;
        let standard = TowerOptions::default();
        match numbers[..] {
            [floors] => Ok(Self::Tower(TowerOptions { floors, ..standard })),
            [floors, rooms_x, rooms_y, furniture] => {
                Ok(Self::Tower(TowerOptions { floors, rooms_x, rooms_y, furniture, ..standard }))
            }
            _ => Err(SpecError::Tower(text.to_owned())),
        }
    }
}

impl fmt::Display for SceneSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Tower(t) => write!(f, "tower:{}:{}:{}:{}", t.floors, t.rooms_x, t.rooms_y, t.furniture),
        }
    }
}

impl SceneSpec {
    /// A short name for a table: the stem of the file, or the tower.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            Self::Tower(_) => self.to_string(),
        }
    }

    /// Reads or generates the scene.
    ///
    /// # Errors
    /// [`SpecError`] with the file or the tower's name.
    pub fn load(&self) -> Result<Scene, SpecError> {
        match self {
            Self::File(path) => Ok(read_scene(path)?.scene),
            Self::Tower(options) => {
                tower(*options).map_err(|source| SpecError::Generate { spec: self.to_string(), source })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_named_and_found_again() {
        let small: SceneSpec = "tower:1:2:1:1".parse().unwrap();
        assert_eq!(small.to_string().parse::<SceneSpec>().unwrap(), small);
        assert!(small.load().unwrap().n_triangles() > 100);
        assert_eq!("tower:3".parse::<SceneSpec>().unwrap().name(), "tower:3:6:4:2");
        let file: SceneSpec = "a/b.glb".parse().unwrap();
        assert_eq!((file.name(), file.load().is_err()), ("b".to_owned(), true));
        for bad in ["tower:", "tower:x", "tower:1:2", "tower:1:2:3:4:5", "tower:-1"] {
            assert!(matches!(bad.parse::<SceneSpec>(), Err(SpecError::Tower(_))), "{bad}");
        }
        let error = "tower:0".parse::<SceneSpec>().unwrap().load().unwrap_err();
        assert!(error.to_string().starts_with("tower:0:6:4:2: "), "{error}");
    }
}
