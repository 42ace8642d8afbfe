//! Plans: walls in the plane.

use crate::arrays::{cube, rows};
use crate::bake::{Said, baked, said_of};
use crate::error::{bakeable_failed, error, value_error};
use crate::long;
use crate::table::Table;
use numpy::{PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use sightlines_bake::{BakeError, Bakeable, PlanBakeOptions, Subdivide, bake_plan};
use sightlines_formats::{Source, geojson};
use sightlines_geometry::Point2;
use sightlines_isovist::{MeshError, WallMesh};
use std::path::PathBuf;
use std::sync::OnceLock;

/// Walls in the plane, checked.
#[pyclass(frozen, module = "sightlines._native")]
pub(crate) struct Plan {
    pub(crate) plan: sightlines_cells::Plan,
    /// Prepared for questions about points, once there is one.
    pub(crate) mesh: OnceLock<Result<WallMesh, MeshError>>,
}

impl From<sightlines_cells::Plan> for Plan {
    fn from(plan: sightlines_cells::Plan) -> Self {
        Self { plan, mesh: OnceLock::new() }
    }
}

#[pymethods]
impl Plan {
    /// Of walls: x and y of both ends in each row.
    #[staticmethod]
    fn from_walls(py: Python<'_>, walls: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let walls = rows::<4>(&walls, "walls")?;
        py.detach(|| {
            let ends = walls.iter().map(|&[ax, ay, bx, by]| (Point2::new(ax, ay), Point2::new(bx, by)));
            sightlines_cells::Plan::from_walls(ends).map(Self::from).map_err(value_error)
        })
    }

    /// Of a text of GeoJSON.
    #[staticmethod]
    fn from_geojson(py: Python<'_>, text: &str) -> PyResult<Self> {
        py.detach(|| geojson::parse_plan(text.as_bytes()).map(Self::from).map_err(value_error))
    }

    /// Of a file with a plan, or with maps of Doom.
    #[staticmethod]
    #[pyo3(signature = (path, map=None))]
    fn from_file(py: Python<'_>, path: PathBuf, map: Option<&str>) -> PyResult<Self> {
        let read = py.detach(|| Bakeable::read(&Source::File(&path), map));
        match read.map_err(|failure| bakeable_failed(&failure))? {
            Bakeable::Plan { plan, .. } => Ok(Self::from(plan)),
            _ => Err(error(format!("{}: this is no plan but a scene in space: use sightlines.bake", path.display()))),
        }
    }

    /// The walls, those that do not block sight left out: shape (n, 2, 2).
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let walls = self.plan.lines().iter().filter(|line| line.opaque);
        let flat: Vec<f64> = walls.flat_map(|line| [line.a.x, line.a.y, line.b.x, line.b.y]).collect();
        let n = flat.len() / 4;
        cube(py, flat, [n, 2, 2])
    }

    /// Names of objects.
    fn object_names(&self) -> Vec<&str> {
        self.plan.objects().iter().map(|object| object.name.as_str()).collect()
    }

    /// The plan as GeoJSON.
    fn to_geojson(&self) -> String {
        geojson::write_plan(&self.plan)
    }

    /// Number of lines, whether or not they block sight.
    fn n_lines(&self) -> usize {
        self.plan.lines().len()
    }

    /// Makes the table.
    #[pyo3(signature = (subdivide, threads, progress=None))]
    fn bake(
        &self,
        py: Python<'_>,
        subdivide: &str,
        threads: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Table, Said)> {
        let subdivide: Subdivide = subdivide.parse().map_err(value_error)?;
        let plan = &self.plan;
        let result = long::run(py, progress.as_ref(), |observer| {
            let options =
                PlanBakeOptions { subdivide, threads, progress: Some(observer), ..PlanBakeOptions::default() };
            let done = bake_plan(plan, &options)?.into_any();
            Ok::<_, BakeError>((said_of(&done), done))
        })?;
        baked(result)
    }
}
