//! From a portal file to the table of its clusters.

use super::BakeArgs;
use super::Error;
use crate::clusters::Clusters;
use crate::output::bytes;
use crate::progress::Bar;
use serde::Serialize;
use sightlines::bake::{BakedPrt, PrtOptions, bake_prt};
use sightlines::formats::Prt;
use sightlines::stabtree::ConvexOptions;
use std::fmt;
use std::path::Path;

/// Builds the table of the clusters of a portal file that came from `path`.
pub(crate) fn bake(path: &Path, prt: &Prt, args: &BakeArgs, show_progress: bool) -> Result<BakedPrt, Error> {
    args.check_for_portals(path)?;
    let baked = with_progress(args, show_progress, |options| bake_prt(prt, options));
    baked.map_err(|source| Error::BakePrt { path: path.to_owned(), source })
}

/// Runs a search with the options of the command, and shows how far it is.
pub(super) fn with_progress<T>(args: &BakeArgs, show_progress: bool, run: impl FnOnce(PrtOptions<'_>) -> T) -> T {
    let bar = Bar::new("visibility of clusters", show_progress);
    let search = ConvexOptions { fast: args.fast, threads: args.threads };
    run(PrtOptions { search, progress: Some(&bar), ..PrtOptions::default() })
}

/// Tells how it was found out which clusters of what see which, and what came out of it.
pub(super) fn write_method(
    f: &mut fmt::Formatter<'_>,
    fast: bool,
    of: fmt::Arguments<'_>,
    clusters: &Clusters,
    verbose: bool,
) -> fmt::Result {
    let how = if fast { "the first, coarse bound only" } else { "exact stabbing of convex portals" };
    write!(f, "method         {how}, of {of}\n{clusters}")?;
    if verbose {
        write!(f, "{}", clusters.undecided_pairs())?;
    }
    Ok(())
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
        write_method(f, self.fast, format_args!("a {} file", self.portal_format), &self.clusters, self.verbose)?;
        writeln!(f, "time           {} to find out who sees whom", self.clusters.time())
    }
}
