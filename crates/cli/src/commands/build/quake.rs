//! What was built from a Quake map with its portal file.

use super::brief::Brief;
use super::portals::{of_clusters, write_method};
use crate::clusters::Clusters;
use crate::error::anyhow;
use crate::map_portals::{MADE, do_not_fit};
use crate::output::{JsonSchema, Serialize, bytes, count, unless_none};
use sightlines::bake::{MapReport, PrtBakeError, WorldSummary};
use sightlines::formats::quake::{Bsp, VisibilityError};
use std::fmt;
use std::path::Path;

/// Names the file that an error is about: the map, its portal file, or both if they do not go together.
pub(super) fn failed(map: &Path, portals: &Path, source: PrtBakeError) -> anyhow::Error {
    match source {
        PrtBakeError::Bsp(_) => anyhow!("{}: {source}", map.display()),
        PrtBakeError::Visibility(
            source @ (VisibilityError::Leafs { .. }
            | VisibilityError::Clusters { .. }
            | VisibilityError::OtherMap { .. }
            | VisibilityError::InsideOut { .. }),
        ) => do_not_fit(portals, map, &source),
        source => anyhow!("{}: {source}", portals.display()),
    }
}

/// The table of a Quake map.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The table that was written.
    out: String,
    /// Format of the map.
    format: &'static str,
    /// Dialect of the portal file, or `made from the map`.
    portal_format: &'static str,
    /// Whether only a coarse bound was computed.
    fast: bool,
    #[serde(flatten)]
    clusters: Clusters,
    /// Faces of the world, which are the objects of the table.
    n_faces: usize,
    /// Faces that no leaf lists, which engines never draw.
    n_unlisted_faces: usize,
    /// Pairs of a cluster and a face that one of its leafs lists.
    n_listed: usize,
    /// Pairs of a cluster and a face that reaches into it without being listed there.
    n_reaching: usize,
    /// Planes between clusters, or between clusters and solids.
    n_planes: usize,
    /// Distance to a plane, in map units, within which a viewer counts as on both sides.
    slack: f64,
    /// Bytes of the table.
    n_bytes: usize,
    /// Whether pairs that are undecided are listed.
    #[serde(skip)]
    verbose: bool,
}

impl Outcome {
    pub(crate) fn new(
        out: &Path,
        bsp: &Bsp,
        portal_format: &'static str,
        fast: bool,
        report: &MapReport,
        n_bytes: usize,
        verbose: bool,
    ) -> Self {
        let WorldSummary { n_faces, n_unlisted_faces, n_listed, n_reaching, n_planes, slack, .. } = report.world;
        Self {
            out: out.display().to_string(),
            format: bsp.format().name(),
            portal_format,
            fast,
            clusters: Clusters::new(&report.clusters),
            n_faces,
            n_unlisted_faces,
            n_listed,
            n_reaching,
            n_planes,
            slack,
            n_bytes,
            verbose,
        }
    }

    pub(super) fn brief(&self) -> Brief {
        let faces = count(self.n_faces as u64, "face");
        let taken = format!("{}: {faces} of the world", self.taken());
        of_clusters(taken, self.fast, &self.clusters, &self.out, self.n_bytes)
    }

    fn taken(&self) -> String {
        match self.portal_format {
            MADE => format!("a {} map, with portals made from it", self.format),
            portals => format!("a {} map with its {portals} file", self.format),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let of = self.taken();
        write_method(f, self.fast, format_args!("{of}"), &self.clusters, self.verbose)?;
        let never = unless_none(self.n_unlisted_faces, |n| format!(", {n} of them never drawn"));
        writeln!(f, "objects        {} of the world{never}", count(self.n_faces as u64, "face"))?;
        writeln!(f, "planes         {}, known to {:.1e} units", self.n_planes, self.slack)?;
        writeln!(f, "time           {} to compute visibility", self.clusters.time())
    }
}
