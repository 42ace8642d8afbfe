//! Formats that are relatives: one map in several of them gives the same, and what is told apart by more than the first bytes.

use crate::common::quake::{SmallBsp, convert};
use crate::common::{data_folder, files};
use sightlines_formats::quake::visibility::{self, check_portals, read_visibility};
use sightlines_formats::quake::{Bsp, BspFormat, read_prt};
use sightlines_pvs::BitMatrix;

/// The formats that a map can be made into, itself included.
fn relatives(format: BspFormat) -> Vec<BspFormat> {
    BspFormat::ALL.into_iter().filter(|&other| convert::base(other) == format).collect()
}

/// Everything of a map but its format and its bytes: the tree, the corners and lists of faces, and where leafs are.
fn content(bsp: &Bsp) -> impl PartialEq + std::fmt::Debug + use<> {
    let (tree, faces, lists) = (bsp.world_tree().unwrap(), bsp.world_faces().unwrap(), bsp.leaf_faces().unwrap());
    let boxes: Vec<_> = bsp.leafs().iter().map(|leaf| (leaf.row, leaf.mins, leaf.maxs)).collect();
    // Triangles of a fan repeat corners of the face; as a set they are the same.
    let corners = |k: usize| {
        let mut corners: Vec<[u64; 3]> = faces.corners(k).iter().map(|p| p.map(f64::to_bits)).collect();
        corners.sort_unstable();
        corners.dedup();
        corners
    };
    let all: Vec<_> = (0..faces.n_faces()).map(corners).collect();
    let listed: Vec<_> = (0..lists.n_leafs()).map(|leaf| lists.of(leaf).to_vec()).collect();
    (tree, all, listed, boxes, bsp.n_clusters(), bsp.n_visible_leafs())
}

#[test]
fn one_map_is_the_same_in_each_format() {
    let mut n = 0;
    for base in [BspFormat::Bsp29, BspFormat::Quake2] {
        let file = SmallBsp::with_world(base).file(false);
        let original = content(&Bsp::parse(file.clone()).unwrap());
        for format in relatives(base) {
            let bsp = Bsp::parse(convert::map(&file, format)).unwrap();
            assert_eq!(bsp.format(), format);
            assert_eq!(content(&bsp), original, "{format:?}");
            n += 1;
        }
        // An impostor: one plane moved.
        let mut moved = file.clone();
        let planes = Bsp::parse(file).unwrap().lumps()[1].start;
        moved[planes + 12 + 2] ^= 1;
        assert_ne!(content(&Bsp::parse(moved).unwrap()), original);
    }
    assert_eq!(n, 3 + 4);
}

/// Real maps, with the pairs that are known to see each other as their visibility: what is written for the one is what is written for the other.
#[test]
fn real_maps_have_the_same_rows_in_each_format() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "real_maps_have_the_same_rows_in_each_format") else { return };
    let mut n = 0;
    for path in files(&data.join("quake"), "prt") {
        let bytes = std::fs::read(path.with_extension("bsp")).unwrap();
        let (prt, bsp) = (read_prt(&path).unwrap(), Bsp::parse(bytes.clone()).unwrap());
        let leafs = prt.leaf_clusters();
        let n_clusters = leafs.n_clusters();
        let mut seen = BitMatrix::identity(n_clusters);
        (0..n_clusters).for_each(|a| (0..n_clusters).filter(|b| (a * b) % 7 == 3).for_each(|b| seen.set(a, b, true)));
        let original = visibility::lump(&bsp, &leafs, &seen).unwrap();
        for format in relatives(bsp.format()).into_iter().skip(1) {
            let other = Bsp::parse(convert::map(&bytes, format)).unwrap();
            assert_eq!(other.format(), format, "{}", path.display());
            assert!(content(&other) == content(&bsp), "{} as {format:?}", path.display());
            assert_eq!(check_portals(&other, &prt), Ok(()));
            let lump = visibility::lump(&other, &leafs, &seen).unwrap();
            if !matches!(format, BspFormat::Quake3 | BspFormat::Wolfenstein) {
                assert_eq!((&lump.bytes, &lump.leaf_rows), (&original.bytes, &original.leaf_rows));
            }
            let [before, after] = [(&bsp, &original), (&other, &lump)].map(|(map, lump)| {
                let written = Bsp::parse(map.with_visibility(lump).unwrap()).unwrap();
                read_visibility(&written, &leafs).unwrap().unwrap()
            });
            assert!(before == after && before == seen, "{} as {format:?}", path.display());
            n += 1;
        }
    }
    eprintln!("{n} maps made into others");
    assert!(n >= 10, "{n}");
}

/// Rows of Quake III have whole words of 64 bits when they are written, and any width that is enough when they are read.
#[test]
fn rows_of_quake_3_are_as_they_are() {
    for n in [1, 7, 8, 63, 64, 65, 130] {
        let map =
            SmallBsp { leafs: vec![vec![]; n], clusters: (0..n as i16).collect(), ..SmallBsp::new(BspFormat::Quake3) };
        let bsp = Bsp::parse(map.file(false)).unwrap();
        let leafs = sightlines_formats::quake::LeafClusters::identity(n as u32).unwrap();
        let mut seen = BitMatrix::identity(n);
        (0..n).for_each(|k| seen.set(k, n - 1 - k, true));
        let lump = visibility::lump(&bsp, &leafs, &seen).unwrap();
        let width = n.div_ceil(64) * 8;
        assert_eq!(lump.bytes.len(), 8 + n * width);
        let is_seen = |bytes: &[u8], width: usize, a: usize, b: usize| bytes[8 + a * width + b / 8] >> (b % 8) & 1 == 1;
        for (a, b) in (0..n).flat_map(|a| (0..8 * width).map(move |b| (a, b))) {
            assert_eq!(is_seen(&lump.bytes, width, a, b), b < n && seen.get(a, b), "{n}: {a} {b}");
        }
        // Narrower, and with bits past the last cluster.
        let narrow = n.div_ceil(8);
        let rows = lump.bytes[8..].chunks(width).flat_map(|row| row[..narrow].to_vec());
        let mut visibility: Vec<u8> =
            [n as u32, narrow as u32].into_iter().flat_map(u32::to_le_bytes).chain(rows).collect();
        if !n.is_multiple_of(8) {
            *visibility.last_mut().unwrap() |= 0x80;
        }
        let read = |visibility: Vec<u8>| {
            let bsp = Bsp::parse(SmallBsp { visibility, ..map.clone() }.file(true)).unwrap();
            read_visibility(&bsp, &leafs)
        };
        assert_eq!(read(visibility.clone()), Ok(Some(seen.clone())));
        let refused = |change: &dyn Fn(&mut Vec<u8>)| {
            let mut changed = visibility.clone();
            change(&mut changed);
            read(changed).unwrap_err().to_string()
        };
        let len = visibility.len();
        let room = |len: usize, width: u32| {
            format!("the visibility lump of {len} bytes has no room for rows of {n} clusters of {width} bytes each")
        };
        assert_eq!(refused(&|v| v.truncate(len - 1)), room(len - 1, narrow as u32));
        assert_eq!(refused(&|v| v[4..8].copy_from_slice(&[0; 4])), room(len, 0));
        assert_eq!(refused(&|v| v[4..8].copy_from_slice(&[0, 0, 0, 0x80])), room(len, 1 << 31));
        let other = format!("the visibility lump is for 2147483648 clusters, the leafs have {n}");
        assert_eq!(refused(&|v| v[..4].copy_from_slice(&[0, 0, 0, 0x80])), other);
    }
    // A table for 2^16 clusters is not made for a lump without rows.
    let map = SmallBsp { clusters: vec![-2; 5], ..SmallBsp::new(BspFormat::Quake2) };
    assert_eq!(Bsp::parse(map.file(false)).unwrap_err().to_string(), "leaf 1: -2 is no cluster");
    let mut bytes = SmallBsp { visibility: vec![0, 0, 1, 0, 9], ..SmallBsp::new(BspFormat::Qbism) }.file(false);
    let leaf = Bsp::parse(bytes.clone()).unwrap().lumps()[8].start + 52 + 4;
    for (cluster, is_read) in [(65535, true), (65536, false), (i32::MAX, false), (-2, false)] {
        bytes[leaf..leaf + 4].copy_from_slice(&i32::to_le_bytes(cluster));
        let bsp = Bsp::parse(bytes.clone());
        assert_eq!(bsp.is_ok(), is_read, "{cluster}");
        let Ok(bsp) = bsp else { continue };
        let leafs = sightlines_formats::quake::LeafClusters::identity(65536).unwrap();
        let no_room = "the visibility lump of 5 bytes has no room for the places of the rows of 65536 clusters";
        assert_eq!(read_visibility(&bsp, &leafs).unwrap_err().to_string(), no_room);
    }
}

/// A map of version 29 with as many models as both sizes of a record allow, each with some faces.
fn with_models(format: BspFormat, n: usize, faces: impl Fn(usize) -> [i32; 2]) -> Bsp {
    let map = SmallBsp::with_world(format);
    let mut lumps = map.lumps();
    let models = map.lump("models");
    let record = lumps[models].clone();
    let at = if format == BspFormat::Hexen2 { 72 } else { 56 };
    lumps[models] = (0..n)
        .flat_map(|k| {
            let mut record = record.clone();
            record[at..at + 8].copy_from_slice(&faces(k).map(i32::to_le_bytes).concat());
            record
        })
        .collect();
    let mut file = format.magic().to_vec();
    file.resize(format.header_len(), 0);
    for (k, lump) in lumps.iter().enumerate() {
        let place = [file.len(), lump.len()].map(|n| (n as u32).to_le_bytes());
        file[4 + 8 * k..][..8].copy_from_slice(&place.concat());
        file.extend(lump);
    }
    Bsp::parse(file).unwrap()
}

#[test]
fn hexen_2_is_told_by_its_models() {
    let follow = |k: usize| if k == 0 { [0, 3] } else { [3 + (k - 1).min(3) as i32, i32::from(k < 4)] };
    for n in 1..=20 {
        for format in [BspFormat::Bsp29, BspFormat::Hexen2] {
            assert_eq!(with_models(format, n, follow).format(), format, "{n} models");
        }
    }
    // Where faces do not follow each other and both sizes fit, it is Quake's.
    let gaps = |k: usize| [2 * k as i32, 1];
    assert_eq!(with_models(BspFormat::Hexen2, 4, gaps).format(), BspFormat::Bsp29);
    assert_eq!(with_models(BspFormat::Hexen2, 3, gaps).format(), BspFormat::Hexen2, "only one size fits");
    assert_eq!(with_models(BspFormat::Bsp29, 5, gaps).format(), BspFormat::Bsp29);
}

/// Maps of Blue Shift and of Quake Live are named, instead of read wrongly or torn.
#[test]
fn relatives_that_are_not_read_are_named() {
    let file = SmallBsp::with_world(BspFormat::HalfLife).file(false);
    let mut swapped = file.clone();
    swapped[4..12].copy_from_slice(&file[12..20]);
    swapped[12..20].copy_from_slice(&file[4..12]);
    let text = "lump 0 has planes and lump 1 has none, as in maps of Half-Life: Blue Shift, which are not read; with the first two entries of the directory exchanged this is a map of Half-Life";
    assert_eq!(Bsp::parse(swapped).unwrap_err().to_string(), text);
    // 18 lumps: the directory is longer, and everything behind it moves.
    let format = BspFormat::Wolfenstein;
    let file = SmallBsp::with_world(format).file(false);
    let longer = |entry: [i32; 2]| {
        let (n, mut bytes) = (format.header_len(), file.clone());
        for k in 0..format.lump_names().len() {
            let at = i32::from_le_bytes(bytes[8 + 8 * k..][..4].try_into().unwrap());
            bytes[8 + 8 * k..][..4].copy_from_slice(&(at + 8).to_le_bytes());
        }
        bytes.splice(n..n, entry.map(i32::to_le_bytes).concat());
        Bsp::parse(bytes)
    };
    let n = file.len() as i32;
    let error = longer([200, 16]).unwrap_err();
    let text = "the directory has an entry for lump 17, which version 47 does not have: 16 bytes at byte 200; such maps (of Quake Live) are not read";
    assert_eq!(error.to_string(), text);
    // Nothing there, a text, and what is no place in the file.
    for entry in [
        [0, 0],
        [200, 0],
        [i32::from_le_bytes(*b"I LO"), i32::from_le_bytes(*b"VE M")],
        [200, n],
        [-4, 4],
        [i32::MAX, i32::MAX],
    ] {
        assert_eq!(longer(entry).map(|bsp| bsp.format()), Ok(format), "{entry:?}");
    }
}

/// Curved faces of Quake III are the quadrangles of their grid.
#[test]
fn curved_faces_are_grids() {
    let map = SmallBsp::with_world(BspFormat::Quake3);
    let file = map.file(false);
    let faces = Bsp::parse(file.clone()).unwrap().lumps()[map.lump("faces")].start;
    let with = |changes: &[(usize, i32)]| {
        let mut bytes = file.clone();
        for (at, number) in changes {
            bytes[faces + at..faces + at + 4].copy_from_slice(&number.to_le_bytes());
        }
        Bsp::parse(bytes).unwrap().world_faces()
    };
    // All 24 vertices as 6 by 4.
    let grid = with(&[(8, 2), (12, 0), (16, 24), (96, 6), (100, 4)]).unwrap();
    assert_eq!((grid.polygons(0).len(), grid.n_faces()), (15, 6));
    assert!(grid.polygons(0).all(|polygon| polygon.len() == 4));
    assert_eq!(with(&[(8, 2), (96, 1), (100, 4)]).unwrap().polygons(0).len(), 1, "a line");
    let error = with(&[(8, 2), (96, 3), (100, 2)]).unwrap_err().to_string();
    assert_eq!(error, "lump 13 (faces): face 0: a grid of 3 by 2 has not its 4 points");
    assert!(with(&[(8, 2), (96, -1), (100, -4)]).is_err() && with(&[(8, 2), (96, 0), (100, 0)]).is_err());
    assert!(with(&[(8, 2), (96, i32::MAX), (100, i32::MAX)]).is_err());
    let error = with(&[(12, 22)]).unwrap_err().to_string();
    assert_eq!(error, "lump 13 (faces): record 0 names 4 records from 22 on of lump 10 (vertices), which has 24");
    let error = with(&[(24, i32::MIN)]).unwrap_err().to_string();
    assert_eq!(
        error,
        "lump 13 (faces): record 0 names -2147483648 records from 0 on of lump 11 (indices), which has 36"
    );
    // A flare has neither.
    assert_eq!(with(&[(8, 4), (16, 0), (24, 0)]).unwrap().polygons(0).len(), 0);
    let shared: Vec<(usize, i32)> = (0..6).flat_map(|k| [(104 * k + 20, 0), (104 * k + 24, 36)]).collect();
    let shared = with(&shared).unwrap_err().to_string();
    let end = "names 180 records of lump 11 (indices), which has 36: they share more than is read";
    assert!(shared.starts_with("lump 13 (faces): its records ") && shared.ends_with(&end[6..]), "{shared}");
}
