//! Walks in files.

use crate::error::InputError;
use serde::Deserialize;
use sightlines::eye_to_cell::ViewError;
use sightlines::geometry::{CoordinateError, check_coordinate};
use sightlines::walkthrough::CameraPose;
use std::path::Path;

/// Why a file is not a walk. Frames count from 0.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PathError {
    #[error("{0}")]
    Text(serde_json::Error),
    #[error("there are no frames in the walk")]
    Empty,
    #[error("frame {frame}: {source}")]
    Frame { frame: usize, source: serde_json::Error },
    #[error("frame {frame}: {what} has {found} numbers, but the table has {dimension} dimensions")]
    Count { frame: usize, what: &'static str, found: usize, dimension: u8 },
    #[error("frame {frame}: {what}: {source}")]
    Coordinate { frame: usize, what: &'static str, source: CoordinateError },
    #[error("frame {frame}: {source}")]
    View { frame: usize, source: ViewError },
}

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

/// Reads a walk for a table with so many dimensions. The outer error is that of reading, the inner one of what was read.
pub(crate) fn read(path: &Path, dimension: u8) -> Result<Result<Vec<CameraPose>, PathError>, InputError> {
    let bytes = std::fs::read(path).map_err(|source| InputError::Open { path: path.to_owned(), source })?;
    Ok(parse(&bytes, dimension))
}

fn parse(bytes: &[u8], dimension: u8) -> Result<Vec<CameraPose>, PathError> {
    let Text { frames } = serde_json::from_slice(bytes).map_err(PathError::Text)?;
    if frames.is_empty() {
        return Err(PathError::Empty);
    }
    let stand = |(frame, value): (usize, serde_json::Value)| {
        let text: FrameText = serde_json::from_value(value).map_err(|source| PathError::Frame { frame, source })?;
        Ok(CameraPose {
            eye: point(&text.eye, frame, "eye", dimension)?,
            dir: point(&text.dir, frame, "dir", dimension)?,
        })
    };
    frames.into_iter().enumerate().map(stand).collect()
}

fn point(numbers: &[f64], frame: usize, what: &'static str, dimension: u8) -> Result<[f64; 3], PathError> {
    if numbers.len() != usize::from(dimension) {
        return Err(PathError::Count { frame, what, found: numbers.len(), dimension });
    }
    let check = |&x: &f64| check_coordinate(x).map_err(|source| PathError::Coordinate { frame, what, source });
    let numbers = numbers.iter().map(check).collect::<Result<Vec<_>, _>>()?;
    Ok(crate::view::lifted(&numbers))
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
