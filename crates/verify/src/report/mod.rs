//! What was checked and found, as fields for programs and as lines for people.

mod proofs;
mod unproven;
mod violations;

pub use proofs::ProofOutcome;
pub use unproven::Unproven;
pub use violations::{ReportedViolation, Violations};

use crate::{Confirmed, Findings, OwnSummary, Remarks, Violation};
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use sightlines_frame::FrameFacts;
use sightlines_progress::words::{count, percent, seconds_of};
use sightlines_pvs::Frame;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Exit code 1 if `is_true` is false.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct VerifyReport {
    /// What was checked: a table, or a map with its own visibility.
    table: String,
    /// What it was checked against.
    scene: String,
    /// Whether no violation was found, by rays, structure or proofs. Rays find violations; they do not prove that there are none.
    is_true: bool,
    /// Cells whose structure was checked.
    n_cells: usize,
    /// Portals whose structure was checked.
    n_portals: usize,
    /// Objects whose structure was checked.
    n_objects: usize,
    /// Doors of the table.
    n_doors: usize,
    /// Random rays.
    n_rays: u64,
    /// Segments, free as far as doubles tell, that were followed through the portals of the table, and its stab trees if it has any.
    n_followed: u64,
    /// Sequences of portals, which stab trees do not have, that rays were aimed along.
    n_sequences: u64,
    /// The frame of the table, if it has one: the scene was moved into it, and places are along its axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameFacts>,
    /// Of a plan, if the table states it: openings up to this width count as closed, as ends of walls were joined to others within it.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<f64>,
    /// What was checked besides the structure.
    checked: Checked,
    /// The lump that was checked, of a map's own visibility.
    #[serde(skip_serializing_if = "Option::is_none")]
    own: Option<OwnSummary>,
    /// Why no rays were shot.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_rays: Option<&'static str>,
    /// Of unordered pairs of different cells.
    cells: Pairs,
    /// Of pairs of a cell and an object.
    objects: Pairs,
    /// Hidden pairs at which random segments were shot, everywhere alike: those of which each is next to something visible from the other, as any
    /// free segment of a hidden pair passes such a pair; where cells leave gaps all, or some chosen at random.
    n_sampled_pairs: u64,
    /// Random segments for each sampled pair.
    n_segments_each: u64,
    /// The share of free segments from which on such a pair is found in 99 of 100 runs, unless a nearer pair is wrong as well; 1 if none were shot.
    share_found: f64,
    #[serde(flatten)]
    remarks: Remarks,
    /// With a frame: hidden pairs that rays join in the scene of the file and not along the frame, through openings narrower than the gap or past
    /// things thinner than it; no violation. Rays stop once they have found 1,000 hidden pairs, so there may be more.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_cracks: Option<u64>,
    /// With a frame: triangles that have an area in the file and none along the frame, as they are thinner than the gap; no violation.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_flattened: Option<u64>,
    /// How many times what single precision explains the gap is, if that is much.
    #[serde(skip)]
    wide_gap: Option<f64>,
    #[serde(flatten)]
    found: Violations,
    /// With `--draw` and a violation to draw: the picture that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<String>,
    /// Seconds in all.
    seconds: f64,
    /// What the proofs show, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    proofs: Option<ProofOutcome>,
    /// Of a table of cells without portals, which can have no proofs.
    #[serde(skip_serializing_if = "Option::is_none")]
    unproven: Option<Unproven>,
}

/// Checks besides the structure of the table.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Checked {
    /// Whether the scene was compared with the digests of what the table was made of; older tables have none.
    digests: bool,
    /// Whether random rays were shot.
    random_rays: bool,
    /// Whether random segments were shot at hidden pairs.
    random_segments: bool,
    /// Whether rays were aimed at hidden pairs.
    aimed_rays: bool,
    /// Whether proofs were checked.
    proofs: bool,
}

impl Checked {
    fn has_rays(self) -> bool {
        self.random_rays || self.random_segments || self.aimed_rays
    }

    fn has_any(self) -> bool {
        self.has_rays() || self.proofs
    }
}

/// Checked pairs, and what rays did with them.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Pairs {
    /// Pairs that the table lists as visible.
    n_visible: u64,
    /// Of the visible pairs, those that a ray joined.
    n_confirmed: u64,
    /// `n_confirmed` by `n_visible`; 1 if there are none.
    confirmed_share: f64,
    /// Pairs that the table lists as hidden.
    n_hidden: u64,
    /// Of the hidden pairs, those that rays were aimed at.
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

impl VerifyReport {
    /// What was found of a table, or of a map with its `own` visibility, in the file `table`, checked against that of the `scene`.
    pub fn new(
        [table, scene]: [&Path; 2],
        has_digests: bool,
        found: &Findings,
        violations: Violations,
        own: Option<OwnSummary>,
        proofs: Option<ProofOutcome>,
        time: Duration,
    ) -> Self {
        let is_true = violations.is_empty() && proofs.as_ref().is_none_or(|proofs| proofs.is_true);
        let checked = Checked {
            digests: has_digests,
            random_rays: found.n_rays > 0,
            random_segments: found.sampled.n_pairs > 0 && found.sampled.n_each > 0,
            aimed_rays: found.cells.aimed + found.objects.aimed > 0,
            proofs: proofs.as_ref().is_some_and(|proofs| !proofs.is_stale),
        };
        Self {
            table: table.display().to_string(),
            scene: scene.display().to_string(),
            is_true,
            n_cells: found.n_cells,
            n_portals: found.n_portals,
            n_objects: found.n_objects,
            n_doors: found.n_doors,
            n_rays: found.n_rays,
            n_followed: found.n_followed,
            n_sequences: found.n_sequences,
            frame: None,
            gap: None,
            checked,
            own,
            no_rays: found.no_rays,
            cells: found.cells.into(),
            objects: found.objects.into(),
            n_sampled_pairs: found.sampled.n_pairs,
            n_segments_each: found.sampled.n_each,
            share_found: found.sampled.share_found(),
            remarks: found.remarks,
            n_cracks: None,
            n_flattened: None,
            wide_gap: None,
            found: violations,
            picture: None,
            seconds: time.as_secs_f64(),
            proofs,
            unproven: None,
        }
    }

    /// The same for a table with a frame, whose gap is so many times what single precision explains, if that is much.
    pub fn in_frame(self, frame: Option<&Frame>, wide_gap: Option<f64>) -> Self {
        let Some(frame) = frame else { return self };
        let (n_cracks, n_flattened) = (Some(self.remarks.cracks), Some(self.remarks.flattened));
        Self { frame: Some(frame.into()), n_cracks, n_flattened, wide_gap, ..self }
    }

    /// The same of a plan whose walls were joined within a gap, if it is above 0.
    pub fn with_gap(self, gap: f64) -> Self {
        Self { gap: Some(gap).filter(|gap| *gap > 0.0), ..self }
    }

    /// The same with a picture, if one was drawn.
    pub fn with_picture(self, picture: Option<PathBuf>) -> Self {
        Self { picture: picture.map(|p| p.display().to_string()), ..self }
    }

    /// The same of a table with pairs that can have no proof; where this is `strict`, it is only true if none of them is hidden.
    pub fn with_unproven(self, unproven: Option<Unproven>, strict: bool) -> Self {
        let is_true = self.is_true && !(strict && unproven.is_some_and(|unproven| !unproven.hides_none()));
        Self { is_true, unproven, ..self }
    }

    /// Whether nothing was found that a true table must not have.
    pub fn is_true(&self) -> bool {
        self.is_true
    }

    fn pairs(f: &mut fmt::Formatter<'_>, what: &str, p: &Pairs) -> fmt::Result {
        let share = percent(p.confirmed_share);
        writeln!(f, "{what:<14} {} of {} visible pairs confirmed by rays ({share})", p.n_confirmed, p.n_visible)?;
        writeln!(f, "               {} of {} hidden pairs aimed at", p.n_aimed_at, p.n_hidden)
    }
}

/// Violations of each kind that people are shown.
const SHOWN: usize = 5;

impl fmt::Display for VerifyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.proofs.iter().try_for_each(|proofs| write!(f, "{proofs}"))?;
        self.unproven.iter().try_for_each(|unproven| write!(f, "{unproven}"))?;
        writeln!(f, "checked        {} against {}", self.table, self.scene)?;
        let things = [(self.n_cells, "cell"), (self.n_portals, "portal"), (self.n_objects, "object")];
        let mut things = things.map(|(n, noun)| count(n as u64, noun)).join(", ");
        if self.n_doors > 0 {
            things += &format!(", {}", count(self.n_doors as u64, "door"));
        }
        self.own.iter().try_for_each(|own| write!(f, "{own}"))?;
        writeln!(f, "structure      {things}")?;
        if !self.checked.digests && self.own.is_none() {
            writeln!(f, "digests        none in the table: whether the scene has changed since is not known")?;
        }
        if let Some(frame) = &self.frame {
            writeln!(f, "frame          {frame}")?;
            writeln!(
                f,
                "               the scene was moved into it, every corner by less than that; places are along its axes"
            )?;
        }
        if let Some(gap) = self.gap {
            writeln!(f, "precision      walls that miss each other by no more than {gap:.2e} units were joined")?;
        }
        match self.no_rays {
            Some(why) => writeln!(f, "rays           none: {why}")?,
            None if !self.checked.has_rays() => writeln!(f, "rays           none")?,
            None => {
                writeln!(f, "rays           {} in random directions", self.n_rays)?;
                if self.n_portals > 0 {
                    let segments = count(self.n_followed, "segment");
                    writeln!(f, "portals        {segments} followed through them")?;
                }
                if self.n_sequences > 0 {
                    let sequences = count(self.n_sequences, "sequence");
                    writeln!(f, "stab trees     rays aimed along {sequences} of portals that they lack")?;
                }
                if self.checked.random_segments {
                    let pairs = count(self.n_sampled_pairs, "hidden pair");
                    let [n, share] = [count(self.n_segments_each, "random segment"), percent(self.share_found)];
                    writeln!(f, "segments       {n} at each of {pairs}")?;
                    writeln!(
                        f,
                        "               a pair with {share} of them free is found in 99 of 100 runs, unless nearer pairs are wrong too"
                    )?;
                }
                Self::pairs(f, "cells", &self.cells)?;
                if self.n_objects > 0 {
                    Self::pairs(f, "objects", &self.objects)?;
                }
            }
        }
        let remarks = [
            (self.remarks.portals_in_walls, "portal", "with a wall in it: more is shown there"),
            (self.remarks.listed_apart, "object", "listed in a cell that it does not touch"),
            (self.remarks.cells_without_places, "cell", "from which no ray was shot: too thin, or without a portal"),
            (
                self.remarks.doors_as_boxes,
                "door",
                "not compared, for want of a box in the table or a leaf in the scene",
            ),
            (self.remarks.unlisted_door_portals, "portal", "that a door could close and does not: more is shown there"),
            (self.remarks.flattened, "triangle", "thinner than the gap, which the table takes to be none"),
            (
                self.remarks.cracks,
                "hidden pair",
                "joined by rays through openings narrower than the gap, or past things thinner than it",
            ),
        ];
        if let Some(times) = self.wide_gap {
            writeln!(
                f,
                "remark         the gap is {times:.0} times what single precision explains in this scene: rays cannot check anything narrower"
            )?;
        }
        for (n, noun, what) in remarks.into_iter().filter(|(n, ..)| *n > 0) {
            writeln!(f, "remark         {} {what}", count(n, noun))?;
        }
        let mut shown: BTreeMap<&str, usize> = BTreeMap::new();
        for v in &self.found.violations {
            let n = shown.entry(v.kind).or_default();
            *n += 1;
            if *n <= SHOWN {
                writeln!(f, "violation      {}: {}", v.kind, v.text)?;
            }
        }
        for (kind, n) in self.found.n_violations_by_kind.iter().filter(|(_, n)| **n > SHOWN) {
            writeln!(f, "               {kind}: {n} in all; --json has more of them")?;
        }
        if let Some(picture) = &self.picture {
            writeln!(f, "picture        {picture}")?;
        }
        writeln!(f, "time           {}", seconds_of(self.seconds))?;
        match self.found.n_violations {
            0 if self.is_true && !self.checked.has_any() => {
                writeln!(
                    f,
                    "result         only the structure was checked, and is sound: no ray was shot and no proof was there, so nothing"
                )?;
                writeln!(f, "               is known of whether what the table hides is hidden")
            }
            0 if self.is_true => writeln!(f, "result         nothing found that contradicts the table"),
            0 => {
                writeln!(f, "result         nothing found by structure and rays, but not all that is hidden is proven")
            }
            n if self.found.n_violations_by_kind.get(Violation::CHANGED) == Some(&n) => {
                writeln!(f, "result         the scene is not as when the table was made")?;
                let found = if self.checked.has_any() {
                    "nothing else was found that contradicts the table"
                } else {
                    "whether that matters is not known: no ray was shot and no proof was there"
                };
                writeln!(f, "               {found}")
            }
            n if self.found.has_more_violations => {
                writeln!(f, "result         at least {}", count(n as u64, "violation"))
            }
            n => writeln!(f, "result         {}", count(n as u64, "violation")),
        }
    }
}
