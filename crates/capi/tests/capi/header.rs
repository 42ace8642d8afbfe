//! The header is what the crate says, and says something of everything.

use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn header() -> PathBuf {
    folder().join("include/sightlines.h")
}

fn generated() -> String {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).expect("the configuration is readable");
    let mut builder = cbindgen::Builder::new().with_config(config);
    let mut sources: Vec<PathBuf> = fs::read_dir(folder().join("src"))
        .expect("the sources are there")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| !["fuzz.rs", "fuzz", "lib.rs"].iter().any(|name| path.ends_with(name)))
        .collect();
    // The order of the header: what others need comes first.
    let order = [
        "version",
        "status",
        "table",
        "info",
        "query",
        "view",
        "eye",
        "viewer",
        "doors",
        "image",
        "relevance",
        "scene",
        "bake",
    ];
    let rank = |path: &PathBuf| order.iter().position(|name| path.file_stem().is_some_and(|stem| stem == *name));
    sources.retain(|path| rank(path).is_some());
    sources.sort_by_key(rank);
    assert!(sources.len() >= 10, "{sources:?}");
    for source in sources {
        builder = builder.with_src(source);
    }
    let mut text = Vec::new();
    builder.generate().expect("the sources are readable").write(&mut text);
    String::from_utf8(text).expect("the header is text")
}

#[test]
fn the_header_is_that_of_the_crate() {
    let made = generated();
    if std::env::var_os("BLESS").is_some_and(|value| value == "1") {
        fs::write(header(), &made).expect("the header is writable");
    }
    let kept = fs::read_to_string(header()).expect("the header is readable");
    let differs = kept.lines().zip(made.lines()).position(|(a, b)| a != b);
    assert!(kept == made, "the header differs from the crate from line {:?} on: write it anew with BLESS=1", differs);
}

/// What is missing in a header: functions without a comment, arguments and results that it does not mention. And how many functions
/// there are.
fn gaps(header: &str) -> (Vec<String>, usize) {
    let (mut gaps, mut n) = (Vec::new(), 0);
    let mut comment = "";
    for part in header.split("\n\n") {
        let (own, code) = part.rsplit_once("*/").unwrap_or(("", part));
        let is_comment = part.starts_with("/**");
        comment = if is_comment { own } else { comment };
        let code = code.trim();
        let Some(open) = code.find("(").filter(|_| code.ends_with(");") && !code.starts_with("typedef")) else {
            continue;
        };
        let name = code[..open].rsplit([' ', '*']).next().expect("a name");
        n += 1;
        if !is_comment {
            gaps.push(format!("{name} has no comment"));
            continue;
        }
        let arguments = code[open + 1..code.len() - 2].split(',').map(str::trim).filter(|a| *a != "void");
        for argument in arguments {
            let called = argument.rsplit([' ', '*']).next().expect("a name");
            // What a handle is for is in the name of the function.
            let is_handle = ["sl_table *", "sl_viewer *", "sl_scene *", "sl_relevance *"]
                .iter()
                .any(|kind| argument.contains(kind));
            if !(comment.contains(&format!("@param {called} ")) || is_handle && !argument.contains("**")) {
                gaps.push(format!("{name} does not say what {called} is"));
            }
        }
        if !code.starts_with("void") && !comment.contains("@return") {
            gaps.push(format!("{name} does not say what it returns"));
        }
    }
    (gaps, n)
}

#[test]
fn the_header_says_what_every_argument_is() {
    let header = fs::read_to_string(header()).expect("the header is readable");
    let (gaps, n) = gaps(&header);
    assert!(gaps.is_empty() && n >= 55, "{n} functions\n{}", gaps.join("\n"));
}

#[test]
fn impostor_headers_with_gaps_are_caught() {
    let good =
        "/**\n * Adds.\n *\n * @param a  One.\n * @return The sum.\n */\nint sl_add(const sl_table *table, int a);\n\n";
    assert_eq!(gaps(good), (vec![], 1));
    let cases = [
        (good.replace("@param a ", "@param b "), "sl_add does not say what a is"),
        (good.replace("@return", "Returns"), "sl_add does not say what it returns"),
        ("int sl_add(int a);\n\n".to_owned(), "sl_add has no comment"),
    ];
    for (header, gap) in cases {
        assert_eq!(gaps(&header), (vec![gap.to_owned()], 1));
    }
}

/// Functions of a header of which none of these texts speaks.
fn not_called<'a>(header: &'a str, texts: &str) -> Vec<&'a str> {
    let names = header.lines().filter(|line| !line.starts_with([' ', '/', '#'])).filter_map(|line| {
        let name = line[..line.find('(')?].rsplit([' ', '*']).next()?;
        name.starts_with("sl_").then_some(name)
    });
    names.filter(|name| !texts.contains(&format!("{name}(")) && !texts.contains(&format!(", {name},"))).collect()
}

#[test]
fn every_function_is_called_by_a_test() {
    let header = fs::read_to_string(header()).expect("the header is readable");
    let read = |path: &str| fs::read_to_string(folder().join(path)).expect("a test is readable");
    let texts = ["tests/capi/same.rs", "tests/capi/bakes.rs", "tests/c/border.c", "src/fuzz/mod.rs"].map(read).concat();
    assert_eq!(not_called(&header, &texts), [""; 0]);
    // The impostor: without the tests in C nobody calls these.
    let without = texts.replace("sl_check_version", "");
    assert_eq!(not_called(&header, &without), ["sl_check_version"]);
    assert!(not_called(&header, "").len() > 55);
}
