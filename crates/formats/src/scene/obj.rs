//! Wavefront OBJ: corners and faces, line by line.

use super::build::{Builder, Compact};
use super::error::{ObjErrorKind, SceneReadError};
use super::polygon::{MAX_WINDING_CORNERS, PolygonError, triangulate};
use super::{MAX_ELEMENTS, MIRROR_SUFFIX, SceneFile, SceneFormat};
use crate::point::check_point;
use sightlines_cells::Point3;
use std::borrow::Cow;

/// Reads an OBJ.
///
/// One object per `o` that has faces; where a file has no `o`, one per `g`. Faces before the first are an
/// object too. An object without a name is called `object N`. Faces of more than three corners are cut into
/// triangles that cover the face and nothing else, even where it is not convex. Coordinates are taken in
/// double precision. Everything about looks, lines, points and curves is skipped.
///
/// Costs time and memory in proportion to the text, but for winding faces of many corners.
///
/// # Errors
/// [`SceneReadError::Obj`] with the line, or [`SceneReadError::NoTriangles`].
///
/// # Source
/// Wavefront Technologies, Advanced Visualizer manual, appendix B1 (the format of `.obj`). Chosen here: materials do
/// not split objects; self-intersecting outlines are refused, because the extent of such a face is undefined.
pub fn parse_obj(bytes: &[u8]) -> Result<SceneFile, SceneReadError> {
    let obj = Obj::read(bytes)?;
    let mut builder = Builder::default();
    for (k, group) in obj.groups.iter().enumerate() {
        let end = obj.groups.get(k + 1).map_or(obj.faces.len(), |next| next.first_face);
        let faces = &obj.faces[group.first_face..end];
        if !faces.is_empty() {
            let mesh = obj.mesh(faces)?;
            let vertices = mesh.corners.iter().map(|&v| obj.positions[v]).collect();
            builder.add(group.name.clone(), vertices, mesh.triangles.iter().copied(), false);
            if group.name.ends_with(MIRROR_SUFFIX) {
                builder.mark_mirror();
            }
        }
    }
    builder.finish(SceneFormat::Obj)
}

/// The parts of an OBJ that matter here.
#[derive(Debug, Default)]
struct Obj {
    positions: Vec<Point3>,
    /// Corners of all faces, one after the other, as the file has them but never negative.
    corners: Vec<i64>,
    faces: Vec<Face>,
    groups: Vec<Group>,
    n_triangles: usize,
}

/// Invariant: `first_corner` ascends, and every face has three corners or more.
#[derive(Debug)]
struct Face {
    line: usize,
    first_corner: usize,
    n_corners: usize,
}

/// What becomes an object.
#[derive(Debug)]
struct Group {
    name: String,
    first_face: usize,
}

impl Obj {
    fn read(bytes: &[u8]) -> Result<Self, SceneReadError> {
        let divider = if lines(bytes).any(|(_, line)| keyword(&line) == b"o") { b"o" } else { b"g" };
        let mut obj = Self::default();
        obj.groups.push(Group { name: "object 0".to_owned(), first_face: 0 });
        for (number, line) in lines(bytes) {
            let fail = |kind| SceneReadError::Obj { line: number, kind };
            match keyword(&line) {
                b"v" => obj.vertex(words(&line).map_err(fail)?).map_err(fail)?,
                b"f" => obj.face(number, words(&line).map_err(fail)?).map_err(fail)?,
                word if word == divider => obj.group(text(&line).map_err(fail)?),
                _ => {}
            }
        }
        Ok(obj)
    }

    fn vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a str>) -> Result<(), ObjErrorKind> {
        let mut number = || words.next().and_then(|word| word.parse().ok()).ok_or(ObjErrorKind::Vertex);
        let point = [number()?, number()?, number()?];
        // One number more is a weight, three or four more are a colour.
        if let (Some(weight), None) = (words.next(), words.next())
            && weight.parse() != Ok(1.0)
        {
            return Err(ObjErrorKind::Weight);
        }
        self.positions.push(check_point(point)?);
        Ok(())
    }

    fn face<'a>(&mut self, line: usize, words: impl Iterator<Item = &'a str>) -> Result<(), ObjErrorKind> {
        let first_corner = self.corners.len();
        for word in words {
            // Behind slashes are texture coordinates and normals.
            let index = word.split('/').next().and_then(|index| index.parse::<i64>().ok());
            let index = index.ok_or(ObjErrorKind::FaceIndex)?;
            // Negative indices count back from the last corner so far. A length fits into an i64.
            let absolute = if index < 0 { self.positions.len() as i64 + 1 + index } else { index };
            if absolute < 1 {
                return Err(ObjErrorKind::Index { index });
            }
            self.corners.push(absolute);
        }
        let n_corners = self.corners.len() - first_corner;
        if n_corners < 3 {
            return Err(ObjErrorKind::FaceCorners);
        }
        self.n_triangles += n_corners - 2;
        if self.n_triangles > MAX_ELEMENTS {
            return Err(ObjErrorKind::TooMany { max: MAX_ELEMENTS });
        }
        self.faces.push(Face { line, first_corner, n_corners });
        Ok(())
    }

    fn group(&mut self, name: &str) {
        if self.groups.last().is_some_and(|group| group.first_face == self.faces.len()) {
            self.groups.pop();
        }
        let name = if name.is_empty() { format!("object {}", self.groups.len()) } else { name.to_owned() };
        self.groups.push(Group { name, first_face: self.faces.len() });
    }

    /// The triangles of `faces`. Indices are looked up only here, since a face may stand before its corners.
    fn mesh(&self, faces: &[Face]) -> Result<Compact, SceneReadError> {
        let (mut used, mut triangles) = (Vec::new(), Vec::new());
        for face in faces {
            let fail = |kind| SceneReadError::Obj { line: face.line, kind };
            let corners = self.look_up(face).map_err(fail)?;
            let polygon: Vec<Point3> = corners.iter().map(|&v| self.positions[v]).collect();
            let cut = triangulate(&polygon).map_err(|error| match error {
                PolygonError::Crossing => fail(ObjErrorKind::Crossing),
                PolygonError::TooLarge => {
                    fail(ObjErrorKind::LargeFace { n_corners: face.n_corners, max: MAX_WINDING_CORNERS })
                }
            })?;
            triangles.extend(cut.into_iter().map(|t| t.map(|k| corners[k])));
            used.extend(corners);
        }
        Ok(Compact::new(used, triangles.into_iter()))
    }

    fn look_up(&self, face: &Face) -> Result<Vec<usize>, ObjErrorKind> {
        let corners = &self.corners[face.first_corner..][..face.n_corners];
        let find = |&index: &i64| {
            let place = usize::try_from(index - 1).ok().filter(|&v| v < self.positions.len());
            place.ok_or(ObjErrorKind::Index { index })
        };
        corners.iter().map(find).collect()
    }
}

/// Lines with their numbers from 1. Comments are gone, and lines that end in a backslash have the next one
/// behind them.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut rest = bytes.split(|&b| b == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (number, line) = rest.next()?;
        let mut whole = Cow::Borrowed(line);
        while let Some(unfinished) = whole.trim_ascii_end().strip_suffix(b"\\") {
            let mut joined = unfinished.to_vec();
            joined.push(b' ');
            joined.extend_from_slice(rest.next().map_or(&[], |(_, next)| next));
            whole = Cow::Owned(joined);
        }
        if let Some(comment) = whole.iter().position(|&b| b == b'#') {
            match &mut whole {
                Cow::Borrowed(line) => *line = &line[..comment],
                Cow::Owned(line) => line.truncate(comment),
            }
        }
        Some((number + 1, whole))
    })
}

fn keyword(line: &[u8]) -> &[u8] {
    let line = line.trim_ascii_start();
    &line[..line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len())]
}

/// What follows the keyword.
fn text(line: &[u8]) -> Result<&str, ObjErrorKind> {
    let behind = &line.trim_ascii_start()[keyword(line).len()..];
    std::str::from_utf8(behind.trim_ascii()).map_err(|_| ObjErrorKind::Utf8)
}

fn words(line: &[u8]) -> Result<impl Iterator<Item = &str>, ObjErrorKind> {
    Ok(text(line)?.split_ascii_whitespace())
}
