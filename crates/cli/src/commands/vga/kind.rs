//! What `vga` writes, by the name of its output.

use crate::error::{Result, anyhow};
use std::path::Path;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Csv,
    GeoJson,
    Svg,
    Png,
}

impl Kind {
    pub(super) fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("geojson" | "json") => Ok(Self::GeoJson),
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(anyhow!("{}: the name of the output ends in .csv, .geojson, .svg or .png", path.display())),
        }
    }

    pub(super) fn is_picture(self) -> bool {
        matches!(self, Self::Svg | Self::Png)
    }
}
