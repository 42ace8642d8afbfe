//! What of a scene nobody can ever see.

use crate::arrays::rows;
use crate::bake::{Mesh, scene_of};
use crate::error::{bakeable_failed, error, value_error};
use crate::long;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use sightlines_bake::{Bakeable, BakeableError};
use sightlines_cells::Scene;
use sightlines_formats::Source;
use sightlines_geometry::{Aabb, check_coordinate};
use sightlines_multifocal::Volume;
use sightlines_strip::{Eyes, Fate, Grain, StripError, StripOptions, Stripped, strip};
use std::path::{Path, PathBuf};

/// How to decide.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options<'py> {
    /// Boxes of eyes; none if they are everywhere outside.
    boxes: Option<PyReadonlyArray2<'py, f64>>,
    /// Whether eyes are wherever a way leads from the boxes.
    walk: bool,
    triangles: bool,
    gap: f64,
    keep: Vec<String>,
    effort: Option<u64>,
    ignore_mirrors: bool,
    seed: u64,
    threads: usize,
}

/// The same, without anything of Python.
struct Checked {
    eyes: Eyes,
    keep: Vec<String>,
    options: StripOptions,
}

/// An object: name, fate, reason, free segment, which triangles are hidden.
type Part<'py> = (String, &'static str, Option<&'static str>, Option<[f64; 6]>, Bound<'py, PyArray1<bool>>);

/// All of them, and how many closed surfaces there are.
type Parts<'py> = (Vec<Part<'py>>, usize);

/// Why a scene is not decided.
enum Failed {
    Read(Box<BakeableError>),
    Keep(String),
    Strip(StripError),
}

fn aabb(b: [f64; 6], what: &str) -> PyResult<Aabb<3>> {
    let [x0, y0, z0, x1, y1, z1] = b;
    for x in b {
        check_coordinate(x).map_err(|failure| value_error(format!("{what}: {failure}")))?;
    }
    let (min, max) = ([x0, y0, z0], [x1, y1, z1]);
    if (0..3).any(|k| min[k] > max[k]) {
        return Err(value_error(format!("{what}: a lower corner above the upper one")));
    }
    Ok(Aabb { min, max })
}

impl Options<'_> {
    fn check(&self) -> PyResult<Checked> {
        let volume = |(i, b): (usize, &[f64; 6])| {
            let what = format!("eyes: {i}");
            Volume::new(aabb(*b, &what)?).map_err(|failure| value_error(format!("{what}: {failure}")))
        };
        let eyes = match &self.boxes {
            None => Eyes::outside(),
            Some(boxes) => {
                let boxes = rows::<6>(boxes, "eyes")?;
                let boxes = boxes.iter().enumerate().map(volume).collect::<PyResult<Vec<_>>>()?;
                let eyes = if self.walk { Eyes::joined_to(boxes) } else { Eyes::in_boxes(boxes) };
                eyes.map_err(|failure| value_error(format!("eyes: {failure}")))?
            }
        };
        let mut options = StripOptions {
            grain: if self.triangles { Grain::Triangles } else { Grain::Objects },
            gap: self.gap,
            ignore_mirrors: self.ignore_mirrors,
            seed: self.seed,
            threads: self.threads,
            ..StripOptions::default()
        };
        options.effort.shared_cells = self.effort.unwrap_or(options.effort.shared_cells);
        Ok(Checked { eyes, keep: self.keep.clone(), options })
    }
}

impl Checked {
    fn strip(mut self, scene: &Scene, observer: &dyn sightlines_progress::Observer) -> Result<Stripped, Failed> {
        for name in &self.keep {
            let named = (0u32..).zip(scene.objects()).filter(|(_, of)| of.name == *name).map(|(k, _)| k);
            let before = self.options.keep.len();
            self.options.keep.extend(named);
            if self.options.keep.len() == before {
                return Err(Failed::Keep(name.clone()));
            }
        }
        strip(scene, &self.eyes, &self.options, Some(observer)).map_err(Failed::Strip)
    }
}

fn failed(name: &Path, failure: Failed) -> PyErr {
    match failure {
        Failed::Read(failure) => bakeable_failed(name, &failure),
        Failed::Keep(object) => value_error(format!("keep: there is no object named '{object}'")),
        Failed::Strip(failure @ StripError::Gap(_)) => value_error(failure),
        Failed::Strip(failure) => error(format!("{}: {failure}", name.display())),
    }
}

fn parts<'py>(py: Python<'py>, scene: &Scene, stripped: &Stripped) -> Parts<'py> {
    let part = |(of, found): (&sightlines_cells::SceneObject, &sightlines_strip::ObjectFate)| {
        let (fate, reason, witness) = match found.fate {
            Fate::Seen([[a, b, c], [d, e, f]]) => ("seen", None, Some([a, b, c, d, e, f])),
            Fate::Hidden(reason) => ("hidden", Some(reason.name()), None),
            Fate::Undecided => ("undecided", None, None),
            Fate::Kept => ("kept", None, None),
        };
        let hidden: Vec<bool> = (0..of.triangles.len()).map(|t| found.hides(t)).collect();
        (of.name.clone(), fate, reason, witness, hidden.into_pyarray(py))
    };
    (scene.objects().iter().zip(&stripped.objects).map(part).collect(), stripped.n_closed_surfaces)
}

fn read_and_strip<'py>(
    py: Python<'py>,
    name: &Path,
    bytes: Option<&[u8]>,
    options: &Options<'_>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Parts<'py>> {
    let options = options.check()?;
    let result = long::run(py, progress, |observer| {
        // Bytes stand alone: files that they name are refused.
        let source = bytes.map_or(Source::File(name), |bytes| Source::Memory { name, bytes, beside: None });
        match Bakeable::read(&source, None).map_err(|failure| Failed::Read(Box::new(failure)))? {
            Bakeable::Scene(file) => options.strip(&file.scene, observer).map(|found| (file.scene, found)),
            _ => Err(Failed::Read(Box::new(BakeableError::Kind))),
        }
    })?;
    let (scene, found) = result.map_err(|failure| failed(name, failure))?;
    Ok(parts(py, &scene, &found))
}

/// Decides about the scene of a file.
#[pyfunction]
#[pyo3(signature = (path, options, progress=None))]
pub(crate) fn strip_file<'py>(
    py: Python<'py>,
    path: PathBuf,
    options: Options<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Parts<'py>> {
    read_and_strip(py, &path, None, &options, progress.as_ref())
}

/// Decides about the content of a file.
#[pyfunction]
#[pyo3(signature = (bytes, name, options, progress=None))]
pub(crate) fn strip_bytes<'py>(
    py: Python<'py>,
    bytes: &[u8],
    name: &str,
    options: Options<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Parts<'py>> {
    read_and_strip(py, Path::new(name), Some(bytes), &options, progress.as_ref())
}

/// Decides about meshes.
#[pyfunction]
#[pyo3(signature = (meshes, options, progress=None))]
pub(crate) fn strip_meshes<'py>(
    py: Python<'py>,
    meshes: Vec<Mesh<'_>>,
    options: Options<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Parts<'py>> {
    let options = options.check()?;
    let scene = scene_of(&meshes)?;
    let result = long::run(py, progress.as_ref(), |observer| options.strip(&scene, observer))?;
    let found = result.map_err(|failure| failed(Path::new("meshes"), failure))?;
    Ok(parts(py, &scene, &found))
}
