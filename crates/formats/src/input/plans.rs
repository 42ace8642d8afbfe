//! Plans of any format, with options.

use super::{Source, detect_file};
use crate::error::in_file;
use crate::plan::{PlanFile, PlanReadOptions};
use crate::{ReadError, dxf, geojson};
use std::path::Path;

/// Reads a plan from a file of any format of plans; GeoJSON if no format recognises it.
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_plan_file(path: impl AsRef<Path>, options: &PlanReadOptions) -> Result<PlanFile, ReadError> {
    let path = path.as_ref();
    match detect_file(path)? {
        Some(format) if format.name == "dxf" => {
            in_file(path, || Ok(dxf::parse_dxf(&Source::File(path).bytes()?, options)?))
        }
        _ => geojson::read_plan_file(path),
    }
}
