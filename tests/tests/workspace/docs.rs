//! The written word: links that lead somewhere, a README per crate, nothing that only our machines have.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace").to_path_buf()
}

/// All files of the workspace but those of git, of builds, and of the demo, sorted.
fn files_of_workspace() -> Vec<PathBuf> {
    let of_plugins = ["bevy", "bevy-trenchbroom"].map(|name| root().join("integrations").join(name));
    let mut outputs = vec![root().join("target"), root().join("demo"), root().join("python/target")];
    outputs.extend(of_plugins.iter().flat_map(|plugin| [plugin.join("target"), plugin.join("assets")]));
    let mut files = Vec::new();
    let mut folders = vec![root()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder is readable") {
            let path = entry.expect("an entry is readable").path();
            let name = path.file_name().expect("an entry has a name").to_string_lossy().into_owned();
            let hidden = name.starts_with('.') && ![".ci", ".cargo", ".github", ".gitignore"].contains(&name.as_str());
            if hidden || outputs.contains(&path) {
                continue;
            }
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}

fn folders_of_crates() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("crates")).expect("crates is readable");
    let mut folders: Vec<PathBuf> = entries.map(|e| e.expect("an entry is readable").path()).collect();
    folders.retain(|f| f.join("Cargo.toml").is_file());
    folders.sort();
    folders
}

// --- Links -----------------------------------------------------------------------------------------

/// Targets of links and pictures that lead to files, outside code, with what stands behind `#`: a heading, or a symbol.
fn targets(markdown: &str) -> Vec<(String, Option<String>)> {
    let mut found = Vec::new();
    let mut in_code = false;
    for line in markdown.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        // What stands between backticks is code: keep every other piece.
        let text: String = line.split('`').step_by(2).collect();
        for (at, _) in text.match_indices("](") {
            let rest = &text[at + 2..];
            let target = rest.split([')', ' ']).next().unwrap_or("");
            if !target.is_empty() && !target.contains("://") && !target.starts_with("mailto:") {
                let (file, anchor) = target.split_once('#').map_or((target, None), |(file, at)| (file, Some(at)));
                found.push((file.to_owned(), anchor.map(str::to_owned)));
            }
        }
    }
    found
}

/// Targets of links and pictures that lead to other files.
fn links(markdown: &str) -> Vec<String> {
    targets(markdown).into_iter().map(|(file, _)| file).filter(|file| !file.is_empty()).collect()
}

/// Links of a file that lead nowhere.
fn dead_links(file: &Path, markdown: &str) -> Vec<String> {
    let folder = file.parent().expect("a file lies in a folder");
    links(markdown).into_iter().filter(|target| !folder.join(target).exists()).collect()
}

#[test]
fn links_of_all_documents_lead_to_files() {
    let is_document = |p: &PathBuf| p.extension().is_some_and(|e| e == "md");
    let documents: Vec<PathBuf> = files_of_workspace().into_iter().filter(is_document).collect();
    let mut n_links = 0;
    for document in &documents {
        let text = fs::read_to_string(document).expect("a document is readable");
        n_links += links(&text).len();
        let dead = dead_links(document, &text);
        assert!(dead.is_empty(), "{} has dead links: {dead:?}", document.display());
    }
    assert!(documents.len() >= 15 && n_links >= 15, "{} documents, {n_links} links", documents.len());
}

#[test]
fn impostor_a_dead_link_is_caught() {
    let file = root().join("README.md");
    let text = "A [page](docs/ARCHITECTURE.md#words), a [ghost](docs/GHOST.md), [the web](https://example.org/x)\n\
                and `[code](nowhere)`.\n```\n[more code](nowhere)\n```\n![picture](ghost.png \"title\") [here](#figures)\n";
    assert_eq!(links(text), ["docs/ARCHITECTURE.md", "docs/GHOST.md", "ghost.png"]);
    assert_eq!(dead_links(&file, text), ["docs/GHOST.md", "ghost.png"]);
}

// --- Anchors ---------------------------------------------------------------------------------------

/// The anchors of a document's headings, as GitHub makes them.
fn headings(markdown: &str) -> Vec<String> {
    let anchor = |title: &str| {
        let kept = title.to_lowercase().replace(|c: char| !c.is_alphanumeric() && c != ' ' && c != '-' && c != '_', "");
        kept.trim().replace(' ', "-")
    };
    let mut in_code = false;
    let mut found = Vec::new();
    for line in markdown.lines() {
        in_code ^= line.trim_start().starts_with("```");
        let title = line.trim_start_matches('#');
        if !in_code && title.len() < line.len() && title.starts_with(' ') {
            found.push(anchor(title));
        }
    }
    found
}

/// Whether a Rust file defines something: an item, a field, or a variant.
fn defines(rust: &str, symbol: &str) -> bool {
    const KINDS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "mod"];
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    rust.lines().map(str::trim_start).filter(|line| !line.starts_with("//")).any(|line| {
        let words: Vec<&str> = line.split(|c: char| !is_word(c)).filter(|word| !word.is_empty()).collect();
        let is_item = words.windows(2).any(|pair| KINDS.contains(&pair[0]) && pair[1] == symbol);
        let member = line.strip_prefix("pub ").or_else(|| line.strip_prefix("pub(crate) ")).unwrap_or(line);
        let rest = member.strip_prefix(symbol);
        is_item
            || rest.is_some_and(|rest| {
                rest.is_empty() || rest.starts_with([':', ',', '(', '{']) && !rest.starts_with("::")
            })
    })
}

/// Links of a file to headings or symbols that are not there, of how many that name one.
fn dead_anchors(file: &Path, markdown: &str) -> (Vec<String>, usize) {
    let folder = file.parent().expect("a file lies in a folder");
    let (mut dead, mut n_anchors) = (Vec::new(), 0);
    for (target, anchor) in targets(markdown) {
        let Some(anchor) = anchor else { continue };
        let path = if target.is_empty() { file.to_path_buf() } else { folder.join(&target) };
        let text = if target.is_empty() { markdown.to_owned() } else { fs::read_to_string(&path).unwrap_or_default() };
        let exists = match path.extension().and_then(|e| e.to_str()) {
            Some("md") => headings(&text).contains(&anchor),
            Some("rs") => defines(&text, &anchor),
            _ => text.contains(&anchor),
        };
        n_anchors += 1;
        if !exists {
            dead.push(format!("{target}#{anchor}"));
        }
    }
    (dead, n_anchors)
}

#[test]
fn links_to_headings_and_symbols_lead_there() {
    let is_document = |p: &PathBuf| p.extension().is_some_and(|e| e == "md");
    let (mut n_all, mut complaints) = (0, Vec::new());
    for document in files_of_workspace().into_iter().filter(is_document) {
        let text = fs::read_to_string(&document).expect("a document is readable");
        let (dead, n_anchors) = dead_anchors(&document, &text);
        complaints.extend(dead.into_iter().map(|link| format!("{}: {link}", document.display())));
        n_all += n_anchors;
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(n_all >= 5, "{n_all} anchors");
}

#[test]
fn impostor_a_missing_heading_or_symbol_is_caught() {
    let file = root().join("docs/PAGE.md");
    let text = "# Where do I…\n[here](#where-do-i), [nowhere](#gone), [words](ARCHITECTURE.md#words), [ghost](STYLE.md#ghost),\n\
                [test](../tests/tests/workspace/docs.rs#dead_anchors), [no](../tests/tests/workspace/docs.rs#no_such_symbol)";
    let (dead, n_anchors) = dead_anchors(&file, text);
    let no_symbol = "../tests/tests/workspace/docs.rs#no_such_symbol";
    assert_eq!((dead.as_slice(), n_anchors), (&["#gone".into(), "STYLE.md#ghost".into(), no_symbol.into()][..], 6));

    let rust =
        "// fn a()\nlet b = c::d(e);\npub struct F {\n    pub(crate) g: u32,\n}\nenum H {\n    I(u32),\n    J,\n}\n";
    for there in ["F", "g", "H", "I", "J"] {
        assert!(defines(rust, there), "{there}");
    }
    for absent in ["a", "c", "d", "e", "u32", "G"] {
        assert!(!defines(rust, absent), "{absent}");
    }
}

/// The tasks of a page's section "Where do I…", each with how many files and symbols it leads to.
fn tasks(markdown: &str) -> Vec<(String, usize, usize)> {
    let section = markdown.lines().skip_while(|line| *line != "## Where do I…").skip(1);
    let rows = section.take_while(|line| !line.starts_with("## ")).filter(|line| line.starts_with("| "));
    let task = |row: &str| {
        let (name, place) = row.trim_matches(['|', ' ']).split_once(" | ")?;
        let leads = targets(place);
        let n_symbols = leads.iter().filter(|(_, anchor)| anchor.is_some()).count();
        Some((name.to_owned(), leads.len(), n_symbols))
    };
    rows.skip(2).filter_map(task).collect()
}

#[test]
fn where_do_i_leads_somewhere_for_fifteen_tasks() {
    let text = fs::read_to_string(root().join("docs/ARCHITECTURE.md")).expect("docs/ARCHITECTURE.md is readable");
    let tasks = tasks(&text);
    assert!(tasks.iter().all(|(_, n_files, _)| *n_files > 0), "{tasks:?}");
    let n_symbols: usize = tasks.iter().map(|(_, _, n_symbols)| n_symbols).sum();
    assert!(tasks.len() >= 15 && n_symbols >= 20, "{} tasks, {n_symbols} symbols", tasks.len());
}

#[test]
fn impostor_a_task_without_a_place_is_noticed() {
    let text = "# A\n\n## Where do I…\n\n| task | place |\n| --- | --- |\n| add | [a](b.rs#c), [d](e.rs) |\n| take | `f` |\n\n## B\n";
    assert_eq!(tasks(text), [("add".to_owned(), 2, 1), ("take".to_owned(), 0, 0)]);
}

// --- Modules ---------------------------------------------------------------------------------------

/// Paths of modules that a document names between backticks, such as `sightline::planar`; the first part is a crate's folder.
fn module_paths(markdown: &str) -> Vec<&str> {
    let is_part =
        |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || "_-0123456789".contains(c));
    let codes = markdown.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    codes.filter(|code| code.contains("::") && code.split("::").all(is_part)).collect()
}

/// Whether a Rust file re-exports something.
fn re_exports(rust: &str, symbol: &str) -> bool {
    let words = |item: &str| item.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == symbol);
    rust.split(';').filter_map(|item| item.rsplit_once("pub use ")).any(|(_, item)| words(item))
}

/// Whether a path leads to a module, or to an item in one; `None` if its first part is no crate's folder.
fn module_exists(path: &str) -> Option<bool> {
    let mut parts = path.split("::");
    let first = parts.next()?;
    let folder = ["crates", "."].map(|place| root().join(place).join(first).join("src"));
    let mut folder = folder.into_iter().find(|src| src.is_dir())?;
    let mut file = folder.join("lib.rs");
    for part in parts {
        let [alone, inside] = [folder.join(format!("{part}.rs")), folder.join(part).join("mod.rs")];
        folder = folder.join(part);
        file = match (alone.is_file(), inside.is_file()) {
            (true, _) => alone,
            (_, true) => inside,
            _ => {
                let text = fs::read_to_string(&file).unwrap_or_default();
                return Some(defines(&text, part) || re_exports(&text, part));
            }
        };
    }
    Some(true)
}

#[test]
fn modules_that_documents_name_exist() {
    let is_document = |p: &PathBuf| p.extension().is_some_and(|e| e == "md");
    let (mut n_paths, mut complaints) = (0, Vec::new());
    for document in files_of_workspace().into_iter().filter(is_document) {
        let text = fs::read_to_string(&document).expect("a document is readable");
        for (path, exists) in module_paths(&text).into_iter().filter_map(|path| Some((path, module_exists(path)?))) {
            n_paths += 1;
            if !exists {
                complaints.push(format!("{}: {path}", document.display()));
            }
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(n_paths >= 40, "{n_paths} paths");
}

#[test]
fn impostor_a_module_that_does_not_exist_is_caught() {
    let text = "`pvs::format` and `pvs::ghost`, `std::fs`, `Table::new`, `eye-to-cell`, `geometry::orient2d`";
    let paths = module_paths(text);
    assert_eq!(paths, ["pvs::format", "pvs::ghost", "std::fs", "geometry::orient2d"]);
    let exist: Vec<_> = paths.into_iter().map(module_exists).collect();
    assert_eq!(exist, [Some(true), Some(false), None, Some(true)]);
    assert!(re_exports("mod a;\npub use a::{b, c};\n", "c") && !re_exports("pub use a::b;\nuse a::c;\n", "c"));
}

// --- READMEs ---------------------------------------------------------------------------------------

/// What a crate's README lacks: its title, an example, or the whole.
fn lacks(name: &str, readme: Option<&str>) -> Option<&'static str> {
    match readme {
        None => Some("has no README.md"),
        Some(text) if !text.starts_with(&format!("# {name}\n")) => Some("has a README.md without its title"),
        Some(text) if text.lines().count() < 8 || !text.contains("```") => Some("has a README.md without an example"),
        Some(_) => None,
    }
}

#[test]
fn readmes_exist_for_every_crate() {
    let crates = folders_of_crates();
    let mut complaints = Vec::new();
    for folder in &crates {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest is readable");
        let manifest: toml::Table = manifest.parse().expect("a manifest is TOML");
        let name = manifest["package"]["name"].as_str().expect("a name");
        let readme = fs::read_to_string(folder.join("README.md")).ok();
        complaints.extend(lacks(name, readme.as_deref()).map(|what| format!("{name} {what}")));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(crates.len() >= 14, "{} crates", crates.len());
}

#[test]
fn impostor_a_missing_or_empty_readme_is_caught() {
    assert!(lacks("a", None).is_some());
    assert!(lacks("a", Some("# b\n")).is_some());
    assert!(lacks("a", Some("# a\n")).is_some());
    assert!(lacks("a", Some("# a\n\n1\n2\n3\n4\n```\nx\n```\n")).is_none());
}

#[test]
fn readme_names_the_two_commands_and_every_crate() {
    let readme = fs::read_to_string(root().join("README.md")).expect("README.md is readable");
    for command in ["cargo run --release -- demo", "cargo xtask test"] {
        assert!(readme.contains(command), "README.md does not name `{command}`");
    }
    let n_lines = readme.lines().count();
    assert!(n_lines <= 150, "README.md has {n_lines} lines; figures belong into docs/FIGURES.md");
    let crates = folders_of_crates();
    for folder in &crates {
        let link = format!("(crates/{}", folder.file_name().expect("a crate has a name").to_string_lossy());
        assert!(readme.contains(&link), "README.md does not link to {link}");
    }
    assert!(crates.len() >= 14, "{} crates", crates.len());
}

// --- Words -----------------------------------------------------------------------------------------

/// Paths that a user's machine does not have. In pieces, so that this file may stand.
const FOREIGN: [&str; 4] =
    [concat!("..", "/shared"), concat!("/wor", "k/"), concat!("/hom", "e/"), concat!("/Use", "rs/")];

/// Foreign paths in a file; the script of the checks alone may name the folder beside the checkout.
fn foreign_paths(name: &str, text: &str) -> Vec<&'static str> {
    let allowed = |word: &str| name == ".ci/run" && word == FOREIGN[0];
    FOREIGN.into_iter().filter(|word| text.contains(word) && !allowed(word)).collect()
}

#[test]
fn files_name_no_path_that_only_our_machines_have() {
    let mut n_texts = 0;
    for path in files_of_workspace() {
        let bytes = fs::read(&path).expect("a file is readable");
        let Ok(text) = String::from_utf8(bytes) else { continue };
        let name = path.strip_prefix(root()).expect("it lies below the root").to_string_lossy().replace('\\', "/");
        let foreign = foreign_paths(&name, &text);
        assert!(foreign.is_empty(), "{name} names {foreign:?}");
        n_texts += 1;
    }
    assert!(n_texts >= 100, "{n_texts} texts");
}

#[test]
fn impostor_a_foreign_path_is_caught() {
    for word in FOREIGN {
        assert_eq!(foreign_paths("docs/STYLE.md", &format!("see {word}x")), [word]);
    }
    assert!(foreign_paths(".ci/run", FOREIGN[0]).is_empty());
    assert_eq!(foreign_paths(".ci/run", FOREIGN[1]), [FOREIGN[1]]);
    assert!(foreign_paths("README.md", "the framework's home is here").is_empty());
}
