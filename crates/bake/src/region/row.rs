//! What one cell sees by itself, as sets of runs, and as bytes.

use sightlines_multifocal::{QueryCounts, WorkDone};
use sightlines_pvs::runs::{read_runs, read_varint, runs_of, write_runs, write_varint};
use std::ops::Range;

/// Ascending indices.
type Runs = Vec<Range<u32>>;

/// What one cell may see. Pairs of sets are of cells and of objects.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct CellRow {
    pub(super) cells: Runs,
    pub(super) objects: Runs,
    /// What a ray reaches.
    pub(super) proven: [Runs; 2],
    /// What was not decided because the allowance was over.
    pub(super) left: [Runs; 2],
    pub(super) effort: WorkDone,
}

impl CellRow {
    pub(super) fn new(visible: [Vec<bool>; 2], proven: [Vec<bool>; 2], left: [Vec<bool>; 2], effort: WorkDone) -> Self {
        let set = |bits: Vec<bool>| {
            let of = |(k, bit): (u32, bool)| bit.then_some(k);
            let mut runs = runs_of((0..).zip(bits).filter_map(of));
            runs.shrink_to_fit();
            runs
        };
        let [cells, objects] = visible.map(set);
        Self { cells, objects, proven: proven.map(set), left: left.map(set), effort }
    }

    /// The row of a cell about which nothing was decided, among so many cells and objects: it sees all of them.
    pub(super) fn undecided(sizes: [u32; 2]) -> Self {
        let all = sizes.map(|n| runs_of(0..n));
        let [cells, objects] = all.clone();
        Self { cells, objects, left: all, ..Self::default() }
    }

    /// Of a row that is decided.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let Self { cells, objects, proven: [cells_proven, objects_proven], effort, .. } = self;
        let mut out = Vec::new();
        [cells, objects, cells_proven, objects_proven].into_iter().for_each(|runs| write_runs(runs, &mut out));
        let WorkDone { n_volumes, queries: QueryCounts { groups, boxes, triangles } } = *effort;
        [n_volumes, groups, boxes, triangles].into_iter().for_each(|n| write_varint(n, &mut out));
        out
    }

    /// `None` if these are no bytes of a row of so many cells and objects.
    pub(super) fn from_bytes(mut bytes: &[u8], [n_cells, n_objects]: [u32; 2]) -> Option<Self> {
        let mut runs = |n: u32| read_runs(&mut bytes, n);
        let [cells, objects] = [runs(n_cells)?, runs(n_objects)?];
        let proven = [runs(n_cells)?, runs(n_objects)?];
        let mut number = || read_varint(&mut bytes);
        let n_volumes = number()?;
        let queries = QueryCounts { groups: number()?, boxes: number()?, triangles: number()? };
        let effort = WorkDone { n_volumes, queries };
        bytes.is_empty().then_some(Self { cells, objects, proven, left: Default::default(), effort })
    }
}

/// The runs of indices below `n` that are not in a set.
pub(super) fn gaps(runs: &[Range<u32>], n: u32) -> impl Iterator<Item = Range<u32>> + '_ {
    let starts = std::iter::once(0).chain(runs.iter().map(|run| run.end));
    let ends = runs.iter().map(|run| run.start).chain([n]);
    starts.zip(ends).map(|(start, end)| start..end).filter(|gap| !gap.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_and_only_where_they_fit() {
        let bits = |text: &str| text.chars().map(|c| c == '1').collect::<Vec<bool>>();
        let effort = WorkDone { n_volumes: 3, queries: QueryCounts { groups: 1, boxes: 300, triangles: 7 } };
        let none = || [bits("000000"), bits("000")];
        let row = CellRow::new([bits("110101"), bits("011")], [bits("100001"), bits("010")], none(), effort);
        assert_eq!((&row.cells, row.objects.len()), (&vec![0..2, 3..4, 5..6], 1));
        let bytes = row.to_bytes();
        assert_eq!(CellRow::from_bytes(&bytes, [6, 3]), Some(row.clone()));
        assert_eq!([[5, 3], [6, 2]].map(|sizes| CellRow::from_bytes(&bytes, sizes)), [None, None]);
        assert!((0..bytes.len()).all(|n| CellRow::from_bytes(&bytes[..n], [6, 3]).is_none()));
        assert_eq!(gaps(&row.cells, 6).collect::<Vec<_>>(), [2..3, 4..5]);
        let count = |runs: &[Range<u32>]| gaps(runs, 2).flatten().count();
        let whole = runs_of(0..2);
        assert_eq!((count(&[]), count(&whole)), (2, 0));
    }
}
