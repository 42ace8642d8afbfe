//! Proofs for a table, from its graph.

use crate::baked::Baked;
use crate::graph::{GraphRef, OtherGraph, TableGraph};
use crate::stopwatch::Stopwatch;
use sightlines_certificates::axial::{AxialNetworkError, AxialProofs};
use sightlines_certificates::convex::{ConvexNetworkError, ConvexProofs};
use sightlines_certificates::planar::{NetworkError, PlanarProofs};
use sightlines_geometry::Aabb;
use sightlines_progress::{Cancelled, Halt};
use sightlines_pvs::{CellId, Table};
use sightlines_stabtree::{
    CertifyError as SearchError, CertifyOptions, ObjectRows, certify_axial, certify_convex, certify_planar,
};
use std::error::Error;
use std::time::Duration;

/// Why a table cannot have proofs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// There are no portals: the cells are boxes that were given, or the portals were stripped.
    #[error("proofs need the cells and portals that the table was made from, and it does not have them")]
    NoGraph,
    /// The graph of another table.
    #[error(transparent)]
    OtherGraph(#[from] OtherGraph),
    /// Cells or portals of a plan that nothing can be proven about.
    #[error(transparent)]
    Plan(#[from] NetworkError),
    /// Cells or portals of a scene in space that nothing can be proven about.
    #[error(transparent)]
    Space(#[from] AxialNetworkError),
    /// Cells or portals of a Quake map that nothing can be proven about.
    #[error(transparent)]
    Convex(#[from] ConvexNetworkError),
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The store of units ends the work: it keeps what was done, and the rest is for others or later.
    #[error(transparent)]
    Halted(Halt),
}

impl CertifyError {
    fn of<N: Error + Into<Self>>(error: SearchError<N>) -> Self {
        match error {
            SearchError::Network(error) => error.into(),
            SearchError::Halted(halt) => Self::Halted(halt),
            _ => Cancelled.into(),
        }
    }
}

/// Proofs of a table, of the kind that it is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Proofs {
    /// Of a plan.
    Plan(PlanarProofs),
    /// Of a scene in space.
    Space(AxialProofs),
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

/// Proofs, and the time that they took.
#[derive(Debug, Clone, PartialEq)]
pub struct Certified {
    /// The proofs.
    pub proofs: Proofs,
    /// Time to find them.
    pub time: Duration,
}

/// Finds proofs for the pairs of cells of a table, and in space for the objects that cells do not see.
///
/// A pair without one is left open, so nothing here has to be trusted: the checker decides
/// which pairs are proven. Proofs know no sides of walls: a table of a scene some walls of which hide from one side only has to be
/// [baked for proofs](crate::BakeRequest::for_proofs), or the lines past the backs of these contradict it.
///
/// * `graph`: the one that the table was made from: [`Baked::graph`], or
///   [`from_table::graph`](fn@crate::from_table::graph) of a table from a file
///
/// # Errors
/// [`CertifyError::NoGraph`] for boxes without portals; [`CertifyError::OtherGraph`] for the graph of another table;
/// [`CertifyError::Cancelled`] if the observer cancels, [`CertifyError::Halted`] by the store of units; others for cells and portals that nothing can be proven about.
pub fn certify_table<'g>(
    table: &Table,
    graph: impl Into<GraphRef<'g>>,
    options: &CertifyOptions<'_>,
) -> Result<Certified, CertifyError> {
    let start = Stopwatch::start();
    let graph = graph.into();
    graph.check_size(table)?;
    let rows = &table.parts().rows;
    let proofs = match graph {
        GraphRef::Planar(graph) => Proofs::Plan(certify_planar(graph, rows, options).map_err(CertifyError::of)?),
        GraphRef::Axial(graph) => {
            let boxes: Vec<Aabb<3>> = table.objects().iter().map(|o| Aabb { min: o.min, max: o.max }).collect();
            let cells = (0..table.n_cells() as u32).map(CellId);
            let seen: Vec<_> = cells.map(|cell| table.visible_objects(cell)).collect();
            let objects = Some(ObjectRows { boxes: &boxes, seen: &seen });
            Proofs::Space(certify_axial(graph, rows, objects, options).map_err(CertifyError::of)?)
        }
        GraphRef::Convex(graph) => Proofs::Convex(certify_convex(graph, rows, options).map_err(CertifyError::of)?),
        GraphRef::Boxes(_) => return Err(CertifyError::NoGraph),
    };
    Ok(Certified { proofs, time: start.elapsed() })
}

impl<R> Baked<TableGraph, R> {
    /// Proofs for the pairs of the table ([`certify_table`]).
    ///
    /// # Errors
    /// As [`certify_table`].
    pub fn certify(&self, options: &CertifyOptions<'_>) -> Result<Certified, CertifyError> {
        certify_table(&self.table, &self.graph, options)
    }
}
