//! From a portal file to the table of its clusters.

use super::BakeArgs;
use crate::commands::vis::Clusters;
use crate::error::CliError;
use crate::output::bytes;
use crate::progress::ShareBar;
use serde::Serialize;
use sightlines::bake::{BakedPrt, PrtOptions, bake_prt};
use sightlines::formats::Prt;
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use std::fmt;
use std::path::Path;

/// Builds the table of the clusters of a portal file that came from `path`.
pub(crate) fn bake(path: &Path, prt: &Prt, args: &BakeArgs, show_progress: bool) -> Result<BakedPrt, CliError> {
    args.check_for_portals(path)?;
    let mut bar = ShareBar::new("which clusters see which", show_progress);
    let mut watch = |search: &ConvexSearch| bar.set(search.share_done());
    let search = ConvexOptions { fast: args.fast, threads: args.threads };
    let baked = bake_prt(prt, PrtOptions { search, from: None, watch: Some(&mut watch) });
    baked.map_err(|source| CliError::BakePrt { path: path.to_owned(), source })
}

/// What was built.
#[derive(Debug, Serialize)]
pub(crate) struct Outcome {
    out: String,
    portal_format: &'static str,
    fast: bool,
    #[serde(flatten)]
    clusters: Clusters,
    n_bytes: usize,
    #[serde(skip)]
    verbose: bool,
}

impl Outcome {
    pub(crate) fn new(out: &Path, prt: &Prt, args: &BakeArgs, baked: &BakedPrt, n_bytes: usize) -> Self {
        Self {
            out: out.display().to_string(),
            portal_format: prt.dialect().magic(),
            fast: args.fast,
            clusters: Clusters::new(&baked.clusters),
            n_bytes,
            verbose: false,
        }
    }

    /// Lists pairs that are undecided.
    pub(crate) fn verbose(mut self, verbose: bool) -> Self {
        self.verbose = verbose;
        self
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let how = if self.fast { "the first, coarse bound only" } else { "exact stabbing of convex portals" };
        writeln!(f, "method         {how}, of a {} file", self.portal_format)?;
        write!(f, "{}", self.clusters)?;
        if self.verbose {
            write!(f, "{}", self.clusters.undecided_pairs())?;
        }
        writeln!(f, "time           {} to find out who sees whom", self.clusters.time())
    }
}
