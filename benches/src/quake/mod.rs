//! Maps of convex portals: what is measured of them, each method in a process of its own.

pub mod chart;
pub mod job;
pub mod rows;

use sightlines::cells::{CellGraph, Convex};
use sightlines::formats::quake::{graph_of_prt, read_prt};
use sightlines::pvs::BitMatrix;
use sightlines::scenes::world::{QuakeLikeOptions, World, quake_like};
use sightlines_testkit::convex::seen_by_rays;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Lines that show what is seen in a generated world.
const N_LINES: usize = 20_000;

/// A map that can be loaded by its name, by another process too.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MapSpec {
    /// A portal file; what is known to be seen lies beside it, as `.seen.bin`.
    File(PathBuf),
    /// `world:SEED:ROOMS_X:ROOMS_Y:FLOORS`: a generated level.
    World(QuakeLikeOptions),
}

/// Why a map cannot be named or loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A world with something else than four numbers.
    #[error("'{0}': a world is world:SEED:ROOMS_X:ROOMS_Y:FLOORS")]
    World(String),
    /// A portal file that cannot be read.
    #[error("{0}")]
    Read(String),
    /// What is known to be seen does not belong to the map.
    #[error("{}: not a square of {n_clusters} clusters", path.display())]
    Witness {
        /// Of the table.
        path: PathBuf,
        /// Of the map.
        n_clusters: usize,
    },
    /// A world that cannot be generated.
    #[error("{spec}: {source}")]
    Generate {
        /// Its name.
        spec: String,
        /// What is wrong with its options.
        source: sightlines::scenes::GenerateError,
    },
}

impl FromStr for MapSpec {
    type Err = MapError;

    fn from_str(text: &str) -> Result<Self, MapError> {
        let Some(numbers) = text.strip_prefix("world:") else { return Ok(Self::File(text.into())) };
        let wrong = || MapError::World(text.to_owned());
        let numbers: Vec<u32> = numbers.split(':').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
        let &[seed, rooms_x, rooms_y, floors] = &numbers[..] else { return Err(wrong()) };
        Ok(Self::World(QuakeLikeOptions { seed: u64::from(seed), rooms_x, rooms_y, floors }))
    }
}

impl fmt::Display for MapSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::World(QuakeLikeOptions { seed, rooms_x, rooms_y, floors }) => {
                write!(f, "world:{seed}:{rooms_x}:{rooms_y}:{floors}")
            }
        }
    }
}

impl MapSpec {
    /// What it is called in tables.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            Self::World(_) => self.to_string(),
        }
    }

    /// Its clusters and portals.
    ///
    /// # Errors
    /// Files that cannot be read, and worlds that cannot be generated.
    pub fn graph(&self) -> Result<CellGraph<Convex>, MapError> {
        match self {
            Self::File(path) => read_prt(path).map(|prt| graph_of_prt(&prt)).map_err(|e| MapError::Read(e.to_string())),
            Self::World(options) => self.world(*options).map(|world| world.graph),
        }
    }

    fn world(&self, options: QuakeLikeOptions) -> Result<World, MapError> {
        quake_like(options).map_err(|source| MapError::Generate { spec: self.to_string(), source })
    }

    /// Pairs that are known to see each other, by means that know nothing of any method here; `None` for files without
    /// such a table.
    ///
    /// # Errors
    /// Tables that cannot be read or belong to another map, and worlds that cannot be generated.
    pub fn witness(&self, n_clusters: usize) -> Result<Option<BitMatrix>, MapError> {
        match self {
            Self::File(path) => read_witness(&path.with_extension("seen.bin"), n_clusters),
            Self::World(options) => {
                let mut seen = BitMatrix::identity(n_clusters);
                for [a, b] in seen_by_rays(&self.world(*options)?, N_LINES, 1).pairs {
                    seen.set(a as usize, b as usize, true);
                    seen.set(b as usize, a as usize, true);
                }
                Ok(Some(seen))
            }
        }
    }
}

/// A table: the number of clusters, then a row of words for each, all as `u64` with the least byte first.
fn read_witness(path: &Path, n: usize) -> Result<Option<BitMatrix>, MapError> {
    if !path.is_file() {
        return Ok(None);
    }
    let bytes = std::fs::read(path).map_err(|e| MapError::Read(format!("{}: {e}", path.display())))?;
    let words = job::words_of(&bytes);
    let table = words.split_first().filter(|(head, _)| **head == n as u64).and_then(|(_, words)| matrix_of(n, words));
    table.map(Some).ok_or_else(|| MapError::Witness { path: path.to_owned(), n_clusters: n })
}

/// The square matrix with these words, row by row; `None` if they are too many, too few, or have bits behind a row.
pub(crate) fn matrix_of(n: usize, words: &[u64]) -> Option<BitMatrix> {
    let mut matrix = BitMatrix::new(n, n);
    let stride = n.div_ceil(64);
    let spare = if n.is_multiple_of(64) { 0 } else { u64::MAX << (n % 64) };
    if words.len() != n * stride || words.chunks_exact(stride.max(1)).any(|row| row[stride - 1] & spare != 0) {
        return None;
    }
    words.chunks_exact(stride.max(1)).zip(0..).for_each(|(words, row)| matrix.row_mut(row).copy_from_slice(words));
    Some(matrix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_named() {
        let spec: MapSpec = "world:7:2:3:1".parse().unwrap();
        assert_eq!(spec.to_string(), "world:7:2:3:1");
        assert_eq!(spec, MapSpec::World(QuakeLikeOptions { seed: 7, rooms_x: 2, rooms_y: 3, floors: 1 }));
        let file: MapSpec = "some/where/e1m1.prt".parse().unwrap();
        assert_eq!((file.name().as_str(), file.to_string().as_str()), ("e1m1", "some/where/e1m1.prt"));
        for wrong in ["world:1", "world:1:2:3:x", "world:1:2:3:4:5"] {
            assert!(wrong.parse::<MapSpec>().unwrap_err().to_string().starts_with(&format!("'{wrong}'")));
        }
        assert!("world:1:99:1:1".parse::<MapSpec>().unwrap().graph().unwrap_err().to_string().contains("rooms_x"));
        assert!(file.graph().unwrap_err().to_string().contains("e1m1.prt"));
    }

    #[test]
    fn what_lines_show_is_a_part_of_everything() {
        let spec: MapSpec = "world:1:1:1:1".parse().unwrap();
        let n = spec.graph().unwrap().n_cells();
        let witness = spec.witness(n).unwrap().unwrap();
        assert!(witness.is_symmetric() && witness.count_ones() > n as u64);
    }

    #[test]
    fn matrices_fit_or_are_none() {
        assert_eq!(matrix_of(2, &[3, 2]).unwrap().count_ones(), 3);
        assert!(matrix_of(2, &[3]).is_none() && matrix_of(2, &[3, 4]).is_none() && matrix_of(0, &[]).is_some());
    }
}
