//! Real maps of Quake and Quake II with their portals.

use crate::common::quake::difference_besides_visibility;
use crate::common::{data_folder, files};
use sightlines_formats::quake::VisibilityError;
use sightlines_formats::quake::prt::{LeafList, PrtDialect, parse_prt, write_prt};
use sightlines_formats::quake::visibility::{self, VisibilityLump, check_portals, read_visibility};
use sightlines_formats::quake::{Bsp, Prt, read_bsp, read_prt};
use sightlines_pvs::BitMatrix;
use std::path::Path;

fn maps(test: &str) -> Option<Vec<(Prt, Bsp, std::path::PathBuf)>> {
    let data = data_folder("SIGHTLINES_DATA", test)?;
    let prts = files(&data.join("quake"), "prt");
    assert!(!prts.is_empty(), "no maps in the data folder");
    let read = |path: &std::path::PathBuf| {
        let prt = read_prt(path).unwrap_or_else(|e| panic!("{e}"));
        let bsp = read_bsp(path.with_extension("bsp")).unwrap_or_else(|e| panic!("{e}"));
        (prt, bsp, path.clone())
    };
    Some(prts.iter().map(read).collect())
}

/// Pairs that are known to see each other; for maps without them a pattern that only has to be written.
fn table(path: &Path, n: usize) -> (BitMatrix, bool) {
    let mut seen = BitMatrix::identity(n);
    let Ok(bytes) = std::fs::read(path.with_extension("seen.bin")) else {
        (0..n).for_each(|a| (0..n).filter(|b| (a * b) % 7 == 3).for_each(|b| seen.set(a, b, true)));
        return (seen, false);
    };
    let words: Vec<u64> = bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!((words[0] as usize, words.len()), (n, 1 + n * n.div_ceil(64)), "{}", path.display());
    for (row, words) in words[1..].chunks_exact(n.div_ceil(64)).enumerate() {
        seen.row_mut(row).copy_from_slice(words);
    }
    (seen, true)
}

#[test]
fn portals_fit_their_maps_and_are_written_again() {
    let Some(maps) = maps("portals_fit_their_maps_and_are_written_again") else { return };
    let mut n_listed = 0;
    for (prt, bsp, path) in &maps {
        let leafs = prt.leaf_clusters();
        assert_eq!(check_portals(bsp, prt), Ok(()), "{}", path.display());
        let text = write_prt(prt);
        assert_eq!(parse_prt(text.as_bytes()).as_ref(), Ok(prt), "{}", path.display());
        // Compilers write shortest decimals too, but with exponents, and where two are as short the other one.
        let words = |text: &str| text.split_ascii_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let original = std::fs::read_to_string(path).unwrap();
        let n_words = words(&original).len();
        let n_same = words(&original).iter().zip(words(&text)).filter(|(a, b)| *a == b).count();
        let n_degenerate = prt.portals().filter(|p| p.is_degenerate()).count();
        eprintln!(
            "{}: {:?} {}, {} clusters, {} leafs, {} portals ({n_degenerate} degenerate), {n_same} of {n_words} words the same",
            path.display(),
            bsp.format(),
            prt.dialect(),
            prt.n_clusters(),
            leafs.n_leafs(),
            prt.n_portals(),
        );
        assert_eq!(words(&text).len(), n_words);
        assert!(n_same > n_words / 100 * 99, "{}: {n_same} of {n_words}", path.display());
        n_listed += usize::from(prt.dialect() != PrtDialect::Prt1);
        // The portals of any other map are distinguished from a map's own: two maps have equally many leafs, so
        // positions count too.
        let others = maps.iter().filter(|(other, _, _)| check_portals(bsp, other).is_err()).count();
        assert_eq!(others + 1, maps.len(), "{}", path.display());
    }
    assert!(n_listed > 0 && n_listed < maps.len(), "both kinds of portal files are there");
}

/// Puts what is known to be seen into each map, and reads it back.
#[test]
fn visibility_is_written_into_maps() {
    let Some(maps) = maps("visibility_is_written_into_maps") else { return };
    let mut n_tables = 0;
    for (prt, bsp, path) in &maps {
        let name = path.display();
        let leafs = prt.leaf_clusters();
        let (seen, known) = table(path, leafs.n_clusters());
        n_tables += usize::from(known);
        // Made without visibility; if one is there, it must be written again as the same matrix.
        let own = read_visibility(bsp, &leafs).unwrap_or_else(|e| panic!("{name}: {e}"));
        for seen in own.into_iter().chain([seen]) {
            let lump = visibility::lump(bsp, &leafs, &seen).unwrap_or_else(|e| panic!("{name}: {e}"));
            let written = bsp.with_visibility(&lump).unwrap_or_else(|e| panic!("{name}: {e}"));
            let after = Bsp::parse(written).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(difference_besides_visibility(bsp, &after), None, "{name}");
            assert!(read_visibility(&after, &leafs) == Ok(Some(seen.clone())), "{name}");
            let again = visibility::lump(&after, &leafs, &seen).unwrap();
            assert!(again == lump, "{name}");
            assert!(after.with_visibility(&again).as_deref() == Ok(after.as_bytes()), "{name}");
            // Without the new lump the file is what it was, but for what leafs say of it.
            let emptied = VisibilityLump { bytes: Vec::new(), ..lump.clone() };
            let emptied = Bsp::parse(after.with_visibility(&emptied).unwrap()).unwrap();
            assert_eq!(difference_besides_visibility(bsp, &emptied), None, "{name}");
            assert_eq!(emptied.as_bytes().len(), bsp.as_bytes().len().next_multiple_of(4), "{name}");
            let loud = lump.ambient.iter().filter(|l| **l != [0; 4]).count();
            eprintln!("{name}: lump of {} bytes, {loud} of {} leafs with sounds", lump.bytes.len(), lump.ambient.len());
        }
    }
    assert!(n_tables > 0, "maps with tables of what is seen");
}

/// No portal of a real map is taken for one inside out, and those that are turned round alone are found, whatever clusters are around.
#[test]
fn single_portals_inside_out_are_found() {
    let Some(maps) = maps("single_portals_inside_out_are_found") else { return };
    let (mut n_by_portals_alone, mut n_all) = (0, 0);
    for (prt, bsp, path) in &maps {
        assert_eq!(check_portals(bsp, prt), Ok(()), "{}", path.display());
        let step = prt.n_portals().div_ceil(12);
        let (mut n, mut n_found) = (0, 0);
        for turned in (0..prt.n_portals()).step_by(step).filter(|&k| !prt.portal(k).is_degenerate()) {
            let mut other = Prt::new(prt.n_clusters()).unwrap();
            for (k, portal) in prt.portals().enumerate() {
                let mut points = portal.points.to_vec();
                if k == turned {
                    points.reverse();
                }
                other.push_portal(portal.clusters, &points).unwrap();
            }
            let list = if prt.dialect() == PrtDialect::Prt1Am { LeafList::PerLeaf } else { LeafList::PerCluster };
            if prt.dialect() != PrtDialect::Prt1 {
                other = other.with_leafs(list, prt.leaf_clusters().cluster_of_leaf().to_vec()).unwrap();
            }
            let clusters = prt.portal(turned).clusters;
            n_by_portals_alone += usize::from(other.inside_out() == Some(turned));
            n_all += 1;
            n += 1;
            n_found +=
                usize::from(check_portals(bsp, &other) == Err(VisibilityError::InsideOut { portal: turned, clusters }));
        }
        eprintln!("{}: {n_found} of {n}", path.display());
        assert!(n >= 8 && n_found == n, "{}: {n_found} of {n}", path.display());
    }
    // The impostor: who asks the other portals alone, and not the tree.
    assert!(n_by_portals_alone < n_all, "{n_by_portals_alone} of {n_all}");
}
