//! The clusters of a Quake map, as `vis` and `build` report them.

use crate::output::{JsonSchema, Serialize, count, percent, seconds_of};
use sightlines::bake::ClusterVisibility;
use sightlines::formats::quake::Prt;
use std::collections::BTreeMap;
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

/// What was found about clusters.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Clusters {
    /// Clusters.
    n_clusters: usize,
    /// Portals that have an area.
    n_portals: usize,
    /// Unordered pairs of different clusters that may see each other.
    n_visible_pairs: u64,
    /// `n_visible_pairs` as a share of all unordered pairs of different clusters.
    visible_share: f64,
    /// Pairs of clusters that count as visible though no line was found, the lower number first.
    undecided: Vec<[u32; 2]>,
    /// Counts of elementary operations by name; those of an earlier run included if it was resumed.
    counters: BTreeMap<&'static str, u64>,
    /// Seconds of the search for visible pairs, in this run.
    see_seconds: f64,
    #[serde(skip)]
    n_pairs: u64,
}

impl Clusters {
    pub(crate) fn new(found: &ClusterVisibility) -> Self {
        let (n_visible_pairs, n_pairs) = (found.n_visible_pairs(), found.n_pairs());
        Self {
            n_clusters: found.n_clusters(),
            n_portals: found.n_portals,
            n_visible_pairs,
            visible_share: n_visible_pairs as f64 / n_pairs.max(1) as f64,
            undecided: found.seen.undecided.clone(),
            counters: found.seen.counters.named().into_iter().collect(),
            see_seconds: found.see_time.as_secs_f64(),
            n_pairs,
        }
    }
}

impl fmt::Display for Clusters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "clusters       {}\nportals        {}", self.n_clusters, self.n_portals)?;
        let share = percent(self.visible_share);
        writeln!(f, "visible pairs  {} of {}, {share}", self.n_visible_pairs, self.n_pairs)?;
        writeln!(f, "undecided      {}, which count as visible", count(self.undecided.len() as u64, "pair"))?;
        let effort: Vec<String> = self.counters.iter().map(|(name, n)| format!("{n} {name}")).collect();
        writeln!(f, "effort         {}", effort.join(", "))
    }
}

impl Clusters {
    /// The pairs that are undecided, one on each line.
    pub(crate) fn undecided_pairs(&self) -> impl fmt::Display + '_ {
        struct Pairs<'p>(&'p [[u32; 2]]);
        impl fmt::Display for Pairs<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.iter().try_for_each(|[a, b]| writeln!(f, "  clusters {a} and {b}"))
            }
        }
        Pairs(&self.undecided)
    }

    /// How many there are, with their portals.
    pub(crate) fn brief(&self) -> String {
        let (clusters, portals) = (self.n_clusters as u64, self.n_portals as u64);
        format!("{}, {}", count(clusters, "cluster"), count(portals, "portal"))
    }

    /// How many pairs see each other.
    pub(crate) fn brief_pairs(&self) -> String {
        let undecided = match self.undecided.len() {
            0 => String::new(),
            n => format!(", {n} of them undecided"),
        };
        let [seen, all] = [self.n_visible_pairs, self.n_pairs];
        format!("{seen} of {} visible{undecided}", count(all, "pair"))
    }

    /// Time of the search.
    pub(crate) fn see_seconds(&self) -> f64 {
        self.see_seconds
    }

    /// Time of the search, in words.
    pub(crate) fn time(&self) -> String {
        seconds_of(self.see_seconds)
    }
}
