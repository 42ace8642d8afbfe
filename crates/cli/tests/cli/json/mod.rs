//! What commands print with `--json`: every object has a version, and `docs/json.md` lists its fields, no more and no less.

mod commands;
mod page;

use crate::common::Folder;
use commands::Results;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// The section of the fields that all objects have.
const COMMON: &str = "Every command";

/// A field of the page.
#[derive(Debug, Clone)]
struct Field {
    /// The kinds of JSON values that it may have: `null`, `boolean`, `integer`, `number`, `text`, `list` or `object`.
    kinds: Vec<String>,
    /// Whether it may be absent.
    optional: bool,
    /// Whether the fields below it are not on the page.
    free: bool,
    /// Its name and meaning: the same in all sections that share it.
    row: String,
}

impl Field {
    fn new(field: &str, cell: &str, meaning: &str) -> Self {
        let kind = |part: &str| part.split([' ', ',']).next().unwrap_or_default().to_owned();
        let says = |word: &str| cell.split(", ").any(|part| part == word);
        Self {
            kinds: cell.split(" or ").map(kind).collect(),
            optional: says("optional"),
            free: says("free keys"),
            row: format!("{field}: {meaning}"),
        }
    }

    fn fits(&self, value: &Value) -> bool {
        let is = |kind: &String| match (kind.as_str(), value) {
            ("integer", Value::Number(n)) => n.is_u64() || n.is_i64(),
            ("null", Value::Null)
            | ("boolean", Value::Bool(_))
            | ("number", Value::Number(_))
            | ("text", Value::String(_))
            | ("list", Value::Array(_))
            | ("object", Value::Object(_)) => true,
            _ => false,
        };
        self.kinds.iter().any(is)
    }
}

/// The fields of a section by their paths: `a.b` is below the object `a`, `a[].b` below each element of the list `a`.
type Section = BTreeMap<String, Field>;

/// A row of a section: a field, or the anchor of a part whose fields are below it, or both.
type Row<'a> = (Option<&'a str>, Option<&'a str>, &'a str, &'a str);

/// The rows of all sections of the page, by headings without code marks.
fn rows(page: &str) -> BTreeMap<String, Vec<Row<'_>>> {
    let (mut all, mut heading) = (BTreeMap::<String, Vec<Row<'_>>>::new(), String::new());
    for line in page.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            heading = title.replace('`', "");
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, first, kind, meaning, _] = cells[..] else { continue };
        let field = first.strip_prefix('`').and_then(|rest| rest.split_once('`')).map(|(field, _)| field);
        let part = first.split_once("](#").map(|(_, rest)| rest.trim_end_matches(')'));
        if field.is_some() || part.is_some() {
            assert!(field.is_none() || !(kind.is_empty() || meaning.is_empty()), "{heading}: {line}");
            all.entry(heading.clone()).or_default().push((field, part, kind, meaning));
        }
    }
    all
}

/// Where a link to a heading leads.
fn anchor(heading: &str) -> String {
    let letters = heading.to_lowercase().replace(' ', "-");
    letters.chars().filter(|c| c.is_alphanumeric() || *c == '-').collect()
}

/// The sections of all commands, with the fields of parts in their places.
fn sections(page: &str) -> BTreeMap<String, Section> {
    fn add(heading: &str, below: &str, all: &BTreeMap<String, Vec<Row<'_>>>, out: &mut Section) {
        for &(field, part, kind, meaning) in all.get(heading).into_iter().flatten() {
            if let Some(field) = field {
                let path = format!("{below}{}", field.trim_end_matches("[]"));
                assert!(
                    out.insert(path.clone(), Field::new(field, kind, meaning)).is_none(),
                    "{heading}: {path} twice"
                );
            }
            if let Some(part) = part {
                let part = all.keys().find(|other| anchor(other) == part).expect("the part of a link");
                let below = field.map_or(below.to_owned(), |field| format!("{below}{field}."));
                add(part, &below, all, out);
            }
        }
    }
    let all = rows(page);
    let commands = all.keys().filter(|heading| !heading.starts_with("Part: ") && *heading != COMMON);
    let section = |heading: &String| {
        let mut out = Section::new();
        [COMMON, heading].into_iter().for_each(|heading| add(heading, "", &all, &mut out));
        (heading.clone(), out)
    };
    commands.map(section).collect()
}

/// Compares an object, or the list of objects, at a path with the page; `seen` gets the paths that are there.
fn compare(section: &Section, value: &Value, at: &str, seen: &mut BTreeSet<String>, wrong: &mut BTreeSet<String>) {
    match value {
        Value::Array(list) => list.iter().for_each(|value| compare(section, value, &format!("{at}[]"), seen, wrong)),
        Value::Object(members) => {
            let below = if at.is_empty() { String::new() } else { format!("{at}.") };
            missing(section, members, &below, wrong);
            for (name, value) in members {
                let path = format!("{below}{name}");
                seen.insert(path.clone());
                match section.get(&path) {
                    None => _ = wrong.insert(format!("{path} is not on the page")),
                    Some(field) if !field.fits(value) => _ = wrong.insert(format!("{path} is {value}")),
                    Some(field) if field.free => {}
                    Some(_) => compare(section, value, &path, seen, wrong),
                }
            }
        }
        _ => {}
    }
}

/// The fields that must be in an object and are not.
fn missing(section: &Section, members: &Map<String, Value>, below: &str, wrong: &mut BTreeSet<String>) {
    for (path, _) in section.iter().filter(|(_, field)| !field.optional) {
        if let Some(name) = path.strip_prefix(below).filter(|name| !name.contains('.'))
            && !members.contains_key(name)
        {
            wrong.insert(format!("{path} is missing"));
        }
    }
}

/// Everything in which the page and results differ: also fields, optional ones too, that no result has.
fn differences(page: &str, results: &[(&str, Value)]) -> Vec<String> {
    let sections = sections(page);
    let (mut all, mut rows, mut found) = (Vec::new(), BTreeSet::new(), BTreeSet::new());
    let names: BTreeSet<&str> =
        sections.keys().map(String::as_str).chain(results.iter().map(|(name, _)| *name)).collect();
    for name in names {
        let of_name = || results.iter().filter(|(other, _)| *other == name).map(|(_, value)| value);
        let Some(section) = sections.get(name).filter(|_| of_name().next().is_some()) else {
            all.push(format!("{name}: not both a section and a result"));
            continue;
        };
        let (mut seen, mut wrong) = (BTreeSet::new(), BTreeSet::new());
        for value in of_name() {
            compare(section, value, "", &mut seen, &mut wrong);
            if value["version"] != 3 {
                wrong.insert("the version is not 3".to_owned());
            }
        }
        all.extend(wrong.into_iter().map(|what| format!("{name}: {what}")));
        rows.extend(section.values().map(|field| field.row.clone()));
        found.extend(seen.iter().filter_map(|path| section.get(path)).map(|field| field.row.clone()));
    }
    all.extend(rows.difference(&found).map(|row| format!("{row} is in no result")));
    all
}

#[test]
fn results_have_a_version_and_the_fields_on_the_page() {
    let results = Results::of_all_commands();
    let page = &page::page();
    let wrong = differences(page, &results);
    assert!(wrong.is_empty(), "{} differences:\n{}", wrong.len(), wrong.join("\n"));
    assert!(results.len() > 60 && sections(page).len() > 30, "{} results", results.len());

    // Impostors. A page without a row: its field is noticed.
    let lines: Vec<&str> = page.lines().collect();
    let is_row = |line: &str| line.starts_with("| `");
    let fields: Vec<usize> = (0..lines.len()).filter(|&k| is_row(lines[k])).collect();
    assert!(fields.len() > 400, "{} rows", fields.len());
    for k in fields.into_iter().step_by(41) {
        let without = [&lines[..k], &lines[k + 1..]].concat().join("\n");
        let found = differences(&without, &results);
        assert!(found.iter().any(|what| what.contains("is not on the page")), "{}: {found:?}", lines[k]);
        // With one more, optional or not.
        for kind in ["integer", "integer, optional"] {
            let more = format!("| `no_such_field` | {kind} | none |");
            let with = [&lines[..k], &[more.as_str()], &lines[k..]].concat().join("\n");
            let found = differences(&with, &results);
            assert!(
                !found.is_empty() && found.iter().all(|what| what.contains("no_such_field")),
                "{}: {found:?}",
                lines[k]
            );
        }
    }
    // A field of another type; a result without a version, with another, or with one field more deep inside.
    assert!(!differences(&page.replacen("| `seconds` | number |", "| `seconds` | text |", 1), &results).is_empty());
    assert!(!differences(&page.replacen("## `vis`", "## `viz`", 1), &results).is_empty());
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut results = results.clone();
        results.iter_mut().filter(|(name, _)| *name == "render").for_each(|(_, value)| change(value));
        differences(page, &results)
    };
    assert_eq!(changed(&|_| ()), [""; 0]);
    assert!(!changed(&|value| _ = value.as_object_mut().map(|members| members.remove("version"))).is_empty());
    assert!(!changed(&|value| value["version"] = 1.into()).is_empty());
    assert_eq!(changed(&|value| value["pictures"][0]["new"] = 1.into()), ["render: pictures[].new is not on the page"]);
}

/// Every command that has `--json` has a section, and the other way round.
#[test]
fn every_command_with_json_is_on_the_page() {
    fn first(line: &str) -> Option<&str> {
        line.strip_prefix("  ").filter(|l| !l.starts_with(' ')).and_then(|l| l.split(' ').next())
    }
    let folder = Folder::new();
    let help = folder.run(&["--help"]).expect(0).out;
    let page = &page::page();
    let list = help.split_once("Commands:").expect("a list of commands").1;
    let of_json = |command: &&str| {
        let args = match *command {
            "generate" => &["generate", "tower", "--help"][..],
            "job" => &["job", "plan", "--help"],
            "tiles" => &["tiles", "build", "--help"],
            command => &[command, "--help"],
        };
        folder.run(args).expect(0).out.contains("--json")
    };
    let listed = list.lines().skip(1).take_while(|line| !line.is_empty()).filter_map(first);
    let commands: BTreeSet<&str> = listed.filter(|command| *command != "help").filter(of_json).collect();
    let sections = sections(page);
    let on_page: BTreeSet<&str> = sections.keys().filter_map(|heading| heading.split(' ').next()).collect();
    assert_eq!(commands, on_page);
    assert!(commands.len() > 14, "{commands:?}");
}

#[test]
fn a_table_is_not_written_as_json() {
    let folder = Folder::with_office();
    for out in ["x.json", "x.JSON"] {
        let error = folder.refused(&["build", "office.geojson", "-o", out]);
        assert!(error.starts_with(&format!("{out}: `build` writes a table, which is not JSON: ")), "{error}");
        let command = format!("sightlines export x.pvs -o {out}");
        assert!(error.ends_with(&command), "{error}");
        assert!(!folder.path(out).exists() && !folder.path("x.pvs").exists());
    }
    // What the error names works.
    folder.run(&["build", "office.geojson", "-o", "x.pvs"]).expect(0);
    folder.run(&["export", "x.pvs", "-o", "x.json"]).expect(0);
    assert!(folder.path("x.json").exists());
}

/// The page in the documentation; `BLESS=1` writes it.
#[test]
fn the_page_is_that_of_the_program() {
    let (path, page) = (concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/json.md"), page::page());
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        std::fs::write(path, &page).unwrap();
    }
    let found = std::fs::read_to_string(path).unwrap();
    assert!(found == page, "docs/json.md is not made from these types; write it with BLESS=1");
}
