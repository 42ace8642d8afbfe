//! The clusters of a Quake map, as `vis` and `build` report them.

use crate::output::{JsonSchema, Serialize, count, percent, seconds_of, unless_none};
use sightlines::bake::{ClusterSummary, ClusterVisibility};
use sightlines::formats::quake::Prt;
use std::fmt;
use std::path::Path;

/// Warns of portals that a file has more than once.
pub(crate) fn warn_of_repeats(path: &Path, prt: &Prt) {
    let n = prt.n_repeats() as u64;
    if n > 0 {
        let repeats = if n == 1 { "repeats an earlier one and is" } else { "repeat earlier ones and are" };
        tracing::warn!("{}: {} {repeats} ignored", path.display(), count(n, "portal"));
    }
}

/// What was found about clusters, with words for people.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Clusters {
    #[serde(flatten)]
    summary: ClusterSummary,
}

impl Clusters {
    pub(crate) fn new(found: &ClusterVisibility) -> Self {
        Self { summary: found.into() }
    }
}

impl fmt::Display for Clusters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "clusters       {}\nportals        {}", self.summary.n_clusters, self.summary.n_portals)?;
        let share = percent(self.summary.visible_share);
        writeln!(f, "visible pairs  {} of {}, {share}", self.summary.n_visible_pairs, self.summary.n_pairs)?;
        writeln!(f, "undecided      {}, which count as visible", count(self.summary.undecided.len() as u64, "pair"))?;
        let effort: Vec<String> = self.summary.counters.iter().map(|(name, n)| format!("{n} {name}")).collect();
        writeln!(f, "effort         {}", effort.join(", "))
    }
}

impl Clusters {
    /// The pairs that are undecided, one on each line.
    pub(crate) fn undecided_pairs(&self) -> String {
        self.summary.undecided.iter().map(|[a, b]| format!("  clusters {a} and {b}\n")).collect()
    }

    /// How many there are, with their portals.
    pub(crate) fn brief(&self) -> String {
        let (clusters, portals) = (self.summary.n_clusters as u64, self.summary.n_portals as u64);
        format!("{}, {}", count(clusters, "cluster"), count(portals, "portal"))
    }

    /// How many pairs see each other.
    pub(crate) fn brief_pairs(&self) -> String {
        let undecided = unless_none(self.summary.undecided.len(), |n| format!(", {n} of them undecided"));
        let [seen, all] = [self.summary.n_visible_pairs, self.summary.n_pairs];
        format!("{seen} of {} visible{undecided}", count(all, "pair"))
    }

    /// Time of the search.
    pub(crate) fn see_seconds(&self) -> f64 {
        self.summary.see_seconds
    }

    pub(crate) fn time(&self) -> String {
        seconds_of(self.summary.see_seconds)
    }
}
