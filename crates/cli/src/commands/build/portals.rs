//! What was built from a portal file.

use super::brief::Brief;
use crate::clusters::Clusters;
use crate::output::{JsonSchema, Serialize, bytes};
use sightlines::bake::ClusterVisibility;
use sightlines::formats::Prt;
use std::fmt;
use std::path::Path;

pub(super) fn write_method(
    f: &mut fmt::Formatter<'_>,
    fast: bool,
    of: fmt::Arguments<'_>,
    clusters: &Clusters,
    verbose: bool,
) -> fmt::Result {
    write!(f, "method         {}, of {of}\n{clusters}", method(fast))?;
    if verbose {
        write!(f, "{}", clusters.undecided_pairs())?;
    }
    Ok(())
}

const fn method(fast: bool) -> &'static str {
    if fast { "the first, coarse bound only" } else { "exact stabbing of convex portals" }
}

/// What was built from a map, in three lines.
pub(super) fn of_clusters(taken: String, fast: bool, clusters: &Clusters, out: &str, n_bytes: usize) -> Brief {
    Brief {
        kind: "map",
        taken,
        method: method(fast).to_owned(),
        cells: clusters.brief(),
        out: out.to_owned(),
        n_bytes,
        visible: clusters.brief_pairs(),
        seconds: clusters.see_seconds(),
    }
}

/// The table of a portal file.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The table that was written.
    out: String,
    /// Dialect of the portal file.
    portal_format: &'static str,
    /// Whether only a coarse bound was computed.
    fast: bool,
    #[serde(flatten)]
    clusters: Clusters,
    /// Bytes of the table.
    n_bytes: usize,
    /// Whether pairs that are undecided are listed.
    #[serde(skip)]
    verbose: bool,
}

impl Outcome {
    pub(crate) fn new(
        out: &Path,
        prt: &Prt,
        fast: bool,
        found: &ClusterVisibility,
        n_bytes: usize,
        verbose: bool,
    ) -> Self {
        Self {
            out: out.display().to_string(),
            portal_format: prt.dialect().name(),
            fast,
            clusters: Clusters::new(found),
            n_bytes,
            verbose,
        }
    }

    pub(super) fn brief(&self) -> Brief {
        let taken = format!("a {} file", self.portal_format);
        of_clusters(taken, self.fast, &self.clusters, &self.out, self.n_bytes)
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        write_method(f, self.fast, format_args!("a {} file", self.portal_format), &self.clusters, self.verbose)?;
        writeln!(f, "time           {} to compute visibility", self.clusters.time())
    }
}
