//! Tables: read, written, asked.

use crate::arrays::{Ids, cube, guarded, ids, matrix, ranges, rows};
use crate::error::{error, file_failed, read_failed, room, value_error, write_failed};
use crate::explain::{Explanation, explain};
use crate::relevance::Reaches;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sightlines_bake::{TableGraph, from_table, stated_reading};
use sightlines_formats::atomic_write;
use sightlines_formats::scene::read_scene_with;
use sightlines_packed::{PackOptions, Packed, pack};
use sightlines_pvs::{Axis, CellId, Inside, ObjectId, Place, PlaceBuffer};
use std::path::PathBuf;
use std::sync::OnceLock;

/// A table, and the cells and portals that it was made of, once they are asked for.
#[pyclass(frozen, module = "sightlines._native")]
pub(crate) struct Table {
    table: sightlines_pvs::Table,
    graph: OnceLock<Option<TableGraph>>,
}

impl From<sightlines_pvs::Table> for Table {
    fn from(table: sightlines_pvs::Table) -> Self {
        Self { table, graph: OnceLock::new() }
    }
}

/// Bytes of blocks that are kept while a table is unpacked: each is read many times in a row.
const UNPACK_CACHE: usize = 64 << 20;

fn decode(bytes: &[u8]) -> Result<sightlines_pvs::Table, String> {
    if bytes.starts_with(&sightlines_packed::format::MAGIC) {
        let packed = Packed::open(bytes.to_vec(), UNPACK_CACHE).map_err(|failure| failure.to_string())?;
        return packed.to_table().map_err(|failure| failure.to_string());
    }
    sightlines_pvs::Table::from_bytes(bytes).map_err(|failure| failure.to_string())
}

/// Rows of flags for many eyes, and whether each eye is in a cell.
type Seen<'py> = (Bound<'py, PyArray2<bool>>, Bound<'py, PyArray1<bool>>);

/// Corners and which corners belong to which cell: the first of cell k is `starts[k]`.
type Polygons<'py> = (Bound<'py, PyArray2<f64>>, Ids<'py>);

impl Table {
    /// A table that was just made, with its graph.
    pub(crate) fn with_graph(table: sightlines_pvs::Table, graph: TableGraph) -> Self {
        let made = Self::from(table);
        // It was empty.
        let _ = made.graph.set(Some(graph));
        made
    }

    fn encode(&self, packed: bool) -> PyResult<Vec<u8>> {
        if packed { pack(&self.table, &PackOptions::default()).map_err(error) } else { Ok(self.table.to_bytes()) }
    }

    fn cell(&self, id: i64) -> PyResult<CellId> {
        let n = self.table.n_cells();
        let found = u32::try_from(id).ok().filter(|&id| (id as usize) < n);
        found.map(CellId).ok_or_else(|| PyIndexError::new_err(format!("cell {id} of {n}")))
    }

    /// Points with as many coordinates as the table has, filled up with zeros.
    fn eyes(&self, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<[f64; 3]>> {
        if self.table.dimension() == 2 {
            Ok(rows::<2>(array, "eyes")?.into_iter().map(|[x, y]| [x, y, 0.0]).collect())
        } else {
            rows::<3>(array, "eyes")
        }
    }

    fn eye(&self, eye: &[f64]) -> PyResult<[f64; 3]> {
        let d = usize::from(self.table.dimension());
        if eye.len() != d {
            return Err(value_error(format!("a point of {} coordinates, where {d} are expected", eye.len())));
        }
        if !eye.iter().all(|x| x.is_finite()) {
            return Err(value_error("a coordinate of the point is not finite"));
        }
        Ok(std::array::from_fn(|k| eye.get(k).copied().unwrap_or(0.0)))
    }

    /// For each eye a row of `columns` flags, set by `mark`.
    fn seen<'py>(
        &self,
        py: Python<'py>,
        eyes: &PyReadonlyArray2<'_, f64>,
        columns: usize,
        mark: impl Fn(&Inside<'_>, &mut [bool]) + Sync,
    ) -> PyResult<Seen<'py>> {
        let eyes = self.eyes(eyes)?;
        let mut flags: Vec<bool> = room(eyes.len(), columns)?;
        let inside: Vec<bool> = py.detach(|| {
            guarded(|| {
                let mut buffer = PlaceBuffer::new();
                let place = |(k, eye): (usize, &[f64; 3])| match self.table.place_at_with(*eye, &mut buffer) {
                    Place::Outside => false,
                    Place::Inside(here) => {
                        mark(&here, &mut flags[k * columns..(k + 1) * columns]);
                        true
                    }
                };
                eyes.iter().enumerate().map(place).collect()
            })
        })?;
        Ok((matrix(py, flags, [eyes.len(), columns])?, inside.into_pyarray(py)))
    }

    /// Boxes as an array (n, 2, dimension).
    fn boxes<'py>(
        &self,
        py: Python<'py>,
        boxes: impl Iterator<Item = [[f64; 3]; 2]>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let d = usize::from(self.table.dimension());
        let flat: Vec<f64> = boxes.flatten().flat_map(|p| p.into_iter().take(d)).collect();
        let n = flat.len() / (2 * d);
        cube(py, flat, [n, 2, d])
    }
}

#[pymethods]
impl Table {
    /// Of the bytes of a file, plain or packed.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        py.detach(|| decode(bytes)).map(Self::from).map_err(error)
    }

    /// From a file, plain or packed.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| {
            let bytes = std::fs::read(&path).map_err(|failure| file_failed(&path, &failure))?;
            decode(&bytes).map(Self::from).map_err(|failure| error(format!("{}: {failure}", path.display())))
        })
    }

    /// The bytes of a file.
    fn to_bytes<'py>(&self, py: Python<'py>, packed: bool) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.encode(packed))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes a file beside the old one, which it then replaces.
    fn save(&self, py: Python<'_>, path: PathBuf, packed: bool) -> PyResult<()> {
        py.detach(|| atomic_write(&path, &self.encode(packed)?).map_err(|failure| write_failed(&failure)))
    }

    #[getter]
    fn dimension(&self) -> u8 {
        self.table.dimension()
    }

    #[getter]
    fn n_cells(&self) -> usize {
        self.table.n_cells()
    }

    #[getter]
    fn n_objects(&self) -> usize {
        self.table.objects().len()
    }

    #[getter]
    fn kind(&self) -> String {
        self.table.kind().to_string()
    }

    #[getter]
    fn up(&self) -> Option<&'static str> {
        self.table.up().map(|axis| match axis {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
        })
    }

    #[getter]
    fn has_places(&self) -> bool {
        self.table.has_places()
    }

    #[getter]
    fn info(&self) -> Vec<(String, String)> {
        self.table.info().to_vec()
    }

    /// When bodies in its cells could see each other.
    fn reaches(
        &self,
        py: Python<'_>,
        ladder: Vec<f64>,
        one_moves: bool,
        by_walking: bool,
        threads: usize,
    ) -> PyResult<Reaches> {
        py.detach(|| Reaches::find(self.table.clone(), ladder, one_moves, by_walking, threads))
    }

    /// The same of a file.
    fn load_reaches(&self, py: Python<'_>, path: PathBuf) -> PyResult<Reaches> {
        py.detach(|| Reaches::read(self.table.clone(), &path))
    }

    /// The axes of the table's frame, one in each row.
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(frame) = self.table.frame() else { return Ok(None) };
        let unit = |k: usize| std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 });
        let flat = (0..3).flat_map(|k| frame.to_scene(unit(k))).collect();
        matrix(py, flat, [3, 3]).map(Some)
    }

    fn object_names(&self) -> Vec<&str> {
        self.table.objects().iter().map(|object| object.name.as_str()).collect()
    }

    fn object_bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.boxes(py, self.table.objects().iter().map(|object| [object.min, object.max]))
    }

    fn cell_bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.boxes(py, self.table.cells().iter().map(|cell| [cell.min, cell.max]))
    }

    fn cell_names(&self) -> Option<Vec<&str>> {
        let names = (0..).take(self.table.n_cells()).map(CellId).map(|cell| self.table.cell_name(cell));
        names.collect()
    }

    /// The group of each cell; -1 for none.
    fn cell_groups<'py>(&self, py: Python<'py>) -> Ids<'py> {
        let groups = self.table.cells().iter().map(|cell| cell.group.map_or(-1, i64::from));
        groups.collect::<Vec<_>>().into_pyarray(py)
    }

    /// The corners of all cells of a plan, one cell after the other.
    fn polygons<'py>(&self, py: Python<'py>) -> PyResult<Polygons<'py>> {
        let (mut corners, mut starts) = (Vec::new(), vec![0]);
        for cell in self.table.cells() {
            corners.extend(cell.polygon.iter().flatten());
            starts.push((corners.len() / 2) as i64);
        }
        let n = corners.len() / 2;
        Ok((matrix(py, corners, [n, 2])?, starts.into_pyarray(py)))
    }

    /// The two cells of each portal.
    fn portal_cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let flat: Vec<i64> =
            self.table.portals().iter().flat_map(|portal| portal.cells.map(|cell| i64::from(cell.0))).collect();
        let n = flat.len() / 2;
        matrix(py, flat, [n, 2])
    }

    /// The corners of all portals, one portal after the other.
    fn portal_points<'py>(&self, py: Python<'py>) -> PyResult<Polygons<'py>> {
        let d = usize::from(self.table.dimension());
        let (mut corners, mut starts) = (Vec::new(), vec![0]);
        for portal in self.table.portals() {
            corners.extend(portal.points.iter().flat_map(|p| p.iter().take(d)));
            starts.push((corners.len() / d) as i64);
        }
        let n = corners.len() / d;
        Ok((matrix(py, corners, [n, d])?, starts.into_pyarray(py)))
    }

    /// Whether cell `a` may see cell `b`.
    fn sees(&self, a: i64, b: i64) -> PyResult<bool> {
        Ok(self.table.sees(self.cell(a)?, self.cell(b)?))
    }

    /// The same for many pairs.
    fn sees_many<'py>(
        &self,
        py: Python<'py>,
        a: PyReadonlyArray1<'_, i64>,
        b: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let pairs = a.as_array().into_iter().copied().zip(b.as_array().into_iter().copied());
        let seen: Vec<bool> = pairs.map(|(a, b)| self.sees(a, b)).collect::<PyResult<_>>()?;
        Ok(seen.into_pyarray(py))
    }

    /// Whether the cells at each point may see those at another; true where one is outside.
    fn sees_points<'py>(
        &self,
        py: Python<'py>,
        a: PyReadonlyArray2<'_, f64>,
        b: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let [a, b] = [self.eyes(&a)?, self.eyes(&b)?];
        let seen: Vec<bool> = py.detach(|| {
            let mut buffers = [PlaceBuffer::new(), PlaceBuffer::new()];
            let sees = |(p, q): (&[f64; 3], &[f64; 3])| {
                let [one, other] = &mut buffers;
                let ends = [self.table.cells_at(*p, one), self.table.cells_at(*q, other)];
                let [Place::Inside(from), Place::Inside(to)] = ends else { return true };
                from.iter().any(|&a| to.iter().any(|&b| self.table.sees(a, b)))
            };
            a.iter().zip(&b).map(sees).collect()
        });
        Ok(seen.into_pyarray(py))
    }

    /// The cells that a cell may see.
    fn seen_by_cell<'py>(&self, py: Python<'py>, cell: i64) -> PyResult<Ids<'py>> {
        let cell = self.cell(cell)?;
        Ok(ids(py, self.table.visible(cell).map(|cell| cell.0)))
    }

    /// The objects that a cell may see.
    fn objects_seen_by_cell<'py>(&self, py: Python<'py>, cell: i64) -> PyResult<Ids<'py>> {
        let cell = self.cell(cell)?;
        Ok(ids(py, self.table.visible_objects(cell).into_iter().map(|object| object.0)))
    }

    /// What a cell may see, as triples of an object, its first triangle, and the one behind the last; -1 for all of it.
    fn ranges_seen_by_cell<'py>(&self, py: Python<'py>, cell: i64) -> PyResult<Ids<'py>> {
        Ok(ranges(py, self.table.visible_ranges(self.cell(cell)?)))
    }

    /// The same of a point; none outside.
    fn ranges_from<'py>(&self, py: Python<'py>, eye: Vec<f64>) -> PyResult<Option<Ids<'py>>> {
        let eye = self.eye(&eye)?;
        Ok(self.table.place_at(eye).inside().map(|here| ranges(py, here.visible_ranges())))
    }

    /// The objects that touch a cell.
    fn objects_of_cell<'py>(&self, py: Python<'py>, cell: i64) -> PyResult<Ids<'py>> {
        let cell = self.cell(cell)?;
        Ok(ids(py, self.table.objects_of(cell).iter().map(|object| object.0)))
    }

    /// Which cells see which: shape (n, n).
    fn visibility<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let n = self.table.n_cells();
        let mut flags: Vec<bool> = room(n, n)?;
        py.detach(|| {
            for (cell, row) in (0..).map(CellId).zip(flags.chunks_exact_mut(n.max(1))) {
                self.table.visible(cell).for_each(|other| row[other.idx()] = true);
            }
        });
        matrix(py, flags, [n, n])
    }

    /// Of all pairs of different cells, the share that may see each other.
    #[getter]
    fn visible_share(&self) -> f64 {
        self.table.mean_visible_share()
    }

    /// How many cells each cell sees, itself included.
    fn counts<'py>(&self, py: Python<'py>) -> Ids<'py> {
        let counts = py.detach(|| {
            let ones = |cell: u32| self.table.row(CellId(cell)).iter().map(|word| i64::from(word.count_ones())).sum();
            (0..).take(self.table.n_cells()).map(ones).collect::<Vec<i64>>()
        });
        counts.into_pyarray(py)
    }

    /// The cells that contain a point.
    fn cells_at<'py>(&self, py: Python<'py>, eye: Vec<f64>) -> PyResult<Ids<'py>> {
        let eye = self.eye(&eye)?;
        Ok(ids(py, self.table.place_at(eye).cells().iter().map(|cell| cell.0)))
    }

    /// The cells that may be seen from a point; none outside.
    fn cells_from<'py>(&self, py: Python<'py>, eye: Vec<f64>) -> PyResult<Option<Ids<'py>>> {
        let eye = self.eye(&eye)?;
        Ok(self.table.place_at(eye).inside().map(|here| ids(py, here.visible_cells().map(|cell| cell.0))))
    }

    /// The objects that may be seen from a point; none outside.
    fn objects_from<'py>(&self, py: Python<'py>, eye: Vec<f64>) -> PyResult<Option<Ids<'py>>> {
        let eye = self.eye(&eye)?;
        let seen = self.table.place_at(eye).inside().map(|here| here.visible_objects());
        Ok(seen.map(|seen| ids(py, seen.into_iter().map(|ObjectId(object)| object))))
    }

    /// The cells that may be seen from many points.
    fn cells_from_many<'py>(&self, py: Python<'py>, eyes: PyReadonlyArray2<'_, f64>) -> PyResult<Seen<'py>> {
        self.seen(py, &eyes, self.table.n_cells(), |here, row| {
            here.visible_cells().for_each(|cell| row[cell.idx()] = true);
        })
    }

    /// The objects that may be seen from many points.
    fn objects_from_many<'py>(&self, py: Python<'py>, eyes: PyReadonlyArray2<'_, f64>) -> PyResult<Seen<'py>> {
        self.seen(py, &eyes, self.table.objects().len(), |here, row| {
            here.visible_objects().into_iter().for_each(|object| row[object.idx()] = true);
        })
    }

    /// Why one cell sees another, or why not; for cells without portals by the file of their scene, if that is given.
    #[pyo3(signature = (a, b, scene=None))]
    fn explain(&self, py: Python<'_>, a: i64, b: i64, scene: Option<PathBuf>) -> PyResult<Explanation> {
        let pair = [self.cell(a)?, self.cell(b)?];
        py.detach(|| {
            guarded(|| {
                let graph = self.graph.get_or_init(|| from_table::graph(&self.table));
                let read = |path: PathBuf| read_scene_with(path, &stated_reading(self.table.info()));
                let file = scene.map(read).transpose().map_err(|failure| read_failed(&failure))?;
                explain(&self.table, graph.as_ref(), file.as_ref().map(|file| &file.scene), pair).map_err(error)
            })
        })?
    }
}
