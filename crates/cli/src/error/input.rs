//! What can be wrong with a file that a command reads.

use sightlines::bake::quake::PortalsError;
use sightlines::cells::PlanError;
use sightlines::formats::ReadError;
use sightlines::formats::quake::VisibilityError;
use sightlines::formats::quake::prt::line_of_portal;
use sightlines::packed::PackedError;
use sightlines::pvs::DecodeError;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    /// A WAD, a plan or a scene cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Open { path: PathBuf, source: io::Error },
    /// A file is not a sound table.
    #[error("{}: {source}", path.display())]
    Table { path: PathBuf, source: DecodeError },
    /// A file is not a sound packed table.
    #[error("{}: {source}", path.display())]
    Packed { path: PathBuf, source: PackedError },
    /// A packed table where a plain one is needed.
    #[error("{}: the table is packed; `sightlines unpack` makes it a plain one, which this command takes", path.display())]
    IsPacked { path: PathBuf },
    /// A file is of no kind that the command takes.
    #[error("{}: neither {expected}", path.display())]
    Kind { path: PathBuf, expected: &'static str },
    /// A WAD without maps.
    #[error("{}: there are no maps in the file", .0.display())]
    NoMaps(PathBuf),
    /// A WAD with several maps, and none was named.
    #[error("{}: there are {} maps in the file; choose one with --map: {}", path.display(), names.len(), list(names))]
    WhichMap { path: PathBuf, names: Vec<String> },
    /// A map that is not in the WAD.
    #[error("{}: there is no map {name} in the file; there are {}", path.display(), list(names))]
    NoSuchMap { path: PathBuf, name: String, names: Vec<String> },
    /// `--map` for something without maps.
    #[error("{}: --map is for WADs, and this is none", .0.display())]
    MapOfPlan(PathBuf),
    /// An option that means nothing for what the file holds.
    #[error("{}: {option} is for {meant}, and this is {found}", path.display())]
    Option { path: PathBuf, option: String, meant: &'static str, found: &'static str },
    /// The lines of a map do not make a plan.
    #[error("{}: {}{source}", path.display(), of_map(map.as_ref()))]
    Plan { path: PathBuf, map: Option<String>, source: PlanError },
    /// A file from which a table is built, where the table is needed.
    #[error("{}: is {found}, not a table: build one first: sightlines build {}{} -o {}", path.display(), path.display(),
            if *found == "a WAD" { " --map NAME" } else { "" }, path.with_extension("pvs").display())]
    NotTable { path: PathBuf, found: &'static str },
    /// A table that does not store where its cells are.
    #[error("{}: the table is of a portal file, which does not say where its cells are: {what}", path.display())]
    NoPlaces { path: PathBuf, what: &'static str },
    /// A scene whose triangles were moved, where occluders are needed.
    #[error("{}: the scene was simplified and its triangles were moved, so that it may hide what can be seen: use the original \
             that it was made from", .0.display())]
    NoOccluder(PathBuf),
    /// A Quake map without a portal file beside it, of which no portals can be made either.
    #[error("{}: there is no {} beside it, and no portals can be made from the map: {source}", path.display(), name_with(path, "prt"))]
    MadePortals { path: PathBuf, source: Box<PortalsError> },
    /// A portal file of another map.
    #[error("{}: does not go with {}: {source}", prt.display(), bsp.display())]
    OtherMap { prt: PathBuf, bsp: PathBuf, source: Box<VisibilityError> },
    /// A portal file with a portal that the map contradicts.
    #[error("{}: line {line}: {source}", prt.display())]
    InsideOut { prt: PathBuf, line: usize, source: Box<VisibilityError> },
}

impl InputError {
    /// Portals that do not go with a map.
    pub(crate) fn of_portals(prt: &Path, bsp: &Path, source: Box<VisibilityError>) -> Self {
        let line = match *source {
            VisibilityError::InsideOut { portal, .. } => {
                std::fs::read(prt).ok().and_then(|text| line_of_portal(&text, portal))
            }
            _ => None,
        };
        match line {
            Some(line) => Self::InsideOut { prt: prt.to_owned(), line, source },
            None => Self::OtherMap { prt: prt.to_owned(), bsp: bsp.to_owned(), source },
        }
    }
}

/// Names the map of a file, if it has one.
pub(crate) fn of_map(map: Option<&String>) -> String {
    map.map_or(String::new(), |name| format!("map {name}: "))
}

/// The name of a file, without its folder, with another ending.
fn name_with(path: &Path, ending: &str) -> String {
    path.with_extension(ending).file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn list(names: &[String]) -> String {
    const MOST: usize = 40;
    let shown = names.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}
