//! Tests of the table that need no Gappa.

use super::*;
use crate::step::root;
use std::fs;
use table::{Claim, is_suspect, parse, problems, read};

#[test]
fn the_table_has_the_lines_of_the_sources() {
    let entries = read().expect("it is readable");
    let found = problems(&entries).expect("sources are readable");
    assert!(found.is_empty(), "{} problems:\n{}", found.len(), found.join("\n"));
    let counts = Counts::of(&entries);
    assert!(counts.gappa > 50 && counts.written > 10, "{counts}");
}

/// A table with one constant of an existing file.
fn one(change: impl Fn(&str) -> String) -> Vec<Entry> {
    let text = "[[constant]]\nname = 'x'\nfile = 'crates/pvs/src/side.rs'\nlines = '''\nleft - right < -bound\nlet bound = RELATIVE * (left.abs() \
                + right.abs()) + f64::MIN_POSITIVE;\n'''\nclaim = 'gappa'\nconstant = 'f64::MIN_POSITIVE'\nspare = 1.5\nexpression = '''\nvalue = a - b\n\
                bound = C * (abs(a) + abs(b))\n'''\nwhy = 'A reason.'\n";
    parse(&change(text)).expect("it is a table")
}

/// What is wrong with the entry itself.
fn of_entry(change: impl Fn(&str) -> String) -> Vec<String> {
    problems(&one(change))
        .expect("sources are readable")
        .into_iter()
        .filter(|problem| problem.starts_with("x: "))
        .collect()
}

#[test]
fn impostors_of_the_table_are_noticed() {
    assert_eq!(of_entry(str::to_owned), Vec::<String>::new());
    for (from, to, word) in [
        // A line that the source no longer has, a constant that is not in it.
        ("left - right < -bound", "left - right < bound", "does not have the line"),
        ("constant = 'f64::MIN_POSITIVE'", "constant = '2.0 * f64::MIN_POSITIVE'", "no line has"),
        ("constant = 'f64::MIN_POSITIVE'", "constant = 'RELATIVE'", "has no value"),
        ("abs(a) + abs(b)", "abs(a)", "the bound has nothing for b"),
        ("expression = '''\nvalue = a - b\nbound = C * (abs(a) + abs(b))\n'''", "script = 'none.gappa'", "none.gappa"),
        ("claim = 'gappa'", "claim = 'written'\ntest = 'crates/pvs/src/side.rs#none'", "has no test none"),
        ("claim = 'gappa'\n", "claim = 'open'\nother = 1\n", ""),
    ] {
        let found = of_entry(|text| text.replace(from, to));
        assert!(
            found.len() == usize::from(!word.is_empty()) && found.iter().all(|f| f.contains(word)),
            "{to}: {found:?}"
        );
    }
    let reason = of_entry(|text| text.replace("claim = 'gappa'", "claim = 'free'").replace("A reason.", ""));
    assert!(matches!(&reason[..], [only] if only.contains("no reason")), "{reason:?}");
    // What the table leaves out.
    let others = problems(&one(str::to_owned)).expect("sources are readable");
    let lacks =
        |line: &str| others.iter().any(|problem| problem.contains(line) && problem.contains("not in the table"));
    assert!(lacks("const RELATIVE: f64 = (3.0") && lacks("const MARGIN: f32 = 0x1p-19;"));
    assert!(!lacks("let bound = RELATIVE"));
}

#[test]
fn tables_that_are_none_are_refused() {
    for (text, word) in [
        ("", "no constants"),
        ("[[constant]]\nfile = 'x'", "no lines"),
        ("[[constant]]\nlines = 'x'", "no file"),
        ("[[constant]]\nfile = 'x'\nlines = 'y'\nclaim = 'true'", "true"),
        ("[[constant]]\nfile = 'x'\nlines = 'y'\nclaim = 'gappa'", "no expression"),
        ("[[constant]]\nfile = 'x'\nlines = 'y'\nclaim = 'written'\ntest = 'z'\nwhy = ''", "no file#test"),
        ("constant", ""),
    ] {
        let problem = parse(text).expect_err("it is none");
        assert!(problem.contains(word), "{text}: {problem}");
    }
}

#[test]
fn suspects_are_recognised() {
    for line in [
        "let x = y * f64::EPSILON;",
        "x.next_up()",
        "2f64.powi(-44)",
        "if a > 1e-9 {",
        "const M: f32 = 0x1p-19;",
        "1.0 / (1u64 << 40) as f64",
    ] {
        assert!(is_suspect(line), "{line}");
    }
    for line in ["// by f64::EPSILON", "let x = y * 2.0;", "the-e-1", "1u32 << 4"] {
        assert!(!is_suspect(line), "{line}");
    }
}

/// The impostors of constants are on the other side of the least that is proven, and not on the side that is easier.
#[test]
fn impostors_are_harder_to_prove() {
    let mut n = 0;
    for entry in read().expect("it is readable") {
        let Claim::Gappa(proof) = &entry.claim else { continue };
        let (good, bad) = proof.trials().expect("a constant has a value");
        let is_harder = |a: f64, b: f64| if proof.is_largest { a > b } else { a < b };
        assert!(good.iter().all(|&good| bad.iter().all(|&bad| is_harder(bad, good))), "{}", entry.name);
        n += 1;
    }
    assert!(n > 50, "{n}");
}

/// `docs/PROOFS.md` has the counts and what is open; `BLESS=1` writes them.
#[test]
fn the_page_has_the_counts_of_the_table() {
    const BORDER: &str = "<!-- counted -->\n";
    let path = root().join("docs/PROOFS.md");
    let text = fs::read_to_string(&path).expect("it is readable");
    let parts: Vec<&str> = text.split(BORDER).collect();
    let [before, old, after] = parts[..] else { panic!("the page has two borders") };
    let new = Counts::of(&read().expect("it is readable")).table();
    if std::env::var_os("BLESS").is_some_and(|bless| bless == "1") {
        fs::write(&path, [before, &new, after].join(BORDER)).expect("it is writable");
    } else {
        assert_eq!(old, new, "BLESS=1 writes it");
    }
}
