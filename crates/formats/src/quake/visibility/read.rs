//! Reads a map's visibility lump.

use super::{Bsp, LeafClusters, VisibilityError, check_match, other_clusters, put_row, raw, rle};
use crate::bytes::number_at;
use crate::error::{Malformed, Within, malformed};
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
    Ok(Some(rows?))
}

/// Which clusters hear which in a map of Quake II; `None` for an empty lump and for other formats.
///
/// # Errors
/// [`VisibilityError`] with the cluster whose row is wrong.
pub fn read_hearing(bsp: &Bsp) -> Result<Option<BitMatrix>, VisibilityError> {
    let has_rows = bsp.row_form() == RowForm::SeenAndHeard && !bsp.visibility().is_empty();
    Ok(has_rows.then(|| quake2_rows(bsp, 1)).transpose()?)
}

fn quake_rows(bsp: &Bsp, leafs: &LeafClusters) -> Result<BitMatrix, Malformed> {
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
            decode(lump, offset, &mut row).within(format_args!("leaf {leaf}"))?;
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

/// Reads the row that begins at a place of a lump.
fn decode(lump: &[u8], offset: u32, row: &mut [u8]) -> Result<(), Malformed> {
    let bytes = lump.get(offset as usize..).filter(|bytes| !bytes.is_empty());
    let beyond = || malformed!("its row begins at byte {offset} of the {} bytes of the visibility lump", lump.len());
    let read = rle::decode(bytes.ok_or_else(beyond)?, row);
    read.map(drop).within(format_args!("its row at byte {offset} of the visibility lump"))
}

pub(super) fn quake2_rows(bsp: &Bsp, kind: usize) -> Result<BitMatrix, Malformed> {
    let (lump, n) = (bsp.visibility(), bsp.n_clusters());
    let no_room = |n_clusters: u32| {
        let what = format_args!("the places of the rows of {n_clusters} clusters");
        malformed!("the visibility lump of {} bytes has no room for {what}", lump.len())
    };
    let n_clusters = number_at(lump, 0).ok_or_else(|| no_room(0))?;
    if n_clusters as usize != n {
        return Err(other_clusters(n_clusters, n));
    }
    // Before memory is taken for as many.
    if lump.len() < 4 + 8 * n {
        return Err(no_room(n_clusters));
    }
    let mut seen = BitMatrix::new(n, n);
    let mut row = vec![0u8; rle::row_len(n)];
    for cluster in 0..n {
        let offset = number_at(lump, 4 + 8 * cluster + 4 * kind).ok_or_else(|| no_room(n_clusters))?;
        decode(lump, offset, &mut row).within(format_args!("cluster {cluster}"))?;
        put_row(&mut row, n, seen.row_mut(cluster));
    }
    Ok(seen)
}
