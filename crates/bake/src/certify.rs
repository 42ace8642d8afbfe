//! Proofs for a finished table.

use crate::{axial_graph_of, convex_graph_of, graph_of};
use sightlines_certificates::convex::{ConvexNetworkError, ConvexProofs};
use sightlines_certificates::plan::{NetworkError, PlanProofs};
use sightlines_certificates::space::{BoxNetworkError, BoxProofs};
use sightlines_pvs::Table;
use sightlines_stabtree::{CertifyOptions, certify_convex, certify_plan, certify_space};
use std::time::{Duration, Instant};

/// Why a table cannot have proofs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// The table does not have the cells and portals that it was made from.
    #[error("proofs need the cells and portals that the table was made from, and it does not have them")]
    NoGraph,
    /// Cells or portals of a plan that nothing can be proven about.
    #[error(transparent)]
    Plan(#[from] NetworkError),
    /// Cells or portals of a scene in space that nothing can be proven about.
    #[error(transparent)]
    Space(#[from] BoxNetworkError),
    /// Cells or portals of a Quake map that nothing can be proven about.
    #[error(transparent)]
    Convex(#[from] ConvexNetworkError),
}

/// Proofs of a table, of the kind that it is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Proofs {
    /// Of a plan.
    Plan(PlanProofs),
    /// Of a scene in space.
    Space(BoxProofs),
    /// Of a Quake map, or of a portal file.
    Convex(ConvexProofs),
}

impl Proofs {
    /// The bytes of these proofs.
    pub fn to_bytes(&self) -> Vec<u8> {
        match self {
            Self::Plan(proofs) => proofs.to_bytes(),
            Self::Space(proofs) => proofs.to_bytes(),
            Self::Convex(proofs) => proofs.to_bytes(),
        }
    }
}

/// Proofs, and how they came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Certified {
    /// The proofs.
    pub proofs: Proofs,
    /// Time to find them.
    pub time: Duration,
}

/// Finds proofs for what a table says. What it finds none for is left open, so this needs no trust: whether all pairs
/// have a proof is for the checker to say.
///
/// # Errors
/// [`CertifyError`] for tables of regions, and those whose portals were stripped.
pub fn certify_table(table: &Table, options: &CertifyOptions) -> Result<Certified, CertifyError> {
    let start = Instant::now();
    let rows = &table.parts().rows;
    let proofs = if let Some(graph) = graph_of(table) {
        Proofs::Plan(certify_plan(&graph, rows, options)?)
    } else if let Some(graph) = axial_graph_of(table) {
        Proofs::Space(certify_space(&graph, rows, options)?)
    } else if let Some(graph) = convex_graph_of(table) {
        Proofs::Convex(certify_convex(&graph, rows, options)?)
    } else {
        return Err(CertifyError::NoGraph);
    };
    Ok(Certified { proofs, time: start.elapsed() })
}
