//! What is going to be done, and about how long that takes.

use super::auto::Chosen;
use crate::output::seconds;
use crate::progress::{Bar, rough};
use sightlines::bake::{BakeOptions, Bakeable, CellsFrom, SceneMethod};
use sightlines::progress::{Observer, Progress};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What is going to be done, in a line; none for what is no scene.
#[derive(Debug, Default)]
pub(super) struct Plan {
    line: Option<String>,
}

impl Plan {
    pub(super) fn new(
        content: &Bakeable,
        options: &BakeOptions<'_>,
        auto: Option<&Chosen>,
        limit: Option<Duration>,
    ) -> Self {
        if !matches!(content, Bakeable::Scene(_)) {
            return Self::default();
        }
        let cells = match &options.cells {
            CellsFrom::KdTree => "cells along walls".to_owned(),
            CellsFrom::Places(how) => format!("about {} places", how.n_cells()),
            CellsFrom::Grid(n) => format!("{} boxes of a grid", n.iter().map(|&n| u64::from(n)).product::<u64>()),
            CellsFrom::Boxes(given) => format!("{} given boxes", given.cells.len()),
        };
        let method = match (auto, options.method) {
            (Some(chosen), _) => chosen.method().to_owned(),
            (None, SceneMethod::Both) => "sightlines and multifocal".to_owned(),
            (None, method) => method.name().to_owned(),
        };
        let frame = match &options.frame {
            Some(frame) => format!("along axes of its own, with a gap of {:.1e} units", frame.gap()),
            None => "along the axes of the file".to_owned(),
        };
        let limit = limit.map_or(String::new(), |limit| {
            format!(
                "; decided for {}, from which reading, cutting cells and preparing take what they need",
                seconds(limit)
            )
        });
        Self { line: Some(format!("cells: {cells}; hidden by {method}; {frame}{limit}")) }
    }
}

/// Passes reports on to a bar. Says with the first one what is going to be done, and, once a part of it is known, about how long it takes.
pub(super) struct Announcer<'a> {
    bar: &'a Bar,
    start: Instant,
    /// None where nothing is to be said.
    pace: Option<Mutex<Pace>>,
}

/// What is known of the phase that is going on.
#[derive(Debug)]
struct Pace {
    phase: &'static str,
    since: Instant,
    /// What is going to be done, until that is said: once the scene is found to have room for cells, so that an error found early stays one line.
    plan: Option<String>,
    is_said: bool,
    is_said_of_cells: bool,
}

/// The phase in which places are cut.
const CUTTING: &str = "cuts";

/// An estimate is given after this share of a phase.
const SAMPLE: f64 = 0.03;
/// And not before so much time of it.
const LEAST: Duration = Duration::from_millis(700);

impl<'a> Announcer<'a> {
    pub(super) fn new(bar: &'a Bar, plan: &Plan, show: bool) -> Self {
        let start = Instant::now();
        let line = plan.line.as_ref().filter(|_| show);
        let pace = Pace { phase: "", since: start, plan: line.cloned(), is_said: false, is_said_of_cells: false };
        Self { bar, start, pace: line.map(|_| Mutex::new(pace)) }
    }

    /// The estimate that is due with a report, if one is.
    fn estimate(&self, progress: Progress) -> Option<String> {
        let now = Instant::now();
        let mut pace = self.pace.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
        // Cutting may yet find that there are too many cells; if it takes long, that is said at once all the same.
        if !matches!(progress.phase, "solid matter" | CUTTING) || now - self.start > LEAST {
            pace.plan.take().iter().for_each(|plan| self.bar.say(plan));
        }
        if pace.phase != progress.phase {
            tracing::info!("{} after {:.2} s", progress.phase, (now - self.start).as_secs_f64());
            (pace.phase, pace.since) = (progress.phase, now);
        }
        // The pairs that are left to sightlines after all cells, and cuts, are no sample of the rest.
        let of_cells = progress.phase == CUTTING;
        let counts = of_cells || matches!(progress.phase, "cells" | "pairs and objects");
        let took = now - pace.since;
        let is_said = if of_cells { pace.is_said_of_cells } else { pace.is_said };
        if is_said || !counts || progress.share < SAMPLE || took < LEAST || progress.done < 8 {
            return None;
        }
        *(if of_cells { &mut pace.is_said_of_cells } else { &mut pace.is_said }) = true;
        let all = (now - self.start).as_secs_f64() + took.as_secs_f64() * (1.0 - progress.share) / progress.share;
        let all = Duration::try_from_secs_f64(all).ok()?;
        let Progress { done, total, phase, .. } = progress;
        let what = if of_cells { "to cut cells" } else { "in all" };
        Some(format!("about {} {what}, by the first {done} of {total} {phase}", rough(all)))
    }
}

impl Observer for Announcer<'_> {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        if let Some(line) = self.estimate(progress) {
            self.bar.say(&line);
        }
        self.bar.report(progress)
    }
}
