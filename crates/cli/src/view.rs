//! The view of a viewer as arguments: the method and the lens.

use crate::error::Result;
use crate::facts::axis_named;
use crate::input::refuse;
use crate::numbers;
use crate::tables::Cells;
use sightlines::eye_to_cell::{Method, UnknownMethod, View, ViewError};
use sightlines::formats::scene::Axis;
use sightlines::geometry::check_coordinate;
use sightlines::walkthrough::CameraPose;
use std::path::Path;
use std::str::FromStr;

/// The angle of view where none is given, in degrees.
const FOV: f64 = 75.0;
/// Width by height where nothing is given.
const ASPECT: f64 = 4.0 / 3.0;
/// The maximum number of reflections in a row.
const MOST_BOUNCES: usize = 8;

/// One of the methods, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Methods {
    All,
    One(Method),
}

impl Methods {
    /// The methods; the answer of each lies within that of the one before.
    pub(crate) fn list(self) -> Vec<Method> {
        match self {
            Self::All => Method::ALL.to_vec(),
            Self::One(method) => vec![method],
        }
    }
}

impl FromStr for Methods {
    type Err = UnknownMethods;

    fn from_str(text: &str) -> Result<Self, UnknownMethods> {
        if text == "all" { Ok(Self::All) } else { Ok(Self::One(text.parse()?)) }
    }
}

/// The help on `--method`: the names of all methods, and what `more` adds.
pub(crate) fn method_help(more: &str) -> String {
    format!(
        "Eye-to-cell method: {} (each within the one before), or all{more}",
        Method::ALL.map(Method::name).join(", ")
    )
}

/// Neither `all` nor the name of a method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}, all")]
pub(crate) struct UnknownMethods(#[from] UnknownMethod);

/// How wide the picture is.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct LensArgs {
    /// Angle of view in degrees, above 0 and up to 360; in space the horizontal one [default: 75]
    #[arg(long, help_heading = "Viewer", value_name = "DEGREES", value_parser = degrees, allow_hyphen_values = true)]
    fov: Option<f64>,
    /// Scenes in space: aspect ratio of the picture, width by height [default: 4/3]
    #[arg(long, help_heading = "Viewer", value_name = "W/H", value_parser = aspect, allow_hyphen_values = true)]
    aspect: Option<f64>,
    /// Scenes in space: up direction of the picture, an axis or a vector [default: the up axis of the table, else y]
    #[arg(long, help_heading = "Viewer", value_name = "AXIS|X,Y,Z", allow_hyphen_values = true)]
    up: Option<Up>,
}

impl LensArgs {
    /// Whether any is given.
    pub(crate) fn is_given(&self) -> bool {
        self.fov.is_some() || self.aspect.is_some() || self.up.is_some()
    }

    /// Whether an option is given that only a direction of view has.
    pub(crate) fn has_angles(&self) -> bool {
        self.fov.is_some() || self.aspect.is_some()
    }

    pub(crate) fn up(&self) -> Option<Up> {
        self.up
    }

    /// The lens for a table; refuses what means nothing in a plane.
    pub(crate) fn lens(&self, cells: &impl Cells, path: &Path) -> Result<Lens> {
        let fov = self.fov.unwrap_or(FOV);
        if cells.n_dimensions() == 2 {
            let given = [("--aspect", self.aspect.is_some()), ("--up", self.up.is_some())];
            refuse(path, &given, "tables of scenes in space", "the table of a plan")?;
            return Ok(Lens { fov, in_space: None });
        }
        let named = cells.up().map(Up::axis);
        let Up(up) = self.up.or(named).unwrap_or(Up([0.0, 1.0, 0.0]));
        Ok(Lens { fov, in_space: Some((up, self.aspect.unwrap_or(ASPECT))) })
    }
}

/// What turns a place and a direction into a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lens {
    /// In degrees.
    pub(crate) fov: f64,
    /// What is up, and width by height.
    in_space: Option<([f64; 3], f64)>,
}

impl Lens {
    /// What a viewer sees in the picture.
    pub(crate) fn view(&self, CameraPose { eye, dir }: CameraPose) -> Result<View, ViewError> {
        let fov = self.fov.to_radians().min(std::f64::consts::TAU);
        match self.in_space {
            None => View::planar([eye[0], eye[1]], [dir[0], dir[1]], fov),
            Some((up, aspect)) => View::perspective_horizontal(eye, dir, up, fov, aspect),
        }
    }
}

/// Up to three coordinates as three; z is 0 in a plane.
pub(crate) fn lifted(coordinates: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| coordinates.get(k).copied().unwrap_or(0.0))
}

/// What is up in a picture: the name of an axis, or a vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Up(pub(crate) [f64; 3]);

impl Up {
    /// An axis.
    pub(crate) const fn axis(axis: Axis) -> Self {
        let mut up = [0.0; 3];
        up[axis.idx()] = 1.0;
        Self(up)
    }
}

impl FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(axis) = axis_named(text) {
            return Ok(Self::axis(axis));
        }
        let wrong = || "not x, y, z or a vector of three comma-separated numbers".to_owned();
        let numbers: Vec<f64> = text.split(',').map(|x| number(x).ok_or_else(wrong)).collect::<Result<_, _>>()?;
        let up: [f64; 3] = numbers.try_into().map_err(|_| wrong())?;
        if up == [0.0; 3] { Err("the vector has no length".to_owned()) } else { Ok(Self(up)) }
    }
}

/// A number that coordinates may be.
fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().and_then(|x| check_coordinate(x).ok())
}

fn degrees(text: &str) -> Result<f64, String> {
    numbers::number(text, |x| *x > 0.0 && *x <= 360.0, "a number above 0 and at most 360")
}

fn aspect(text: &str) -> Result<f64, String> {
    let quotient = match text.split_once('/') {
        Some((w, h)) => number(w).zip(number(h)).map(|(w, h)| w / h),
        None => number(text),
    };
    // Beyond these, the picture is a line, and the numbers are slips.
    match quotient {
        Some(x) if (1e-3..=1e3).contains(&x) => Ok(x),
        _ => Err("not W/H or a number from 0.001 to 1000".to_owned()),
    }
}

/// How many mirrors a line may meet one after the other.
pub(crate) fn bounces(text: &str) -> Result<usize, String> {
    numbers::at_most(text, MOST_BOUNCES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_an_axis_or_a_vector() {
        assert_eq!(["y".parse(), "0,-1,2".parse()], [Ok(Up([0.0, 1.0, 0.0])), Ok(Up([0.0, -1.0, 2.0]))]);
        for bad in ["w", "", "0,0,0", "1,2", "NaN,0,1", "1e300,0,0"] {
            assert!(bad.parse::<Up>().is_err(), "{bad}");
        }
    }

    #[test]
    fn methods_are_named() {
        assert_eq!("all".parse::<Methods>().unwrap().list(), Method::ALL);
        assert_eq!("exact".parse::<Methods>().unwrap().list(), [Method::Exact]);
        let error = "best".parse::<Methods>().unwrap_err().to_string();
        assert!(error.starts_with("'best' is none of cell-to-cell") && error.ends_with("exact, all"), "{error}");
    }
}
