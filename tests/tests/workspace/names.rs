//! Names of public types: two crates have the same one only for the same idea.
//!
//! Read from the sources, as types that macros make have names of their own. The comparison is fed impostors.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Names that two crates have for one idea, and why each crate has its own type.
const SHARED: [(&str, [&str; 2], &str); 15] = [
    ("AxialPortal", ["certificates", "kdtree"], CHECKER),
    ("BoxProof", ["certificates", "sightline"], CHECKER),
    ("Branch", ["certificates", "sightline"], CHECKER),
    ("Bypass", ["certificates", "sightline"], CHECKER),
    ("CertifyError", ["bake", "stabtree"], "why there are no proofs: of a table, and of the graph below it"),
    ("ConvexTerm", ["certificates", "sightline"], CHECKER),
    ("Explanation", ["bake", "stabtree"], "why a cell sees another: of a table, and of the graph below it"),
    ("MakeMethod", ["bake", "simplify"], "makes a from-region method, one for each thread"),
    ("Obstacle", ["bake", "viewer"], "what keeps two cells apart; the page has no ids of Rust"),
    ("PlanLine", ["cells", "certificates"], CHECKER),
    ("Point3", ["certificates", "geometry"], CHECKER),
    ("ReadError", ["certificates", "formats"], CHECKER),
    ("ReadErrorKind", ["certificates", "formats"], CHECKER),
    ("StabNode", ["packed", "stabtree"], "a node of a stab tree: as stored, and as found"),
    ("WorkOptions", ["simplify", "visibility-graph"], "how work is done, which changes no result"),
];

const CHECKER: &str = "the checker of proofs shares no code with what makes them";

/// The sources of a crate, by module: `""` is the root, `a::b` a module in a module.
type Sources = BTreeMap<String, String>;

/// The public types of a crate that others can name.
fn public_types(sources: &Sources) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (module, text) in sources {
        for name in text.lines().filter_map(type_of_line) {
            if is_reachable(sources, module) || ancestors(module).any(|above| exports(sources, above, name)) {
                found.insert(name.to_owned());
            }
        }
    }
    found
}

/// The name of the public type whose definition begins on a line.
fn type_of_line(line: &str) -> Option<&str> {
    let mut words = line.strip_prefix("pub ")?.split(|c: char| !c.is_alphanumeric() && c != '_');
    ["struct", "enum", "trait", "type", "union"].contains(&words.next()?).then(|| words.next())?
}

/// The modules above a module, the root last.
fn ancestors(module: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(parent(module), |above| parent(above))
}

fn parent(module: &str) -> Option<&str> {
    (!module.is_empty()).then(|| module.rsplit_once("::").map_or("", |(above, _)| above))
}

/// Whether a module and all above it are public.
fn is_reachable(sources: &Sources, module: &str) -> bool {
    parent(module).is_none_or(|above| {
        let own = format!("pub mod {};", module.rsplit("::").next().unwrap_or(module));
        sources.get(above).is_some_and(|text| text.lines().any(|line| line == own)) && is_reachable(sources, above)
    })
}

/// Whether a reachable module exports a name from below it.
fn exports(sources: &Sources, module: &str, name: &str) -> bool {
    let lists = sources.get(module).into_iter().flat_map(|text| text.split("\npub use ").skip(1));
    let mut names = lists.flat_map(|rest| {
        let list = rest.split(';').next().unwrap_or(rest);
        list.split(|c: char| !c.is_alphanumeric() && c != '_')
    });
    is_reachable(sources, module) && names.any(|word| word == name)
}

/// The names that several crates have, with those crates.
fn repeated(crates: &BTreeMap<String, BTreeSet<String>>) -> BTreeMap<&str, Vec<&str>> {
    let mut owners: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (folder, names) in crates {
        names.iter().for_each(|name| owners.entry(name).or_default().push(folder));
    }
    owners.retain(|_, folders| folders.len() > 1);
    owners
}

/// What is wrong: names that are not in the list, and entries of the list that no crates have.
fn defects(crates: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let mut listed: BTreeMap<&str, Vec<&str>> = SHARED.iter().map(|(name, in_, _)| (*name, in_.to_vec())).collect();
    let repeated = repeated(crates);
    let new = repeated.iter().filter(|(name, folders)| listed.get(*name) != Some(folders));
    let mut defects: Vec<String> = new.map(|(name, folders)| format!("{name} is a type of {folders:?}")).collect();
    listed.retain(|name, _| !repeated.contains_key(name));
    defects.extend(listed.keys().map(|name| format!("{name} is in the list for nothing")));
    defects
}

/// Adds the sources below a folder.
fn read(folder: &Path, module: &str, sources: &mut Sources) {
    for entry in fs::read_dir(folder).expect("a folder is readable") {
        let path = entry.expect("an entry is readable").path();
        let name = path.file_stem().expect("an entry has a name").to_string_lossy().into_owned();
        let inside = if module.is_empty() { name.clone() } else { format!("{module}::{name}") };
        if path.is_dir() {
            read(&path, &inside, sources);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let own = if ["lib", "mod"].contains(&name.as_str()) { module.to_owned() } else { inside };
            sources.insert(own, fs::read_to_string(&path).expect("a source is readable"));
        }
    }
}

/// The public types of each published crate.
fn read_crates() -> BTreeMap<String, BTreeSet<String>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace");
    let folders = fs::read_dir(root.join("crates")).expect("crates is readable");
    let mut crates = BTreeMap::new();
    for folder in folders.map(|entry| entry.expect("an entry is readable").path()) {
        let Ok(manifest) = fs::read_to_string(folder.join("Cargo.toml")) else { continue };
        if !manifest.contains("publish = false") {
            let mut sources = Sources::new();
            read(&folder.join("src"), "", &mut sources);
            let name = folder.file_name().expect("a folder has a name").to_string_lossy().into_owned();
            crates.insert(name, public_types(&sources));
        }
    }
    crates
}

#[test]
fn a_name_is_one_idea() {
    let crates = read_crates();
    let n_types: usize = crates.values().map(BTreeSet::len).sum();
    assert!(crates.len() > 30 && n_types > 500, "{} crates with {n_types} types", crates.len());
    let defects = defects(&crates);
    assert!(defects.is_empty(), "rename a type, or give the reason in the list:\n{}", defects.join("\n"));
}

#[test]
fn impostors_are_found() {
    let crates = read_crates();
    let mut same = crates.clone();
    same.get_mut("scenes").expect("a crate").insert("Frame".to_owned());
    assert_eq!(defects(&same), [r#"Frame is a type of ["pvs", "scenes"]"#]);
    let mut third = crates.clone();
    third.get_mut("scenes").expect("a crate").insert("Point3".to_owned());
    assert_eq!(defects(&third), [r#"Point3 is a type of ["certificates", "geometry", "scenes"]"#]);
    let mut gone = crates;
    gone.get_mut("viewer").expect("a crate").remove("Obstacle");
    assert_eq!(defects(&gone), ["Obstacle is in the list for nothing"]);
}

#[test]
fn types_are_public_where_others_can_name_them() {
    let sources = [
        (
            "",
            "//! A crate.\npub mod open;\nmod shut;\n\npub use shut::{\n    Shown,\n    deep::Far,\n};\npub(crate) use shut::Kept;\npub struct Root;\n",
        ),
        ("open", "pub enum Direct<T> {}\npub(crate) struct Own;\nmod inner;\npub use inner::Lifted;\n"),
        ("open::inner", "pub trait Lifted: Send {}\npub struct Buried(u8);\n"),
        ("shut", "mod deep;\npub type Shown = u8;\npub struct Kept;\npub fn shown() {}\n"),
        ("shut::deep", "pub struct Far {}\n"),
    ];
    let sources: Sources = sources.map(|(module, text)| (module.to_owned(), text.to_owned())).into();
    let found = public_types(&sources);
    assert_eq!(found.iter().map(String::as_str).collect::<Vec<_>>(), ["Direct", "Far", "Lifted", "Root", "Shown"]);
}
