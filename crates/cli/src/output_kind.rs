//! What is written of points of a plan, by the name of the output.

use crate::error::{Result, anyhow};
use std::path::Path;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OutputKind {
    Csv,
    GeoJson,
    Svg,
    Png,
}

impl OutputKind {
    /// `endings` is what an error says of the name.
    pub(crate) fn of(path: &Path, endings: &str) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("geojson" | "json") => Ok(Self::GeoJson),
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(anyhow!("{}: the name of the {endings}", path.display())),
        }
    }

    pub(crate) fn is_picture(self) -> bool {
        matches!(self, Self::Svg | Self::Png)
    }
}
