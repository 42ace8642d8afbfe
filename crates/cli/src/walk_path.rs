//! Walks in files.

use crate::error::{ErrorAbout, Result, bail};
use serde::Deserialize;
use sightlines::geometry::check_coordinate;
use sightlines::walkthrough::CameraPose;
use std::path::Path;

/// The file.
#[derive(Debug, Deserialize)]
struct Text {
    frames: Vec<serde_json::Value>,
}

/// A frame of the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameText {
    eye: Vec<f64>,
    dir: Vec<f64>,
}

/// Reads a walk for a table with so many dimensions. Frames count from 0 in errors.
pub(crate) fn read(path: &Path, dimension: u8) -> Result<Vec<CameraPose>> {
    parse(&std::fs::read(path).in_file(path)?, dimension).in_file(path)
}

fn parse(bytes: &[u8], dimension: u8) -> Result<Vec<CameraPose>> {
    let Text { frames } = serde_json::from_slice(bytes)?;
    if frames.is_empty() {
        bail!("there are no frames in the walk");
    }
    let pose = |value: serde_json::Value| -> Result<CameraPose> {
        let FrameText { eye, dir } = serde_json::from_value(value)?;
        Ok(CameraPose { eye: point(&eye, "eye", dimension)?, dir: point(&dir, "dir", dimension)? })
    };
    (0..).zip(frames).map(|(frame, value)| pose(value).about(format_args!("frame {frame}"))).collect()
}

fn point(numbers: &[f64], what: &str, dimension: u8) -> Result<[f64; 3]> {
    if numbers.len() != usize::from(dimension) {
        bail!("{what} has {} numbers, but the table has {dimension} dimensions", numbers.len());
    }
    numbers.iter().try_for_each(|&x| check_coordinate(x).map(drop)).about(what)?;
    Ok(crate::view::lifted(numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walks_are_read_and_mistakes_reported_with_their_frame() {
        let good = br#"{"frames": [{"eye": [1, 2], "dir": [0, 1]}, {"eye": [1.5, 2], "dir": [1, 1]}], "by": "hand"}"#;
        let stands = parse(good, 2).unwrap();
        assert_eq!((stands.len(), stands[1]), (2, CameraPose { eye: [1.5, 2.0, 0.0], dir: [1.0, 1.0, 0.0] }));
        for (text, message) in [
            ("", "EOF while parsing"),
            ("[]", "line 1 column "),
            ("{}", "missing field `frames`"),
            (r#"{"frames": []}"#, "there are no frames in the walk"),
            (r#"{"frames": [{"eye": [1, 2], "dir": [0, 1e999]}]}"#, "number out of range"),
            (r#"{"frames": [{"eye": [1, 2], "dir": [0, 1]}, {"eye": [1, 2]}]}"#, "frame 1: missing field `dir`"),
            (r#"{"frames": [{"eye": [1, 2], "dir": [0, 1], "fov": 3}]}"#, "frame 0: unknown field `fov`"),
            (r#"{"frames": [{"eye": [1, 2, 3], "dir": [0, 1]}]}"#, "frame 0: eye has 3 numbers, but the table has 2"),
            (r#"{"frames": [{"eye": [1, 2], "dir": [0, 1e300]}]}"#, "frame 0: dir: "),
            (r#"{"frames": [{"eye": [1, null], "dir": [0, 1]}]}"#, "frame 0: invalid type: null"),
        ] {
            let error = parse(text.as_bytes(), 2).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
