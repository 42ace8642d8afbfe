//! Wavefront OBJ: corners and faces, line by line.

use super::buffers::load_file;
use super::build::{Builder, Compact};
use super::mtl::{before_comment, parse_mtl};
use super::role::{MeshNames, Role, role_of_name};
use super::surface::{Classification, Classifier, Evidence, SceneReadOptions};
use super::write_obj::{OCCLUDER, SEE_THROUGH, SIMPLIFIED, STATEMENT};
use super::{MAX_ELEMENTS, SceneFile, SceneFormat, Simplification};
use crate::beside::Neighbours;
use crate::bytes::{text_lines, without_mark};
use crate::error::{Malformed, counted, malformed};
use crate::point::check_point;
use sightlines_cells::Point3;
use sightlines_geometry::triangles::{MAX_WINDING_CORNERS, PolygonError, triangulate};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Reads an OBJ.
///
/// One object per `o` that has faces; where a file has no `o`, one per `g`. Faces before the first are an
/// object too. An object without a name is called `object N`. Faces of more than three corners are cut into
/// triangles that cover the face and nothing else, even where it is not convex. Coordinates are taken in
/// double precision. Everything about looks, lines, points and curves is skipped.
///
/// Comments that [`write_obj`](super::write_obj()) writes are read: what is simplified, and what hides nothing.
///
/// Materials are not looked up, so faces with a material of a library (`mtllib`) hide nothing: it may be glass. See
/// [`parse_obj_with`].
///
/// Costs time and memory in proportion to the text, but for winding faces of many corners.
///
/// # Errors
/// [`Malformed`] with the line, or if there are no triangles. An invalid face is left out, with a warning.
///
/// # Source
/// Wavefront Technologies, Advanced Visualizer manual, appendix B1 (the format of `.obj`). Chosen here: materials do
/// not split objects, but for the faces of an object that are see-through while others are not; the extent of a face whose
/// outline crosses itself is undefined: it hides nothing, and is seen wherever a triangle of its corners is.
pub fn parse_obj(bytes: &[u8]) -> Result<SceneFile, Malformed> {
    parse_obj_with(bytes, None, &SceneReadOptions::default())
}

/// As [`parse_obj`], with options, and with materials wherever `beside` has the libraries that the file names.
///
/// Faces with a material that lets light through hide nothing; nor do those with a material of which nothing is known,
/// because its library, or it in the library, is missing. Faces without a material are opaque, and so are, with a warning, those
/// of a file that names no library: nobody who reads it can draw them otherwise. Where an object has faces of both kinds, those that hide nothing become an object of their own, behind it,
/// with `#see-through` at the end of its name.
///
/// # Errors
/// As [`parse_obj`]. A library that cannot be read is a warning.
pub fn parse_obj_with(
    bytes: &[u8],
    beside: Option<&dyn Neighbours>,
    options: &SceneReadOptions,
) -> Result<SceneFile, Malformed> {
    let obj = Obj::read(bytes)?;
    let mut builder = Builder::saying(obj.simplified);
    let mut classifier = Classifier::new(options);
    let surfaces = Surfaces::read(&obj, beside, &mut builder.warnings);
    obj.wrong.iter().for_each(|wrong| builder.leave_out(1, wrong.clone()));
    let (mut n_valid, mut ambiguous) = (0, None);
    let names: MeshNames<'_> = obj.groups.iter().map(|group| group.name.as_str()).collect();
    for (k, group) in obj.groups.iter().enumerate() {
        let end = obj.groups.get(k + 1).map_or(obj.faces.len(), |next| next.first_face);
        let faces = &obj.faces[group.first_face..end];
        // What each material makes of the faces of this object.
        let mut classes = BTreeMap::new();
        for face in faces {
            classes.entry(face.material).or_insert_with(|| {
                let material = face.material.map(|m| obj.materials[m].as_str());
                let role = names.role_of(&group.name).filter(|(role, _)| *role != Role::Mirror);
                let named = role.map(|(role, ending)| (role, format!("a name with {ending}")));
                // What is not drawn stays so.
                let stated = group.is_see_through && named.as_ref().is_none_or(|(role, _)| role.is_drawn());
                classifier.classify([Evidence {
                    names: [Some(group.name.as_str()), material].into_iter().flatten().collect(),
                    role: if stated { Some((Role::SeeThrough, "a comment".to_owned())) } else { named },
                    see_through: material.and_then(|m| surfaces.see_through(m)),
                    ..Evidence::default()
                }])
            });
        }
        let mut cut = Vec::new();
        for face in faces {
            match obj.cut(face)? {
                Ok(triangles) => cut.push((face, triangles)),
                Err(what) => builder.leave_out(1, what.on_line(face.line)),
            }
        }
        for (face, what) in cut.iter().filter_map(|(face, cut)| Some((face, cut.ambiguous.as_ref()?))) {
            ambiguous.get_or_insert_with(|| (0, what.clone().on_line(face.line))).0 += 1;
        }
        n_valid += cut.iter().filter(|(_, cut)| cut.ambiguous.is_none()).count();
        let hides = |(face, cut): &(&Face, FaceCut)| {
            cut.ambiguous.is_none() && classes[&face.material].as_ref().is_none_or(Classification::hides)
        };
        let (walls, glass): (Vec<_>, Vec<_>) = cut.into_iter().partition(hides);
        let behind = if walls.is_empty() { "" } else { "#see-through" };
        for (faces, suffix, hides) in [(walls, "", true), (glass, behind, false)] {
            let Some(&(first, _)) = faces.first() else { continue };
            let used = faces.iter().flat_map(|(_, cut)| &cut.corners).copied().collect();
            let triangles = faces.iter().flat_map(|(_, cut)| cut.triangles.iter().map(|t| t.map(|k| cut.corners[k])));
            let mesh = Compact::new(used, triangles);
            if mesh.triangles.is_empty() {
                continue;
            }
            let name = format!("{}{suffix}", group.name);
            let vertices = mesh.corners.iter().map(|&v| obj.positions[v]).collect();
            builder.add(name, vertices, (mesh.triangles.iter().copied(), &[]), false, false);
            if matches!(role_of_name(&group.name), Some((Role::Mirror, _))) {
                builder.mark_mirror();
            }
            // The reason is that of the first face; others have a like one.
            let class = classes[&first.material].clone();
            let ambiguous = || Some(Classification::see_through("an outline that crosses itself".to_owned()));
            let class = if hides { class } else { class.filter(|class| !class.hides()).or_else(ambiguous) };
            class.into_iter().for_each(|class| builder.classify(class, None));
        }
    }
    if let Some((n, first)) = ambiguous {
        if n_valid == 0 {
            return Err(first);
        }
        let faces = counted(n, "face hides", "faces hide");
        builder.warnings.push(format!("{faces} nothing: {first}"));
    }
    builder.warnings.extend(classifier.warnings());
    builder.finish(SceneFormat::Obj, options)
}

struct Surfaces {
    /// Why each lets light through; `None` for one that is opaque.
    known: BTreeMap<String, Option<String>>,
    /// The same by what stands in their names before a `#`, which may begin a comment.
    before_comments: BTreeMap<String, Option<String>>,
    /// What is said of one that is not known; `None` if the file names no library, so that there are none.
    unknown: Option<String>,
}

impl Surfaces {
    fn read(obj: &Obj, beside: Option<&dyn Neighbours>, warnings: &mut Vec<String>) -> Self {
        let mut known: BTreeMap<String, Option<String>> = BTreeMap::new();
        let mut before_comments = known.clone();
        let mut missing = Vec::new();
        for library in &obj.libraries {
            let (files, unread) = read_libraries(library, beside);
            missing.extend(unread);
            for (name, why) in files.iter().flat_map(|bytes| parse_mtl(bytes)) {
                let short = before_comment(&name).to_owned();
                for (names, name) in [(&mut before_comments, short), (&mut known, name)] {
                    let entry = names.entry(name).or_default();
                    *entry = entry.take().or_else(|| why.clone());
                }
            }
        }
        warnings.extend(missing_libraries(&missing));
        let n_faces = obj.faces.iter().filter(|face| face.material.is_some()).count();
        if let (true, Some(first), true) = (obj.libraries.is_empty(), obj.materials.first(), n_faces > 0) {
            let faces = counted(n_faces, "face has a material", "faces have materials");
            warnings.push(format!(
                "{faces}, such as {first:?}, and the file names no library (mtllib): they count as opaque; name what is glass \
                 (--see-through)"
            ));
        }
        let unknown = match missing.first() {
            Some(library) => Some(format!("a material of the missing {library}")),
            None => (!obj.libraries.is_empty()).then(|| "a material that is in no library".to_owned()),
        };
        Self { known, before_comments, unknown }
    }

    fn see_through(&self, material: &str) -> Option<String> {
        let found = self.known.get(material).or_else(|| self.before_comments.get(before_comment(material)));
        found.unwrap_or(&self.unknown).clone()
    }
}

fn missing_libraries(missing: &[&str]) -> Option<String> {
    /// How many of them are named.
    const MANY: usize = 8;
    let mut names: Vec<&str> = Vec::new();
    for &name in missing {
        if names.len() <= MANY && !names.contains(&name) {
            names.push(name);
        }
    }
    let others = if names.len() > MANY { " and others" } else { "" };
    names.truncate(MANY);
    let [it, its, libraries] = if names.len() > 1 { ["them", "their", "libraries"] } else { ["it", "its", "library"] };
    let names: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    (!names.is_empty()).then(|| {
        format!(
            "the material {libraries} {}{others} cannot be read: put {it} beside the OBJ; without {it}, faces with {its} materials \
             hide nothing",
            names.join(", ")
        )
    })
}

/// The contents of the libraries that a line names, one, whose name may have spaces, or several; and the names of those that cannot be read.
fn read_libraries<'l>(line: &'l str, beside: Option<&dyn Neighbours>) -> (Vec<Vec<u8>>, Vec<&'l str>) {
    // Names from Windows may have backslashes.
    let read = |name: &str| load_file(beside, name).or_else(|_| load_file(beside, &name.replace('\\', "/"))).ok();
    if let Some(bytes) = read(line).or_else(|| read(before_comment(line))) {
        return (vec![bytes], vec![]);
    }
    let (mut files, mut missing) = (Vec::new(), Vec::new());
    for name in before_comment(line).split_ascii_whitespace() {
        read(name).map_or_else(|| missing.push(name), |bytes| files.push(bytes));
    }
    // If there is none, or the line does not fall into names of libraries, it may be one name; the others are then of something else.
    let is_name = |word: &&str| word.len() > 4 && word.to_ascii_lowercase().ends_with(".mtl");
    let is_one = files.is_empty() || !missing.iter().all(is_name);
    if is_one { (Vec::new(), vec![line]) } else { (files, missing) }
}

#[derive(Debug, Default)]
struct Obj {
    positions: Vec<Point3>,
    /// Corners of all faces, one after the other, as the file has them but never negative.
    corners: Vec<i64>,
    faces: Vec<Face>,
    groups: Vec<Group>,
    n_triangles: usize,
    /// Names of materials, in the order in which faces first have them.
    materials: Vec<String>,
    /// What each line that names files with materials has behind its keyword.
    libraries: Vec<String>,
    /// Why faces are none, in the order of the file.
    wrong: Vec<Malformed>,
    simplified: Option<Simplification>,
}

/// Invariant: `first_corner` ascends, and every face has three corners or more.
#[derive(Debug)]
struct Face {
    line: usize,
    first_corner: usize,
    n_corners: usize,
    material: Option<usize>,
}

#[derive(Debug)]
struct FaceCut {
    corners: Vec<usize>,
    triangles: Vec<[usize; 3]>,
    /// Why it is not known what of these triangles is drawn.
    ambiguous: Option<Malformed>,
}

#[derive(Debug)]
struct Group {
    name: String,
    first_face: usize,
    is_see_through: bool,
}

impl Obj {
    fn read(bytes: &[u8]) -> Result<Self, Malformed> {
        let bytes = without_mark(bytes);
        let divider = if lines(bytes).any(|(_, line)| keyword(&line) == b"o") { b"o" } else { b"g" };
        let mut obj = Self::default();
        obj.groups.push(Group { name: "object 0".to_owned(), first_face: 0, is_see_through: false });
        let (mut by_name, mut material) = (BTreeMap::new(), None);
        for (number, line) in lines(bytes) {
            let fail = |what: Malformed| what.on_line(number);
            match keyword(&line) {
                b"v" => obj.vertex(words(&line).map_err(fail)?).map_err(fail)?,
                b"f" => {
                    let before = obj.corners.len();
                    if let Err(what) = obj.face(number, material, words(&line).map_err(fail)?) {
                        obj.corners.truncate(before);
                        obj.wrong.push(fail(what));
                    }
                    if obj.n_triangles > MAX_ELEMENTS {
                        return Err(fail(malformed!("with it the scene has more than {MAX_ELEMENTS} triangles")));
                    }
                }
                b"usemtl" => {
                    let name = lossy_text(&line);
                    let next = by_name.len();
                    material = (!name.is_empty()).then(|| *by_name.entry(name).or_insert(next));
                }
                b"mtllib" => obj.library(lossy_text(&line)),
                word if word == STATEMENT.as_bytes() => obj.statement(&lossy_text(&line)),
                word if word == divider => obj.group(text(&line).map_err(fail)?),
                _ => {}
            }
        }
        let mut names: Vec<(usize, String)> = by_name.into_iter().map(|(name, k)| (k, name)).collect();
        names.sort_unstable();
        obj.materials = names.into_iter().map(|(_, name)| name).collect();
        Ok(obj)
    }

    /// A comment of ours. Others who write one may have added what we do not know.
    fn statement(&mut self, text: &str) {
        let mut words = text.split_ascii_whitespace();
        match words.next() {
            Some(SIMPLIFIED) => self.simplified = Some(Simplification { occluder: words.eq([OCCLUDER]) }),
            Some(SEE_THROUGH) => self.groups.last_mut().expect("there is always a group").is_see_through = true,
            _ => {}
        }
    }

    fn library(&mut self, name: String) {
        if !name.is_empty() && !self.libraries.contains(&name) {
            self.libraries.push(name);
        }
    }

    fn vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a str>) -> Result<(), Malformed> {
        let missing = || malformed!("a corner needs three numbers");
        let mut number = || words.next().and_then(|word| word.parse().ok()).ok_or_else(missing);
        let point = [number()?, number()?, number()?];
        // One number more is a weight, three or four more are a colour.
        if let (Some(weight), None) = (words.next(), words.next())
            && weight.parse() != Ok(1.0)
        {
            return Err(malformed!("a corner with a weight other than 1"));
        }
        self.positions.push(check_point(point)?);
        Ok(())
    }

    fn face<'a>(
        &mut self,
        line: usize,
        material: Option<usize>,
        words: impl Iterator<Item = &'a str>,
    ) -> Result<(), Malformed> {
        let first_corner = self.corners.len();
        for word in words {
            // Behind slashes are texture coordinates and normals.
            let index = word.split('/').next().and_then(|index| index.parse::<i64>().ok());
            let index = index.ok_or_else(|| malformed!("a face needs indices of corners"))?;
            // Negative indices count back from the last corner so far. A length fits into an i64.
            let absolute = if index < 0 { self.positions.len() as i64 + 1 + index } else { index };
            if absolute < 1 {
                return Err(no_corner(index));
            }
            self.corners.push(absolute);
        }
        let n_corners = self.corners.len() - first_corner;
        if n_corners < 3 {
            return Err(malformed!("a face needs three corners or more"));
        }
        self.n_triangles += n_corners - 2;
        self.faces.push(Face { line, first_corner, n_corners, material });
        Ok(())
    }

    fn group(&mut self, name: &str) {
        if self.groups.last().is_some_and(|group| group.first_face == self.faces.len()) {
            self.groups.pop();
        }
        let name = if name.is_empty() { format!("object {}", self.groups.len()) } else { name.to_owned() };
        self.groups.push(Group { name, first_face: self.faces.len(), is_see_through: false });
    }

    /// The triangles of a face; or why it is none. Indices are looked up only here, since a face may stand before its corners.
    ///
    /// # Errors
    /// [`Malformed`] for a face that engines may draw, but which has too many corners to tell how.
    fn cut(&self, face: &Face) -> Result<Result<FaceCut, Malformed>, Malformed> {
        /// The most corners of a face of which all triangles are taken.
        const MOST_AMBIGUOUS: usize = 16;
        let corners = match self.look_up(face) {
            Ok(corners) => corners,
            Err(what) => return Ok(Err(what)),
        };
        let polygon: Vec<Point3> = corners.iter().map(|&v| self.positions[v]).collect();
        let n = corners.len();
        let what = match triangulate(&polygon) {
            Ok(triangles) => return Ok(Ok(FaceCut { corners, triangles, ambiguous: None })),
            Err(PolygonError::Crossing) => malformed!("the outline of the face crosses itself"),
            Err(PolygonError::TooLarge) => {
                malformed!("a winding face of {n} corners, more than {MAX_WINDING_CORNERS}")
            }
        };
        if n > MOST_AMBIGUOUS {
            return Err(what.on_line(face.line));
        }
        let triangles = (0..n).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| [k, j, i])));
        Ok(Ok(FaceCut { corners, triangles: triangles.collect(), ambiguous: Some(what) }))
    }

    fn look_up(&self, face: &Face) -> Result<Vec<usize>, Malformed> {
        let corners = &self.corners[face.first_corner..][..face.n_corners];
        let find = |&index: &i64| {
            let place = usize::try_from(index - 1).ok().filter(|&v| v < self.positions.len());
            place.ok_or_else(|| no_corner(index))
        };
        corners.iter().map(find).collect()
    }
}

fn no_corner(index: i64) -> Malformed {
    malformed!("there is no corner {index}")
}

/// Lines with their numbers from 1. Comments are gone, but for those behind names, which may have a `#`, and lines that end in a backslash have the next one
/// behind them.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut rest = text_lines(bytes).enumerate();
    std::iter::from_fn(move || {
        let (number, line) = rest.next()?;
        let mut whole = Cow::Borrowed(line);
        while let Some(unfinished) = whole.trim_ascii_end().strip_suffix(b"\\") {
            let mut joined = unfinished.to_vec();
            joined.push(b' ');
            joined.extend_from_slice(rest.next().map_or(&[], |(_, next)| next));
            whole = Cow::Owned(joined);
        }
        let word = keyword(&whole);
        let has_name = matches!(word, b"o" | b"g" | b"usemtl" | b"mtllib") || word == STATEMENT.as_bytes();
        if let Some(comment) = whole.iter().position(|&b| b == b'#').filter(|_| !has_name) {
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

fn behind(line: &[u8]) -> &[u8] {
    line.trim_ascii_start()[keyword(line).len()..].trim_ascii()
}

fn text(line: &[u8]) -> Result<&str, Malformed> {
    std::str::from_utf8(behind(line)).map_err(|_| malformed!("not UTF-8"))
}

/// The same, whatever it is: names of materials and files are compared and never shown as they are.
fn lossy_text(line: &[u8]) -> String {
    String::from_utf8_lossy(behind(line)).into_owned()
}

fn words(line: &[u8]) -> Result<impl Iterator<Item = &str>, Malformed> {
    Ok(text(line)?.split_ascii_whitespace())
}
