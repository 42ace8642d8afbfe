//! Proofs that came with a table, checked against its cells, portals and rows.
//!
//! The proofs are checked by `sightlines-certificates`, which knows no tables: what it proves of cells and portals is compared
//! here with what the table says. Whether cells and portals are those of the scene is what the structure's check is for.

use sightlines_certificates::axial::{AxialNetwork, AxialNetworkError, AxialPortal, AxialProofs};
use sightlines_certificates::convex::{ConvexNetwork, ConvexNetworkError, ConvexPortal, ConvexProofs};
use sightlines_certificates::planar::{NetworkError, PlanarNetwork, PlanarPortal, PlanarProofs};
use sightlines_certificates::{Kind, Proven, ReadError, Refusal, kind_of};
use sightlines_pvs::{CellId, SceneMethods, Table, TableKind};
use std::fmt;

/// Why proofs cannot be compared with a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProofError {
    /// The bytes are no proofs.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Proofs for another kind of table.
    #[error("the proofs are for {proofs}, and the table is {table}")]
    Kind {
        /// What they are for.
        proofs: &'static str,
        /// What the table is of.
        table: &'static str,
    },
    /// The table was stripped of its portals, or never had any.
    #[error("proofs speak of cells and portals, and the table does not have them")]
    NoGraph,
    /// A portal without the corners that it should have.
    #[error("portal {0} of the table is no rectangle across an axis")]
    Portal(usize),
    /// Cells or portals of a plan that nothing can be proven about.
    #[error("the table: {0}")]
    Plan(#[from] NetworkError),
    /// Cells or portals of a scene in space that nothing can be proven about.
    #[error("the table: {0}")]
    Space(#[from] AxialNetworkError),
    /// Cells or portals of a Quake map that nothing can be proven about.
    #[error("the table: {0}")]
    Convex(#[from] ConvexNetworkError),
}

/// Something that the proofs show not to be as the table says.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProofViolation {
    /// The proofs are of other cells, or one of them does not hold.
    Refused(Refusal),
    /// Cells that are hidden from each other in the table, and a checked line joins them.
    Joined([CellId; 2]),
    /// Cells that see each other in the table of a plan or a Quake map, and it is proven that no line joins them.
    Apart([CellId; 2]),
}

impl fmt::Display for ProofViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => write!(f, "the proofs do not hold: {refusal}"),
            Self::Joined([a, b]) => {
                write!(f, "cells {a} and {b} are hidden from each other, but a proven line joins them")
            }
            Self::Apart([a, b]) => {
                write!(f, "cells {a} and {b} see each other, but it is proven that no line joins them")
            }
        }
    }
}

/// What proofs say about a table; counts are of unordered pairs of different cells but where they are of objects.
///
/// Without a proof nothing is known to be wrong, and nothing is certain. Showing too much hides nothing: tables of scenes in space give cells that are
/// too thin to be decided the pairs of their neighbours, and some pairs are only assumed visible. In tables that no from-region method took part in, a
/// hidden pair that a line through portals joins is a violation; such a method hides by walls that are no borders of cells, of which proofs do not speak.
///
/// A cell and an object are proven hidden by a proof of their own, or as every cell that the object touches is proven hidden, if there is any. Of plans
/// and Quake maps the table says which cells those are; the check of its structure compares that with the scene.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct ProofFindings {
    /// Pairs that the table lists as visible and that a line joins.
    pub n_visible: u64,
    /// Pairs that the table lists as hidden and that are proven.
    pub n_hidden: u64,
    /// Pairs listed as visible and proven to be hidden; only in tables of scenes in space, which show pairs that they do not decide.
    pub n_excess: u64,
    /// Pairs listed as visible without a proof.
    pub n_unproven_visible: u64,
    /// Pairs listed as hidden without a proof.
    pub n_unproven_hidden: u64,
    /// Of the pairs listed as hidden without a proof, those that a line through portals joins: only a from-region method hides them.
    pub n_hidden_past_portals: u64,
    /// Some of the pairs hidden without a proof, by their cells.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::as_json::pairs"))]
    #[cfg_attr(feature = "schemars", schemars(with = "Vec<[u32; 2]>"))]
    pub unproven_hidden: Vec<[CellId; 2]>,
    /// Pairs of a cell and an object listed as hidden, with a proof.
    pub n_hidden_objects: u64,
    /// Pairs of a cell and an object listed as hidden, without a proof.
    pub n_unproven_hidden_objects: u64,
    /// Violations.
    pub n_violations: u64,
    /// Some of the violations, a sentence each.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::as_json::texts"))]
    #[cfg_attr(feature = "schemars", schemars(with = "Vec<String>"))]
    pub violations: Vec<ProofViolation>,
}

impl ProofFindings {
    /// Pairs and violations that are listed; beyond, they are counted.
    pub const MOST_LISTED: usize = 1000;

    /// Whether nothing speaks against the table; if `strict`, also whether everything that it hides is proven to be hidden.
    pub const fn is_true(&self, strict: bool) -> bool {
        self.n_violations == 0 && (!strict || self.n_unproven_hidden + self.n_unproven_hidden_objects == 0)
    }

    fn add(&mut self, violation: ProofViolation) {
        self.n_violations += 1;
        if self.violations.len() < Self::MOST_LISTED {
            self.violations.push(violation);
        }
    }

    /// Everything that a table states, as far as nothing of it is proven. For tables that cannot have proofs: their counts of what rests on methods
    /// and rays alone. O(cells (cells + objects)).
    pub fn without_proofs(table: &Table) -> Self {
        Self::of(table, |_, _| [false; 2], |_, _| false)
    }

    fn compared(table: &Table, proven: &Proven) -> Self {
        let cells = |a, b| [proven.visible.has(a, b), proven.hidden.has(a, b)];
        if table.parts().objects_seen.is_some() {
            return Self::of(table, cells, |cell, object| proven.hidden_objects.has(cell, object));
        }
        let mut touched = vec![Vec::new(); table.objects().len()];
        for cell in (0..table.n_cells() as u32).map(CellId) {
            table.objects_of(cell).iter().for_each(|object| touched[object.idx()].push(cell.0));
        }
        Self::of(table, cells, |cell, object| {
            touched[object as usize].iter().all(|&other| proven.hidden.has(cell, other))
        })
    }

    /// Compares with what is proven visible and hidden of each pair.
    fn of(table: &Table, proven: impl Fn(u32, u32) -> [bool; 2], is_object_hidden: impl Fn(u32, u32) -> bool) -> Self {
        let mut findings = Self::default();
        let by_regions = has_from_region(table.kind());
        let may_exceed = table.dimension() == 3 && !table.kind().is_quake();
        let n = table.n_cells() as u32;
        for a in 0..n {
            for b in a + 1..n {
                let pair = [CellId(a), CellId(b)];
                let [joined, apart] = proven(a, b);
                match (table.sees(pair[0], pair[1]), joined, apart) {
                    (true, true, false) => findings.n_visible += 1,
                    (false, false, true) => findings.n_hidden += 1,
                    (true, false, true) if may_exceed => findings.n_excess += 1,
                    (true, _, true) => findings.add(ProofViolation::Apart(pair)),
                    (false, true, _) if !by_regions => findings.add(ProofViolation::Joined(pair)),
                    (true, false, false) => findings.n_unproven_visible += 1,
                    (false, ..) => {
                        findings.n_unproven_hidden += 1;
                        findings.n_hidden_past_portals += u64::from(joined);
                        if findings.unproven_hidden.len() < Self::MOST_LISTED {
                            findings.unproven_hidden.push(pair);
                        }
                    }
                }
            }
            let mut seen = table.visible_objects(CellId(a)).into_iter().peekable();
            for object in 0..table.objects().len() as u32 {
                if seen.next_if(|other| other.0 == object).is_some() {
                    continue;
                }
                match is_object_hidden(a, object) {
                    true => findings.n_hidden_objects += 1,
                    false => findings.n_unproven_hidden_objects += 1,
                }
            }
        }
        findings
    }
}

/// Whether a from-region method took part in a table, whose reasons are no walls between cells.
const fn has_from_region(kind: TableKind) -> bool {
    match kind {
        TableKind::SceneKdTree { hidden_by } | TableKind::SceneGivenCells { hidden_by } => {
            let SceneMethods { from_region, .. } = hidden_by;
            from_region
        }
        _ => false,
    }
}

/// Whether proofs can speak of a table: not if its cells are boxes that were given or cut without portals, between which anything may
/// stand, and which may overlap. [`ProofFindings::without_proofs`] counts what such a table states.
pub fn can_be_proven(table: &Table) -> bool {
    !matches!(table.kind(), TableKind::SceneGivenCells { .. })
}

/// Checks all proofs, and compares what they prove with a table. Exact.
///
/// Cost: as for [`PlanarProofs::check`], [`AxialProofs::check`] and [`ConvexProofs::check`], and O(cells (cells + objects)), where the objects of cells
/// are those that touch them also O(cells) for each cell that an object touches.
///
/// # Errors
/// [`ProofError`] for bytes that are no proofs of such a table. Proofs that do not hold are a violation, not an error.
pub fn check_proofs(table: &Table, bytes: &[u8]) -> Result<ProofFindings, ProofError> {
    let kind = kind_of(bytes)?;
    let proven = match kind {
        Kind::Planar => PlanarProofs::from_bytes(bytes)?.check(&plan_of(table)?),
        Kind::Axial => AxialProofs::from_bytes(bytes)?.check(&boxes_of(table)?),
        Kind::Convex => ConvexProofs::from_bytes(bytes)?.check(&convex_of(table)?),
    };
    Ok(match proven {
        Ok(proven) => ProofFindings::compared(table, &proven),
        Err(refusal) => {
            let mut findings = ProofFindings::default();
            findings.add(ProofViolation::Refused(refusal));
            findings
        }
    })
}

/// The cells and portals of a table of a plan, as proofs know them.
///
/// # Errors
/// [`ProofError`] for other tables, stripped ones, and those whose cells and portals do not fit together.
pub fn plan_of(table: &Table) -> Result<PlanarNetwork, ProofError> {
    if table.dimension() != 2 {
        return Err(ProofError::Kind { proofs: "a plan", table: "of a scene in space" });
    }
    if table.cells().iter().any(|cell| cell.polygon.is_empty()) {
        return Err(ProofError::NoGraph);
    }
    let cells: Vec<Vec<[f64; 2]>> = table.cells().iter().map(|cell| cell.polygon.clone()).collect();
    let portal = |p: &sightlines_pvs::PortalRecord| {
        let [[lx, ly, _], [rx, ry, _]] = p.points[..] else { return None };
        Some(PlanarPortal { cells: p.cells.map(|cell| cell.0), sides: p.sides, left: [lx, ly], right: [rx, ry] })
    };
    let portals: Option<Vec<PlanarPortal>> = table.portals().iter().map(portal).collect();
    Ok(PlanarNetwork::new(&cells, &portals.ok_or(ProofError::NoGraph)?)?)
}

/// The cells, portals and objects of a table of a scene in space, as proofs know them.
///
/// # Errors
/// [`ProofError`] for other tables, stripped ones, those of regions, and those whose cells and portals do not fit together.
pub fn boxes_of(table: &Table) -> Result<AxialNetwork, ProofError> {
    if table.dimension() != 3 {
        return Err(ProofError::Kind { proofs: "a scene in space", table: "of a plan" });
    }
    if table.kind().is_quake() {
        return Err(ProofError::Kind { proofs: "a scene in space", table: "of a Quake map" });
    }
    // Without portals nothing says that a gap between given boxes is a wall.
    if is_stripped(table) || !can_be_proven(table) {
        return Err(ProofError::NoGraph);
    }
    let cells: Vec<[[f64; 3]; 2]> = table.cells().iter().map(|cell| [cell.min, cell.max]).collect();
    let mut portals = Vec::with_capacity(table.portals().len());
    for (index, p) in table.portals().iter().enumerate() {
        let mut extent = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for point in &p.points {
            for k in 0..3 {
                extent[0][k] = extent[0][k].min(point[k]);
                extent[1][k] = extent[1][k].max(point[k]);
            }
        }
        let axis = u8::try_from(p.sides[0] / 2).ok().filter(|axis| *axis < 3).ok_or(ProofError::Portal(index))?;
        // Four different corners of the rectangle around them are that rectangle.
        let corner = |point: &[f64; 3]| (0..3).all(|k| point[k] == extent[0][k] || point[k] == extent[1][k]);
        let differ = (0..4).all(|i| (0..i).all(|j| p.points.get(i) != p.points.get(j)));
        if p.points.len() != 4 || !p.points.iter().all(corner) || !differ {
            return Err(ProofError::Portal(index));
        }
        portals.push(AxialPortal { cells: p.cells.map(|cell| cell.0), extent, axis, forward: p.sides[0] % 2 == 1 });
    }
    let objects: Vec<_> = table.objects().iter().map(|object| [object.min, object.max]).collect();
    Ok(AxialNetwork::new(&cells, &portals)?.with_objects(&objects))
}

/// The cells and portals of a table of a Quake map, as proofs know them: with corners that count as on a portal's plane within
/// [`ConvexNetwork::OF_FILES`], as they do for the search.
///
/// # Errors
/// [`ProofError`] for other tables, stripped ones, and those with portals that are no polygons.
pub fn convex_of(table: &Table) -> Result<ConvexNetwork, ProofError> {
    if table.dimension() != 3 || !table.kind().is_quake() {
        return Err(ProofError::Kind { proofs: "a Quake map", table: "of another kind" });
    }
    if is_stripped(table) {
        return Err(ProofError::NoGraph);
    }
    // Tables have them counter-clockwise as seen from the first cell, which is about the direction into it.
    let portal = |p: &sightlines_pvs::PortalRecord| ConvexPortal {
        cells: p.cells.map(|cell| cell.0),
        corners: p.points.iter().rev().copied().collect(),
    };
    let portals: Vec<ConvexPortal> = table.portals().iter().map(portal).collect();
    Ok(ConvexNetwork::new(table.n_cells(), &portals, ConvexNetwork::OF_FILES)?)
}

/// Whether the portals of a table in space are missing: cells that see each other are joined by some.
fn is_stripped(table: &Table) -> bool {
    let cells = || (0..table.n_cells() as u32).map(CellId);
    table.portals().is_empty() && cells().any(|cell| table.visible(cell).any(|other| other != cell))
}
