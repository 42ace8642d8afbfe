//! Portal files: what is read, what is refused and where, and that hostile ones are refused at once.

use crate::common::line_of;
use crate::common::quake::{SMALL_PRTS, check_prt};
use proptest::prelude::*;
use sightlines_cells::CellId;
use sightlines_formats::Malformed;
use sightlines_formats::quake::prt::{LeafList, Prt, PrtDialect, SolidFace, parse_prt, write_prt};
use sightlines_formats::quake::{LeafClusters, MAX_CLUSTERS, graph_of_prt, read_prt};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};
use std::time::{Duration, Instant};

/// The text of the error, which must come at once.
fn refused(text: &[u8]) -> String {
    let start = Instant::now();
    let error = parse_prt(text).expect_err("a portal file that is wrong");
    assert!(start.elapsed() < Duration::from_secs(2), "{error} took {:?}", start.elapsed());
    error.to_string()
}

const PORTAL: &str = "3 0 1 (0 0 0) (1 0 0) (0 1 0)\n";

#[test]
fn dialects_are_read() {
    let all = SMALL_PRTS.map(|text| parse_prt(text.as_bytes()).unwrap());
    let [plain, lists, numbers, counts, faces] = &all;
    assert_eq!(all.each_ref().map(|p| p.dialect()), PrtDialect::ALL);
    for prt in &all {
        assert_eq!((prt.n_clusters(), prt.n_portals()), (3, 2));
        let portals: Vec<_> = prt.portals().collect();
        assert_eq!(portals[0].clusters, [0, 1]);
        assert_eq!(portals[0].points, [[0., 0., 0.], [0., 8., 0.], [0., 8., 8.], [0., 0., 8.]]);
        assert_eq!(portals[1].clusters, [2, 1]);
        assert_eq!(portals[1].points, [[64., 0., 0.], [64.25, 0., 9.], [64., 1e-3, 0.5]]);
    }
    assert_eq!(plain.listed_leafs(), None);
    assert_eq!(plain.leaf_clusters().cluster_of_leaf(), [0, 1, 2]);
    assert_eq!(lists.listed_leafs().unwrap().cluster_of_leaf(), [1, 2, 0, 1]);
    assert_eq!(lists.leaf_clusters(), numbers.leaf_clusters());
    assert_eq!(counts.listed_leafs().unwrap().cluster_of_leaf(), [0, 1, 2, 2]);
    assert_eq!((faces.listed_leafs(), faces.hints()), (None, Some(&[0, 1][..])));
    let [face] = faces.solid_faces() else { panic!("one face") };
    assert_eq!((face.cluster, &face.points[..]), (2, faces.portal(1).points));
    assert!(all[..4].iter().all(|prt| prt.hints().is_none() && prt.solid_faces().is_empty()));
    assert_eq!(SMALL_PRTS.map(|text| text.replace("1e-3", "0.001")), all.each_ref().map(write_prt));
}

/// Files that begin alike: the pieces behind the two counts tell a `PRT1` from one of Quake III.
#[test]
fn dialects_that_begin_alike_are_told_apart() {
    let dialect = |text: &str| parse_prt(text.as_bytes()).map(|prt| prt.dialect()).map_err(|error| error.to_string());
    let triangle = "(0 0 0) (1 0 0) (0 1 0)";
    assert_eq!(dialect("PRT1 1 0"), Ok(PrtDialect::Prt1));
    assert_eq!(dialect("PRT1 1 0 0"), Ok(PrtDialect::Quake3));
    assert_eq!(dialect(&format!("PRT1 1 0 1 3 0 {triangle}")), Ok(PrtDialect::Quake3));
    assert_eq!(dialect(&format!("PRT1 2 1 3 0 1 {triangle}")), Ok(PrtDialect::Prt1));
    assert_eq!(dialect(&format!("PRT1 2 1 0 3 0 1 0 {triangle}")), Ok(PrtDialect::Quake3));
    assert_eq!(dialect(&format!("2 1 1 1 3 0 1 {triangle}")), Ok(PrtDialect::HalfLife));
    // Between the two: faces without hints.
    let error = "line 1, column 10: the number of points of portal 0: 0 is not from 3 to 64";
    assert_eq!(dialect(&format!("PRT1 2 1 0 3 0 1 {triangle}")), Err(error.to_owned()));
}

#[test]
fn hostile_files_of_half_life() {
    let text = |counts: &str| refused(format!("2\n1\n{counts}\n{PORTAL}").as_bytes());
    let many = "line 4, column 1: the number of leafs of cluster 1: 65536 is not from 0 to 65535";
    assert_eq!(text("1\n65536"), many);
    assert_eq!(
        text("2147483648\n1"),
        "line 3, column 1: the number of leafs of cluster 0: 2147483648 is not from 0 to 65536"
    );
    // A count too few: the portal's number of points is taken for it.
    assert_eq!(text("1"), "line 4, column 3: the number of points of portal 0: 0 is not from 3 to 64");
    assert_eq!(refused(b"2147483648 1"), "line 1, column 1: the number of clusters: 2147483648 is not from 1 to 65536");
    assert_eq!(refused(b"0 0"), "line 1, column 1: the number of clusters: 0 is not from 1 to 65536");
    assert_eq!(refused(b"3 0 1 -1"), "line 1, column 7: the number of leafs of cluster 1: -1 is not from 0 to 65535");
    let prt = parse_prt(format!("2\n1\n3\n0\n{PORTAL}").as_bytes()).unwrap();
    assert_eq!(prt.leaf_clusters().cluster_of_leaf(), [0, 0, 0]);
    let order = prt.with_leafs(LeafList::Counts, vec![0, 1, 0]).unwrap_err();
    assert_eq!(order.to_string(), "leaf 2 is of cluster 0, and the leaf before it of a later one");
}

#[test]
fn hostile_files_of_quake_3() {
    let text =
        |behind: &str| refused(format!("PRT1\n2\n1\n2147483648\n3 0 1 0 (0 0 0) (1 0 0) (0 1 0)\n{behind}").as_bytes());
    assert_eq!(text(""), "line 6, column 1: expected the number of points of solid face 0, found the end of the file");
    assert_eq!(text("3 2"), "line 6, column 3: the cluster of solid face 0: 2 is not from 0 to 1");
    assert_eq!(text("65 1"), "line 6, column 1: the number of points of solid face 0: 65 is not from 3 to 64");
    let place = "line 6, column 12: expected point 1 of solid face 0 in parentheses, found ";
    assert_eq!(text("3 1 (0 0 0) 1"), format!("{place}\"1\"").replace("column 12", "column 13"));
    assert_eq!(text("3 1 (0 0 0) (1 nan 0)"), format!("{place}\"nan\"").replace("column 12", "column 16"));
    let far = text("3 1 (0 0 0) (1 1e300 0)");
    assert!(far.starts_with("line 6, column 1: solid face 0, point 1: coordinate 1e300 is "), "{far}");
    let prt = parse_prt(b"PRT1 2 0").unwrap();
    assert!(prt.clone().with_faces(vec![1], vec![]).is_err(), "a hint of no portal");
    let face = |cluster, n| SolidFace { cluster, points: vec![[1.0, 2.0, 3.0]; n] };
    for (face, is_sound) in [(face(1, 3), true), (face(2, 3), false), (face(1, 2), false), (face(1, 65), false)] {
        assert_eq!(prt.clone().with_faces(vec![], vec![face]).is_ok(), is_sound);
    }
}

#[test]
fn whitespace_is_free() {
    for text in SMALL_PRTS {
        let prt = parse_prt(text.as_bytes());
        let same = [
            text.replace('\n', "\r\n"),
            text.replace('\n', " \t\x0B\x0C "),
            text.trim_end().to_owned(),
            format!("\n\n {text}\n \r\n"),
            text.replace('(', " ( ").replace(')', " ) "),
            text.replace(") (", ")("),
        ];
        for (k, text) in same.iter().enumerate() {
            assert_eq!(parse_prt(text.as_bytes()), prt, "variant {k}");
        }
    }
    let crlf = "PRT1\r\n2\r\n1\r\n3 0 1 (0 0 0) (1 0 0) (0 nan 0)\r\n";
    let error = "line 4, column 26: expected a coordinate of point 2 of portal 0, found \"nan\"";
    assert_eq!(refused(crlf.as_bytes()), error);
}

#[test]
fn hostile_truncated_files_are_refused_where_they_end() {
    let text = refused(b"PRT1\n2\n2\n3 0 1 (0 0 0) (1 0 0) (0 1 0)\n");
    assert_eq!(text, "line 5, column 1: expected the number of points of portal 1, found the end of the file");
    let text = refused(b"PRT1\n2\n1\n3 0 1 (0 0 0) (1 0 0");
    assert_eq!(text, "line 4, column 21: expected the \")\" behind point 1 of portal 0, found the end of the file");
    let text = refused(format!("PRT2\n2\n2\n1\n{PORTAL}0 1\n-1\n").as_bytes());
    assert_eq!(text, "line 8, column 1: expected a leaf of cluster 1 or -1, found the end of the file");
    let text = refused(format!("PRT1-AM\n2\n1\n3\n{PORTAL}0 1").as_bytes());
    // There is room for three leafs in the bytes, but not behind the portals.
    assert_eq!(text, "line 6, column 4: expected the cluster of leaf 2, found the end of the file");
}

#[test]
fn hostile_header_only() {
    for magic in ["PRT1", "PRT2", "PRT1-AM"] {
        assert!(refused(magic.as_bytes()).ends_with("found the end of the file"), "{magic}");
        assert!(refused(format!("{magic}\n").as_bytes()).ends_with("found the end of the file"), "{magic}");
    }
    assert_eq!(refused(b"PRT1\n7\n9\n"), {
        "line 4, column 1: expected the number of points of portal 0, found the end of the file"
    });
    assert_eq!(refused(b"PRT1\n0\n0\n"), "line 2, column 1: the number of clusters: 0 is not from 1 to 65536");
    // One room without doors is a map.
    assert_eq!(parse_prt(b"PRT1 1 0").map(|prt| prt.n_clusters()), Ok(1));
}

#[test]
fn hostile_counts_are_not_believed() {
    assert_eq!(
        refused(format!("PRT1\n2\n1000000000\n{PORTAL}").as_bytes()),
        "line 5, column 1: expected the number of points of portal 1, found the end of the file"
    );
    assert_eq!(
        refused(b"PRT1\n1000000000\n0\n"),
        "line 2, column 1: the number of clusters: 1000000000 is not from 1 to 65536"
    );
    assert_eq!(
        refused(b"PRT2\n4000000000\n1\n0\n0 -1\n"),
        "line 2, column 1: 4000000000 leafs cannot be listed in the 10 bytes that follow"
    );
    assert_eq!(
        refused(b"PRT1-AM\n1\n0\n4000000000\n0\n"),
        "line 4, column 1: 4000000000 leafs cannot be listed in the 3 bytes that follow"
    );
    let huge = refused(b"PRT1\n2\n99999999999999999999999\n");
    assert_eq!(huge, "line 3, column 1: the number of portals: 99999999999999999999999 is not from 0 to 4294967295");
}

#[test]
fn hostile_windings_of_one_and_two_points() {
    for n in [0, 1, 2, 65, 1_000_000_000] {
        let points = "(0 0 0) ".repeat(n.min(65));
        let text = refused(format!("PRT1\n2\n1\n{n} 0 1 {points}\n").as_bytes());
        assert_eq!(text, format!("line 4, column 1: the number of points of portal 0: {n} is not from 3 to 64"));
    }
    let most = format!("PRT1\n2\n1\n64 0 1 {}\n", "(0 0 1) ".repeat(64));
    assert_eq!(parse_prt(most.as_bytes()).unwrap().portal(0).points.len(), 64);
    // Fewer points than announced, and more.
    let text = refused(format!("PRT1\n2\n2\n{}{PORTAL}", PORTAL.replacen('3', "4", 1)).as_bytes());
    assert_eq!(text, "line 5, column 1: expected the \"(\" before point 3 of portal 0, found \"3\"");
    let text = refused(b"PRT1\n2\n2\n3 0 1 (0 0 0) (1 0 0) (0 1 0) (2 2 2)\n3 0 1");
    assert_eq!(text, "line 4, column 31: expected the number of points of portal 1, found \"(\"");
}

#[test]
fn hostile_numbers() {
    for word in ["nan", "NaN", "inf", "-inf", "infinity", "0x10", "1,5", "--1", "1e", ".", "-", "1_0", "\u{661}"] {
        let text = refused(format!("PRT1\n2\n1\n3 0 1 (0 {word} 0) (1 0 0) (0 1 0)\n").as_bytes());
        assert!(text.starts_with("line 4, column 10: expected a coordinate of point 0 of portal 0, found "), "{text}");
    }
    for (word, shown) in [("1e999", "inf is"), ("1e300", "1e300 is"), ("-1e61", "-1e61 is")] {
        let text = refused(format!("PRT1\n2\n1\n3 0 1 (0 0 0) (1 0 {word}) (0 1 0)\n").as_bytes());
        assert!(text.starts_with(&format!("line 4, column 1: portal 0, point 1: coordinate {shown} ")), "{text}");
    }
    let read = |word: &str| parse_prt(PORTAL_WITH.replace('X', word).as_bytes()).unwrap().portal(0).points[0][0];
    assert_eq!(["+5", "5.", "5e0", "0.5E1"].map(read), [5.0; 4]);
    assert_eq!(read("104.00000000000003").to_bits(), 104.00000000000003f64.to_bits());
    // What rounding leaves of zeros.
    assert_eq!(["-0", "1e-300", "-1e-60"].map(read).map(f64::to_bits), [0; 3]);
    for word in ["1.0", "0x3", "3a", "+", "-", "(", "\u{663}"] {
        let text = refused(format!("PRT1\n{word}\n0\n").as_bytes());
        assert!(text.starts_with("line 2, column 1: expected the number of clusters, found "), "{text}");
    }
}

const PORTAL_WITH: &str = "PRT1 2 1 3 0 1 (X 0 0) (1 0 0) (0 1 0)";

#[test]
fn hostile_leafs_and_clusters_out_of_range() {
    for (word, found) in [("2", "2"), ("-1", "-1"), ("4294967296", "4294967296")] {
        let text = refused(PORTAL_WITH.replace("0 1 (X", &format!("0 {word} (5")).as_bytes());
        assert_eq!(text, format!("line 1, column 14: a cluster of portal 0: {found} is not from 0 to 1"));
    }
    let text = refused(PORTAL_WITH.replace("0 1 (X", "1 1 (5").as_bytes());
    assert_eq!(text, "line 1, column 10: portal 0 joins cluster 1 with itself");
    let lists = |lists: &str| refused(format!("PRT2\n3\n2\n1\n{PORTAL}{lists}").as_bytes());
    assert_eq!(lists("0 3 -1\n1 2 -1\n"), "line 6, column 3: a leaf of cluster 0 or -1: 3 is not from 0 to 2");
    assert_eq!(lists("0 -2 -1\n1 2 -1\n"), "line 6, column 3: a leaf of cluster 0 or -1: -2 is not from 0 to 2");
    assert_eq!(lists("0 1 -1\n1 2 -1\n"), "line 7, column 1: leaf 1 is in cluster 0 and in cluster 1");
    assert_eq!(lists("0 -1\n2 -1\n"), "line 8, column 1: leaf 1 is in no cluster");
    assert_eq!(lists("0 1 2 -1\n-1\n0 -1\n"), "line 8, column 1: expected the end of the file, found \"0\"");
    let numbers = |list: &str| refused(format!("PRT1-AM\n2\n1\n3\n{PORTAL}{list}").as_bytes());
    assert_eq!(numbers("0\n2\n1\n"), "line 7, column 1: the cluster of leaf 1: 2 is not from 0 to 1");
    assert_eq!(numbers("0\n1\n1\n1\n"), "line 9, column 1: expected the end of the file, found \"1\"");
}

#[test]
fn hostile_parentheses() {
    let text = |from: &str, to: &str| refused(PORTAL_WITH.replace('X', "0").replacen(from, to, 1).as_bytes());
    assert_eq!(text("(0", "0"), "line 1, column 16: expected the \"(\" before point 0 of portal 0, found \"0\"");
    assert_eq!(text(") (", " ("), "line 1, column 23: expected the \")\" behind point 0 of portal 0, found \"(\"");
    assert_eq!(text("0 0)", "0 0 0)"), "line 1, column 23: expected the \")\" behind point 0 of portal 0, found \"0\"");
    assert_eq!(text("0 0)", "0)"), "line 1, column 20: expected a coordinate of point 0 of portal 0, found \")\"");
    assert_eq!(text("(0", "((0"), "line 1, column 17: expected a coordinate of point 0 of portal 0, found \"(\"");
}

#[test]
fn hostile_beginnings_and_ends() {
    let magic = "line 1, column 1: expected PRT1, PRT2, PRT1-AM or the number of clusters, found ";
    assert_eq!(refused(b""), format!("{magic}the end of the file"));
    for (text, found) in [("PRT3\n1\n0\n", "PRT3"), ("prt1\n", "prt1"), ("12a\n4\n", "12a"), ("\0\0", "\0\0")] {
        assert_eq!(refused(text.as_bytes()), format!("{magic}{found:?}"));
    }
    let long = refused("x".repeat(5_000_000).as_bytes());
    assert_eq!(long, format!("{magic}\"{}...\"", "x".repeat(40)));
    assert_eq!(
        refused(&[b' '; 5_000_000][..]),
        "line 1, column 5000001: expected PRT1, PRT2, PRT1-AM or the number of clusters, found the end of the file"
    );
    for behind in ["x", "0", "-1", "\0", PORTAL] {
        let text = refused(format!("PRT1\n2\n1\n{PORTAL}{behind}").as_bytes());
        assert!(text.starts_with("line 5, column 1: expected the end of the file, found "), "{text}");
    }
}

#[test]
fn degenerate_windings_are_kept_and_reported() {
    let is_reported = |points: &str| {
        let prt = parse_prt(format!("PRT1 2 1 {} 0 1 {points}", points.matches('(').count()).as_bytes()).unwrap();
        assert_eq!(write_prt(&prt).matches('(').count(), points.matches('(').count());
        prt.portal(0).is_degenerate()
    };
    assert!(is_reported("(1 2 3) (1 2 3) (1 2 3)"));
    assert!(is_reported("(0 0 0) (1 1 1) (3 3 3) (2 2 2)"));
    assert!(is_reported("(5 5 5) (5 5 5) (6 5 5) (9 5 5)"));
    assert!(!is_reported("(5 5 5) (5 5 5) (6 5 5) (9 5 5.000000001)"));
    assert!(!is_reported("(10000000 0 0) (10000000 0 5) (10000000.000000002 0 9)"));
}

/// What rounding explains is read, as compilers round: to 17 digits, to six decimals, to whole numbers nearby. More
/// is refused where it stands.
#[test]
fn hostile_portals_that_are_not_flat() {
    let text = |off: f64| format!("PRT1\n2\n2\n{PORTAL}4 1 0 (0 0 0) (64 0 64) (64 64 {}) (0 64 0)\n", 64.0 + off);
    let n_read = [0.0, 1e-13, 1e-6, 0.05, -0.2].map(|off| parse_prt(text(off).as_bytes()).is_ok());
    assert_eq!(n_read, [true; 5]);
    for off in [2.0, -2.0, 40.0, 1e6] {
        let error = refused(text(off).as_bytes());
        let start = "line 5, column 1: portal 1 is not flat: a point is ";
        assert!(error.starts_with(start) && error.ends_with(" units off the plane of the others"), "{error}");
    }
    // Far away, what doubles hold is rounding too.
    let far = |off: f64| {
        let x = 2f64.powi(60);
        let points = [[x, 0.0, 0.0], [x, 2.0 * x, 0.0], [0.0, 2.0 * x, x + off], [0.0, 0.0, x]];
        Prt::new(2).unwrap().push_portal([0, 1], &points)
    };
    assert_eq!(far(1024.0), Ok(()));
    let error = far(2f64.powi(30)).unwrap_err().to_string();
    let by = error.strip_prefix("portal 0 is not flat: a point is ").and_then(|rest| rest.split(' ').next());
    assert!(by.is_some_and(|by| by.parse::<f64>().unwrap() > 1e6), "{error}");
}

#[test]
fn portals_are_built_with_the_same_checks() {
    let square = [[0., 0., 0.], [0., 8., 0.], [0., 8., 8.], [0., 0., 8.]];
    let mut prt = Prt::new(3).unwrap();
    prt.push_portal([2, 0], &square).unwrap();
    let before = prt.clone();
    let text = |r: Result<(), Malformed>| r.unwrap_err().to_string();
    assert_eq!(text(prt.push_portal([0, 1], &square[..2])), "the number of points of portal 1: 2 is not from 3 to 64");
    assert_eq!(text(prt.push_portal([0, 3], &square)), "a cluster of portal 1: 3 is not from 0 to 2");
    assert_eq!(text(prt.push_portal([1, 1], &square)), "portal 1 joins cluster 1 with itself");
    let nan = [[0.0; 3], [1.0; 3], [1.0, f64::NAN, 0.0]];
    assert_eq!(text(prt.push_portal([0, 1], &nan)), "portal 1, point 2: coordinate NaN is not a finite number");
    assert_eq!(prt, before);
    assert!(Prt::new(0).is_err() && Prt::new(MAX_CLUSTERS + 1).is_err() && Prt::new(MAX_CLUSTERS).is_ok());
    let error = prt.with_leafs(LeafList::PerLeaf, vec![0, 3]).unwrap_err().to_string();
    assert_eq!(error, "leaf 1 is in cluster 3, but there are 3");
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.prt");
    std::fs::write(&path, "PRT1\n1\n1\n").unwrap();
    let text = read_prt(&path).unwrap_err().to_string();
    assert!(
        text.ends_with(
            "room.prt: line 4, column 1: expected the number of points of portal 0, found the end of the file"
        )
    );
    std::fs::write(&path, SMALL_PRTS[1]).unwrap();
    assert_eq!(write_prt(&read_prt(&path).unwrap()), SMALL_PRTS[1].replace("1e-3", "0.001"));
    assert!(read_prt(folder.path().join("absent.prt")).unwrap_err().to_string().contains("absent.prt: "));
}

#[test]
fn every_prefix_and_flipped_bit_is_read_or_refused() {
    for text in SMALL_PRTS.map(str::as_bytes) {
        let accepted = (0..text.len()).filter(|&len| check_prt(&text[..len])).count();
        // Only the space and the line's end behind the last piece may be missing.
        assert!((1..=2).contains(&accepted), "{accepted} prefixes are read");
        let flipped = flipped_bits(text).filter(|t| check_prt(t)).count();
        assert!((text.len() / 2..4 * text.len()).contains(&flipped), "{flipped} flipped files are read");
    }
}

#[test]
fn damaged_files_are_read_or_refused() {
    let rounds = crate::common::setting("SIGHTLINES_FUZZ_ROUNDS", 5_000);
    let first = crate::common::setting("SIGHTLINES_FUZZ_SEED", 0);
    let accepted = (first..first + rounds)
        .filter(|&number| {
            let broken = mutate(SMALL_PRTS[number as usize % SMALL_PRTS.len()].as_bytes(), &mut SplitMix::new(number));
            std::panic::catch_unwind(|| check_prt(&broken)).unwrap_or_else(|_| {
                panic!("replay with SIGHTLINES_FUZZ_ROUNDS=1 SIGHTLINES_FUZZ_SEED={number}: {broken:?}")
            })
        })
        .count() as u64;
    assert!((rounds / 100..=rounds * 95 / 100).contains(&accepted) || rounds < 1000, "{accepted} of {rounds} accepted");
}

/// Portals with coordinates as bits, from a small grid as well.
fn portals() -> impl Strategy<Value = Prt> {
    let coordinate = prop_oneof![
        3 => (-8i32..8).prop_map(f64::from),
        1 => (-1e6..1e6f64).boxed(),
        1 => (-1.0..1.0f64, -130i32..166).prop_map(|(x, exponent)| x * 2f64.powi(exponent)),
    ];
    let point = [coordinate.clone(), coordinate.clone(), coordinate];
    let portal = (0..20u32, 1..20u32, proptest::collection::vec(point, 3..9));
    let leafs = proptest::option::of((0..4, proptest::collection::vec(0..20u32, 1..60)));
    (proptest::collection::vec(portal, 0..12), leafs).prop_map(|(portals, leafs)| {
        let mut prt = Prt::new(20).unwrap();
        for (a, step, points) in portals {
            // Points that go round nothing or are on no plane are refused; of them a triangle is left, or nothing.
            let pair = [a, (a + step) % 20];
            let is_not_flat = |error: &Malformed| error.what.contains(" is not flat: ");
            let refused = |added: &Result<(), Malformed>| match added {
                Ok(()) => false,
                Err(error) if is_not_flat(error) || error.what.contains(" is not a convex polygon: ") => true,
                Err(error) => panic!("{error}"),
            };
            if refused(&prt.push_portal(pair, &points)) {
                let again = prt.push_portal(pair, &points[..3]);
                assert!(!again.as_ref().is_err_and(is_not_flat), "a triangle is flat: {again:?}");
            }
        }
        match leafs {
            None => prt,
            Some((0, leafs)) => prt.with_leafs(LeafList::PerCluster, leafs).unwrap(),
            Some((1, leafs)) => prt.with_leafs(LeafList::PerLeaf, leafs).unwrap(),
            Some((2, mut leafs)) => {
                leafs.sort_unstable();
                prt.with_leafs(LeafList::Counts, leafs).unwrap()
            }
            Some((_, leafs)) => {
                let hints = (0..prt.n_portals() as u32).collect();
                let face = |&cluster| SolidFace { cluster, points: vec![[f64::from(cluster), 0.5, -3.0]; 3] };
                prt.with_faces(hints, leafs.iter().map(face).collect()).unwrap()
            }
        }
    })
}

/// The same without portals that clusters contradict.
fn in_order(prt: Prt) -> Prt {
    let Some(wrong) = prt.inside_out() else { return prt };
    let mut rest = Prt::new(prt.n_clusters()).unwrap();
    for (_, portal) in prt.portals().enumerate().filter(|&(k, _)| k != wrong) {
        rest.push_portal(portal.clusters, portal.points).unwrap();
    }
    let leafs = || prt.leaf_clusters().cluster_of_leaf().to_vec();
    in_order(match prt.dialect() {
        PrtDialect::Prt1 => rest,
        PrtDialect::Prt2 => rest.with_leafs(LeafList::PerCluster, leafs()).unwrap(),
        PrtDialect::Prt1Am => rest.with_leafs(LeafList::PerLeaf, leafs()).unwrap(),
        PrtDialect::HalfLife => rest.with_leafs(LeafList::Counts, leafs()).unwrap(),
        PrtDialect::Quake3 => {
            let hints = (0..rest.n_portals() as u32).collect();
            rest.with_faces(hints, prt.solid_faces().to_vec()).unwrap()
        }
    })
}

proptest! {
    /// What is written is read as the same, bit for bit, and written as the same.
    #[test]
    fn portals_read_as_written(prt in portals()) {
        let prt = in_order(prt);
        let text = write_prt(&prt);
        let read = parse_prt(text.as_bytes()).unwrap();
        let bits = |p: &Prt| -> Vec<u64> { p.portals().flat_map(|p| p.points.to_vec()).flatten().map(f64::to_bits).collect() };
        prop_assert_eq!(bits(&read), bits(&prt));
        prop_assert_eq!(&read, &prt);
        prop_assert_eq!(write_prt(&read), text);
    }

    /// A file that is cut off in front of its last number is refused, at its end.
    #[test]
    fn portals_cut_off_are_refused(prt in portals(), at in any::<prop::sample::Index>()) {
        let text = write_prt(&prt);
        // Without portals the beginning of one of Quake III is a `PRT1`.
        prop_assume!(prt.dialect() != PrtDialect::Quake3 || prt.n_portals() > 0);
        let last = text.trim_end().rfind(char::is_whitespace).unwrap();
        let cut = at.index(last);
        let error = parse_prt(&text.as_bytes()[..cut]).unwrap_err();
        prop_assert!(line_of(&error) <= text[..cut].matches('\n').count() + 1, "{}", error);
    }
}

#[test]
fn a_portal_leads_from_the_first_cluster_into_the_second() {
    let text = "PRT1\n3\n2\n4 1 0 (0 0 0 ) (0 1 0 ) (0 1 1 ) (0 0 1 )\n3 1 2 (-9 0 0 ) (-9 1 0 ) (-9 2 0 )\n";
    let graph = graph_of_prt(&parse_prt(text.as_bytes()).unwrap());
    assert_eq!((graph.n_cells(), graph.portals().len()), (3, 1), "a portal without area is none");
    assert_eq!(graph.portals()[0].cells, [CellId(1), CellId(0)]);
    assert_eq!(graph.portals()[0].shape.normal(), [2.0, 0.0, 0.0]);
}

#[test]
fn repeats_are_found_whatever_their_order() {
    let square = [[8.0, 0.0, 0.0], [8.0, 4.0, 0.0], [8.0, 4.0, 4.0], [8.0, 0.0, 4.0]];
    let turned = [square[2], square[3], square[0], square[1]];
    let mut reversed = turned;
    reversed.reverse();
    let mut moved = square;
    moved[0][1] = -1.0;
    let mut prt = Prt::new(3).unwrap();
    let all: [([u32; 2], &[[f64; 3]]); 7] = [
        ([0, 1], &square),
        ([0, 1], &turned),
        ([1, 0], &reversed),
        ([0, 1], &moved),
        ([0, 2], &square),
        ([0, 1], &square),
        ([0, 1], &square[..3]),
    ];
    all.iter().for_each(|(clusters, points)| prt.push_portal(*clusters, points).unwrap());
    assert_eq!(prt.repeats(), [false, true, true, false, false, true, false]);
    assert_eq!(prt.n_repeats(), 3);
    assert_eq!(graph_of_prt(&prt).portals().len(), 4);
}

#[test]
fn leafs_are_grouped() {
    let leafs = LeafClusters::new(4, vec![2, 0, 2, 3, 0]).unwrap();
    assert_eq!((leafs.n_leafs(), leafs.n_clusters()), (5, 4));
    let groups: Vec<&[u32]> = (0..4).map(|c| leafs.leafs_of(c)).collect();
    assert_eq!(groups, [&[1, 4][..], &[], &[0, 2], &[3]]);
    assert_eq!(leafs.cluster_of_leaf(), [2, 0, 2, 3, 0]);
    assert_eq!(LeafClusters::identity(3), LeafClusters::new(3, vec![0, 1, 2]));
}

#[test]
fn impossible_groups_are_refused() {
    let text = |r: Result<LeafClusters, Malformed>| r.unwrap_err().to_string();
    assert_eq!(text(LeafClusters::new(2, vec![0, 2])), "leaf 1 is in cluster 2, but there are 2");
    assert_eq!(text(LeafClusters::identity(0)), "0 clusters are not from 1 to 65536");
    assert_eq!(text(LeafClusters::identity(u32::MAX)), "4294967295 clusters are not from 1 to 65536");
}

/// A row of cubes of 64 units, with a portal between each two; those in the list go round the wrong way.
fn row(n: u32, reversed: &[u32]) -> Prt {
    let mut prt = Prt::new(n).unwrap();
    for k in 0..n - 1 {
        let x = 64.0 * f64::from(k + 1);
        // Counter-clockwise as seen from inside of the second cluster, at larger x.
        let mut points = [[x, 0.0, 0.0], [x, 64.0, 0.0], [x, 64.0, 64.0], [x, 0.0, 64.0]];
        if reversed.contains(&k) {
            points.reverse();
        }
        prt.push_portal([k, k + 1], &points).unwrap();
    }
    prt
}

#[test]
fn portals_that_go_round_the_wrong_way_are_found() {
    assert_eq!(row(6, &[]).inside_out(), None);
    // At the ends of the row only one cluster tells.
    for (k, found) in [(0, None), (1, Some(1)), (2, Some(2)), (3, Some(3)), (4, None)] {
        assert_eq!(row(6, &[k]).inside_out(), found, "portal {k}");
    }
    assert_eq!(row(6, &[0, 1, 2, 3, 4]).inside_out(), Some(0));
    assert_eq!(row(3, &[0, 1]).inside_out(), Some(0));
    assert_eq!(row(2, &[0]).inside_out(), None, "nothing tells");
}

/// A dead end, and a cluster that winds from it round a bend and back behind it.
#[test]
fn a_cluster_that_winds_back_is_no_mistake() {
    let mut prt = Prt::new(4).unwrap();
    let square = |x: f64, y: f64| [[x, y, 0.0], [x, y + 64.0, 0.0], [x, y + 64.0, 64.0], [x, y, 64.0]];
    prt.push_portal([0, 1], &square(0.0, 0.0)).unwrap();
    let mut back = square(-64.0, 128.0);
    back.reverse();
    prt.push_portal([1, 2], &back).unwrap();
    let mut further = square(-128.0, 128.0);
    further.reverse();
    prt.push_portal([2, 3], &further).unwrap();
    assert_eq!(prt.inside_out(), None);
}

/// Two clusters of merged leafs: each has a dead end beside the other's, and a hall behind that.
#[test]
fn clusters_that_lie_on_both_sides_are_no_mistake() {
    let square = |x: f64| [[x, 0.0, 0.0], [x, 64.0, 0.0], [x, 64.0, 64.0], [x, 0.0, 64.0]];
    let halls = |n: usize| {
        let mut prt = Prt::new(6).unwrap();
        for ([a, b], x) in
            [([0, 1], 0.0), ([0, 2], 192.0), ([0, 3], 256.0), ([4, 1], -192.0), ([5, 1], -256.0)].iter().take(n)
        {
            prt.push_portal([*a, *b], &square(*x)).unwrap();
        }
        prt
    };
    assert_eq!(halls(5).inside_out(), None);
    // With one portal elsewhere for each, both might be convex.
    let mut convex = halls(2);
    convex.push_portal([4, 1], &square(-192.0)).unwrap();
    assert_eq!(convex.inside_out(), Some(0));
}
