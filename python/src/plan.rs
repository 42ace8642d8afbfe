//! Plans: walls in the plane.

use crate::arrays::{cube, rows};
use crate::bake::{Said, baked, said_of};
use crate::error::{bakeable_failed, error, read_failed, value_error};
use crate::long;
use crate::table::Table;
use numpy::{PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use sightlines_bake::{BakeError, Bakeable, Gap, PlanBakeOptions, Subdivide, bake_plan};
use sightlines_cells::PlanLine;
use sightlines_formats::input::read_plan_file;
use sightlines_formats::{PlanReadOptions, Source, detect_file, geojson};
use sightlines_geometry::Point2;
use sightlines_isovist::{MeshError, WallMesh};
use std::path::PathBuf;
use std::sync::OnceLock;

/// What a file states beside its plan: the reference system as JSON, the names of layers, and what a user should hear.
type Stated = (Option<String>, Vec<String>, Vec<String>);

/// A plan prepared for questions about points.
pub(crate) struct Prepared {
    pub(crate) mesh: WallMesh,
    /// For each line of the plan its number among the walls, which are the lines that block sight; -1 for the others.
    pub(crate) wall_numbers: Vec<i64>,
}

impl Prepared {
    fn new(plan: &sightlines_cells::Plan) -> Result<Self, MeshError> {
        let mut next = 0..;
        let number = |line: &PlanLine| if line.opaque { next.next().unwrap_or(-1) } else { -1 };
        Ok(Self { mesh: WallMesh::new(plan)?, wall_numbers: plan.lines().iter().map(number).collect() })
    }
}

/// Walls in the plane, checked.
#[pyclass(frozen, module = "sightlines._native")]
pub(crate) struct Plan {
    pub(crate) plan: sightlines_cells::Plan,
    /// Prepared for questions about points, once there is one.
    prepared: OnceLock<Result<Prepared, MeshError>>,
}

impl From<sightlines_cells::Plan> for Plan {
    fn from(plan: sightlines_cells::Plan) -> Self {
        Self { plan, prepared: OnceLock::new() }
    }
}

impl Plan {
    /// The plan prepared for questions about points; made once.
    pub(crate) fn prepared(&self) -> Result<&Prepared, MeshError> {
        self.prepared.get_or_init(|| Prepared::new(&self.plan)).as_ref().map_err(Clone::clone)
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

    /// Of a file with a plan, or with maps of Doom; with what else the file states.
    #[staticmethod]
    #[pyo3(signature = (path, map=None, layers=None, deviation=None))]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        map: Option<&str>,
        layers: Option<Vec<String>>,
        deviation: Option<f64>,
    ) -> PyResult<(Self, Stated)> {
        if let Some(x) = deviation.filter(|x| !(x.is_finite() && *x > 0.0)) {
            return Err(value_error(format!("deviation is {x}, where a finite number above 0 is expected")));
        }
        let options = PlanReadOptions { layers, deviation };
        py.detach(|| {
            let format = detect_file(&path).map_err(|failure| read_failed(&failure))?;
            if format.is_none_or(|format| ["dxf", "geojson"].contains(&format.name)) {
                let file = read_plan_file(&path, &options).map_err(|failure| read_failed(&failure))?;
                return Ok((Self::from(file.plan), (file.crs, file.layers, file.warnings)));
            }
            match Bakeable::read(&Source::File(&path), map).map_err(|failure| bakeable_failed(&path, &failure))? {
                Bakeable::Plan { plan, .. } => Ok((Self::from(plan), Stated::default())),
                _ => {
                    Err(error(format!("{}: this is no plan: use sightlines.bake for scenes in space", path.display())))
                }
            }
        })
    }

    /// The same plan with ends of walls joined to others within a gap; without one, within what digits explain. It is new only if that makes a
    /// difference.
    #[pyo3(signature = (gap=None))]
    fn joined(slf: Bound<'_, Self>, gap: Option<f64>) -> PyResult<Bound<'_, Self>> {
        let plan = &slf.get().plan;
        let joined = slf.py().detach(|| gap.map_or(Gap::OfFile, Gap::Width).join(plan)).map_err(value_error)?;
        joined.map_or_else(|| Ok(slf.clone()), |joined| Bound::new(slf.py(), Self::from(joined)))
    }

    /// Openings up to this width are closed.
    fn gap(&self) -> f64 {
        self.plan.gap()
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
