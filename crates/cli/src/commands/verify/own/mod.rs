//! The visibility stored in a map, which engines load: checked like a table, whichever program wrote it.

mod doom;
mod quake;

use super::violations::{ReportedViolation, Violations};
use crate::commands::verify::Error;
use crate::input;
use crate::output::{bytes, count};
use serde::Serialize;
use sightlines::formats::InputKind;
use sightlines::pvs::{BitMatrix, CellId, Table};
use sightlines::verify::{Findings, Violation};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// What a map says of itself, as a table of cells.
#[derive(Debug)]
pub(super) struct Own {
    /// Cells see each other unless the map hides one from the other, one way or both.
    pub(super) table: Table,
    pub(super) about: About,
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

/// What was looked at.
#[derive(Debug, Clone, Serialize)]
pub(super) struct About {
    /// The name of the lump.
    lump: &'static str,
    n_bytes: usize,
    /// Leafs of a Quake map.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_leafs: Option<usize>,
    /// What is hidden from each other: clusters of leafs, or sectors.
    sides: &'static str,
    n_sides: usize,
    /// Unordered pairs of sides.
    n_hidden_pairs: u64,
    /// Of these, pairs of which only one is hidden from the other.
    n_hidden_one_way: u64,
    /// Clusters whose leafs have different rows; what one of them sees counts for all.
    n_uneven_clusters: usize,
}

impl fmt::Display for About {
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

/// The own visibility of a map, if `path` is one; `scene` is what it will be checked against.
///
/// # Errors
/// [`Error`] for a map without visibility of its own, for files that cannot be read, and for those that do not go together.
pub(super) fn read(path: &Path, scene: &Path, map: Option<&str>, prt: Option<&Path>) -> Result<Option<Own>, Error> {
    match input::kind_of(path)? {
        Some(InputKind::Bsp) => quake::read(path, scene, prt).map(Some),
        Some(InputKind::Wad) => doom::read(path, scene, map).map(Some),
        _ => Ok(None),
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

impl Own {
    /// The findings in terms of leafs or sectors, each pair once, and with a ray if there is one.
    pub(super) fn violations(&self, found: &Findings) -> Violations {
        let mut of_pairs: BTreeMap<[u32; 2], ReportedViolation> = BTreeMap::new();
        let mut others = Vec::new();
        for v in &found.violations {
            let cells = v.cells();
            let sides = match (v, &cells[..]) {
                (Violation::HiddenCell { .. } | Violation::HiddenNeighbour { .. }, &[a, b]) => self.sides_of([a, b]),
                _ => None,
            };
            match sides {
                None => others.push(ReportedViolation::from(v)),
                Some([a, b]) => {
                    let told = self.reported([a, b], v);
                    let known = of_pairs.get(&[a.min(b), a.max(b)]);
                    if known.is_none_or(|known| !known.has_ray() && told.has_ray()) {
                        of_pairs.insert([a.min(b), a.max(b)], told);
                    }
                }
            }
        }
        for (side, s) in (0u32..).zip(&self.sides) {
            if s.has_places && self.hides(side, side) && !of_pairs.contains_key(&[side, side]) {
                let text = format!("{} is hidden from itself", s.name);
                of_pairs.insert(
                    [side, side],
                    ReportedViolation::of_sides("hidden-from-itself", vec![s.name.clone()], text),
                );
            }
        }
        Violations::reported(found, of_pairs.into_values().chain(others).collect())
    }

    fn sides_of(&self, cells: [CellId; 2]) -> Option<[u32; 2]> {
        let [a, b] = cells.map(|cell| self.side_of.get(cell.idx()).copied().flatten());
        Some([a?, b?])
    }

    fn hides(&self, viewer: u32, target: u32) -> bool {
        self.hidden.get(viewer as usize, target as usize)
    }

    fn reported(&self, [a, b]: [u32; 2], v: &Violation) -> ReportedViolation {
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
        let names = if a == b { vec![x.to_owned()] } else { vec![x.to_owned(), y.to_owned()] };
        ReportedViolation::from(v).of(names, format!("{hidden}, but {but}"))
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
