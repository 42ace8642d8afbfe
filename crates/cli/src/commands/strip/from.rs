//! Where eyes are, as arguments.

use crate::error::{ErrorAbout, Result, bail};
use crate::eye;
use crate::input;
use crate::region::Region;
use crate::simplification;
use sightlines::cells::Scene;
use sightlines::formats::SceneFile;
use sightlines::formats::view_cells::read_view_cells;
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::Volume;
use sightlines::pvs::Table;
use sightlines::strip::Eyes;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A place of eyes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum From {
    /// Everywhere outside of the scene.
    Outside,
    /// A box.
    Box(Region),
    /// The boxes of a file.
    Cells(PathBuf),
    /// The cells of a table.
    Table(PathBuf),
    /// Wherever a way leads from a point, or from the view volumes of the file.
    Walk(Option<Point3>),
}

impl FromStr for From {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "outside" {
            return Ok(Self::Outside);
        }
        if let Some(region) = text.strip_prefix("box=") {
            return Ok(Self::Box(region.parse()?));
        }
        if text == "walk" {
            return Ok(Self::Walk(None));
        }
        if let Some(point) = text.strip_prefix("walk=") {
            return Ok(Self::Walk(Some(eye::point(point)?)));
        }
        if let Some(path) = text.strip_prefix("cells=") {
            return Ok(Self::Cells(path.into()));
        }
        if Path::new(text).extension().is_some_and(|end| end.eq_ignore_ascii_case("pvs")) {
            return Ok(Self::Table(text.into()));
        }
        bail!(
            "neither outside nor box=X0,Y0,Z0,X1,Y1,Z1 nor cells=FILE.json nor walk nor walk=X,Y,Z nor a table FILE.pvs"
        )
    }
}

impl fmt::Display for From {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside => f.write_str("outside"),
            Self::Box(Region(b)) => {
                let numbers: Vec<String> = b.min.iter().chain(&b.max).map(f64::to_string).collect();
                write!(f, "box={}", numbers.join(","))
            }
            Self::Cells(path) => write!(f, "cells={}", path.display()),
            Self::Table(path) => write!(f, "{}", path.display()),
            Self::Walk(None) => f.write_str("walk"),
            Self::Walk(Some([x, y, z])) => write!(f, "walk={x},{y},{z}"),
        }
    }
}

/// The table among the places, if there is one; then it is the only one.
pub(super) fn table(from: &[From]) -> Result<Option<(&Path, Table)>> {
    let one = |from: &From| matches!(from, From::Table(_) | From::Outside);
    if from.len() > 1
        && let Some(alone) = from.iter().find(|from| one(from))
    {
        bail!("--from {alone}: has to be the only place of eyes; boxes and files of cells can be several");
    }
    let walks = |from: &&From| matches!(from, From::Walk(_));
    if let Some(walk) = from.iter().find(walks)
        && !from.iter().all(|from| walks(&from))
    {
        bail!("--from {walk}: eyes either walk from all places or stay in them; give boxes without walk");
    }
    match from {
        [From::Table(path)] => Ok(Some((path, input::table(path)?))),
        _ => Ok(None),
    }
}

/// The eyes, and the scene along the axes of the table if that has a frame.
pub(super) fn eyes(
    from: &[From],
    table: Option<&(&Path, Table)>,
    path: &Path,
    file: &SceneFile,
) -> Result<(Eyes, Option<Scene>)> {
    let scene = &file.scene;
    if let Some((table_path, table)) = table {
        return Ok(match simplification::along([path, table_path], table, scene)? {
            Some((table, along)) => (Eyes::in_cells_of(&table, &along).in_file(table_path)?, Some(along)),
            None => (Eyes::in_cells_of(table, scene).in_file(table_path)?, None),
        });
    }
    if from.contains(&From::Outside) {
        return Ok((Eyes::outside(), None));
    }
    let mut volumes = Vec::new();
    for place in from {
        match place {
            From::Box(Region(b)) => volumes.push(Volume::new(*b).about("--from")?),
            From::Cells(path) => {
                let cells = read_view_cells(path)?;
                if cells.axes.is_some() {
                    bail!(
                        "{}: the cells have axes of their own; give boxes along the axes of the scene",
                        path.display()
                    );
                }
                let boxes = cells.cells.iter().map(|cell| Volume::new(cell.bounds));
                volumes.extend(boxes.collect::<Result<Vec<_>, _>>().in_file(path)?);
            }
            From::Walk(Some(point)) => volumes.push(Volume::new(Aabb { min: *point, max: *point }).about("--from")?),
            From::Walk(None) => {
                if file.info.view_volumes.is_empty() {
                    bail!("{}: --from walk: the file has no view volumes; give points as walk=X,Y,Z", path.display());
                }
                let boxes = file.info.view_volumes.iter().map(|b| Volume::new(*b));
                volumes.extend(boxes.collect::<Result<Vec<_>, _>>().in_file(path)?);
            }
            From::Outside | From::Table(_) => {}
        }
    }
    let is_walk = matches!(from, [From::Walk(_), ..]);
    let eyes = if is_walk { Eyes::joined_to(volumes) } else { Eyes::in_boxes(volumes) };
    Ok((eyes.about("--from")?, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_parsed_and_displayed() {
        for text in ["outside", "box=0,1,2,3,4,5.5", "cells=a.json", "level.pvs", "walk", "walk=1,-2.5,3"] {
            assert_eq!(text.parse::<From>().unwrap().to_string(), text);
        }
        let error = |text: &str| text.parse::<From>().unwrap_err().to_string();
        assert!(error("inside").starts_with("neither outside nor box="));
        assert!(error("box=1,2").starts_with("a box is six"));
        let both = ["outside", "box=0,0,0,1,1,1"].map(|text| text.parse().unwrap());
        assert!(table(&both).unwrap_err().to_string().contains("only place of eyes"));
        let both = ["walk=1,2,3", "box=0,0,0,1,1,1"].map(|text| text.parse().unwrap());
        assert!(table(&both).unwrap_err().to_string().contains("stay in them"));
    }
}
