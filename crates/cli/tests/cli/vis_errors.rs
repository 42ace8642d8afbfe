//! Bad maps and portal files: one line with file and place, exit code 2, quickly, and nothing written.

use crate::common::Folder;
use crate::common::quake::{rooms, small_maps};
use std::time::{Duration, Instant};

/// What was seen to make another program run for ever, or crash.
#[test]
fn hostile_portals_are_refused_with_file_and_line() {
    let map = rooms(3, 2);
    let sound = map.prt.as_str();
    let line = |n: usize| sound.lines().nth(n - 1).unwrap();
    let replaced = |n: usize, with: &str| {
        let lines = sound.lines().enumerate().map(|(k, line)| if k + 1 == n { with } else { line });
        lines.collect::<Vec<_>>().join("\n")
    };
    let cases = [
        ("cut in a portal", sound[..sound.len() - 20].to_owned(), "line 10, "),
        ("cut between portals", sound.lines().take(7).collect::<Vec<_>>().join("\n"), "line "),
        ("one point", replaced(6, "1 1 0 (1 1 1 ) "), "line 6, column 1: "),
        ("two points", replaced(6, "2 1 0 (1 1 1 ) (2 2 2 ) "), "line 6, column 1: "),
        ("65 points", replaced(6, &format!("65 1 0 {}", "(1 1 1 ) ".repeat(65))), "line 6, column 1: "),
        ("nan", replaced(5, &line(5).replacen('(', "(nan ", 1)), "line 5, column "),
        ("inf", replaced(5, "3 0 1 (inf 0 0 ) (1 0 0 ) (0 1 0 ) "), "line 5, column "),
        ("large", replaced(5, "3 0 1 (1e300 0 0 ) (1 0 0 ) (0 1 0 ) "), "line 5, column "),
        ("leaf as the count", replaced(4, &line(4).replacen(" 0 1 ", " 0 6 ", 1)), "line 4, column "),
        ("negative leaf", replaced(4, &line(4).replacen(" 0 1 ", " -1 1 ", 1)), "line 4, column "),
        ("leaf as itself", replaced(4, &line(4).replacen(" 0 1 ", " 1 1 ", 1)), "line 4, column "),
        ("no polygon", replaced(4, "4 0 1 (0 0 0 ) (1 1 0 ) (1 0 0 ) (0 1 0 ) "), "line 4, column "),
        ("header only", sound.lines().take(3).collect::<Vec<_>>().join("\n"), "line 3, column "),
        ("magic only", "PRT1\n".to_owned(), "line 2, column 1: "),
        ("nothing", String::new(), "line 1, column 1: "),
        ("other magic", "PRT3\n1\n0\n".to_owned(), "line 1, column 1: "),
        ("a billion portals", replaced(3, "1000000000"), "line 10, column "),
        ("a billion leafs", replaced(2, "1000000000"), "line 2, column 1: "),
        ("a billion listed leafs", "PRT2\n1000000000\n6\n0\n".to_owned(), "line 2, column 1: "),
        ("listed leafs missing", sound.replacen("PRT1\n6\n", "PRT1-AM\n6\n", 1), "line "),
        ("leafs listed twice", format!("PRT2\n6\n6\n{}\n0 -1\n0 -1\n", sound.splitn(3, '\n').nth(2).unwrap()), "line "),
        ("text behind", format!("{sound}7\n"), "line 11, column 1: "),
        ("no portals", "PRT1\n6\n0\n".to_owned(), "there are 6 clusters, but no portals"),
    ];
    assert!(line(10).starts_with("4 "), "the last line is a portal");
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("sound.prt", sound);
    folder.write("out.bsp", "precious");
    for (what, text, place) in cases {
        folder.write("bad.prt", &text);
        let start = Instant::now();
        for args in [
            &["vis", "map.bsp", "--prt", "bad.prt", "-o", "out.bsp"][..],
            &["vis", "map.bsp", "--prt", "bad.prt"],
            &["build", "bad.prt", "-o", "out.pvs"],
        ] {
            let error = folder.refused(args);
            let is_named = what == "nothing" || error.contains(place) || error.contains("neither");
            assert!(error.starts_with("bad.prt: ") && is_named, "{what}: {error}");
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{what} took {:?}", start.elapsed());
        assert_eq!(folder.read("out.bsp"), b"precious");
        assert_eq!(folder.read("map.bsp"), map.bsp);
    }
    assert_eq!(folder.names(), ["bad.prt", "map.bsp", "out.bsp", "sound.prt"]);
    folder.run(&["vis", "map.bsp", "--prt", "sound.prt", "-o", "out.bsp"]).expect(0);
}

/// Portals of another map, with as many leafs or not, are distinguished from the map's own; both files are named.
#[test]
fn portals_of_another_map_are_refused() {
    let folder = Folder::new();
    let (map, larger) = (rooms(3, 2), rooms(4, 2));
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &larger.prt);
    let error = folder.refused(&["vis", "map.bsp"]);
    let text =
        "map.prt: does not go with map.bsp: the portals are of a map with 8 leafs, this one has 6 that can be seen";
    assert_eq!(error, text);
    // As many leafs, but elsewhere.
    let turned = rooms(2, 3);
    folder.write("map.prt", &turned.prt);
    let error = folder.refused(&["vis", "map.bsp"]);
    assert!(error.starts_with("map.prt: does not go with map.bsp: the portals are of another map: "), "{error}");
    assert_eq!(folder.read("map.bsp"), map.bsp);
    assert_eq!(folder.names(), ["map.bsp", "map.prt"]);
}

#[test]
fn damaged_maps_are_refused() {
    let folder = Folder::new();
    let mut n_refused = 0;
    // Each map once, with the first of the portals that go with it.
    let mut maps = small_maps();
    maps.dedup_by(|a, b| a.bsp == b.bsp);
    for map in maps {
        folder.write("map.prt", &map.prt);
        for len in [0, 3, 8, 60, map.bsp.len() / 2, map.bsp.len() - 1] {
            folder.write("map.bsp", &map.bsp[..len]);
            let run = folder.run(&["vis", "map.bsp"]);
            // The last bytes may be padding.
            if run.code != 0 {
                assert!(run.code == 2 && run.err.starts_with("error: map."), "{}", run.err);
                assert_eq!(folder.read("map.bsp"), &map.bsp[..len]);
                n_refused += 1;
            }
        }
        folder.write("map.bsp", b"IBSP\x2D\0\0\0aaaaaaaaaaaaaaaaaaaaaaaaaaaaa");
        let error = folder.refused(&["vis", "map.bsp"]);
        assert!(error.starts_with("map.bsp: not a map: it begins with "), "{error}");
    }
    assert!(n_refused > 50, "{n_refused}");
    assert_eq!(folder.names(), ["map.bsp", "map.prt"]);
}

#[test]
fn files_that_are_missing_or_taken_are_named() {
    let folder = Folder::new();
    let map = rooms(2, 2);
    assert!(folder.refused(&["vis", "no.bsp"]).starts_with("no.bsp: No such file"));
    folder.write("map.bsp", &map.bsp);
    let error = folder.refused(&["vis", "map.bsp"]);
    assert!(error.starts_with("map.bsp: there is no map.prt beside it, and no portals can be made"), "{error}");
    assert!(folder.refused(&["vis", "map.bsp", "--prt", "no.prt"]).starts_with("no.prt: No such file"));
    folder.write("map.prt", &map.prt);
    let error =
        "map.prt: these are the portals of a map, and the map itself is needed: sightlines vis map.bsp --prt map.prt";
    assert_eq!(folder.refused(&["vis", "map.prt"]), error);
    assert!(folder.refused(&["vis", "map.bsp", "-o", "map.prt"]).ends_with("the output would replace the input"));
    assert!(folder.refused(&["vis", "map.bsp", "-o", "no/map.bsp"]).starts_with("no/map.bsp: cannot be written: "));
    assert!(folder.refused(&["build", "map.prt", "-o", "map.prt"]).ends_with("the output would replace the input"));
    for args in [&["vis"][..], &["vis", "map.bsp", "--threads", "x"], &["vis", "map.bsp", "--level", "4"]] {
        assert!(!folder.run(args).expect(2).err.is_empty());
    }
    assert_eq!((folder.read("map.bsp"), folder.read("map.prt")), (map.bsp, map.prt.into_bytes()));
}
