//! The visibility lump of a map, in the form that engines load.
//!
//! Quake has a row of leafs for each leaf; the leafs of a cluster share theirs. Quake II has a row of clusters
//! for each cluster, and a second one for what can be heard. Rows are coded by [`rle`]. Quake III has a row of clusters for
//! each cluster, as it is.

use super::bsp::{AmbientTextures, RowForm};
use super::{Bsp, LeafClusters, rle};
use crate::error::{Malformed, malformed};
use sightlines_pvs::BitMatrix;
use sightlines_pvs::bits::{ones, or_words};
use std::borrow::Cow;

mod error;
mod fit;
mod orientation;
mod raw;
mod read;

pub use super::bsp::VisibilityLump;
pub use error::VisibilityError;
use fit::has_more_clusters;
pub use fit::{check_match, check_portals, clusters_of_leafs};
use read::quake2_rows;
pub use read::{read_hearing, read_visibility};

/// Makes the lump for a map, and the loudness of its leafs.
///
/// * `leafs`: the leafs of the clusters, from the portal file; Quake II and III ignore them.
/// * `seen`: row `a` has the clusters that cluster `a` sees. Written as it is: the caller guarantees that everything
///   sees itself and that visibility is symmetric.
///
/// Rows are in the order of clusters, those of Quake II's second kind behind all of the first; a cluster without
/// leafs has none. Those of Quake III have whole words of 64 bits, as its compilers write them. Clusters that see the same have equal rows, but not one row. O(clusters × leafs / 8).
///
/// # Errors
/// [`VisibilityError`] if the three do not fit together, if the lump would be too large, or if the
/// faces of a leaf cannot be looked up.
pub fn lump(bsp: &Bsp, leafs: &LeafClusters, seen: &BitMatrix) -> Result<VisibilityLump, VisibilityError> {
    lump_with_sounds(bsp, leafs, seen, AmbientTextures::ALL)
}

/// As [`lump`], with the sounds of some textures only.
///
/// # Errors
/// As there.
pub fn lump_with_sounds(
    bsp: &Bsp,
    leafs: &LeafClusters,
    seen: &BitMatrix,
    textures: AmbientTextures,
) -> Result<VisibilityLump, VisibilityError> {
    check_match(bsp, leafs)?;
    match bsp.row_form() {
        RowForm::SeenAndHeard => quake2_lump(of_map(bsp, leafs, seen)?.as_ref()),
        RowForm::Raw => raw::lump(of_map(bsp, leafs, seen)?.as_ref()),
        RowForm::OfLeafs => {
            let (bytes, leaf_rows) = quake_lump(leafs, seen)?;
            let ambient = if bsp.format().has_sounds() { loudness(bsp, leafs, seen, textures)? } else { Vec::new() };
            Ok(VisibilityLump { bytes, leaf_rows, ambient })
        }
    }
}

/// How loud water, sky, slime and lava are in each leaf that can be seen: 255 where a face of the kind lies on a
/// leaf that it sees, else 0. Slime counts as water. O(file + clusters²).
///
/// # Errors
/// [`VisibilityError`] if the three do not fit together, or the faces of a leaf cannot be looked up.
///
/// # Source
/// What Quake's vis has always written: loudness was meant to fall with distance, but every distance is taken as 0.25.
pub fn ambient(bsp: &Bsp, leafs: &LeafClusters, seen: &BitMatrix) -> Result<Vec<[u8; 4]>, VisibilityError> {
    loudness(bsp, leafs, seen, AmbientTextures::ALL)
}

/// What some textures do to the loudness.
fn loudness(
    bsp: &Bsp,
    leafs: &LeafClusters,
    seen: &BitMatrix,
    textures: AmbientTextures,
) -> Result<Vec<[u8; 4]>, VisibilityError> {
    check_match(bsp, leafs)?;
    check_square(seen, leafs.n_clusters())?;
    let made = bsp.leaf_sounds_of(textures)?;
    let own: Vec<u8> =
        (0..leafs.n_clusters()).map(|c| leafs.leafs_of(c).iter().fold(0, |bits, &l| bits | made[l as usize])).collect();
    let heard: Vec<u8> =
        (0..own.len()).map(|cluster| seen.iter_ones(cluster).fold(0, |bits, other| bits | own[other])).collect();
    let level = |bits: u8| std::array::from_fn(|k| if bits >> k & 1 == 1 { u8::MAX } else { 0 });
    Ok(leafs.cluster_of_leaf().iter().map(|&cluster| level(heard[cluster as usize])).collect())
}

/// The lump of a map of Quake II with what is visible as the map has it, and what is audible made of that anew. `None` for other formats and for a
/// map without visibility.
///
/// # Errors
/// [`VisibilityError`] with the cluster whose row is wrong, or if the lump would be too large.
pub fn lump_with_new_hearing(bsp: &Bsp) -> Result<Option<VisibilityLump>, VisibilityError> {
    let has_rows = bsp.row_form() == RowForm::SeenAndHeard && !bsp.visibility().is_empty();
    has_rows.then(|| quake2_lump(&quake2_rows(bsp, 0)?)).transpose()
}

fn check_square(seen: &BitMatrix, n_clusters: usize) -> Result<(), VisibilityError> {
    let (n_rows, n_cols) = (seen.n_rows(), seen.n_cols());
    let fits = n_rows == n_clusters && n_cols == n_clusters;
    if fits { Ok(()) } else { Err(VisibilityError::Matrix { n_rows, n_cols, n_clusters }) }
}

/// Which clusters of a map of Quake II see which.
fn of_map<'s>(bsp: &Bsp, leafs: &LeafClusters, seen: &'s BitMatrix) -> Result<Cow<'s, BitMatrix>, VisibilityError> {
    if !has_more_clusters(bsp, leafs) {
        return Ok(Cow::Borrowed(seen));
    }
    check_square(seen, leafs.n_clusters())?;
    let n = leafs.n_leafs();
    let mut rows = BitMatrix::new(n, n);
    for (leaf, cluster) in leafs.cluster_of_leaf().iter().enumerate() {
        for other in seen.iter_ones(*cluster as usize) {
            leafs.leafs_of(other).iter().for_each(|&other| rows.set(leaf, other as usize, true));
        }
    }
    Ok(Cow::Owned(rows))
}

fn quake_lump(leafs: &LeafClusters, seen: &BitMatrix) -> Result<(Vec<u8>, Vec<u32>), VisibilityError> {
    check_square(seen, leafs.n_clusters())?;
    let mut bytes = Vec::new();
    let mut row = vec![0; rle::row_len(leafs.n_leafs())];
    let mut leaf_rows = vec![0; leafs.n_leafs()];
    for cluster in 0..leafs.n_clusters() {
        let own = leafs.leafs_of(cluster);
        if own.is_empty() {
            continue;
        }
        row.fill(0);
        for other in seen.iter_ones(cluster) {
            for &leaf in leafs.leafs_of(other) {
                row[leaf as usize / 8] |= 1 << (leaf % 8);
            }
        }
        let place = place(bytes.len())?;
        own.iter().for_each(|&leaf| leaf_rows[leaf as usize] = place);
        rle::encode(&row, &mut bytes);
    }
    place(bytes.len())?;
    Ok((bytes, leaf_rows))
}

/// Quake II's lump: the number of clusters, two offsets for each, the rows of visible clusters, the rows of audible
/// ones.
///
/// Audible in a cluster is everything visible from a cluster that it sees.
fn quake2_lump(seen: &BitMatrix) -> Result<VisibilityLump, VisibilityError> {
    let n = seen.n_rows();
    check_square(seen, n)?;
    let mut bytes = vec![0; 4 + 8 * n];
    let (mut seen_at, mut heard_at) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for cluster in 0..n {
        seen_at.push(place(bytes.len())?);
        append_row(seen.row(cluster), n, &mut bytes);
    }
    let mut heard = vec![0u64; n.div_ceil(64)];
    for cluster in 0..n {
        heard.fill(0);
        ones(seen.row(cluster)).for_each(|other| or_words(&mut heard, seen.row(other)));
        heard_at.push(place(bytes.len())?);
        append_row(&heard, n, &mut bytes);
    }
    // The lump's length fits 31 bits, so does the number of clusters.
    place(bytes.len())?;
    bytes[..4].copy_from_slice(&(n as u32).to_le_bytes());
    let places = seen_at.iter().zip(&heard_at).flat_map(|(seen, heard)| [seen, heard]);
    for (entry, place) in bytes[4..].chunks_exact_mut(4).zip(places) {
        entry.copy_from_slice(&place.to_le_bytes());
    }
    Ok(VisibilityLump { bytes, leaf_rows: Vec::new(), ambient: Vec::new() })
}

/// Puts bytes of a row, of at least `n` bits, into a row of a matrix. Bits past the last cluster mean nothing.
fn put_row(bytes: &mut [u8], n: usize, row: &mut [u64]) {
    let bytes = &mut bytes[..n.div_ceil(8)];
    if let (Some(last), true) = (bytes.last_mut(), !n.is_multiple_of(8)) {
        *last &= (1 << (n % 8)) - 1;
    }
    for (word, bytes) in row.iter_mut().zip(bytes.chunks(8)) {
        *word = bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
    }
}

fn other_clusters(lump: u32, map: usize) -> Malformed {
    malformed!("the visibility lump is for {lump} clusters, the leafs have {map}")
}

fn append_row(words: &[u64], n_columns: usize, out: &mut Vec<u8>) {
    let row: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).take(rle::row_len(n_columns)).collect();
    rle::encode(&row, out);
}

fn place(at: usize) -> Result<u32, VisibilityError> {
    i32::try_from(at).map(i32::cast_unsigned).map_err(|_| VisibilityError::TooLarge { len: at })
}
