//! The visibility that a map has of its own, which engines load: checked as a table is, whoever wrote it.

mod doom;
mod quake;

use crate::{Findings, Violation};
use sightlines_formats::quake::VisibilityError;
use sightlines_formats::reject::RejectLengthError;
use sightlines_progress::words::{bytes, count};
use sightlines_pvs::{BitMatrix, CellId, Table};
use std::collections::BTreeMap;
use std::fmt;

/// What a map itself says about visibility, as a table that [`verify`](crate::verify) takes.
///
/// [`OwnVisibility::of_bsp`] reads the visibility lump of a Quake map, [`OwnVisibility::of_reject`] the REJECT lump of a Doom map.
/// The table has no objects: check it against a scene without any.
#[derive(Debug)]
pub struct OwnVisibility {
    /// Cells see each other unless the map hides one from the other, one way or both.
    pub table: Table,
    /// What was read.
    pub about: OwnSummary,
    /// What each cell is a part of, such as its sector; `None` for what is nobody's.
    side_of: Vec<Option<u32>>,
    sides: Vec<Side>,
    /// Row `a` has the sides that are hidden from side `a`.
    hidden: BitMatrix,
}

/// A leaf, a cluster of leafs or a sector.
#[derive(Debug)]
struct Side {
    /// What users call it.
    name: String,
    /// Whether there is a place in it, from which it sees itself.
    has_places: bool,
}

/// A lump with visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LumpKind {
    /// Of a Quake map.
    Visibility,
    /// Of a Doom map.
    Reject,
}

impl LumpKind {
    /// The name of the lump.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Visibility => "visibility",
            Self::Reject => "REJECT",
        }
    }
}

impl fmt::Display for LumpKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a lump is like. Its *sides* are what it hides from each other: clusters of leafs, or sectors.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(description = "What was looked at."))]
pub struct OwnSummary {
    /// Name of the lump.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::as_json::text"))]
    #[cfg_attr(feature = "schemars", schemars(with = "String"))]
    pub lump: LumpKind,
    /// Size of the lump.
    pub n_bytes: usize,
    /// Leafs of a Quake map.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub n_leafs: Option<usize>,
    /// What is hidden from each other: clusters of leafs, or sectors.
    pub sides: &'static str,
    /// How many clusters or sectors there are.
    pub n_sides: usize,
    /// Unordered pairs of sides of which at least one is hidden from the other.
    pub n_hidden_pairs: u64,
    /// Of the hidden pairs, those of which only one is hidden from the other.
    pub n_hidden_one_way: u64,
    /// Clusters whose leafs have different rows; what is visible from one leaf counts for all.
    pub n_uneven_clusters: usize,
}

impl fmt::Display for OwnSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sides = count(self.n_sides as u64, self.sides);
        let sides = self.n_leafs.map_or(sides.clone(), |n| format!("{} in {sides}", count(n as u64, "leaf")));
        writeln!(f, "lump           {} of the map, {}, for {sides}", self.lump, bytes(self.n_bytes as u64))?;
        writeln!(f, "               {} hidden", count(self.n_hidden_pairs, "pair"))?;
        if self.n_hidden_one_way > 0 {
            writeln!(f, "remark         {} hidden one way only", count(self.n_hidden_one_way, "pair"))?;
        }
        if self.n_uneven_clusters > 0 {
            let n = count(self.n_uneven_clusters as u64, "cluster");
            writeln!(
                f,
                "remark         {n} with leafs that do not see the same: what one of them sees counts for all"
            )?;
        }
        Ok(())
    }
}

/// Why the own visibility of a map cannot be checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OwnError {
    /// The map has none.
    #[error("there is no {0} lump, or an empty one")]
    Missing(LumpKind),
    /// The portals are not those of the map.
    #[error(transparent)]
    OtherMap(Box<VisibilityError>),
    /// The lump of a Quake map is damaged.
    #[error(transparent)]
    Visibility(Box<VisibilityError>),
    /// The REJECT lump has another length than the sectors need.
    #[error(transparent)]
    Length(RejectLengthError),
}

/// A violation in terms of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnViolation {
    /// The kind, as [`Violation::kind`], or `hidden-from-itself`.
    pub kind: &'static str,
    /// The one or two sides concerned, as users call them; empty if cells are concerned that are nobody's.
    pub sides: Vec<String>,
    /// The violation of the table that shows it; `None` if none is needed.
    pub violation: Option<Violation>,
    /// All of it in a sentence.
    pub text: String,
}

impl OwnViolation {
    /// Whether a segment shows it.
    fn has_ray(&self) -> bool {
        self.violation.as_ref().is_some_and(|v| v.segment().is_some())
    }

    fn of_cells(v: &Violation) -> Self {
        Self { kind: v.kind(), sides: Vec::new(), violation: Some(v.clone()), text: v.to_string() }
    }
}

/// How many unordered pairs of different sides are hidden, and how many of these one way only.
fn hidden_pairs(hidden: &BitMatrix) -> [u64; 2] {
    let (mut n, mut one_way) = (0, 0);
    for a in 0..hidden.n_rows() {
        for b in hidden.iter_ones(a).filter(|&b| b != a) {
            let both = hidden.get(b, a);
            n += u64::from(a < b || !both);
            one_way += u64::from(!both);
        }
    }
    [n, one_way]
}

impl OwnVisibility {
    /// What was found in the table, in terms of leafs or sectors: each pair of them once, with a ray if there is one, and sides that
    /// the map hides from themselves.
    pub fn violations(&self, found: &Findings) -> Vec<OwnViolation> {
        let mut of_pairs: BTreeMap<[u32; 2], OwnViolation> = BTreeMap::new();
        let mut others = Vec::new();
        for v in &found.violations {
            let cells = v.cells();
            let sides = match (v, &cells[..]) {
                (Violation::HiddenCell { .. } | Violation::HiddenNeighbour { .. }, &[a, b]) => self.sides_of([a, b]),
                _ => None,
            };
            match sides {
                None => others.push(OwnViolation::of_cells(v)),
                Some([a, b]) => {
                    let of_sides = self.of_sides([a, b], v);
                    let known = of_pairs.get(&[a.min(b), a.max(b)]);
                    if known.is_none_or(|known| !known.has_ray() && of_sides.has_ray()) {
                        of_pairs.insert([a.min(b), a.max(b)], of_sides);
                    }
                }
            }
        }
        for (side, s) in (0u32..).zip(&self.sides) {
            if s.has_places && self.hides(side, side) && !of_pairs.contains_key(&[side, side]) {
                let text = format!("{} is hidden from itself", s.name);
                let sides = vec![s.name.clone()];
                of_pairs
                    .insert([side, side], OwnViolation { kind: "hidden-from-itself", sides, violation: None, text });
            }
        }
        of_pairs.into_values().chain(others).collect()
    }

    fn sides_of(&self, cells: [CellId; 2]) -> Option<[u32; 2]> {
        let [a, b] = cells.map(|cell| self.side_of.get(cell.idx()).copied().flatten());
        Some([a?, b?])
    }

    fn hides(&self, viewer: u32, target: u32) -> bool {
        self.hidden.get(viewer as usize, target as usize)
    }

    fn of_sides(&self, [a, b]: [u32; 2], v: &Violation) -> OwnViolation {
        let [x, y] = [a, b].map(|side| self.sides[side as usize].name.as_str());
        let hidden = match (self.hides(a, b), self.hides(b, a)) {
            _ if a == b => format!("{x} is hidden from itself"),
            (true, false) => format!("{y} is hidden from {x}"),
            (false, true) => format!("{x} is hidden from {y}"),
            _ => format!("{x} and {y} are hidden from each other"),
        };
        let but = match *v {
            Violation::HiddenCell { segment: [p, q], .. } => {
                format!("nothing is between {} and {}", point(p), point(q))
            }
            _ => "a portal joins them".to_owned(),
        };
        let sides = if a == b { vec![x.to_owned()] } else { vec![x.to_owned(), y.to_owned()] };
        OwnViolation { kind: v.kind(), sides, violation: Some(v.clone()), text: format!("{hidden}, but {but}") }
    }
}

/// Coordinates in full.
fn point([x, y, z]: [f64; 3]) -> String {
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_counted_once() {
        let mut hidden = BitMatrix::new(4, 4);
        for (a, b) in [(0, 1), (1, 0), (2, 0), (1, 3), (3, 3)] {
            hidden.set(a, b, true);
        }
        assert_eq!(hidden_pairs(&hidden), [3, 2]);
        assert_eq!(hidden_pairs(&BitMatrix::new(3, 3)), [0, 0]);
    }
}
