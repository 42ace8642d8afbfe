//! Proofs that came with a table, as they were checked.

use crate::{ProofFindings, WallFindings};
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use sightlines_progress::words::{bytes, count, seconds_of};
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// Pairs and violations that people are shown.
const SHOWN: usize = 5;

/// Checked proofs.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct ProofOutcome {
    /// The file of proofs.
    file: String,
    /// Its size.
    n_bytes: usize,
    /// Whether the file was found beside the table but belongs to another one; then nothing of it was checked.
    pub is_stale: bool,
    /// Whether nothing contradicts the table and, with `--strict`, everything hidden is proven.
    pub is_true: bool,
    #[serde(flatten)]
    found: ProofFindings,
    #[serde(flatten)]
    walls: WallFindings,
    /// Seconds to check them.
    seconds: f64,
}

impl ProofOutcome {
    /// What was found of proofs in a file of so many bytes; where this is `strict`, what has no proof is not true.
    pub fn new(
        (file, n_bytes): (&Path, usize),
        found: ProofFindings,
        walls: WallFindings,
        strict: bool,
        time: Duration,
    ) -> Self {
        let is_true = found.is_true(strict) && !(strict && walls.n_bare > 0);
        let (file, seconds) = (file.display().to_string(), time.as_secs_f64());
        Self { file, n_bytes, is_stale: false, is_true, found, walls, seconds }
    }

    /// A file beside the table that belongs to another one.
    pub fn stale(file: (&Path, usize), strict: bool, time: Duration) -> Self {
        let nothing = Self::new(file, ProofFindings::default(), WallFindings::default(), strict, time);
        Self { is_stale: true, is_true: !strict, ..nothing }
    }
}

impl fmt::Display for ProofOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_stale {
            writeln!(
                f,
                "proofs         {} is stale: it is about other cells, portals or objects than the table has",
                self.file
            )?;
            return writeln!(f, "               not checked; build the table with --certify again, or remove the file");
        }
        let (found, walls) = (&self.found, &self.walls);
        let time = seconds_of(self.seconds);
        writeln!(f, "proofs         {}, {}, checked in {time}", self.file, bytes(self.n_bytes as u64))?;
        let [shown, hidden] = [(found.n_visible, "visible"), (found.n_hidden, "hidden")]
            .map(|(n, what)| count(n, &format!("{what} pair")));
        writeln!(f, "               {shown} and {hidden} proven")?;
        if found.n_hidden_objects > 0 {
            let hidden = count(found.n_hidden_objects, "hidden pair");
            writeln!(f, "               {hidden} of a cell and an object proven")?;
        }
        if found.n_excess > 0 {
            let shown = count(found.n_excess, "visible pair");
            writeln!(f, "               {shown} proven to be hidden: the table shows more than is visible")?;
        }
        for (n, what) in [(found.n_unproven_visible, "visible"), (found.n_unproven_hidden, "hidden")] {
            if n > 0 {
                writeln!(f, "unproven       {}", count(n, &format!("{what} pair")))?;
            }
        }
        if found.n_hidden_past_portals > 0 {
            let n = found.n_hidden_past_portals;
            writeln!(f, "               {n} of these are joined through portals: a from-region method hides them")?;
        }
        let pairs = found.unproven_hidden.iter().take(SHOWN).map(|[a, b]| format!("{a} and {b}"));
        let pairs: Vec<String> = pairs.collect();
        if !pairs.is_empty() {
            writeln!(f, "               hidden without a proof: {}", pairs.join(", "))?;
        }
        if found.n_unproven_hidden_objects > 0 {
            let hidden = count(found.n_unproven_hidden_objects, "hidden pair");
            writeln!(f, "unproven       {hidden} of a cell and an object")?;
        }
        if walls.n_walls > 0 {
            let backed = count(walls.n_walls - walls.n_bare, "wall");
            writeln!(f, "walls          {backed} of {} covered by the scene", walls.n_walls)?;
        }
        for (cell, [x, y, z]) in walls.bare.iter().take(SHOWN) {
            writeln!(f, "               not covered: of cell {cell}, at ({x}, {y}, {z})")?;
        }
        for text in found.violations.iter().take(SHOWN) {
            writeln!(f, "violation      {text}")?;
        }
        match found.n_violations {
            0 => writeln!(f, "proofs say     nothing that contradicts the table"),
            n => writeln!(f, "proofs say     {}", count(n, "violation")),
        }
    }
}
