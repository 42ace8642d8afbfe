//! The report of `vis`.

use super::certify::Certified;
use crate::clusters::Clusters;
use crate::output::{bytes, count, seconds};
use serde::Serialize;
use sightlines::bake::VisMap;
use sightlines::formats::quake::Bsp;
use sightlines::progress::memory;
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// What was written.
#[derive(Debug, Serialize)]
pub(crate) struct Outcome {
    out: String,
    format: &'static str,
    portal_format: &'static str,
    /// Leafs that can be seen.
    n_leafs: usize,
    #[serde(flatten)]
    pub(crate) clusters: Clusters,
    pub(super) fast: bool,
    /// Whether it resumed an earlier run.
    pub(super) resumed: bool,
    /// What was proven, if `--certify` was given.
    pub(super) certified: Option<Certified>,
    pub(crate) n_bytes: usize,
    /// Reading and writing included.
    pub(crate) seconds: f64,
    peak_bytes: Option<u64>,
    #[serde(skip)]
    pub(super) verbose: bool,
}

impl Outcome {
    pub(super) fn new(out: &Path, bsp: &Bsp, portal_format: &'static str, map: &VisMap) -> Self {
        Self {
            out: out.display().to_string(),
            format: bsp.format().name(),
            portal_format,
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
        writeln!(f, "time           {} to compute visibility, {all} in all{run}", self.clusters.time())?;
        self.peak_bytes.map_or(Ok(()), |peak| writeln!(f, "memory         {} at most", bytes(peak)))
    }
}
