//! Reads a map's visibility lump.

use super::bytes::{number, put_row};
use super::{Bsp, LeafClusters, VisibilityError, check_match, raw, rle};
use crate::quake::bsp::{LeafRow, RowForm};
use sightlines_pvs::BitMatrix;

/// Which clusters see which according to a map: row `a` has what cluster `a` sees. `None` for a map whose lump
/// is empty, because nothing was computed yet.
///
/// A cluster of several leafs sees what any of its leafs sees any leaf of. Bits past the last leaf are ignored.
/// The result is that of the file, which need not be symmetric. O(rows of the lump) per cluster.
///
/// # Errors
/// [`VisibilityError`] with the leaf or cluster whose row is wrong.
pub fn read_visibility(bsp: &Bsp, leafs: &LeafClusters) -> Result<Option<BitMatrix>, VisibilityError> {
    check_match(bsp, leafs)?;
    if bsp.visibility().is_empty() {
        return Ok(None);
    }
    let rows = match bsp.row_form() {
        RowForm::SeenAndHeard => quake2_rows(bsp, 0),
        RowForm::Raw => raw::rows(bsp),
        RowForm::OfLeafs => quake_rows(bsp, leafs),
    };
    rows.map(Some)
}

/// Which clusters hear which in a map of Quake II; `None` for an empty lump and for other formats.
///
/// # Errors
/// [`VisibilityError`] with the cluster whose row is wrong.
pub fn read_hearing(bsp: &Bsp) -> Result<Option<BitMatrix>, VisibilityError> {
    let has_rows = bsp.row_form() == RowForm::SeenAndHeard && !bsp.visibility().is_empty();
    has_rows.then(|| quake2_rows(bsp, 1)).transpose()
}

fn quake_rows(bsp: &Bsp, leafs: &LeafClusters) -> Result<BitMatrix, VisibilityError> {
    let (lump, n_clusters) = (bsp.visibility(), leafs.n_clusters());
    let mut seen = BitMatrix::new(n_clusters, n_clusters);
    let mut row = vec![0u8; rle::row_len(leafs.n_leafs())];
    for cluster in 0..n_clusters {
        let own = leafs.leafs_of(cluster);
        let mut rows: Vec<(LeafRow, usize)> =
            own.iter().map(|&k| k as usize + 1).map(|k| (bsp.leafs()[k].row, k)).collect();
        // Most often there is one row for all of them.
        rows.dedup_by_key(|(row, _)| *row);
        for (place, leaf) in rows {
            let LeafRow::At(offset) = place else {
                (0..n_clusters).for_each(|other| seen.set(cluster, other, true));
                continue;
            };
            let bytes = lump.get(offset as usize..).filter(|bytes| !bytes.is_empty());
            let bytes = bytes.ok_or(VisibilityError::RowPlace { leaf, offset, len: lump.len() })?;
            rle::decode(bytes, &mut row).map_err(|source| VisibilityError::Row { leaf, offset, source })?;
            for (byte, bits) in row.iter().enumerate().filter(|(_, bits)| **bits != 0) {
                let columns = (0..8).filter(|k| bits >> k & 1 == 1).map(|k| 8 * byte + k);
                for &other in columns.filter_map(|leaf| leafs.cluster_of_leaf().get(leaf)) {
                    seen.set(cluster, other as usize, true);
                }
            }
        }
    }
    Ok(seen)
}

/// The rows of one kind of a lump of Quake II: 0 seen, 1 heard.
pub(super) fn quake2_rows(bsp: &Bsp, kind: usize) -> Result<BitMatrix, VisibilityError> {
    let (lump, n) = (bsp.visibility(), bsp.n_clusters());
    let number = |at: usize| number(lump, at);
    let n_clusters = number(0).ok_or(VisibilityError::Places { len: lump.len(), n_clusters: 0 })?;
    if n_clusters as usize != n {
        return Err(VisibilityError::LumpClusters { lump: n_clusters, map: n });
    }
    // Before memory is taken for as many.
    if lump.len() < 4 + 8 * n {
        return Err(VisibilityError::Places { len: lump.len(), n_clusters });
    }
    let mut seen = BitMatrix::new(n, n);
    let mut row = vec![0u8; rle::row_len(n)];
    for cluster in 0..n {
        let offset =
            number(4 + 8 * cluster + 4 * kind).ok_or(VisibilityError::Places { len: lump.len(), n_clusters })?;
        let bytes = lump.get(offset as usize..).filter(|bytes| !bytes.is_empty());
        let bytes = bytes.ok_or(VisibilityError::ClusterRowPlace { cluster, offset, len: lump.len() })?;
        rle::decode(bytes, &mut row).map_err(|source| VisibilityError::ClusterRow { cluster, offset, source })?;
        put_row(&mut row, n, seen.row_mut(cluster));
    }
    Ok(seen)
}
