//! What was stripped, in numbers and part by part.

use super::StripArgs;
use crate::output::{JsonSchema, Serialize, bytes, count, percent, point, seconds_of, share, unless_none};
use sightlines::cells::Scene;
use sightlines::strip::{Fate, FateCounts, HiddenReason, Stripped};
use std::fmt;
use std::time::Duration;

/// How many parts have which fate.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct Fates {
    /// All.
    n: usize,
    /// Seen, each with a free segment.
    n_seen: usize,
    /// Hidden, for any reason.
    n_hidden: usize,
    /// Of those, within a closed surface that no eye is in.
    n_enclosed: usize,
    /// Hidden as surfaces block all lines from the eyes.
    n_by_lines: usize,
    /// Hidden by the table.
    n_by_table: usize,
    /// Hidden only if openings within the gap count as closed.
    n_by_gap: usize,
    /// Neither seen nor hidden; they stay.
    n_undecided: usize,
    /// Not asked about, as `--keep` says or as they have no triangles or may be anywhere; they stay.
    n_kept: usize,
}

impl From<FateCounts> for Fates {
    fn from(counts: FateCounts) -> Self {
        let of = |reason: HiddenReason| counts.hidden[reason as usize];
        Self {
            n: counts.all,
            n_seen: counts.seen,
            n_hidden: counts.n_hidden(),
            n_enclosed: of(HiddenReason::Enclosed),
            n_by_lines: of(HiddenReason::LineSpace),
            n_by_table: of(HiddenReason::Table),
            n_by_gap: of(HiddenReason::Gap),
            n_undecided: counts.undecided,
            n_kept: counts.kept,
        }
    }
}

/// One object.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct Part {
    /// Its index in the scene.
    object: usize,
    /// Its name.
    name: String,
    /// `seen`, `hidden`, `undecided` or `kept`.
    fate: &'static str,
    /// Why it is hidden: `enclosed`, `line-space`, `table` or `gap`.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'static str>,
    /// If it is seen, a free segment: from an eye through a point of it, and a little farther.
    #[serde(skip_serializing_if = "Option::is_none")]
    witness: Option<[[f64; 3]; 2]>,
    /// Its triangles.
    n_triangles: usize,
    /// Those of them that are hidden.
    n_hidden_triangles: usize,
}

impl Part {
    pub(super) fn all(scene: &Scene, stripped: &Stripped) -> Vec<Self> {
        let part =
            |(object, (of, found)): (usize, (&sightlines::cells::SceneObject, &sightlines::strip::ObjectFate))| {
                let (fate, reason, witness) = match found.fate {
                    Fate::Seen(free) => ("seen", None, Some(free)),
                    Fate::Hidden(reason) => ("hidden", Some(reason.name()), None),
                    Fate::Undecided => ("undecided", None, None),
                    Fate::Kept => ("kept", None, None),
                };
                let n_triangles = of.triangles.len();
                let n_hidden_triangles = (0..n_triangles).filter(|&t| found.hides(t)).count();
                Self { object, name: of.name.clone(), fate, reason, witness, n_triangles, n_hidden_triangles }
            };
        scene.objects().iter().zip(&stripped.objects).enumerate().map(part).collect()
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { object, name, fate, reason, witness, n_triangles, n_hidden_triangles } = self;
        write!(f, "{name} (object {object}, {}): {fate}", count(*n_triangles as u64, "triangle"))?;
        match (reason, witness) {
            (Some("enclosed"), _) => write!(f, ": a closed surface is between it and every eye")?,
            (Some("line-space"), _) => write!(f, ": surfaces block all lines from the eyes")?,
            (Some("table"), _) => write!(f, ": the table hides it from all cells")?,
            (Some(_), _) => write!(f, ": it is seen at most through openings within the gap")?,
            (None, Some([eye, end])) => write!(f, " from {}: nothing is before it towards {}", point(eye), point(end))?,
            (None, None) if *fate == "undecided" => {
                write!(f, ": no free line to it was found, and no proof that there is none")?
            }
            (None, None) => {}
        }
        if *n_hidden_triangles > 0 && n_hidden_triangles < n_triangles {
            write!(f, "; {n_hidden_triangles} of its triangles are hidden")?;
        }
        writeln!(f)
    }
}

/// What `--report` writes.
#[derive(Debug, Serialize)]
pub(super) struct Report<'a> {
    /// The version of its form.
    pub(super) version: u32,
    /// The scene.
    pub(super) scene: String,
    /// Where eyes are.
    pub(super) from: &'a [String],
    /// All objects, in order.
    pub(super) parts: &'a [Part],
}

/// The scene that is left.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene.
    scene: String,
    /// The scene that was written; null if none was.
    out: Option<String>,
    /// Size of the scene that was written; null if none was.
    n_bytes: Option<usize>,
    /// Where eyes are, as `--from` says.
    from: Vec<String>,
    /// What counts as one part: `parts`, which are objects, or `triangles`.
    grain: &'static str,
    /// Openings of this width count as closed, in scene units; 0 if none do.
    gap: f64,
    /// Objects.
    objects: Fates,
    /// Triangles; without `--triangles` those of an object have its fate.
    triangles: Fates,
    /// Closed surfaces that were found.
    n_closed_surfaces: usize,
    /// Hidden objects that the file still has, or shows, as they share a node with what is seen or are animated.
    n_stay: usize,
    /// The objects that `--explain` names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    explained: Vec<Part>,
    /// Seconds in all.
    seconds: f64,
}

/// A file that was made.
pub(super) struct MadeFile {
    pub(super) bytes: Vec<u8>,
    /// Hidden objects that stay in it.
    pub(super) n_stay: usize,
}

impl Outcome {
    pub(super) fn new(
        args: &StripArgs,
        from: Vec<String>,
        (scene, stripped): (&Scene, &Stripped),
        file: Option<&MadeFile>,
        explained: Vec<Part>,
        time: Duration,
    ) -> Self {
        Self {
            scene: args.scene.display().to_string(),
            out: args.output.as_ref().map(|path| path.display().to_string()),
            n_bytes: file.map(|file| file.bytes.len()),
            from,
            grain: if args.triangles { "triangles" } else { "parts" },
            gap: args.gap,
            objects: stripped.count_objects().into(),
            triangles: stripped.count_triangles(scene).into(),
            n_closed_surfaces: stripped.n_closed_surfaces,
            n_stay: file.map_or(0, |file| file.n_stay),
            explained,
            seconds: time.as_secs_f64(),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Some(out), Some(n)) = (&self.out, self.n_bytes) {
            writeln!(f, "wrote {out}, {}", bytes(n as u64))?;
        }
        writeln!(f, "eyes           {}", self.from.join(", "))?;
        for (what, fates) in [("objects", &self.objects), ("triangles", &self.triangles)] {
            let share = |n: usize| percent(share(n as f64, fates.n as f64));
            let kept = unless_none(fates.n_kept, |n| format!(", {n} not asked about"));
            let undecided = unless_none(fates.n_undecided, |n| format!(", {n} undecided"));
            let (seen, hidden) = (fates.n_seen, fates.n_hidden);
            let hidden = format!("{hidden} hidden ({})", share(hidden));
            writeln!(f, "{what:<14} {}: {seen} seen, {hidden}{undecided}{kept}", fates.n)?;
        }
        let of = &self.objects;
        let reasons = [
            (of.n_enclosed, "enclosed"),
            (of.n_by_lines, "by lines"),
            (of.n_by_table, "by the table"),
            (of.n_by_gap, "by the gap"),
        ];
        let reasons: Vec<String> =
            reasons.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        if !reasons.is_empty() {
            writeln!(f, "hidden         {} of the objects", reasons.join(", "))?;
        }
        if self.n_stay > 0 {
            writeln!(
                f,
                "still there    {}, which share a node with what is seen or are animated",
                count(self.n_stay as u64, "hidden object")
            )?;
        }
        self.explained.iter().try_for_each(|part| write!(f, "{part}"))?;
        writeln!(f, "time           {}", seconds_of(self.seconds))
    }
}
