//! The report of `vis`.

use crate::clusters::Clusters;
use crate::output::{JsonSchema, Serialize, bytes, count, seconds_of};
use sightlines::bake::VisMap;
use sightlines::bake::quake::{ProvenPairs, SampledProofs};
use sightlines::formats::quake::Bsp;
use sightlines::progress::memory;
use std::fmt;
use std::path::Path;

/// The map that was written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The map that was written.
    out: String,
    /// Format of the map.
    format: &'static str,
    /// Dialect of the portal file, or `made from the map`.
    portal_format: &'static str,
    /// Leafs that can be visible.
    n_leafs: usize,
    #[serde(flatten)]
    pub(crate) clusters: Clusters,
    /// Whether only a coarse bound was computed.
    pub(super) fast: bool,
    /// Whether an interrupted run was resumed.
    pub(super) resumed: bool,
    /// With `--certify`: what was proven; null without.
    pub(super) certified: Option<SampledProofs>,
    /// Bytes of the map.
    pub(crate) n_bytes: usize,
    /// Seconds in all, reading and writing included.
    pub(crate) seconds: f64,
    /// The largest memory in use; null if the system does not report it.
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
            write_proofs(f, certified)?;
        }
        let all = seconds_of(self.seconds);
        let run = if self.resumed { ", in this run" } else { "" };
        writeln!(f, "time           {} to compute visibility, {all} in all{run}", self.clusters.time())?;
        self.peak_bytes.map_or(Ok(()), |peak| writeln!(f, "memory         {} at most", bytes(peak)))
    }
}

/// The lines about proofs of some pairs.
fn write_proofs(f: &mut fmt::Formatter<'_>, proofs: &SampledProofs) -> fmt::Result {
    for (what, proven) in [("visible", &proofs.visible), ("hidden", &proofs.hidden)] {
        let ProvenPairs { n_picked, n_accepted, n_loose, n_too_many, n_undecided } = proven;
        write!(f, "certified      {n_accepted} of {} checked", count(*n_picked as u64, &format!("{what} pair")))?;
        for (n, why) in
            [(n_loose, "hidden after all"), (n_too_many, "with too many sequences"), (n_undecided, "undecided")]
        {
            if *n > 0 {
                write!(f, ", {n} {why}")?;
            }
        }
        writeln!(f)?;
    }
    Ok(())
}
