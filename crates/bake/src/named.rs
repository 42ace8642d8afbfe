//! A request as JSON, by the names that the program's options have, with `_` for `-`.

use crate::eye_level::EyeLevelOptions;
use crate::gap::Gap;
use crate::methods::Backend;
use crate::places::PlaceOptions;
use crate::region::CellsFrom;
use crate::request::{BakeRequest, BufferRequest};
use serde_json::Value;
use sightlines_formats::view_cells::parse_view_cells;
use sightlines_geometry::{Aabb, check_coordinate};
use sightlines_multifocal::Split;
use sightlines_pvs::Axis;
use std::ops::RangeBounds;
use std::str::FromStr;

/// The members of a request. All of them may be left out.
#[derive(Debug, Default, serde::Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Named {
    /// Scenes: `"kd-tree"`, `"places"` or `"eye-level"`; or boxes, as a file of cells has them: `{"cells": [{"id": "hall", "min": [0, 0, 0], "max": [4, 2.5, 6]}]}`.
    cells: Option<Value>,
    /// Scenes: a grid of so many boxes along each axis.
    grid: Option<[u32; 3]>,
    /// Scenes: so many boxes, cut where views differ: the cells `"places"`.
    n_cells: Option<u32>,
    /// Scenes: the width of cells that are cut, at most, in scene units.
    cell_size: Option<f64>,
    /// Scenes: from how far to how far above floors eyes are, in scene units: the cells `"eye-level"`.
    eye_height: Option<[f64; 2]>,
    /// Scenes: `"x"`, `"y"` or `"z"`, the axis that points upwards, for the cells `"eye-level"`.
    up: Option<String>,
    /// Scenes: what decides.
    method: Option<String>,
    /// Plans and scenes: how precise coordinates are, in scene units.
    gap: Option<f64>,
    /// Scenes: where viewers can be: the lower corner, and the upper one.
    view_region: Option<[f64; 6]>,
    /// Scenes: objects smaller than this in every direction, in scene units, hide nothing from sightlines.
    detail_below: Option<f64>,
    /// Scenes: fail if there are more cells.
    max_cells: Option<u32>,
    /// Scenes: keep the insides of solids as cells.
    keep_solid: bool,
    /// K-d trees: split only along walls that cover at least this share of a cell, from 0 to 1.
    tau: Option<f64>,
    /// Plans: `"auto"`, `"kd"` or `"triangulation"`.
    subdivide: Option<String>,
    /// Scenes: objects of more triangles than this are split into parts.
    parts: Option<u32>,
    /// Scenes by methods that look from whole cells: how often a cell may be halved.
    split: Option<u32>,
    /// Multifocal: planes on each side of a cell; 0 for none.
    planes: Option<u32>,
    /// Multifocal: texels along the longer side of a plane.
    texels: Option<u32>,
    /// Multifocal: the most occluders drawn on each side of a cell.
    occluders: Option<u32>,
    /// Multifocal: whether blocked texels are carried over from one plane to the next.
    carry: Option<bool>,
    /// Multifocal: the most sides of triangles examined to find a sheet; 0 for no sheets.
    sheets: Option<u32>,
    /// Multifocal: `"cpu"`, `"reference"` or `"gpu"`.
    backend: Option<String>,
    /// Quake maps and portal files: only a coarse bound.
    fast: bool,
}

/// Why a text is no request.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct RequestError(pub String);

/// Why members make no request.
type Unfit = String;

impl BakeRequest {
    /// Reads a request from JSON, by the names of the program's options with `_` for `-`; what is left out is not said.
    ///
    /// # Errors
    /// [`RequestError`] for what is no request, with the name of the option.
    pub fn from_json(text: &str) -> Result<Self, RequestError> {
        serde_json::from_str(text).map_err(|error| RequestError(error.to_string()))
    }
}

fn within<T: PartialOrd + std::fmt::Display + Copy>(
    name: &str,
    value: Option<T>,
    range: impl RangeBounds<T>,
    expected: &str,
) -> Result<Option<T>, Unfit> {
    match value.filter(|value| !range.contains(value)) {
        Some(value) => Err(format!("{name} is {value}, where {expected} is expected")),
        None => Ok(value),
    }
}

fn parsed<T: FromStr<Err: std::fmt::Display>>(name: &str, text: Option<&str>) -> Result<Option<T>, Unfit> {
    text.map(|text| text.parse().map_err(|error| format!("{name}: {error}"))).transpose()
}

fn region([x0, y0, z0, x1, y1, z1]: [f64; 6]) -> Result<Aabb<3>, Unfit> {
    let (min, max) = ([x0, y0, z0], [x1, y1, z1]);
    for x in min.iter().chain(&max) {
        check_coordinate(*x).map_err(|error| format!("view_region: {error}"))?;
    }
    if (0..3).any(|k| min[k] > max[k]) {
        return Err("view_region: a lower corner above the upper one".to_owned());
    }
    Ok(Aabb { min, max })
}

impl Named {
    /// The cells, of which one kind may be named.
    fn cells(&self) -> Result<Option<CellsFrom>, Unfit> {
        let Self { cell_size, eye_height, n_cells, grid, .. } = *self;
        let up = match self.up.as_deref() {
            None => None,
            Some(name) => {
                let axis = ["x", "y", "z"].iter().position(|axis| *axis == name);
                let axis = axis.map(|k| Axis::ALL[k]).ok_or_else(|| format!("up: '{name}' is none of x, y and z"))?;
                Some(axis)
            }
        };
        let kind = match &self.cells {
            None => None,
            Some(Value::String(kind)) => Some(kind.as_str()),
            Some(_) => Some("boxes"),
        };
        let implied = [
            ("grid", grid.is_some()),
            ("places", n_cells.is_some()),
            ("eye-level", eye_height.is_some() || up.is_some()),
        ];
        let mut all = kind.into_iter().chain(implied.iter().filter(|(_, is)| *is).map(|&(kind, _)| kind));
        let Some(kind) = all.next() else { return Ok(None) };
        if let Some(other) = all.find(|other| *other != kind) {
            return Err(format!("cells cannot be of the kinds {kind} and {other} at once"));
        }
        Ok(Some(match kind {
            "kd-tree" => CellsFrom::KdTree,
            "grid" => CellsFrom::Grid(grid.ok_or("cells: a grid needs three numbers, as grid")?),
            "places" => CellsFrom::Places(PlaceOptions { n_cells, cell_size }),
            "eye-level" => {
                CellsFrom::EyeLevel(EyeLevelOptions { cell_size, eye_height, up, ..EyeLevelOptions::default() })
            }
            "boxes" if self.cells.as_ref().is_some_and(|cells| !cells.is_string()) => {
                let text = self.cells.as_ref().map(Value::to_string).unwrap_or_default();
                CellsFrom::Boxes(parse_view_cells(text.as_bytes()).map_err(|error| format!("cells: {error}"))?)
            }
            other => return Err(format!("cells: '{other}' is none of kd-tree, places and eye-level")),
        }))
    }
}

impl TryFrom<Named> for BakeRequest {
    type Error = Unfit;

    fn try_from(named: Named) -> Result<Self, Unfit> {
        const FROM_0: &str = "a number from 0 on";
        let cells = named.cells()?;
        let cell_size = match cells {
            Some(CellsFrom::Places(_) | CellsFrom::EyeLevel(_)) => None,
            _ => named.cell_size,
        };
        let split = within("split", named.split, 0..=12, "a number from 0 to 12")?;
        let gap = within("gap", named.gap, 0.0.., FROM_0)?;
        Ok(Self {
            cells,
            cell_size,
            method: parsed("method", named.method.as_deref())?,
            gap: gap.map_or(Gap::OfFile, Gap::Width),
            view_region: named.view_region.map(region).transpose()?,
            detail_below: within("detail_below", named.detail_below, 0.0.., FROM_0)?,
            max_cells: within("max_cells", named.max_cells, 1.., "a number from 1 on")?,
            keep_solid: named.keep_solid,
            tau: within("tau", named.tau, 0.0..=1.0, "a share from 0 to 1")?,
            subdivide: parsed("subdivide", named.subdivide.as_deref())?,
            buffers: BufferRequest {
                planes: within("planes", named.planes, 0..=256, "a number from 0 to 256")?,
                texels: within("texels", named.texels, 1..=8192, "a number from 1 to 8192")?,
                occluders: named.occluders,
                carry: named.carry,
                sheets: named.sheets,
                backend: parsed::<Backend>("backend", named.backend.as_deref())?,
            },
            split: split.map(|depth| Split { depth, ..Split::default() }),
            parts: named.parts,
            fast: named.fast,
            for_proofs: false,
        })
    }
}

#[cfg(feature = "schemars")]
impl schemars::JsonSchema for BakeRequest {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "BakeRequest".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        Named::json_schema(generator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<BakeRequest, String> {
        BakeRequest::from_json(text).map_err(|error| error.0)
    }

    #[test]
    fn kinds_of_cells_follow_from_their_options() {
        let cells = |text: &str| read(text).expect("a request").cells;
        let places = |n_cells, cell_size| Some(CellsFrom::Places(PlaceOptions { n_cells, cell_size }));
        let none = EyeLevelOptions::default();
        assert_eq!(read("{}"), Ok(BakeRequest::default()));
        assert_eq!(cells(r#"{"cell_size": 4}"#), None);
        assert_eq!(read(r#"{"cell_size": 4}"#).expect("a request").cell_size, Some(4.0));
        assert_eq!(cells(r#"{"cells": "kd-tree"}"#), Some(CellsFrom::KdTree));
        assert_eq!(cells(r#"{"grid": [1, 2, 3]}"#), Some(CellsFrom::Grid([1, 2, 3])));
        assert_eq!(cells(r#"{"n_cells": 9, "cell_size": 4}"#), places(Some(9), Some(4.0)));
        assert_eq!(cells(r#"{"cells": "places"}"#), places(None, None));
        let eyes = EyeLevelOptions { eye_height: Some([0.5, 2.0]), up: Some(Axis::Y), ..none };
        assert_eq!(cells(r#"{"eye_height": [0.5, 2], "up": "y"}"#), Some(CellsFrom::EyeLevel(eyes)));
        assert_eq!(cells(r#"{"cells": "eye-level"}"#), Some(CellsFrom::EyeLevel(none)));
        let boxes = cells(r#"{"cells": {"cells": [{"id": "a", "min": [0, 0, 0.1], "max": [1, 1, 0.3]}]}}"#);
        let Some(CellsFrom::Boxes(boxes)) = boxes else { panic!("{boxes:?}") };
        assert_eq!(boxes.cells[0].bounds, Aabb { min: [0.0, 0.0, 0.1], max: [1.0, 1.0, 0.3] });
    }

    #[test]
    fn what_is_no_request_is_refused_by_name() {
        let cases = [
            (r#"{"cell": 3}"#, "unknown field `cell`"),
            (r#"{"grid": [1, 2, 3], "n_cells": 4}"#, "cells cannot be of the kinds grid and places at once"),
            (r#"{"cells": "kd-tree", "up": "y"}"#, "cells cannot be of the kinds kd-tree and eye-level at once"),
            (r#"{"cells": "boxes"}"#, "cells: 'boxes' is none of kd-tree, places and eye-level"),
            (r#"{"cells": "grid"}"#, "cells: a grid needs three numbers, as grid"),
            (r#"{"cells": {"cells": []}}"#, "cells: "),
            (r#"{"cells": 3}"#, "cells: "),
            (r#"{"up": "up"}"#, "up: 'up' is none of x, y and z"),
            (r#"{"gap": -1}"#, "gap is -1, where a number from 0 on is expected"),
            (r#"{"tau": 2}"#, "tau is 2, where a share from 0 to 1 is expected"),
            (r#"{"texels": 0}"#, "texels is 0, where a number from 1 to 8192 is expected"),
            (r#"{"split": 13}"#, "split is 13, where a number from 0 to 12 is expected"),
            (r#"{"max_cells": 0}"#, "max_cells is 0, where a number from 1 on is expected"),
            (r#"{"method": "best"}"#, "method: 'best' is no method for scenes"),
            (r#"{"subdivide": "best"}"#, "subdivide: 'best' is no subdivision"),
            (r#"{"backend": "best"}"#, "backend: 'best' is no backend"),
            (r#"{"view_region": [0, 0, 0, 1, -1, 1]}"#, "view_region: a lower corner above the upper one"),
            (r#"{"view_region": [0, 0, 0, 1, 1, 1e300]}"#, "view_region: "),
        ];
        for (text, expected) in cases {
            let found = read(text).expect_err(text);
            assert!(found.starts_with(expected), "{text}: {found}");
        }
    }
}
