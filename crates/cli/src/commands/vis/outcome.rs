//! What `vis` says that it did.

use super::certify::Certified;
use crate::memory;
use crate::output::{bytes, count, percent, seconds};
use serde::Serialize;
use sightlines::bake::quake::named_counters;
use sightlines::bake::{SeenClusters, VisMap};
use sightlines::formats::quake::{Bsp, BspFormat, Prt};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// What was found about clusters.
#[derive(Debug, Serialize)]
pub(crate) struct Clusters {
    n_clusters: usize,
    /// Portals with an area.
    n_portals: usize,
    /// Unordered pairs of different clusters.
    n_visible_pairs: u64,
    /// Of all unordered pairs of different clusters.
    visible_share: f64,
    /// Pairs that count as visible though no line was found, lower id first.
    undecided: Vec<[u32; 2]>,
    /// Counts of elementary operations; of earlier runs too, if this one was resumed.
    counters: BTreeMap<&'static str, u64>,
    /// Of the search, in this run.
    see_seconds: f64,
    #[serde(skip)]
    n_pairs: u64,
}

impl Clusters {
    pub(crate) fn new(found: &SeenClusters) -> Self {
        let (n_visible_pairs, n_pairs) = (found.n_visible_pairs(), found.n_pairs());
        Self {
            n_clusters: found.n_clusters(),
            n_portals: found.n_portals,
            n_visible_pairs,
            visible_share: n_visible_pairs as f64 / n_pairs.max(1) as f64,
            undecided: found.seen.undecided.clone(),
            counters: named_counters(&found.seen.counters).into_iter().collect(),
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

    /// Time of the search.
    pub(crate) fn time(&self) -> String {
        seconds(Duration::from_secs_f64(self.see_seconds))
    }
}

/// A format of maps as users know it.
pub(crate) fn format_name(format: BspFormat) -> &'static str {
    match format {
        BspFormat::Bsp29 => "BSP 29",
        BspFormat::Bsp2 => "BSP2",
        BspFormat::Bsp2Psb => "2PSB",
        BspFormat::Quake2 => "IBSP 38",
    }
}

/// What was written.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    out: String,
    format: &'static str,
    portal_format: &'static str,
    /// Leafs that can be seen.
    n_leafs: usize,
    #[serde(flatten)]
    clusters: Clusters,
    pub(super) fast: bool,
    /// Whether it went on from an earlier run.
    pub(super) resumed: bool,
    /// What was proven, if that was asked for.
    pub(super) certified: Option<Certified>,
    n_bytes: usize,
    /// Reading and writing included.
    pub(super) seconds: f64,
    peak_bytes: Option<u64>,
    #[serde(skip)]
    pub(super) verbose: bool,
}

impl Outcome {
    pub(super) fn new(out: &Path, bsp: &Bsp, prt: &Prt, map: &VisMap) -> Self {
        Self {
            out: out.display().to_string(),
            format: format_name(bsp.format()),
            portal_format: prt.dialect().magic(),
            n_leafs: bsp.n_visible_leafs(),
            clusters: Clusters::new(&map.clusters),
            fast: false,
            resumed: false,
            certified: None,
            n_bytes: map.bytes.len(),
            seconds: 0.0,
            peak_bytes: memory::peak_bytes(),
            verbose: false,
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let leafs = count(self.n_leafs as u64, "leaf");
        writeln!(f, "map            {} with {leafs}, portals {}", self.format, self.portal_format)?;
        let how = if self.fast { "the first, coarse bound only" } else { "exact stabbing of convex portals" };
        writeln!(f, "method         {how}")?;
        write!(f, "{}", self.clusters)?;
        if self.verbose {
            write!(f, "{}", self.clusters.undecided_pairs())?;
        }
        if let Some(certified) = &self.certified {
            write!(f, "{certified}")?;
        }
        let all = seconds(Duration::from_secs_f64(self.seconds));
        let run = if self.resumed { ", in this run" } else { "" };
        writeln!(f, "time           {} to find out who sees whom, {all} in all{run}", self.clusters.time())?;
        self.peak_bytes.map_or(Ok(()), |peak| writeln!(f, "memory         {} at most", bytes(peak)))
    }
}
