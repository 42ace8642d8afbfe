//! The tree and the faces of a map's world: what is read, and what is refused.

use crate::common::quake::{SmallBsp, check_world, small_worlds};
use sightlines_formats::quake::bsp::{BspChild, MAX_TREE_DEPTH};
use sightlines_formats::quake::{Bsp, BspFormat};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

fn small(format: BspFormat) -> Bsp {
    Bsp::parse(SmallBsp::with_world(format).file(false)).unwrap()
}

#[test]
fn trees_are_read() {
    for format in BspFormat::ALL {
        let tree = small(format).world_tree().unwrap();
        assert_eq!((tree.nodes().len(), tree.root()), (4, BspChild::Node(0)), "{format:?}");
        for (k, node) in tree.nodes().iter().enumerate() {
            assert_eq!((node.index as usize, node.normal, node.distance), (k, [1.0, 0.0, 0.0], 64.0 * (k + 1) as f64));
            let further = if k < 3 { BspChild::Node(k as u32 + 1) } else { BspChild::Leaf(0) };
            assert_eq!(node.children, [further, BspChild::Leaf(k as u32 + 1)]);
        }
    }
}

#[test]
fn faces_are_read() {
    for format in BspFormat::ALL {
        let (bsp, map) = (small(format), SmallBsp::with_world(format));
        let (faces, lists) = (bsp.world_faces().unwrap(), bsp.leaf_faces().unwrap());
        assert_eq!((faces.n_faces(), faces.range()), (6, 0..6), "{format:?}");
        let mut face = 0;
        for (leaf, names) in map.leafs.iter().enumerate() {
            let x = 64.0 * leaf as f64 + 32.0;
            for k in face..face + names.len() {
                let square = [[x, 8.0, 8.0], [x, 24.0, 8.0], [x, 24.0, 24.0], [x, 8.0, 24.0]];
                let [a, b, c, d] = square;
                let is_of_triangles = matches!(format, BspFormat::Quake3 | BspFormat::Wolfenstein);
                let polygons: &[&[_]] = if is_of_triangles { &[&[a, b, c], &[a, c, d]] } else { &[&square] };
                assert!(faces.polygons(k).eq(polygons.iter().copied()), "{format:?}, face {k}");
                assert_eq!(faces.corners(k), polygons.concat());
            }
            if leaf < lists.n_leafs() {
                let all: Vec<u32> = (face..face + names.len()).map(|k| k as u32).collect();
                assert_eq!(lists.of(leaf), all);
            }
            face += names.len();
        }
        assert_eq!(lists.n_leafs(), bsp.n_visible_leafs());
    }
}

/// The error of reading a world in which a number of a lump is another: 4 bytes at a place, or 2.
fn refused(format: BspFormat, lump: &str, at: usize, number: i64, n_bytes: usize) -> String {
    let map = SmallBsp::with_world(format);
    let mut bytes = map.file(false);
    let place = Bsp::parse(bytes.clone()).unwrap().lumps()[map.lump(lump)].start + at;
    bytes[place..place + n_bytes].copy_from_slice(&number.to_le_bytes()[..n_bytes]);
    let bsp = Bsp::parse(bytes).unwrap();
    let errors = [bsp.world_tree().err(), bsp.world_faces().err(), bsp.leaf_faces().err()];
    errors.into_iter().flatten().next().map_or("none".to_owned(), |error| error.to_string())
}

#[test]
fn what_is_not_there_is_named() {
    use BspFormat::{Bsp2, Bsp29, Quake2};
    let nan = i64::from(f32::NAN.to_bits());
    for (format, lump, at, number, n_bytes, text) in [
        (Bsp29, "models", 36, 4, 4, "lump 14 (models): record 0 names record 4 of lump 5 (nodes), which has 4"),
        (Bsp29, "models", 36, -7, 4, "lump 14 (models): record 0 names record 6 of lump 10 (leafs), which has 6"),
        (Quake2, "models", 36, 9, 4, "lump 13 (models): record 0 names record 9 of lump 4 (nodes), which has 4"),
        (Bsp29, "nodes", 24, 4, 4, "lump 5 (nodes): record 1 names record 4 of lump 1 (planes), which has 4"),
        (Bsp2, "nodes", 44 + 4, 77, 4, "lump 5 (nodes): record 1 names record 77 of lump 5 (nodes), which has 4"),
        (Bsp29, "nodes", 24 + 4, -9, 2, "lump 5 (nodes): record 1 names record 8 of lump 10 (leafs), which has 6"),
        (Bsp29, "nodes", 24 + 4, 0, 2, "lump 5 (nodes): node 0 is reached twice, so this is no tree"),
        (Quake2, "nodes", 28 + 8, 3, 4, "lump 4 (nodes): node 3 is reached twice, so this is no tree"),
        (Bsp29, "planes", 20, 0, 4, "lump 1 (planes): plane 1 has no normal of unit length, or no finite distance"),
        (
            Bsp29,
            "planes",
            20 + 12,
            nan,
            4,
            "lump 1 (planes): plane 1 has no normal of unit length, or no finite distance",
        ),
        (
            Bsp29,
            "models",
            60,
            7,
            4,
            "lump 14 (models): record 0 names 7 records from 0 on of lump 7 (faces), which has 6",
        ),
        (
            Bsp29,
            "models",
            56,
            -1,
            4,
            "lump 14 (models): record 0 names 6 records from -1 on of lump 7 (faces), which has 6",
        ),
        (
            Quake2,
            "models",
            44,
            7,
            4,
            "lump 13 (models): record 0 names 7 records from 0 on of lump 6 (faces), which has 6",
        ),
        (
            Bsp29,
            "faces",
            20 + 4,
            21,
            4,
            "lump 7 (faces): record 1 names 4 records from 21 on of lump 13 (surfedges), which has 24",
        ),
        (
            Bsp2,
            "faces",
            28 + 12,
            99,
            4,
            "lump 7 (faces): record 1 names 99 records from 4 on of lump 13 (surfedges), which has 24",
        ),
        (
            Bsp29,
            "surfedges",
            8,
            -25,
            4,
            "lump 13 (surfedges): record 2 names record 25 of lump 12 (edges), which has 25",
        ),
        (
            Quake2,
            "surfedges",
            8,
            i64::from(i32::MIN),
            4,
            "lump 12 (surfedges): record 2 names record 2147483648 of lump 11 (edges), which has 25",
        ),
        (Bsp29, "edges", 4, 24, 2, "lump 12 (edges): record 1 names record 24 of lump 3 (vertices), which has 24"),
        (Bsp29, "vertices", 16, nan, 4, "lump 3 (vertices): vertex 1 has a coordinate that is not a finite number"),
        (
            Bsp29,
            "leafs",
            28 + 20,
            6,
            2,
            "lump 10 (leafs): record 1 names 1 records from 6 on of lump 11 (marksurfaces), which has 6",
        ),
        (
            Bsp2,
            "leafs",
            2 * 44 + 36,
            6,
            4,
            "lump 10 (leafs): record 2 names 6 records from 1 on of lump 11 (marksurfaces), which has 6",
        ),
        (
            Bsp29,
            "marksurfaces",
            4,
            6,
            2,
            "lump 11 (marksurfaces): record 2 names record 6 of lump 7 (faces), which has 6",
        ),
        (Quake2, "leaffaces", 4, 6, 2, "lump 9 (leaffaces): record 2 names record 6 of lump 6 (faces), which has 6"),
        (Bsp29, "marksurfaces", 4, 5, 2, "none"),
    ] {
        assert_eq!(refused(format, lump, at, number, n_bytes), text, "{format:?} {lump} {at}");
    }
}

/// Every lump that is read, cut by a byte or to nothing, is an error that names it; those of leafs and of models are refused
/// at once in some formats.
#[test]
fn cut_lumps_are_refused() {
    let mut n_cut = 0;
    for format in BspFormat::ALL {
        let map = SmallBsp::with_world(format);
        let file = map.file(false);
        for name in [
            "planes",
            "nodes",
            "vertices",
            "edges",
            "surfedges",
            "indices",
            "faces",
            "models",
            "leaffaces",
            "marksurfaces",
        ] {
            let Some(lump) = format.lump_names().iter().position(|n| *n == name) else { continue };
            let len = Bsp::parse(file.clone()).unwrap().lumps()[lump].len();
            for cut in [len - 1, 0] {
                let mut bytes = file.clone();
                let at = format.magic().len() + 8 * lump + 4;
                bytes[at..at + 4].copy_from_slice(&(cut as u32).to_le_bytes());
                let error = match Bsp::parse(bytes) {
                    Err(error) => error,
                    Ok(bsp) => {
                        let errors = [bsp.world_tree().err(), bsp.world_faces().err(), bsp.leaf_faces().err()];
                        errors.into_iter().flatten().next().expect("something is missing")
                    }
                };
                assert!(error.to_string().contains(&format!("({name})")), "{format:?}, {name} cut to {cut}: {error}");
                n_cut += 1;
            }
        }
    }
    // Those of Quake III have one list of indices for two of edges.
    assert_eq!(n_cut, (7 * 8 + 2 * 7) * 2);
}

#[test]
fn deep_trees_and_shared_lists_are_refused() {
    let map = |n: usize| SmallBsp { leafs: vec![vec![]; n], n_visible: n, ..SmallBsp::with_world(BspFormat::Bsp2) };
    let read = |n: usize| Bsp::parse(map(n).file(false)).unwrap().world_tree();
    assert_eq!(read(MAX_TREE_DEPTH).unwrap().nodes().len(), MAX_TREE_DEPTH);
    let error = read(MAX_TREE_DEPTH + 1).unwrap_err().to_string();
    assert_eq!(error, "lump 5 (nodes): node 1024 is 1024 steps below the root, more than are followed");
    // Every face and every leaf names all that is listed.
    let mut lumps = SmallBsp::with_world(BspFormat::Bsp29);
    lumps.leafs = vec![vec!["brick"]; 12];
    lumps.n_visible = 12;
    let file = lumps.file(false);
    let places = Bsp::parse(file.clone()).unwrap();
    let (leafs, faces) = (places.lumps()[10].start, places.lumps()[7].start);
    let mut bytes = file.clone();
    for k in 0..12 {
        bytes[leafs + 28 * (k + 1) + 20..][..4].copy_from_slice(&[0, 0, 12, 0]);
        bytes[faces + 20 * k + 4..][..6].copy_from_slice(&[0, 0, 0, 0, 48, 0]);
    }
    let bsp = Bsp::parse(bytes).unwrap();
    let texts = [bsp.leaf_faces().unwrap_err().to_string(), bsp.world_faces().unwrap_err().to_string()];
    let end = "they share more than is read";
    assert_eq!(
        texts[0],
        format!("lump 10 (leafs): its records name 60 records of lump 11 (marksurfaces), which has 12: {end}")
    );
    assert_eq!(
        texts[1],
        format!("lump 7 (faces): its records name 240 records of lump 13 (surfedges), which has 48: {end}")
    );
}

/// More nodes than 15 bits count: children are distinguished from leafs by the number of nodes.
#[test]
fn wide_children_of_version_29_are_read() {
    // A tree as flat as it can be: node `k` has the nodes `2 k + 1` and `2 k + 2`, or leafs.
    let n_nodes = 40_000usize;
    let mut map = SmallBsp::with_world(BspFormat::Bsp29);
    map.leafs = vec![vec![]; 2];
    map.n_visible = 2;
    let mut lumps = map.lumps();
    let child = |k: usize| if k < n_nodes { k as u16 } else { u16::MAX - 1 };
    let node = |k: usize| {
        [vec![0; 4], child(2 * k + 1).to_le_bytes().to_vec(), child(2 * k + 2).to_le_bytes().to_vec(), vec![0; 16]]
            .concat()
    };
    lumps[5] = (0..n_nodes).flat_map(node).collect();
    let mut file = map.format.magic().to_vec();
    file.resize(map.format.header_len(), 0);
    for (k, lump) in lumps.iter().enumerate() {
        let place = (file.len() as u32).to_le_bytes();
        file[4 + 8 * k..][..4].copy_from_slice(&place);
        file[8 + 8 * k..][..4].copy_from_slice(&(lump.len() as u32).to_le_bytes());
        file.extend(lump);
    }
    let tree = Bsp::parse(file).unwrap().world_tree().unwrap();
    assert_eq!(tree.nodes().len(), n_nodes);
    let n_leafs = tree.nodes().iter().flat_map(|n| n.children).filter(|c| *c == BspChild::Leaf(1)).count();
    assert_eq!(n_leafs, n_nodes + 1);
}

#[test]
fn damaged_worlds_cause_no_panic() {
    let worlds = small_worlds();
    assert!(worlds.iter().all(|bytes| check_world(bytes)));
    let mut n_read = 0;
    let mut random = SplitMix::new(29);
    for bytes in &worlds {
        n_read += flipped_bits(bytes).filter(|bytes| check_world(bytes)).count();
        for len in 0..bytes.len() {
            check_world(&bytes[..len]);
        }
        for _ in 0..2000 {
            n_read += usize::from(check_world(&mutate(bytes, &mut random)));
        }
    }
    assert!(n_read > 1000, "{n_read}");
}
