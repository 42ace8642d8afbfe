//! Bakes of files, bytes and meshes.

use crate::arrays::rows;
use crate::error::{bakeable_failed, error, value_error};
use crate::long;
use crate::table::Table;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sightlines_bake::{BakeError, BakeInput, BakeRequest, Bakeable, BakeableError, Baked, Gap, Report, Runtime};
use sightlines_cells::{Scene, SceneObject};
use sightlines_formats::Source;
use sightlines_progress::Observer;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What a bake did: pairs that see each other, pairs assumed to, and those not decided in time.
pub(crate) type Said = (u64, u64, u64);

/// How to bake; what means nothing for an input is refused, but for a limit of time, which only scenes heed.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    /// A request as JSON.
    request: String,
    /// Whether coordinates that Python gives are as precise as single precision is; files say themselves.
    is_single: bool,
    time_limit: Option<f64>,
    threads: usize,
}

/// The same, checked, and without anything of Python.
struct Checked {
    request: BakeRequest,
    time_limit: Option<f64>,
    threads: usize,
}

impl Options {
    fn check(&self) -> PyResult<Checked> {
        let mut request = BakeRequest::from_json(&self.request).map_err(value_error)?;
        if self.is_single && request.gap == Gap::OfFile {
            request.gap = Gap::OfSingle;
        }
        Ok(Checked { request, time_limit: self.time_limit, threads: self.threads })
    }
}

impl Checked {
    /// Bakes an input.
    fn bake(self, input: BakeInput<'_>, observer: &dyn Observer) -> Result<Baked, BakeError> {
        let start = Instant::now();
        let limit = self.time_limit.unwrap_or(f64::INFINITY);
        let spent = move || start.elapsed().as_secs_f64() / limit;
        let runtime = Runtime {
            threads: self.threads,
            progress: Some(observer),
            budget: if self.time_limit.is_some() { Some(&spent) } else { None },
            ..Runtime::default()
        };
        self.request.prepare(input, &runtime)?.run(&runtime)
    }
}

/// What a bake says of itself.
pub(crate) fn said_of(baked: &Baked) -> Said {
    let (pairs, assumed, left) = match &baked.report {
        Report::Plan(did) => (did.n_visible_pairs, 0, None),
        Report::Scene(did) => (did.n_visible_pairs, did.n_assumed, did.limit),
        Report::Regions(did) => (did.n_visible_pairs, did.n_assumed, did.limit),
        _ => (0, 0, None),
    };
    (pairs, assumed, left.map_or(0, |left| left.n_cell_pairs + left.n_object_pairs))
}

/// The result of a bake for Python.
pub(crate) fn baked(result: Result<(Said, Baked), BakeError>) -> PyResult<(Table, Said)> {
    match result {
        Ok((said, baked)) => Ok((Table::with_graph(baked.table, baked.graph), said)),
        Err(failure) => Err(bake_failed(&failure, &failure)),
    }
}

/// An argument that means nothing for what is baked, or an error of the scene.
fn bake_failed(failure: &BakeError, what: impl Display) -> PyErr {
    if matches!(failure, BakeError::Meaningless(_)) { value_error(what) } else { error(what) }
}

/// Why a file was not baked.
enum Failed {
    Read(Box<BakeableError>),
    Bake(Box<BakeError>),
}

fn read_and_bake(
    py: Python<'_>,
    name: &Path,
    bytes: Option<&[u8]>,
    map: Option<&str>,
    options: &Options,
    progress: Option<&Py<PyAny>>,
) -> PyResult<(Table, Said)> {
    let options = options.check()?;
    let result = long::run(py, progress, |observer| {
        // Bytes stand alone: files that they name are refused.
        let source = bytes.map_or(Source::File(name), |bytes| Source::Memory { name, bytes, beside: None });
        let read = Bakeable::read(&source, map).map_err(|failure| Failed::Read(Box::new(failure)))?;
        let done = options.bake((&read).into(), observer).map_err(|failure| Failed::Bake(Box::new(failure)))?;
        Ok((said_of(&done), done))
    })?;
    match result {
        Ok(done) => baked(Ok(done)),
        Err(Failed::Read(failure)) => Err(bakeable_failed(name, &failure)),
        Err(Failed::Bake(failure)) => Err(bake_failed(&failure, format_args!("{}: {failure}", name.display()))),
    }
}

/// Bakes a file of any format.
#[pyfunction]
#[pyo3(signature = (path, map, options, progress=None))]
pub(crate) fn bake_file(
    py: Python<'_>,
    path: PathBuf,
    map: Option<&str>,
    options: Options,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Table, Said)> {
    read_and_bake(py, &path, None, map, &options, progress.as_ref())
}

/// Bakes the content of a file of any format.
#[pyfunction]
#[pyo3(signature = (bytes, name, map, options, progress=None))]
pub(crate) fn bake_bytes(
    py: Python<'_>,
    bytes: &[u8],
    name: &str,
    map: Option<&str>,
    options: Options,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Table, Said)> {
    read_and_bake(py, Path::new(name), Some(bytes), map, &options, progress.as_ref())
}

/// A mesh: name, corners (n, 3), triangles (m, 3), whether it is seen through.
pub(crate) type Mesh<'py> = (String, PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, i64>, bool);

fn object((name, corners, triangles, _): &Mesh<'_>) -> PyResult<SceneObject> {
    let vertices = rows::<3>(corners, &format!("{name}: corners"))?;
    let [n, columns] = [0, 1].map(|k| triangles.shape()[k]);
    if columns != 3 {
        return Err(value_error(format!("{name}: triangles of shape ({n}, {columns}), where (n, 3) is expected")));
    }
    let flat = triangles.as_slice().map_err(|_| value_error(format!("{name}: triangles are not contiguous")))?;
    let corner = |&i: &i64| {
        let index = u32::try_from(i).ok().filter(|&i| (i as usize) < vertices.len());
        index.ok_or_else(|| value_error(format!("{name}: corner {i} of {} in a triangle", vertices.len())))
    };
    let flat: Vec<u32> = flat.iter().map(corner).collect::<PyResult<_>>()?;
    Ok(SceneObject { name: name.clone(), vertices, triangles: flat.as_chunks::<3>().0.to_vec() })
}

/// Meshes as a scene.
pub(crate) fn scene_of(meshes: &[Mesh<'_>]) -> PyResult<Scene> {
    let objects: Vec<SceneObject> = meshes.iter().map(object).collect::<PyResult<_>>()?;
    let seen_through: Vec<u32> = (0..).zip(meshes).filter(|(_, mesh)| mesh.3).map(|(object, _)| object).collect();
    Scene::new(objects).and_then(|scene| scene.with_see_through(seen_through)).map_err(value_error)
}

/// Bakes meshes.
#[pyfunction]
#[pyo3(signature = (meshes, options, progress=None))]
pub(crate) fn bake_meshes(
    py: Python<'_>,
    meshes: Vec<Mesh<'_>>,
    options: Options,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Table, Said)> {
    let options = options.check()?;
    let scene = scene_of(&meshes)?;
    let result = long::run(py, progress.as_ref(), |observer| {
        let done = options.bake(BakeInput::Scene(&scene, None), observer)?;
        Ok::<_, BakeError>((said_of(&done), done))
    })?;
    baked(result)
}
