//! Arrays of numpy: points and ids in, matrices out.

use crate::error::{error, value_error};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sightlines_pvs::TriangleRange;
use std::fmt::Display;

/// An array of ids, as numpy likes indices.
pub(crate) type Ids<'py> = Bound<'py, PyArray1<i64>>;

/// Rows of `D` numbers. They are copied: Python may change the array while other threads read it.
///
/// # Errors
/// `ValueError` for another number of columns, for rows that are not contiguous, and for what is not finite.
pub(crate) fn rows<const D: usize>(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<[f64; D]>> {
    let [n, columns] = [0, 1].map(|k| array.shape()[k]);
    if columns != D {
        return Err(value_error(format!("{what}: an array of shape ({n}, {columns}), where (n, {D}) is expected")));
    }
    let flat = array.as_slice().map_err(|_| value_error(format!("{what}: the array is not contiguous")))?;
    let (rows, _) = flat.as_chunks::<D>();
    match rows.iter().position(|row| !row.iter().all(|x| x.is_finite())) {
        Some(row) => Err(value_error(format!("{what}: row {row} has a coordinate that is not finite"))),
        None => Ok(rows.to_vec()),
    }
}

/// An array of ids. O(n), without a copy.
pub(crate) fn ids(py: Python<'_>, ids: impl IntoIterator<Item = u32>) -> Ids<'_> {
    ids.into_iter().map(i64::from).collect::<Vec<_>>().into_pyarray(py)
}

/// A matrix of its rows, one after the other; not copied.
pub(crate) fn matrix<T: numpy::Element>(
    py: Python<'_>,
    flat: Vec<T>,
    [rows, columns]: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<T>>> {
    flat.into_pyarray(py).reshape([rows, columns])
}

/// The same with three axes.
pub(crate) fn cube<T: numpy::Element>(
    py: Python<'_>,
    flat: Vec<T>,
    shape: [usize; 3],
) -> PyResult<Bound<'_, PyArray3<T>>> {
    flat.into_pyarray(py).reshape(shape)
}

/// Runs what may panic only by a bug of ours, and makes an exception of that.
pub(crate) fn guarded<T>(what: impl FnOnce() -> T) -> PyResult<T> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(what)).map_err(|panic| bug(&*panic))
}

/// What a panic said, as an exception.
pub(crate) fn bug(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let said: &dyn Display = match (panic.downcast_ref::<String>(), panic.downcast_ref::<&str>()) {
        (Some(text), _) => text,
        (_, Some(text)) => text,
        _ => &"no reason was given",
    };
    error(format!("this is a defect of sightlines, please report it: {said}"))
}

/// Ranges of triangles of objects, three numbers each: the object, its first triangle, and the one behind the last; -1 for all of it.
pub(crate) fn ranges(py: Python<'_>, ranges: Vec<TriangleRange>) -> Ids<'_> {
    let of = |(object, range): TriangleRange| {
        let [start, end] = range.map_or([0, -1], |range| [range.start, range.end].map(i64::from));
        [i64::from(object.0), start, end]
    };
    ranges.into_iter().flat_map(of).collect::<Vec<i64>>().into_pyarray(py)
}
