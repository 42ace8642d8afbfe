//! From errors of the libraries to exceptions.

use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use pyo3::{PyErr, PyResult, create_exception};
use sightlines_bake::BakeableError;
use sightlines_formats::error::ReadErrorKind;
use sightlines_formats::{ReadError, WriteError};
use std::fmt::Display;
use std::io;
use std::path::Path;

create_exception!(
    sightlines,
    Error,
    pyo3::exceptions::PyException,
    "A file is damaged or holds something else, a scene cannot be baked, or a limit was met. Arguments that no call accepts are a \
     ValueError, and files that cannot be opened an OSError."
);

/// What a library refuses, in its words.
pub(crate) fn error(why: impl Display) -> PyErr {
    Error::new_err(why.to_string())
}

/// An argument that cannot be used.
pub(crate) fn value_error(why: impl Display) -> PyErr {
    PyValueError::new_err(why.to_string())
}

/// An `OSError` with number, reason and file, of which Python makes `FileNotFoundError` and its like.
fn os_error(path: &Path, source: &io::Error) -> PyErr {
    let name = path.display().to_string();
    match source.raw_os_error() {
        Some(number) => {
            // Python adds the number itself.
            let text = source.to_string();
            let why = text.split(" (os error").next().unwrap_or(&text).to_owned();
            PyOSError::new_err((number, why, name))
        }
        None => PyOSError::new_err(format!("{name}: {source}")),
    }
}

pub(crate) fn read_failed(failure: &ReadError) -> PyErr {
    match &failure.kind {
        ReadErrorKind::Io(source) => os_error(&failure.path, source),
        _ => error(failure),
    }
}

/// Why the file `name` is not baked; all other errors of reading name it themselves.
pub(crate) fn bakeable_failed(name: &Path, failure: &BakeableError) -> PyErr {
    match failure {
        BakeableError::Read(failure) => read_failed(failure),
        BakeableError::Kind => error(format_args!("{}: {failure}", name.display())),
        _ => error(failure),
    }
}

pub(crate) fn write_failed(failure: &WriteError) -> PyErr {
    os_error(&failure.path, &failure.source)
}

pub(crate) fn file_failed(path: &Path, source: &io::Error) -> PyErr {
    os_error(path, source)
}

/// Room for `rows` times `columns` values, all of them the default one.
///
/// # Errors
/// `MemoryError`, where `vec!` would end the process.
pub(crate) fn room<T: Clone + Default>(rows: usize, columns: usize) -> PyResult<Vec<T>> {
    let n = rows.checked_mul(columns);
    let mut all = Vec::new();
    match n.map(|n| all.try_reserve_exact(n)) {
        Some(Ok(())) => {
            all.resize(rows * columns, T::default());
            Ok(all)
        }
        _ => Err(PyMemoryError::new_err(format!("there is no memory for {rows} times {columns} values"))),
    }
}
