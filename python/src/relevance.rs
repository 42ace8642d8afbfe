//! When bodies that move could see each other.

use crate::arrays::{cube, guarded, matrix};
use crate::error::{error, file_failed, room, value_error, write_failed};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sightlines_formats::atomic_write;
use sightlines_geometry::Aabb;
use sightlines_pvs::CellId;
use sightlines_relevance::{Body, Player, PlayerRole, ReachOptions, Relevance, RelevanceOptions, Ways, WhoMoves};
use std::path::PathBuf;
use std::sync::Arc;

/// The reaches of a table, with the table.
#[pyclass(frozen, module = "sightlines._native")]
pub(crate) struct Reaches {
    table: Arc<sightlines_pvs::Table>,
    reaches: sightlines_relevance::Reaches,
}

impl Reaches {
    /// Finds them.
    pub(crate) fn find(
        table: sightlines_pvs::Table,
        ladder: Vec<f64>,
        one_moves: bool,
        by_walking: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let options = ReachOptions {
            ladder,
            movers: if one_moves { WhoMoves::One } else { WhoMoves::Both },
            ways: if by_walking { Ways::Portals } else { Ways::Straight },
            threads,
        };
        let reaches = guarded(|| sightlines_relevance::Reaches::of(&table, &options))?.map_err(value_error)?;
        Ok(Self { table: Arc::new(table), reaches })
    }

    /// Reads them.
    pub(crate) fn read(table: sightlines_pvs::Table, path: &PathBuf) -> PyResult<Self> {
        let bytes = std::fs::read(path).map_err(|failure| file_failed(path, &failure))?;
        let reaches = sightlines_relevance::Reaches::from_bytes(&bytes, &table)
            .map_err(|failure| error(format!("{}: {failure}", path.display())))?;
        Ok(Self { table: Arc::new(table), reaches })
    }
}

#[pymethods]
impl Reaches {
    #[getter]
    fn ladder<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.reaches.ladder().to_vec().into_pyarray(py)
    }

    #[getter]
    fn one_moves(&self) -> bool {
        self.reaches.movers() == WhoMoves::One
    }

    #[getter]
    fn by_walking(&self) -> bool {
        self.reaches.ways() == Ways::Portals
    }

    fn hidden_shares<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.reaches.hidden_shares().into_pyarray(py)
    }

    /// The rungs of all pairs of cells.
    fn rungs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        let n = self.reaches.n_cells();
        let mut rungs: Vec<u8> = room(n, n)?;
        py.detach(|| {
            for (i, row) in rungs.chunks_mut(n.max(1)).enumerate() {
                let rung = |j: usize| self.reaches.rung(CellId(i as u32), CellId(j as u32)) as u8;
                row.iter_mut().enumerate().for_each(|(j, to)| *to = rung(j));
            }
        });
        matrix(py, rungs, [n, n])
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| atomic_write(&path, &self.reaches.to_bytes()).map_err(|failure| write_failed(&failure)))
    }

    /// Who is shown to whom at each of some times, of bodies that are boxes around moving points.
    #[expect(clippy::too_many_arguments, reason = "Python names them all")]
    fn shown<'py>(
        &self,
        py: Python<'py>,
        positions: PyReadonlyArray3<'py, f64>,
        times: PyReadonlyArray1<'py, f64>,
        eyes: [[f64; 3]; 2],
        seen: [[f64; 3]; 2],
        reaches: PyReadonlyArray1<'py, f64>,
        arm: f64,
        hold: f64,
        looks: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray3<bool>>> {
        let [n_times, n, d] = [0, 1, 2].map(|k| positions.shape()[k]);
        let flat = positions.as_slice().map_err(value_error)?.to_vec();
        let (times, reaches) = (times.as_slice().map_err(value_error)?.to_vec(), reaches.as_slice()?.to_vec());
        let mut shown: Vec<bool> = room(n_times, n.saturating_mul(n))?;
        let around = |p: [f64; 3], [min, max]: [[f64; 3]; 2]| Aabb {
            min: std::array::from_fn(|k| p[k] + min[k]),
            max: std::array::from_fn(|k| p[k] + max[k]),
        };
        let usual = RelevanceOptions::of(&self.table);
        let options = RelevanceOptions { hold, looks: looks.unwrap_or(usize::MAX), ..usual };
        py.detach(|| {
            guarded(|| {
                let mut relevance = Relevance::new(Arc::clone(&self.table), self.reaches.clone(), options);
                let mut players: Vec<Player> = Vec::with_capacity(n);
                for (t, &now) in times.iter().enumerate() {
                    players.clear();
                    players.extend((0..n).map(|i| {
                        let at = &flat[(t * n + i) * d..][..d];
                        let p = std::array::from_fn(|k| at.get(k).copied().unwrap_or(0.0));
                        let body = Body { eyes: around(p, eyes), seen: around(p, seen), reach: reaches[i], arm };
                        Player { body, role: PlayerRole::ALONE }
                    }));
                    relevance.update(now, &players);
                    for to in 0..n {
                        let row = &mut shown[(t * n + to) * n..][..n];
                        relevance.shown_to(to as u32).for_each(|of| row[of as usize] = true);
                    }
                }
            })
        })?;
        cube(py, shown, [n_times, n, n])
    }
}
