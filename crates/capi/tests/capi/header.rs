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
    let order = ["version", "status", "table", "info", "query", "view", "viewer", "doors", "image", "scene", "bake"];
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
