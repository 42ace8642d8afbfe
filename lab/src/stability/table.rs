//! What was counted, as CSV.

use super::method::Kind;

/// First line of every file.
pub const HEADER: &str = "sweep,method,kind,parameter,cases,open,unsafe,loose,errors";

/// What one method answered at one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the sweep.
    pub sweep: String,
    /// Name of the method.
    pub method: String,
    /// What is expected of it.
    pub kind: Kind,
    /// The level.
    pub parameter: f64,
    /// Cases asked.
    pub cases: u64,
    /// Of them, those seen through an open set of lines.
    pub open: u64,
    /// Open ones that were called hidden.
    pub n_unsafe: u64,
    /// Hidden ones that were called seen.
    pub loose: u64,
    /// Cases without an answer.
    pub errors: u64,
}

/// What is wrong with a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The first line is not the header.
    #[error("line 1: the header is not `{HEADER}`")]
    Header,
    /// A line has another number of fields.
    #[error("line {line}: {found} fields instead of 9")]
    Fields {
        /// From 1.
        line: usize,
        /// How many it has.
        found: usize,
    },
    /// A field cannot be read.
    #[error("line {line}: {field} cannot be read")]
    Field {
        /// From 1.
        line: usize,
        /// Its name.
        field: &'static str,
    },
    /// Counts that contradict each other.
    #[error("line {0}: more failures than cases that can fail so")]
    Counts(usize),
}

/// Rows as CSV. Numbers are written so that they are read back as they are.
pub fn to_csv(rows: &[Row]) -> String {
    let line = |r: &Row| {
        let counts = [r.cases, r.open, r.n_unsafe, r.loose, r.errors].map(|n| n.to_string()).join(",");
        format!("{},{},{},{},{counts}\n", r.sweep, r.method, r.kind.name(), number(r.parameter))
    };
    std::iter::once(format!("{HEADER}\n")).chain(rows.iter().map(line)).collect()
}

/// A level as text: read back it is the same number.
pub fn number(x: f64) -> String {
    let (plain, short) = (format!("{x}"), format!("{x:e}"));
    if plain.len() <= 6 { plain } else { short }
}

/// Reads what [`to_csv`] wrote.
///
/// # Errors
/// [`TableError`] with the line.
pub fn from_csv(text: &str) -> Result<Vec<Row>, TableError> {
    let mut lines = text.lines();
    if lines.next() != Some(HEADER) {
        return Err(TableError::Header);
    }
    lines.enumerate().map(|(k, line)| row(k + 2, line)).collect()
}

fn row(line: usize, text: &str) -> Result<Row, TableError> {
    let fields: Vec<&str> = text.split(',').collect();
    let &[sweep, method, kind, parameter, cases, open, n_unsafe, loose, errors] = fields.as_slice() else {
        return Err(TableError::Fields { line, found: fields.len() });
    };
    let bad = |field| TableError::Field { line, field };
    let count = |text: &str, field| text.parse::<u64>().map_err(|_| bad(field));
    let row = Row {
        sweep: sweep.to_owned(),
        method: method.to_owned(),
        kind: Kind::ALL.into_iter().find(|k| k.name() == kind).ok_or(bad("kind"))?,
        parameter: parameter.parse().ok().filter(|x: &f64| x.is_finite()).ok_or(bad("parameter"))?,
        cases: count(cases, "cases")?,
        open: count(open, "open")?,
        n_unsafe: count(n_unsafe, "unsafe")?,
        loose: count(loose, "loose")?,
        errors: count(errors, "errors")?,
    };
    let fits = |sum: Option<u64>, all: u64| sum.is_some_and(|sum| sum <= all);
    let failures = row.n_unsafe.checked_add(row.loose).and_then(|n| n.checked_add(row.errors));
    let is_possible = row.open <= row.cases
        && row.n_unsafe <= row.open
        && row.loose <= row.cases - row.open
        && fits(failures, row.cases);
    if is_possible { Ok(row) } else { Err(TableError::Counts(line)) }
}
