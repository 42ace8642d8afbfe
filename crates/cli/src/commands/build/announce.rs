//! What is going to be done, and about how long that takes.

use super::auto::Chosen;
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
    pub(super) fn new(content: &Bakeable, options: &BakeOptions<'_>, auto: Option<&Chosen>) -> Self {
        if !matches!(content, Bakeable::Scene(_)) {
            return Self::default();
        }
        let cells = match &options.cells {
            CellsFrom::KdTree => "rooms along walls".to_owned(),
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
        Self { line: Some(format!("cells: {cells}; hidden by {method}; {frame}")) }
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
    /// What is going to be done, until that is said: once the scene is found to have room for cells, so that an error stays one line.
    plan: Option<String>,
    is_said: bool,
}

/// An estimate is given after this share of a phase.
const SAMPLE: f64 = 0.03;
/// And not before so much time of it.
const LEAST: Duration = Duration::from_millis(700);

impl<'a> Announcer<'a> {
    pub(super) fn new(bar: &'a Bar, plan: &Plan, show: bool) -> Self {
        let start = Instant::now();
        let line = plan.line.as_ref().filter(|_| show);
        let pace = Pace { phase: "", since: start, plan: line.cloned(), is_said: false };
        Self { bar, start, pace: line.map(|_| Mutex::new(pace)) }
    }

    /// The estimate that is due with a report, if one is.
    fn estimate(&self, progress: Progress) -> Option<String> {
        let now = Instant::now();
        let mut pace = self.pace.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
        pace.plan.take().iter().for_each(|plan| self.bar.say(plan));
        if pace.phase != progress.phase {
            tracing::info!("{} after {:.2} s", progress.phase, (now - self.start).as_secs_f64());
            (pace.phase, pace.since) = (progress.phase, now);
        }
        // The pairs that are left to sightlines after all cells, and cuts, are no sample of the rest.
        let counts = matches!(progress.phase, "cells" | "pairs and objects");
        let took = now - pace.since;
        if pace.is_said || !counts || progress.share < SAMPLE || took < LEAST || progress.done < 8 {
            return None;
        }
        pace.is_said = true;
        let all = (now - self.start).as_secs_f64() + took.as_secs_f64() * (1.0 - progress.share) / progress.share;
        let all = Duration::try_from_secs_f64(all).ok()?;
        let Progress { done, total, phase, .. } = progress;
        Some(format!("about {} in all, by the first {done} of {total} {phase}", rough(all)))
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
