//! The axis that points up in a scene, as an argument.

use crate::error::Result;
use crate::facts::axis_named;
use crate::input::refuse;
use sightlines::formats::Input;
use sightlines::formats::scene::Axis;
use std::path::Path;

/// Where up is.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct UpArgs {
    /// Scenes in space: the axis that points up, x, y or z. Pictures, pages and floor plans follow it; what is visible does not depend on it
    /// [default: that of the file, which is y for glTF, and is taken to be y for OBJ]
    #[arg(long, help_heading = "Input", value_name = "AXIS", value_parser = axis)]
    up: Option<Axis>,
}

fn axis(text: &str) -> Result<Axis, String> {
    axis_named(text).ok_or_else(|| "not x, y or z".to_owned())
}

impl UpArgs {
    /// States it of a scene; of anything else it is known.
    ///
    /// # Errors
    /// If an axis is given for what is no scene.
    pub(crate) fn put_into(self, path: &Path, input: &mut Input) -> Result<()> {
        match (input, self.up) {
            (Input::Scene(file), Some(up)) => (file.info.up, file.info.up_is_assumed) = (up, false),
            (Input::Scene(_), None) => {}
            (_, up) => refuse(path, &[("--up", up.is_some())], "scenes in space", "none")?,
        }
        Ok(())
    }
}
