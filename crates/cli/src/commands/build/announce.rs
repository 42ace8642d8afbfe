//! What is going to be done, and about how long that takes.

use super::auto::Chosen;
use crate::output::seconds;
use crate::progress::Bar;
use sightlines::bake::{Bakeable, CellsFrom, Recipe, SceneMethod};
use sightlines::progress::words::rough;
use sightlines::progress::{Observer, Pace, Progress, Work};
use sightlines::report::{ALONG_THE_FILE, FrameFacts};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What is going to be done, in a line; none for what is no scene.
#[derive(Debug, Default)]
pub(super) struct Plan {
    line: Option<String>,
}

impl Plan {
    pub(super) fn new(content: &Bakeable, recipe: &Recipe, auto: Option<&Chosen>, limit: Option<Duration>) -> Self {
        if !matches!(content, Bakeable::Scene(_)) {
            return Self::default();
        }
        let cells = match &recipe.cells {
            CellsFrom::KdTree => "cells along walls".to_owned(),
            CellsFrom::EyeLevel(_) => "cells at the height of eyes".to_owned(),
            CellsFrom::Places(how) => format!("about {} places", how.n_cells()),
            CellsFrom::Grid(n) => format!("{} boxes of a grid", n.iter().map(|&n| u64::from(n)).product::<u64>()),
            CellsFrom::Boxes(given) => format!("{} given boxes", given.cells.len()),
        };
        let method = match (auto, recipe.method) {
            (Some(chosen), _) => chosen.method().to_owned(),
            (None, SceneMethod::Both) => "sightlines and multifocal".to_owned(),
            (None, method) => method.name().to_owned(),
        };
        let frame = match &recipe.frame {
            Some(frame) => FrameFacts::from(frame).to_string(),
            None => ALONG_THE_FILE.to_owned(),
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
    said: Option<Mutex<Said>>,
}

/// What was said, and of what phase.
#[derive(Debug)]
struct Said {
    /// None before the first report.
    pace: Option<Pace>,
    /// What is going to be done, until that is said: once the scene is found to have room for cells, so that an error found early stays one line.
    plan: Option<String>,
    is_said: bool,
    is_said_of_cells: bool,
}

/// An estimate is given after this share of a phase.
const SAMPLE: f64 = 0.03;
/// And not before so much time of it.
const LEAST: Duration = Duration::from_millis(700);
/// Nor before so many units.
const FEWEST: u64 = 8;

impl<'a> Announcer<'a> {
    pub(super) fn new(bar: &'a Bar, plan: &Plan, show: bool) -> Self {
        let line = plan.line.as_ref().filter(|_| show);
        let said = Said { pace: None, plan: line.cloned(), is_said: false, is_said_of_cells: false };
        Self { bar, start: Instant::now(), said: line.map(|_| Mutex::new(said)) }
    }

    /// The lines that are due with a report: the plan, and an estimate.
    fn due(&self, progress: Progress, now: Instant) -> [Option<String>; 2] {
        let Some(said) = &self.said else { return [None, None] };
        let mut said = said.lock().unwrap_or_else(PoisonError::into_inner);
        let since_start = now.saturating_duration_since(self.start);
        // Cutting may yet find that there are too many cells; if it takes long, that is said at once all the same.
        let plan = if progress.work != Work::Cutting || since_start > LEAST { said.plan.take() } else { None };
        let pace = Pace::after(said.pace, progress, now);
        if said.pace.replace(pace) != Some(pace) {
            tracing::info!("{} after {:.2} s", progress.phase, since_start.as_secs_f64());
        }
        [plan, said.estimate(progress, since_start, pace.took(now))]
    }
}

impl Said {
    /// The estimate that is due with a report, if one is. It comes once for the cells, and once for what they see.
    fn estimate(&mut self, progress: Progress, since_start: Duration, took: Duration) -> Option<String> {
        let Progress { done, total, phase, share, work, .. } = progress;
        // The pairs that are left to sightlines after all cells are no sample of the rest; mostly the estimate is out by then.
        let (is_said, what) = match work {
            Work::Cutting => (&mut self.is_said_of_cells, "to cut cells"),
            Work::Deciding => (&mut self.is_said, "in all"),
            _ => return None,
        };
        if *is_said || share < SAMPLE || took < LEAST || done < FEWEST {
            return None;
        }
        let all = since_start.checked_add(self.pace?.left(progress, took)?)?;
        *is_said = true;
        Some(format!("about {} {what}, by the first {done} of {total} {phase}", rough(all)))
    }
}

impl Observer for Announcer<'_> {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.due(progress, Instant::now()).iter().flatten().for_each(|line| self.bar.say(line));
        self.bar.report(progress)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever a phase is called, its kind of work decides.
    #[test]
    fn estimates_are_of_the_kind_of_work() {
        let lines = |phase, work| {
            let bar = Bar::new("", false);
            let announcer = Announcer::new(&bar, &Plan { line: Some("plan".to_owned()) }, true);
            let at = |seconds: u64, done| {
                let progress = Progress::new(phase, done, 100).of(work);
                announcer.due(progress, announcer.start + Duration::from_secs(seconds))
            };
            let [first, early, due, again] = [at(0, 0), at(5, 2), at(10, 20), at(11, 21)];
            assert_eq!((&early[1], &again), (&None, &[None, None]));
            (first[0].is_some(), due[1].clone())
        };
        for name in ["cells", "cuts", "pairs and objects", ""] {
            assert_eq!(lines(name, Work::Other), (true, None));
            let all = format!("about 50 s in all, by the first 20 of 100 {name}");
            assert_eq!(lines(name, Work::Deciding), (true, Some(all)));
            let cells = format!("about 50 s to cut cells, by the first 20 of 100 {name}");
            assert_eq!(lines(name, Work::Cutting), (false, Some(cells)));
        }
    }

    /// What was done before the first report of a phase took none of its time.
    #[test]
    fn estimates_are_by_the_pace_of_the_phase() {
        let bar = Bar::new("", false);
        let announcer = Announcer::new(&bar, &Plan { line: Some("plan".to_owned()) }, true);
        let at = |seconds: u64, done| {
            let progress = Progress::new("cells", done, 100).of(Work::Deciding);
            announcer.due(progress, announcer.start + Duration::from_secs(seconds))[1].take()
        };
        assert_eq!(at(30, 50), None);
        assert_eq!(at(40, 75).as_deref(), Some("about 50 s in all, by the first 75 of 100 cells"));
        let silent = Announcer::new(&bar, &Plan::default(), true);
        assert_eq!(silent.due(Progress::new("", 0, 1), silent.start), [None, None]);
    }
}
