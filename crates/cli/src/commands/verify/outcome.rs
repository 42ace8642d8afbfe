//! What `verify` says.

use crate::output::{count, percent, seconds};
use serde::Serialize;
use sightlines::verify::{Confirmed, Findings, Remarks, Violation};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What was looked at and found.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    table: String,
    scene: String,
    /// Whether nothing was found that a true table must not have, by the proofs too if there are any.
    is_true: bool,
    n_cells: usize,
    n_portals: usize,
    n_objects: usize,
    n_rays: u64,
    /// Why no rays were shot.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_rays: Option<&'static str>,
    cells: Pairs,
    objects: Pairs,
    n_portals_in_walls: u64,
    n_listed_apart: u64,
    n_cells_without_places: u64,
    n_violations: usize,
    n_violations_by_kind: BTreeMap<&'static str, usize>,
    violations: Vec<Told>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<String>,
    seconds: f64,
}

/// Pairs that the table shows and hides, and what rays did with them.
#[derive(Debug, Serialize)]
struct Pairs {
    n_visible: u64,
    n_confirmed: u64,
    confirmed_share: f64,
    n_hidden: u64,
    n_aimed_at: u64,
}

impl From<Confirmed> for Pairs {
    fn from(c: Confirmed) -> Self {
        let Confirmed { visible, confirmed, hidden, aimed } = c;
        Self {
            n_visible: visible,
            n_confirmed: confirmed,
            confirmed_share: c.share(),
            n_hidden: hidden,
            n_aimed_at: aimed,
        }
    }
}

/// A violation.
#[derive(Debug, Serialize)]
struct Told {
    kind: &'static str,
    cells: Vec<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    object: Option<u32>,
    /// From where to where the ray goes, in scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    segment: Option<[[f64; 3]; 2]>,
    text: String,
}

impl From<&Violation> for Told {
    fn from(v: &Violation) -> Self {
        let cells = v.cells().into_iter().map(|cell| cell.0).collect();
        Self { kind: v.kind(), cells, object: v.object(), segment: v.segment(), text: v.to_string() }
    }
}

impl Outcome {
    pub(super) fn new(
        table: &Path,
        scene: &Path,
        found: &Findings,
        is_true: bool,
        time: Duration,
        picture: Option<PathBuf>,
    ) -> Self {
        let Remarks { portals_in_walls, listed_apart, cells_without_places } = found.remarks;
        Self {
            table: table.display().to_string(),
            scene: scene.display().to_string(),
            is_true,
            n_cells: found.n_cells,
            n_portals: found.n_portals,
            n_objects: found.n_objects,
            n_rays: found.n_rays,
            no_rays: found.no_rays,
            cells: found.cells.into(),
            objects: found.objects.into(),
            n_portals_in_walls: portals_in_walls,
            n_listed_apart: listed_apart,
            n_cells_without_places: cells_without_places,
            n_violations: found.n_violations,
            n_violations_by_kind: found.by_kind.clone(),
            violations: found.violations.iter().map(Told::from).collect(),
            picture: picture.map(|p| p.display().to_string()),
            seconds: time.as_secs_f64(),
        }
    }

    fn pairs(f: &mut fmt::Formatter<'_>, what: &str, p: &Pairs) -> fmt::Result {
        let share = percent(p.confirmed_share);
        writeln!(f, "{what:<14} {} of {} visible pairs confirmed by rays ({share})", p.n_confirmed, p.n_visible)?;
        writeln!(f, "               {} of {} hidden pairs aimed at", p.n_aimed_at, p.n_hidden)
    }
}

/// Violations of each kind that people are shown.
const SHOWN: usize = 5;

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "checked        {} against {}", self.table, self.scene)?;
        let things = [(self.n_cells, "cell"), (self.n_portals, "portal"), (self.n_objects, "object")];
        let things = things.map(|(n, noun)| count(n as u64, noun)).join(", ");
        writeln!(f, "structure      {things}")?;
        match self.no_rays {
            Some(why) => writeln!(f, "rays           none: {why}")?,
            None => {
                writeln!(f, "rays           {} in random directions", self.n_rays)?;
                Self::pairs(f, "cells", &self.cells)?;
                if self.n_objects > 0 {
                    Self::pairs(f, "objects", &self.objects)?;
                }
            }
        }
        let remarks = [
            (self.n_portals_in_walls, "portal", "with a wall in it: more is shown there"),
            (self.n_listed_apart, "object", "listed in a cell that it does not touch"),
            (self.n_cells_without_places, "cell", "from which no ray was shot: too thin, or without a portal"),
        ];
        for (n, noun, what) in remarks.into_iter().filter(|(n, ..)| *n > 0) {
            writeln!(f, "remark         {} {what}", count(n, noun))?;
        }
        let mut shown: BTreeMap<&str, usize> = BTreeMap::new();
        for v in &self.violations {
            let n = shown.entry(v.kind).or_default();
            *n += 1;
            if *n <= SHOWN {
                writeln!(f, "violation      {}: {}", v.kind, v.text)?;
            }
        }
        for (kind, n) in self.n_violations_by_kind.iter().filter(|(_, n)| **n > SHOWN) {
            writeln!(f, "               {kind}: {n} in all; --json has more of them")?;
        }
        if let Some(picture) = &self.picture {
            writeln!(f, "picture        {picture}")?;
        }
        writeln!(f, "time           {}", seconds(Duration::from_secs_f64(self.seconds)))?;
        match self.n_violations {
            0 if self.is_true => writeln!(f, "result         nothing found that is not as the table says"),
            0 => writeln!(f, "result         nothing found by structure and rays, but see what the proofs say"),
            n => writeln!(f, "result         {}", count(n as u64, "violation")),
        }
    }
}
