//! The whole of it: sweeps to CSV, CSV to pictures and a page, and whether all is as it must be.

use super::draw::svg;
use super::method::{Kind, Outcome};
use super::page::{Part, page, summary, sums};
use super::sweep::{Finding, Sweep};
use super::table::{Row, TableError, from_csv, to_csv};
use sightlines::formats::files::{WriteError, atomic_write};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What to do.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Folder of the page; CSV and pictures lie below it in `stability/`.
    pub out: PathBuf,
    /// Only sweeps with this in their name; the page is left alone then.
    pub only: Option<String>,
    /// Draw from the CSV files that are there; measure nothing.
    pub draw: bool,
    /// Print the first unsafe failure of methods with this in their name at each level, with all coordinates.
    pub show: Option<String>,
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// No sweep has that in its name.
    #[error("no sweep has `{0}` in its name")]
    NoSweep(String),
    /// A folder could not be made, or a file could not be read.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        #[source]
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A CSV file is not what this program writes.
    #[error("{}: {source}", path.display())]
    Table {
        /// Which.
        path: PathBuf,
        /// What is wrong.
        #[source]
        source: TableError,
    },
    /// There is nothing to draw in a CSV file.
    #[error("{}: there are no rows", .0.display())]
    Empty(PathBuf),
}

/// Measures and draws; returns what is to be printed, and complaints: an empty list is success.
///
/// # Errors
/// [`RunError`], with the file if there is one.
pub fn run(sweeps: &[Sweep], options: &Options) -> Result<(String, Vec<String>), RunError> {
    let chosen: Vec<&Sweep> =
        sweeps.iter().filter(|s| options.only.as_ref().is_none_or(|only| s.name.contains(only.as_str()))).collect();
    if chosen.is_empty() {
        return Err(RunError::NoSweep(options.only.clone().unwrap_or_default()));
    }
    let folder = options.out.join("stability");
    std::fs::create_dir_all(&folder).map_err(|source| RunError::File { path: folder.clone(), source })?;
    let (mut text, mut tables) = (String::new(), Vec::new());
    for sweep in &chosen {
        let path = folder.join(format!("{}.csv", sweep.name));
        if !options.draw {
            let start = Instant::now();
            let (rows, findings) = sweep.measure();
            eprintln!("{}: {:.1} s", sweep.name, start.elapsed().as_secs_f64());
            atomic_write(&path, to_csv(&rows).as_bytes())?;
            show(&mut text, sweep, &findings, options.show.as_deref());
        }
        // What is drawn is what was written.
        let rows = read(&path)?;
        let picture = svg(sweep.name, sweep.parameter, &rows).ok_or_else(|| RunError::Empty(path.clone()))?;
        atomic_write(path.with_extension("svg"), picture.as_bytes())?;
        tables.push(rows);
    }
    if options.only.is_none() {
        let parts: Vec<Part<'_>> = chosen
            .iter()
            .zip(&tables)
            .map(|(s, rows)| Part { name: s.name, about: s.about, parameter: s.parameter, rows })
            .collect();
        atomic_write(options.out.join("stability.md"), page(&parts).as_bytes())?;
    }
    let all = tables.concat();
    text.push_str(&summary(&all));
    Ok((text, complaints(&all, options.only.is_none())))
}

fn read(path: &Path) -> Result<Vec<Row>, RunError> {
    let text = std::fs::read_to_string(path).map_err(|source| RunError::File { path: path.to_owned(), source })?;
    from_csv(&text).map_err(|source| RunError::Table { path: path.to_owned(), source })
}

/// What must not be: a shipped method that hides something wrongly or has no answer, a sweep without cases, and, if
/// `complete`, a naive method that is never wrong.
pub fn complaints(rows: &[Row], complete: bool) -> Vec<String> {
    let mut complaints = Vec::new();
    for row in rows {
        let (sweep, method, level) = (&row.sweep, &row.method, row.parameter);
        if row.cases == 0 {
            complaints.push(format!("{sweep}: no cases for {method} at {level}"));
        }
        if row.kind == Kind::Shipped && row.n_unsafe + row.errors > 0 {
            let (n, e) = (row.n_unsafe, row.errors);
            complaints.push(format!("{sweep}: {method} is shipped and has {n} unsafe failures, {e} errors at {level}"));
        }
    }
    if complete {
        let harmless = sums(rows).into_iter().filter(|s| s.kind == Kind::Naive && s.counts[2] == 0);
        complaints.extend(harmless.map(|s| format!("{} is naive and has no unsafe failure in any sweep", s.method)));
    }
    complaints
}

/// Findings to be printed: those of shipped methods always, others if asked for.
fn show(text: &mut String, sweep: &Sweep, findings: &[Finding], wanted: Option<&str>) {
    let is_shipped = |name: &str| sweep.methods.iter().any(|m| m.name == name && m.kind == Kind::Shipped);
    for Finding { sweep, method, level, outcome, case } in findings {
        if is_shipped(method) || wanted.is_some_and(|w| method.contains(w)) {
            let what = if *outcome == Outcome::Unsafe { "hides wrongly" } else { "has no answer for" };
            let _ = writeln!(text, "{sweep} at {level}: {method} {what}\n    {case}");
        }
    }
}
