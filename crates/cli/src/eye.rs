//! The eye and its picture as arguments.

use crate::error::{Result, anyhow};
use crate::numbers::coordinates;
use crate::view::Up;
use sightlines::geometry::Point3;
use sightlines::visible_surface::{Camera, CameraError};

/// Where the eye is, where it looks, and through what.
#[derive(Debug, clap::Args)]
pub(crate) struct EyeArgs {
    /// The eye, in scene units
    #[arg(long, help_heading = "Viewer", value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub(crate) eye: Point3,
    /// The point in the middle of the picture, in scene units
    #[arg(long, help_heading = "Viewer", value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub(crate) look_at: Point3,
    /// Up direction of the picture, an axis or a vector [default: the up axis of the scene, else y]
    #[arg(long, help_heading = "Viewer", value_name = "AXIS|X,Y,Z", allow_hyphen_values = true)]
    up: Option<Up>,
    /// Vertical angle of view, in degrees
    #[arg(long, help_heading = "Viewer", value_name = "DEGREES", default_value_t = 60.0, allow_hyphen_values = true)]
    pub(crate) fov: f64,
    /// Width and height of the picture, in pixels
    #[arg(long, help_heading = "Viewer", value_name = "WxH", value_parser = size, default_value = "640x480")]
    size: [u32; 2],
    /// Near plane: smallest visible depth along the viewing axis, in scene units
    #[arg(long, help_heading = "Viewer", value_name = "DEPTH", default_value_t = 0.0, allow_hyphen_values = true)]
    near: f64,
    /// Far plane: greatest visible depth, in scene units; inf for none
    #[arg(long, help_heading = "Viewer", value_name = "DEPTH", default_value_t = f64::INFINITY, allow_hyphen_values = true)]
    far: f64,
}

impl EyeArgs {
    /// The up direction of the picture; `named` is that of the scene.
    pub(crate) fn up(&self, named: Up) -> Point3 {
        self.up.unwrap_or(named).0
    }

    pub(crate) fn camera(&self, up: Point3) -> Result<Camera> {
        let camera = Camera::look_at(self.eye, self.look_at, up, self.fov, self.size);
        camera.and_then(|camera| camera.with_depths(self.near, self.far)).map_err(|error| {
            let option = match error {
                CameraError::Eye => "--eye",
                CameraError::Direction => "--look-at",
                CameraError::Angle => "--fov",
                CameraError::Size => "--size",
                // The one that is left.
                _ => "--near, --far",
            };
            anyhow!("{option}: {error}")
        })
    }
}

pub(crate) fn point(text: &str) -> Result<Point3> {
    let numbers = coordinates(text)?;
    numbers.try_into().map_err(|_| anyhow!("a point in space is three comma-separated numbers, such as 9,1.7,-5"))
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "a size is two whole numbers, such as 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let number = |part: &str| part.trim().parse::<u32>().map_err(|_| wrong());
    Ok([number(width)?, number(height)?])
}
