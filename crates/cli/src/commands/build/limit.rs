//! A limit of time, and what was not decided within it.

use crate::output::{count, seconds};
use sightlines::bake::{LimitReport, Report};
use sightlines::progress::Budget;
use std::path::Path;
use std::time::{Duration, Instant};

/// The time since the start of the program, as a share of the limit.
#[derive(Debug)]
pub(super) struct Clock {
    start: Instant,
    limit: Option<Duration>,
}

impl Budget for Clock {
    fn spent(&self) -> f64 {
        self.limit.map_or(0.0, |limit| self.start.elapsed().as_secs_f64() / limit.as_secs_f64())
    }
}

impl Clock {
    pub(super) fn new(limit: Option<Duration>) -> Self {
        Self { start: Instant::now(), limit }
    }

    /// None without a limit.
    pub(super) fn budget(&self) -> Option<&dyn Budget> {
        self.limit.map(|_| self as &dyn Budget)
    }

    pub(super) fn warn_of(&self, path: &Path, report: &Report) {
        match report {
            Report::Scene(report) => self.warn(path, report.limit, report.cut_time),
            Report::Regions(report) => self.warn(path, report.limit, report.cut_time),
            _ => {}
        }
    }

    /// The same, with what was not decided, and the time that cutting cells took.
    pub(super) fn warn(&self, path: &Path, left: Option<LimitReport>, cut_time: Duration) {
        if let (Some(limit), Some(left)) = (self.limit, left) {
            let [limit, cut] = [limit, cut_time].map(seconds);
            tracing::warn!("{}: the limit of {limit} was reached (cutting cells took {cut}): {left}", path.display());
        }
    }
}

/// What a report in few words says of a limit, if it was reached.
pub(super) fn brief(left: Option<LimitReport>) -> String {
    let Some(LimitReport { n_cell_pairs: cells, n_object_pairs: objects, .. }) = left else { return String::new() };
    let cells = count(cells, "pair");
    format!("; not decided in time, and so visible: {cells} of cells, {objects} of a cell and an object")
}
