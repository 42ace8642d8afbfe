//! Visibility graph analysis: the measures of space syntax on a grid of points.

use crate::arrays::{matrix, rows};
use crate::error::{error, value_error};
use crate::isovist::{Failed, touch};
use crate::long;
use crate::plan::Plan;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use sightlines_geometry::Point2;
use sightlines_progress::{Cancelled, Halt, Observer};
use sightlines_visibility_graph::{
    Analysis, AnalysisOptions, GraphError, GridError, Group, Measure, PixelGrid, Points, Turns, UNDEFINED,
    VisibilityGraph, WorkOptions,
};

/// What was computed: points (n, 2), values by name, and how many pairs see each other.
type Found<'py> = (Bound<'py, PyArray2<f64>>, Vec<(&'static str, Bound<'py, PyArray1<f64>>)>, u64);

/// Which measures, and how.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    measures: Vec<String>,
    radius: Option<u32>,
    metric_radius: Option<f64>,
    angular_radius: Option<f64>,
    turns_anywhere: bool,
    touching: bool,
    threads: usize,
}

enum Why {
    Grid(GridError),
    Graph(GraphError),
    Mesh(Failed),
}

impl From<Failed> for Why {
    fn from(failed: Failed) -> Self {
        Self::Mesh(failed)
    }
}

impl From<Cancelled> for Why {
    fn from(cancelled: Cancelled) -> Self {
        Self::Mesh(cancelled.into())
    }
}

impl From<Why> for PyErr {
    fn from(why: Why) -> Self {
        match why {
            Why::Grid(failure) => value_error(failure),
            Why::Graph(failure) => error(failure),
            Why::Mesh(failed) => failed.into(),
        }
    }
}

/// All measures: name, title, unit, group.
#[pyfunction]
pub(crate) fn vga_measures() -> Vec<(&'static str, &'static str, &'static str, &'static str)> {
    Measure::ALL.into_iter().map(|m| (m.name(), m.title(), m.unit(), m.group().name())).collect()
}

/// The measures with some names, or of some groups.
fn measures_named(names: &[String]) -> PyResult<Vec<Measure>> {
    let mut found = Vec::new();
    for name in names {
        let before = found.len();
        found.extend(Measure::ALL.into_iter().filter(|m| m.name() == name || m.group().name() == name));
        if found.len() == before {
            let groups = Group::ALL.map(Group::name).join(", ");
            return Err(value_error(format!("'{name}' is no measure and no group of them ({groups})")));
        }
    }
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

fn analyse(
    plan: &Plan,
    grid: (f64, Option<&[Point2]>),
    measures: &[Measure],
    options: &Options,
    observer: &dyn Observer,
) -> Result<(Points, Analysis, u64), Why> {
    let (spacing, seeds) = grid;
    let grid = PixelGrid::over(&plan.plan, spacing).map_err(Why::Grid)?;
    let inside = || grid.interior().map(|interior| interior.points);
    let points = seeds.map_or_else(inside, |seeds| grid.fill(seeds)).map_err(Why::Grid)?;
    let at = points.coordinates();
    let effort = WorkOptions { threads: options.threads, observer: Some(observer), ..WorkOptions::default() };
    let graph = plan.mesh_around(at.iter().copied(), |mesh| {
        let index = mesh.index(at).map_err(|failure| Failed::Eye(0, failure))?;
        let seen = |eye: u32, list: &mut Vec<u32>| mesh.points_seen(eye, &index, touch(options.touching), list);
        Ok(VisibilityGraph::build(at.len() as u32, seen, &effort))
    })?;
    let graph = graph.map_err(|failure| match failure {
        GraphError::Cancelled(cancelled) => cancelled.into(),
        other => Why::Graph(other),
    })?;
    let n_pairs = (0..at.len() as u32).map(|point| u64::from(graph.n_seen(point))).sum::<u64>() / 2;
    let turns = if options.turns_anywhere { Turns::Anywhere } else { Turns::NearWalls };
    let &Options { radius, metric_radius, angular_radius, .. } = options;
    let analysis_options = AnalysisOptions { radius, metric_radius, angular_radius, turns };
    let analysis = Analysis::of(&graph, &points, measures, &analysis_options, &effort).map_err(Halt::without_store)?;
    Ok((points, analysis, n_pairs))
}

/// Measures of the points of a grid; NaN where a measure has no value.
#[pyfunction]
#[pyo3(signature = (plan, spacing, seeds, options, progress=None))]
pub(crate) fn vga<'py>(
    py: Python<'py>,
    plan: &Plan,
    spacing: f64,
    seeds: Option<PyReadonlyArray2<'py, f64>>,
    options: Options,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found<'py>> {
    for (name, x) in [("metric_radius", options.metric_radius), ("angular_radius", options.angular_radius)] {
        if let Some(x) = x.filter(|x| !(x.is_finite() && *x > 0.0)) {
            return Err(value_error(format!("{name} is {x}, where a finite number above 0 is expected")));
        }
    }
    let seeds = seeds.map(|seeds| rows::<2>(&seeds, "seeds")).transpose()?;
    let seeds: Option<Vec<Point2>> = seeds.map(|seeds| seeds.into_iter().map(Point2::from).collect());
    let measures = measures_named(&options.measures)?;
    let done = long::run(py, progress.as_ref(), |observer| {
        let (points, analysis, n_pairs) = analyse(plan, (spacing, seeds.as_deref()), &measures, &options, observer)?;
        let values = |measure: Measure| {
            let mut values = analysis.values(measure)?;
            values.iter_mut().filter(|x| **x == UNDEFINED).for_each(|x| *x = f64::NAN);
            Some((measure.name(), values))
        };
        let columns: Vec<_> = measures.iter().filter_map(|m| values(*m)).collect();
        Ok::<_, Why>((points, columns, n_pairs))
    })?;
    let (points, columns, n_pairs) = done?;
    let flat: Vec<f64> = points.coordinates().iter().flat_map(|p| [p.x, p.y]).collect();
    let columns = columns.into_iter().map(|(name, values)| (name, values.into_pyarray(py))).collect();
    Ok((matrix(py, flat, [points.len(), 2])?, columns, n_pairs))
}
