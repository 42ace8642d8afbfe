//! Isovists, and sight between points.

use crate::arrays::{Ids, guarded, matrix, rows};
use crate::error::{room, value_error};
use crate::long;
use crate::plan::{Plan, Prepared};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use sightlines_geometry::{Aabb, Point2};
use sightlines_isovist::{
    Boundary, EyeError, Isovist, IsovistFinder, LimitError, Limits, Measures, MeshError, Sector, Touch, WallMesh,
};
use sightlines_progress::{Cancelled, Counter, Observer};

/// Names of measures, in the order of the columns.
const MEASURES: [&str; 11] = [
    "area",
    "perimeter",
    "occlusivity",
    "compactness",
    "drift",
    "drift_angle",
    "minimal_radial",
    "maximal_radial",
    "mean_radial",
    "variance",
    "skewness",
];

fn row(m: &Measures) -> [f64; MEASURES.len()] {
    [
        m.area,
        m.perimeter,
        m.occlusivity,
        m.compactness,
        m.drift,
        m.drift_angle,
        m.minimal_radial,
        m.maximal_radial,
        m.mean_radial,
        m.variance,
        m.skewness,
    ]
}

/// Points that are asked about at once, by one thread.
const CHUNK: usize = 256;

pub(crate) fn touch(passes: bool) -> Touch {
    if passes { Touch::Passes } else { Touch::Blocks }
}

/// Why nothing was computed.
pub(crate) enum Failed {
    Mesh(MeshError),
    Eye(usize, EyeError),
    Limit(LimitError),
    Cancelled,
}

impl From<Cancelled> for Failed {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<Failed> for PyErr {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Mesh(failure) => value_error(failure),
            Failed::Eye(row, failure) => value_error(format!("row {row}: {failure}")),
            Failed::Limit(failure) => value_error(failure),
            // Whatever cancelled raises its own exception before this is seen.
            Failed::Cancelled => crate::error::error(Cancelled),
        }
    }
}

/// Runs `work` on a number of threads, 0 for one for each core; on the shared ones if no others are to be had.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// What many points see.
#[pyclass(frozen, module = "sightlines._native")]
pub(crate) struct Isovists {
    /// All vertices, one isovist after the other, and where each begins.
    corners: Vec<Point2>,
    starts: Vec<i64>,
    /// For the edge from each vertex: its kind, and the wall or -1.
    kinds: Vec<u8>,
    walls: Vec<i64>,
    measures: Vec<[f64; MEASURES.len()]>,
}

#[pymethods]
impl Isovists {
    /// Names of measures.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        MEASURES.to_vec()
    }

    /// A column for each measure.
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.measures.as_flattened().to_vec(), [self.measures.len(), MEASURES.len()])
    }

    /// All vertices.
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flat: Vec<f64> = self.corners.iter().flat_map(|p| [p.x, p.y]).collect();
        matrix(py, flat, [self.corners.len(), 2])
    }

    /// The first vertex of each isovist, and their number at the end.
    fn starts<'py>(&self, py: Python<'py>) -> Ids<'py> {
        self.starts.clone().into_pyarray(py)
    }

    /// What each edge is: 0 a wall, 1 occluding, 2 the frame, 3 a limit.
    fn kinds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        self.kinds.clone().into_pyarray(py)
    }

    /// The wall that each edge lies on, by its number among the plan's walls; -1 for none.
    fn walls<'py>(&self, py: Python<'py>) -> Ids<'py> {
        self.walls.clone().into_pyarray(py)
    }
}

impl Isovists {
    fn new(n: usize) -> Self {
        Self {
            corners: Vec::new(),
            starts: vec![0],
            kinds: Vec::new(),
            walls: Vec::new(),
            measures: Vec::with_capacity(n),
        }
    }

    fn add(&mut self, isovist: &Isovist, wall_numbers: &[i64], keeps_outline: bool) {
        self.measures.push(row(&isovist.measures()));
        if keeps_outline {
            for (corner, boundary) in isovist.vertices().iter().zip(isovist.boundaries()) {
                let (kind, wall) = match boundary {
                    Boundary::Wall(line) => (0, wall_numbers[line.0 as usize]),
                    Boundary::Occluding => (1, -1),
                    Boundary::Frame => (2, -1),
                    _ => (3, -1),
                };
                self.corners.push(*corner);
                self.kinds.push(kind);
                self.walls.push(wall);
            }
        }
        self.starts.push(self.corners.len() as i64);
    }

    fn append(&mut self, mut other: Self) {
        let before = self.corners.len() as i64;
        self.corners.append(&mut other.corners);
        self.starts.extend(other.starts.into_iter().skip(1).map(|start| before + start));
        self.kinds.append(&mut other.kinds);
        self.walls.append(&mut other.walls);
        self.measures.append(&mut other.measures);
    }
}

fn isovists(
    Prepared { mesh, wall_numbers }: &Prepared,
    eyes: &[Point2],
    limits: Option<&Limits>,
    keeps_outlines: bool,
    observer: &dyn Observer,
) -> Result<Isovists, Failed> {
    let counter = Counter::new(Some(observer), "isovists", eyes.len().div_ceil(CHUNK));
    let chunk = |(k, eyes): (usize, &[Point2])| {
        counter.check()?;
        let (mut viewer, mut isovist) = (IsovistFinder::new(mesh), Isovist::default());
        let mut all = Isovists::new(eyes.len());
        for (i, eye) in eyes.iter().enumerate() {
            viewer.look(*eye, &mut isovist).map_err(|failure| Failed::Eye(k * CHUNK + i, failure))?;
            match limits {
                None => all.add(&isovist, wall_numbers, keeps_outlines),
                Some(limits) => {
                    all.add(&isovist.limited(limits).map_err(Failed::Limit)?, wall_numbers, keeps_outlines);
                }
            }
        }
        counter.step()?;
        Ok(all)
    };
    let parts: Vec<Result<Isovists, Failed>> = eyes.par_chunks(CHUNK).enumerate().map(chunk).collect();
    let mut all = Isovists::new(eyes.len());
    // The first failure, in the order of points.
    parts.into_iter().try_for_each(|part| part.map(|part| all.append(part)))?;
    Ok(all)
}

/// A mesh whose frame has these points in it.
fn wider(plan: &sightlines_cells::Plan, points: impl Iterator<Item = Point2> + Clone) -> Result<WallMesh, Failed> {
    WallMesh::around(plan, points).map_err(Failed::Mesh)
}

fn is_inside(mesh: &WallMesh, mut points: impl Iterator<Item = Point2>) -> bool {
    let Aabb { min, max } = mesh.frame();
    points.all(|p| min[0] < p.x && p.x < max[0] && min[1] < p.y && p.y < max[1])
}

impl Plan {
    /// Asks the mesh, or one with a wider frame if points are outside of it.
    pub(crate) fn mesh_around<T>(
        &self,
        points: impl Iterator<Item = Point2> + Clone,
        ask: impl FnOnce(&WallMesh) -> Result<T, Failed>,
    ) -> Result<T, Failed> {
        match self.prepared() {
            Ok(Prepared { mesh, .. }) if is_inside(mesh, points.clone()) => ask(mesh),
            Ok(_) | Err(MeshError::Empty) => ask(&wider(&self.plan, points)?),
            Err(failure) => Err(Failed::Mesh(failure)),
        }
    }
}

fn points(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<Point2>> {
    Ok(rows::<2>(array, what)?.into_iter().map(Point2::from).collect())
}

/// How far and in which directions is looked: radius, direction and angle, deviation.
type Limit = (Option<f64>, Option<([f64; 2], f64)>, Option<f64>);

fn limits((radius, sector, deviation): Limit) -> Limits {
    let sector = sector.map(|([x, y], angle)| Sector { direction: Point2::new(x, y), angle });
    Limits { radius, sector, deviation }
}

/// Isovists of points.
#[pyfunction]
#[pyo3(signature = (plan, eyes, limit, outlines, threads, progress=None))]
pub(crate) fn isovists_of(
    py: Python<'_>,
    plan: &Plan,
    eyes: PyReadonlyArray2<'_, f64>,
    limit: Option<Limit>,
    outlines: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Isovists> {
    let eyes = points(&eyes, "points")?;
    let limits = limit.map(limits);
    let done = long::run(py, progress.as_ref(), |observer| {
        let prepared = plan.prepared().map_err(Failed::Mesh)?;
        on_threads(threads, || isovists(prepared, &eyes, limits.as_ref(), outlines, observer))
    })?;
    Ok(done?)
}

/// The isovist of one point: on this thread, as it is over at once.
#[pyfunction]
#[pyo3(signature = (plan, eye, limit))]
pub(crate) fn isovist_of(
    py: Python<'_>,
    plan: &Plan,
    eye: PyReadonlyArray2<'_, f64>,
    limit: Option<Limit>,
) -> PyResult<Isovists> {
    let eyes = points(&eye, "point")?;
    let limits = limit.map(limits);
    let silent = |_| std::ops::ControlFlow::Continue(());
    let done = py.detach(|| {
        guarded(|| {
            let prepared = plan.prepared().map_err(Failed::Mesh)?;
            isovists(prepared, &eyes, limits.as_ref(), true, &silent)
        })
    })?;
    Ok(done?)
}

/// Whether the points of two lists see each other, pair by pair.
#[pyfunction]
#[pyo3(signature = (plan, a, b, passes, threads, progress=None))]
pub(crate) fn sees<'py>(
    py: Python<'py>,
    plan: &Plan,
    a: PyReadonlyArray2<'py, f64>,
    b: PyReadonlyArray2<'py, f64>,
    passes: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let [a, b] = [points(&a, "a")?, points(&b, "b")?];
    if a.len() != b.len() {
        return Err(value_error(format!("{} points and {} points are no pairs", a.len(), b.len())));
    }
    let all = a.iter().chain(&b).copied();
    let work = |observer: &dyn Observer| {
        plan.mesh_around(all.clone(), |mesh| {
            let one = |k: usize| mesh.sees(a[k], b[k], touch(passes)).map_err(|failure| Failed::Eye(k, failure));
            if a.len() <= CHUNK {
                return (0..a.len()).map(one).collect::<Result<Vec<bool>, Failed>>();
            }
            let counter = Counter::new(Some(observer), "pairs", a.len().div_ceil(CHUNK));
            let chunk = |k: usize| {
                counter.check()?;
                let pairs = k * CHUNK..((k + 1) * CHUNK).min(a.len());
                let seen = pairs.map(one).collect::<Result<Vec<bool>, Failed>>()?;
                counter.step()?;
                Ok(seen)
            };
            let n = a.len().div_ceil(CHUNK);
            let parts: Vec<Result<Vec<bool>, Failed>> =
                on_threads(threads, || (0..n).into_par_iter().map(chunk).collect());
            Ok(parts.into_iter().collect::<Result<Vec<_>, Failed>>()?.concat())
        })
    };
    let seen = if a.len() <= CHUNK {
        let silent = |_| std::ops::ControlFlow::Continue(());
        py.detach(|| guarded(|| work(&silent)))?
    } else {
        long::run(py, progress.as_ref(), work)?
    };
    Ok(seen?.into_pyarray(py))
}

/// Which points see which: a matrix.
#[pyfunction]
#[pyo3(signature = (plan, at, passes, threads, progress=None))]
pub(crate) fn sees_each<'py>(
    py: Python<'py>,
    plan: &Plan,
    at: PyReadonlyArray2<'py, f64>,
    passes: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray2<bool>>> {
    let at = points(&at, "points")?;
    let n = at.len();
    let mut flags: Vec<bool> = room(n, n)?;
    let done = long::run(py, progress.as_ref(), |observer| {
        plan.mesh_around(at.iter().copied(), |mesh| {
            // Which point is refused is not told: all have been checked but for their magnitude.
            let index = mesh.index(&at).map_err(|failure| Failed::Eye(0, failure))?;
            let counter = Counter::new(Some(observer), "points", n);
            let one = |seen: &mut Vec<u32>, (eye, row): (u32, &mut [bool])| {
                counter.check()?;
                mesh.points_seen(eye, &index, touch(passes), seen);
                seen.iter().for_each(|&other| row[other as usize] = true);
                counter.step()
            };
            on_threads(threads, || {
                let rows = (0..n as u32).into_par_iter().zip(flags.par_chunks_mut(n.max(1)));
                rows.map_init(Vec::new, one).collect::<Result<(), Cancelled>>()
            })?;
            Ok(())
        })
    })?;
    done?;
    matrix(py, flags, [n, n])
}
