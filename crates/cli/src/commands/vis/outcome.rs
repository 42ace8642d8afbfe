//! The report of `vis`.

use crate::clusters::Clusters;
use crate::output::{JsonSchema, Serialize, bytes, count, seconds_of};
use sightlines::bake::VisMap;
use sightlines::bake::quake::{ProvenPairs, SampledProofs, WishReport};
use sightlines::formats::quake::Bsp;
use sightlines::progress::memory;
use std::fmt;
use std::path::Path;

/// The map that was written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The map, or the VisPatch file, that was written.
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
    /// With `--visdist` or `--overrides`: what these changed, after visibility was found; null without.
    pub(crate) wishes: Option<Wishes>,
    /// With `--certify`: what was proven; null without.
    pub(super) certified: Option<SampledProofs>,
    /// Bytes of what was written.
    pub(crate) n_bytes: usize,
    /// Seconds in all, reading and writing included.
    pub(crate) seconds: f64,
    /// The largest memory in use; null if the system does not report it.
    peak_bytes: Option<u64>,
    #[serde(skip)]
    pub(super) verbose: bool,
}

/// What was changed because a user wanted it.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Wishes {
    /// With `--visdist`: the distance; null without.
    visdist: Option<f64>,
    /// Pairs of clusters that see each other and were hidden because their boxes are farther from each other.
    n_far_pairs: u64,
    /// Overrides that show a pair that was hidden.
    n_shown: usize,
    /// Overrides that hide what was shown.
    n_hidden: usize,
    /// Overrides that changed nothing.
    n_without_effect: usize,
}

impl Wishes {
    /// `None` if there were none.
    pub(super) fn new(visdist: Option<f64>, has_overrides: bool, did: &WishReport) -> Option<Self> {
        let &WishReport { n_far, n_shown, n_hidden, n_without_effect } = did;
        let all = Self { visdist, n_far_pairs: n_far, n_shown, n_hidden, n_without_effect };
        (visdist.is_some() || has_overrides).then_some(all)
    }

    /// A line for each kind, for people.
    pub(crate) fn lines(&self) -> Vec<String> {
        let far = self.visdist.map(|distance| {
            format!(
                "{} hidden that see each other and are farther apart than {distance}",
                count(self.n_far_pairs, "pair")
            )
        });
        let all = self.n_shown + self.n_hidden + self.n_without_effect;
        let overrides = (all > 0).then(|| {
            let each =
                format!("{} show, {} hide, {} change nothing", self.n_shown, self.n_hidden, self.n_without_effect);
            format!("{}: {each}", count(all as u64, "override"))
        });
        far.into_iter().chain(overrides).collect()
    }
}

impl Outcome {
    pub(super) fn new((out, n_bytes): (&Path, usize), bsp: &Bsp, portal_format: &'static str, map: &VisMap) -> Self {
        Self {
            out: out.display().to_string(),
            format: bsp.format().name(),
            portal_format,
            n_leafs: bsp.n_visible_leafs(),
            clusters: Clusters::new(&map.clusters),
            fast: false,
            resumed: false,
            wishes: None,
            certified: None,
            n_bytes,
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
        for line in self.wishes.iter().flat_map(Wishes::lines) {
            writeln!(f, "wishes         {line}")?;
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
