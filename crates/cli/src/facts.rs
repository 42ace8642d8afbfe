//! The lines about scenes that several commands print.

use crate::output::{JsonSchema, Serialize, seconds_of};
use sightlines::formats::scene::{Axis, LengthUnit, SceneFormat, SceneInfo};
use std::fmt;

pub(crate) fn times(cut_seconds: f64, what: &str, see_seconds: f64) -> String {
    let [cut, see] = [cut_seconds, see_seconds].map(seconds_of);
    format!("{cut} to cut the {what}, {see} to compute visibility")
}

pub(crate) fn axis(axis: Axis) -> &'static str {
    ["x", "y", "z"][axis.idx()]
}

pub(crate) fn axis_named(text: &str) -> Option<Axis> {
    Axis::ALL.into_iter().find(|&named| axis(named) == text)
}

/// What a file states about its scene, for people: format, axis, unit.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct Stated {
    /// Format of the file, such as `glTF` or `OBJ`.
    format: &'static str,
    /// The axis that points up.
    up: &'static str,
    /// Whether `up` is an assumption because the file does not state it.
    up_is_assumed: bool,
    /// Unit of length; null if the file does not state it.
    unit: Option<&'static str>,
}

impl Stated {
    pub(crate) fn new(info: &SceneInfo) -> Self {
        let format = match info.format {
            SceneFormat::Gltf => "glTF",
            SceneFormat::Obj => "OBJ",
            _ => "unknown",
        };
        let unit = (info.unit == LengthUnit::Metre).then_some("metre");
        Self { format, up: axis(info.up), up_is_assumed: info.up_is_assumed, unit }
    }

    /// Whether the file states lengths in metres.
    pub(crate) fn is_in_metres(&self) -> bool {
        self.unit.is_some()
    }

    /// What lengths are in.
    pub(crate) fn unit_name(&self) -> &'static str {
        if self.is_in_metres() { "metres" } else { "units" }
    }
}

impl fmt::Display for Stated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let assumed = if self.up_is_assumed { " (assumed)" } else { "" };
        write!(f, "{} in 3D, {} up{assumed}, ", self.format, self.up)?;
        match self.unit {
            Some(unit) => write!(f, "in {unit}s"),
            None => f.write_str("unit unknown"),
        }
    }
}
