//! Charts of speed against accuracy: each family of methods measured on the same scenes, and pictures of that.
//!
//! Measuring and drawing are separate. Measuring writes one CSV for each family ([`row`]); drawing reads nothing else and
//! gives the same bytes for the same rows ([`chart`], [`page`]). Times differ from machine to machine, so each row says on
//! which it was measured, and by which state of the program; shares do not.

pub mod cell_to_cell;
pub mod certificates;
pub mod eye_to_cell;
pub mod growth;
pub mod multifocal;
pub mod older;
pub mod packed;
pub mod page;
pub mod panels;
pub mod row;
pub mod simplify;
mod slow_stabbers;
pub mod visible_surface;

use row::{Row, RowError};
use sightlines::formats::files::{WriteError, atomic_write};
use sightlines_benches::chart;
use sightlines_benches::measure::quickest;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Something that can be charted.
pub trait Family {
    /// What its files are called, without an ending.
    fn name(&self) -> &'static str;

    /// What its picture is called.
    fn title(&self) -> &'static str;

    /// What is measured, in a few sentences.
    fn about(&self) -> &'static str;

    /// Measures all methods on all scenes.
    ///
    /// # Errors
    /// [`ChartError`] for scenes that cannot be had, and methods that fail.
    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError>;

    /// The panels of its picture, from rows alone.
    fn panels(&self, rows: &[Row]) -> Vec<chart::Panel>;
}

/// All families, in the order of the page.
pub fn families() -> Vec<Box<dyn Family>> {
    vec![
        Box::new(cell_to_cell::CellToCell),
        Box::new(growth::Growth),
        Box::new(eye_to_cell::EyeToCellFamily),
        Box::new(multifocal::MultifocalFamily),
        Box::new(visible_surface::VisibleSurfaceFamily),
        Box::new(simplify::SimplifyFamily),
        Box::new(packed::PackedFamily),
        Box::new(certificates::Certificates),
    ]
}

/// How to measure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// Small scenes and few repeats.
    pub quick: bool,
    /// The folder with real scenes, if there is one and the form is not the quick one.
    pub data: Option<PathBuf>,
    /// Model and number of processors.
    pub machine: String,
    /// The state of the program.
    pub commit: String,
}

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChartError {
    /// A file that cannot be read, or a folder that cannot be made.
    #[error("{}: {source}", path.display())]
    File {
        /// Its path.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file that is no chart's.
    #[error("{}: {source}", path.display())]
    Row {
        /// Its path.
        path: PathBuf,
        /// What is wrong with it.
        source: RowError,
    },
    /// No family has that name.
    #[error("there is no family '{name}', only {known}")]
    Family {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A scene that cannot be had, or a method that failed on it.
    #[error("{family}: {scene}: {source}")]
    Measure {
        /// The family.
        family: &'static str,
        /// The scene.
        scene: String,
        /// Why not.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl ChartError {
    /// A scene that cannot be had, or a method that failed on it.
    pub(crate) fn measure(
        family: &'static str,
        scene: &str,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::Measure { family, scene: scene.to_owned(), source: source.into() }
    }
}

/// What to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// Where CSV and pictures are.
    pub out: PathBuf,
    /// Measures nothing.
    pub draw_only: bool,
    /// Only this family is measured.
    pub only: Option<String>,
}

/// Measures the requested families, then draws all that have a CSV.
///
/// # Errors
/// [`ChartError`]; what was measured before is kept.
pub fn run(task: &Task, settings: &Settings) -> Result<(), ChartError> {
    let families = families();
    if let Some(name) = task.only.as_deref().filter(|name| families.iter().all(|f| f.name() != *name)) {
        let known: Vec<&str> = families.iter().map(|f| f.name()).collect();
        return Err(ChartError::Family { name: name.to_owned(), known: known.join(", ") });
    }
    std::fs::create_dir_all(&task.out).map_err(|source| ChartError::File { path: task.out.clone(), source })?;
    if !task.draw_only {
        for family in families.iter().filter(|f| task.only.as_deref().is_none_or(|only| only == f.name())) {
            let start = Instant::now();
            let rows = family.measure(settings)?;
            eprintln!("{}: {} rows in {:.1} s", family.name(), rows.len(), start.elapsed().as_secs_f64());
            atomic_write(task.out.join(family.name()).with_extension("csv"), row::write(&rows).as_bytes())?;
        }
    }
    draw(&task.out, &families)
}

/// Draws each family of which there is a CSV in `out`, the page of all of them, and `front.svg`: what matters most.
///
/// # Errors
/// [`ChartError`] for files that cannot be read or written.
pub fn draw(out: &Path, families: &[Box<dyn Family>]) -> Result<(), ChartError> {
    let (mut sections, mut front) = (Vec::new(), Vec::new());
    for family in families {
        let path = out.join(family.name()).with_extension("csv");
        if !path.is_file() {
            continue;
        }
        let text = std::fs::read_to_string(&path).map_err(|source| ChartError::File { path: path.clone(), source })?;
        let rows = row::read(&text).map_err(|source| ChartError::Row { path: path.clone(), source })?;
        let panels = family.panels(&rows);
        let svg = chart::svg(family.title(), &panels);
        front.extend(panels.into_iter().filter(|panel| is_in_front(family.name(), &panel.title)));
        atomic_write(path.with_extension("svg"), svg.as_bytes())?;
        sections.push(page::Section { name: family.name(), title: family.title(), about: family.about(), svg, rows });
    }
    if !front.is_empty() {
        let svg = chart::svg("Speed against accuracy, and growth", &front);
        atomic_write(out.join("front.svg"), svg.as_bytes())?;
    }
    Ok(atomic_write(out.join("index.html"), page::html(&sections).as_bytes())?)
}

/// Whether a panel is one of the few that matter most: a scene of each kind, and how time grows.
fn is_in_front(family: &str, title: &str) -> bool {
    let first = match family {
        "cell_to_cell" => &["freedoom1_E1M1,", "tower:2:6:4:2,", "e1m1,"][..],
        "growth" => &["towers: time"][..],
        _ => &[],
    };
    first.iter().any(|first| title.starts_with(first))
}

impl Settings {
    /// For this machine. `data` is left out in the quick form, which is the same everywhere.
    pub fn here(quick: bool, data: Option<PathBuf>) -> Self {
        Self { quick, data: data.filter(|_| !quick), machine: machine(), commit: commit() }
    }

    /// A row that says where and by what it is measured.
    pub(crate) fn row(&self, family: &str, method: &str, scene: &str) -> Row {
        Row {
            family: family.to_owned(),
            method: row::clean(method),
            scene: row::clean(scene),
            threads: 1,
            repeats: 1,
            machine: row::clean(&self.machine),
            commit: row::clean(&self.commit),
            ..Row::default()
        }
    }

    /// One of two values, by form.
    pub(crate) fn pick<T>(&self, quick: T, full: T) -> T {
        if self.quick { quick } else { full }
    }

    /// What something gives, the seconds of the quickest run, and of how many. Those below a second are repeated, 3 times in the
    /// quick form and 5 times else.
    pub(crate) fn best_of<T>(&self, run: impl FnMut() -> T) -> (T, f64, u32) {
        quickest(self.pick(3, 5), run)
    }
}

/// Model and number of processors as Linux tells; 'unknown' elsewhere.
fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let lines = || text.lines().filter_map(|line| line.split_once(':')).map(|(key, value)| (key.trim(), value.trim()));
    match lines().find(|(key, _)| *key == "model name") {
        Some((_, model)) => format!("{model} x {}", lines().filter(|(key, _)| *key == "processor").count()),
        None => "unknown".to_owned(),
    }
}

/// The short name of the state that is checked out; 'unknown' without git.
fn commit() -> String {
    let asked = std::process::Command::new("git").args(["rev-parse", "--short", "HEAD"]).output();
    let text = asked.ok().filter(|o| o.status.success()).map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    text.filter(|t| !t.is_empty()).unwrap_or_else(|| "unknown".to_owned())
}

#[cfg(test)]
mod tests;
