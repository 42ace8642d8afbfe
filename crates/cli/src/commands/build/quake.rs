//! What was built from a Quake map with its portal file.

use super::Error;
use super::brief::Brief;
use super::portals::{of_clusters, write_method};
use crate::clusters::Clusters;
use crate::error::InputError;
use crate::output::{bytes, count};
use serde::Serialize;
use sightlines::bake::{MapReport, PrtBakeError, WorldSummary};
use sightlines::formats::Prt;
use sightlines::formats::quake::{Bsp, VisibilityError};
use std::fmt;
use std::path::Path;

/// Names the file that an error is about: the map, its portal file, or both if they do not go together.
pub(super) fn failed(map: &Path, portals: &Path, source: PrtBakeError) -> Error {
    match source {
        PrtBakeError::Bsp(_) => Error::BakePrt { path: map.to_owned(), source },
        PrtBakeError::Visibility(
            source @ (VisibilityError::Leafs { .. }
            | VisibilityError::Clusters { .. }
            | VisibilityError::OtherMap { .. }
            | VisibilityError::InsideOut { .. }),
        ) => InputError::of_portals(portals, map, Box::new(source)).into(),
        source => Error::BakePrt { path: portals.to_owned(), source },
    }
}

/// What was built.
#[derive(Debug, Serialize)]
pub(crate) struct Outcome {
    out: String,
    format: &'static str,
    portal_format: &'static str,
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
    /// Planes between clusters, or between them and what is solid.
    n_planes: usize,
    /// How near to a plane a viewer counts to both sides, in map units.
    slack: f64,
    n_bytes: usize,
    #[serde(skip)]
    verbose: bool,
}

impl Outcome {
    pub(crate) fn new(out: &Path, bsp: &Bsp, prt: &Prt, fast: bool, report: &MapReport, n_bytes: usize) -> Self {
        let WorldSummary { n_faces, n_unlisted_faces, n_listed, n_reaching, n_planes, slack, .. } = report.world;
        Self {
            out: out.display().to_string(),
            format: bsp.format().name(),
            portal_format: prt.dialect().name(),
            fast,
            clusters: Clusters::new(&report.clusters),
            n_faces,
            n_unlisted_faces,
            n_listed,
            n_reaching,
            n_planes,
            slack,
            n_bytes,
            verbose: false,
        }
    }

    pub(super) fn brief(&self) -> Brief {
        let faces = count(self.n_faces as u64, "face");
        let taken = format!("a {} map with its {} file: {faces} of the world", self.format, self.portal_format);
        of_clusters(taken, self.fast, &self.clusters, &self.out, self.n_bytes)
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
        let of = format_args!("a {} map with its {} file", self.format, self.portal_format);
        write_method(f, self.fast, of, &self.clusters, self.verbose)?;
        let never = match self.n_unlisted_faces {
            0 => String::new(),
            n => format!(", {n} of them never drawn"),
        };
        writeln!(f, "objects        {} of the world{never}", count(self.n_faces as u64, "face"))?;
        writeln!(f, "planes         {}, known to {:.1e} units", self.n_planes, self.slack)?;
        writeln!(f, "time           {} to compute visibility", self.clusters.time())
    }
}
