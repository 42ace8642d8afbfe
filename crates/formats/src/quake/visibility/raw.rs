//! Rows as they are, those of Quake III: the number of clusters, the bytes of a row, and a row for each.

use super::{Bsp, VisibilityError, VisibilityLump, check_square, other_clusters, place, put_row};
use crate::bytes::number_at;
use crate::error::{Malformed, malformed};
use sightlines_pvs::BitMatrix;

const HEADER: usize = 8;

/// The lump of a matrix; rows have whole words of 64 bits, which is how the format's compilers write them.
pub(super) fn lump(seen: &BitMatrix) -> Result<VisibilityLump, VisibilityError> {
    let n = seen.n_rows();
    check_square(seen, n)?;
    let n_words = n.div_ceil(64);
    let len = HEADER + 8 * n_words * n;
    place(len)?;
    let mut bytes = Vec::with_capacity(len);
    for number in [n, 8 * n_words] {
        // The lump's length fits 31 bits, so do these.
        bytes.extend((number as u32).to_le_bytes());
    }
    for cluster in 0..n {
        bytes.extend(seen.row(cluster).iter().flat_map(|word| word.to_le_bytes()));
    }
    Ok(VisibilityLump { bytes, leaf_rows: Vec::new(), ambient: Vec::new() })
}

pub(super) fn rows(bsp: &Bsp) -> Result<BitMatrix, Malformed> {
    let (lump, n) = (bsp.visibility(), bsp.n_clusters());
    let no_room = |n_clusters: u32, width: u32| {
        let what = format_args!("rows of {n_clusters} clusters of {width} bytes each");
        Err(malformed!("the visibility lump of {} bytes has no room for {what}", lump.len()))
    };
    let (n_clusters, width) = match [0, 4].map(|at| number_at(lump, at)) {
        [Some(n_clusters), Some(width)] => (n_clusters, width),
        [n_clusters, _] => return no_room(n_clusters.unwrap_or(0), 0),
    };
    if n_clusters as usize != n {
        return Err(other_clusters(n_clusters, n));
    }
    let needed = HEADER as u64 + u64::from(width) * n as u64;
    // Before memory is taken for as many.
    if (width as usize) < n.div_ceil(8) || needed > lump.len() as u64 {
        return no_room(n_clusters, width);
    }
    let mut seen = BitMatrix::new(n, n);
    let mut row = vec![0; n.div_ceil(8)];
    for cluster in 0..n {
        let at = HEADER + cluster * width as usize;
        row.copy_from_slice(&lump[at..at + n.div_ceil(8)]);
        put_row(&mut row, n, seen.row_mut(cluster));
    }
    Ok(seen)
}
