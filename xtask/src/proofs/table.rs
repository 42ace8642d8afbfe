//! The table of constants: what is claimed of each, and its comparison with the sources.

use super::constant;
use super::terms;
use crate::debian::{files, in_file};
use crate::step::{Failure, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Where the table and the scripts are.
pub(crate) const FOLDER: &str = "xtask/proofs";

/// The crates whose code decides what is hidden, and the shaders.
pub(crate) const DECIDING: [&str; 25] = [
    "shaders",
    "crates/area-light",
    "crates/bake",
    "crates/bsp",
    "crates/cells",
    "crates/certificates",
    "crates/exact",
    "crates/eye-to-cell",
    "crates/frame",
    "crates/from-region",
    "crates/geometry",
    "crates/isovist",
    "crates/kdtree",
    "crates/line-space",
    "crates/multifocal",
    "crates/multifocal-cpu",
    "crates/multifocal-gpu",
    "crates/pvs",
    "crates/relevance",
    "crates/sightline",
    "crates/stabtree",
    "crates/triangulation",
    "crates/verify",
    "crates/visibility-graph",
    "crates/walkthrough",
];

/// What is known of a constant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Claim {
    /// Gappa proves it.
    Gappa(Proof),
    /// The reason is a proof, and a test tries to break it against exact arithmetic: a file and the name of a function in it.
    Written { file: String, test: String },
    /// Whatever its value, nothing visible is hidden: it proposes, chooses, ends a search, or is followed by an exact check.
    Free,
    /// It is no rounding: bits of a number, a range that input is checked against, something exact.
    Exact,
    /// Not proven.
    Open,
}

/// A proof by Gappa.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Proof {
    /// As the source has it.
    pub(crate) constant: String,
    /// How many times it is as large as the least that is proven, to within a hundredth of that; none if one bit less is not.
    pub(crate) spare: Option<f64>,
    /// Whether larger constants are those that prove too much.
    pub(crate) is_largest: bool,
    pub(crate) statement: Statement,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Statement {
    /// An expression, see [`terms`].
    Expression { text: String, by_sign: bool, unit: i32 },
    /// A script with `@C@` for the constant, or `@E@` for the exponent of its last place, by its name.
    Script(String),
}

/// One constant of the table.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) file: String,
    /// Lines of the file: the constant, and the expression that the claim is about.
    pub(crate) lines: Vec<String>,
    pub(crate) why: String,
    pub(crate) claim: Claim,
}

/// All entries, in the order of the files of the table.
pub(crate) fn read() -> Result<Vec<Entry>, Failure> {
    let mut entries = Vec::new();
    for path in files(&root().join(FOLDER))?.iter().filter(|path| path.extension().is_some_and(|e| e == "toml")) {
        let text = in_file(path, fs::read_to_string(path))?;
        let found =
            parse(&text).map_err(|problem| Failure::Unavailable(format!("{}: {problem}", path.display()).into()))?;
        entries.extend(found);
    }
    Ok(entries)
}

pub(crate) fn parse(text: &str) -> Result<Vec<Entry>, String> {
    let table: Table = text.parse().map_err(|error| format!("{error}"))?;
    let list = table.get("constant").and_then(Value::as_array).ok_or("there are no constants")?;
    list.iter().map(|value| entry(value.as_table().ok_or("a constant is a table")?)).collect()
}

fn entry(table: &Table) -> Result<Entry, String> {
    let text = |key: &str| table.get(key).and_then(Value::as_str).map(str::to_owned);
    let file = text("file").ok_or_else(|| format!("there is no file in {table}"))?;
    let name = text("name").unwrap_or_else(|| file.clone());
    let needed = |key: &str| text(key).ok_or_else(|| format!("{name} has no {key}"));
    let lines: Vec<String> =
        needed("lines")?.lines().map(|line| line.trim().to_owned()).filter(|l| !l.is_empty()).collect();
    let claim = match needed("claim")?.as_str() {
        "gappa" => {
            let statement = match text("script") {
                Some(script) => Statement::Script(script),
                None => Statement::Expression {
                    text: needed("expression")?,
                    by_sign: table.get("by_sign").and_then(Value::as_bool).unwrap_or(false),
                    unit: table
                        .get("unit")
                        .and_then(Value::as_integer)
                        .map_or(Ok(-53), i32::try_from)
                        .map_err(|e| e.to_string())?,
                },
            };
            let is_largest = table.get("larger").and_then(Value::as_bool).unwrap_or(false);
            let spare = table.get("spare").and_then(Value::as_float);
            Claim::Gappa(Proof { constant: needed("constant")?, spare, is_largest, statement })
        }
        "written" => {
            let place = needed("test")?;
            let (file, test) = place.split_once('#').ok_or_else(|| format!("{name}: {place:?} is no file#test"))?;
            Claim::Written { file: file.to_owned(), test: test.to_owned() }
        }
        "free" => Claim::Free,
        "exact" => Claim::Exact,
        "open" => Claim::Open,
        other => return Err(format!("{name}: nothing is known as {other:?}")),
    };
    Ok(Entry { why: needed("why")?, name, file, lines, claim })
}

impl Proof {
    /// The constant's value.
    pub(crate) fn value(&self) -> Result<f64, String> {
        constant::value(&self.constant).ok_or_else(|| format!("{} has no value", self.constant))
    }

    /// The script that says it of another constant.
    pub(crate) fn script(&self, constant: f64) -> Result<String, String> {
        let number = constant::dyadic(constant);
        match &self.statement {
            Statement::Expression { text, by_sign, unit } => {
                Ok(terms::script(&terms::goals(text, *by_sign)?, *unit, &number))
            }
            Statement::Script(name) => {
                let path = root().join(FOLDER).join("scripts").join(name);
                let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
                // The last place of a number of this size.
                let place = (constant.log2().floor() as i32 - 52).to_string();
                let script = text.replace("@C@", &number).replace("@E@", &place);
                if script == text { Err(format!("{name} has no constant")) } else { Ok(script) }
            }
        }
    }

    /// What a script for an expression presumes of products of roundings, as a script of its own.
    pub(crate) fn lemmas(&self) -> Result<Option<String>, String> {
        match &self.statement {
            Statement::Expression { text, by_sign, unit } => {
                Ok(Some(terms::lemmas(&terms::goals(text, *by_sign)?, *unit)))
            }
            Statement::Script(_) => Ok(None),
        }
    }

    /// Constants that have to be proven, and such that must not be.
    pub(crate) fn trials(&self) -> Result<(Vec<f64>, Vec<f64>), String> {
        let value = self.value()?;
        Ok(match self.spare {
            None => (vec![value], vec![if self.is_largest { value.next_up() } else { value.next_down() }]),
            Some(spare) => (vec![value, self.bolder(value, spare)], vec![self.bolder(value, spare * 1.01)]),
        })
    }

    /// A constant that is so many times harder to prove.
    pub(crate) fn bolder(&self, value: f64, times: f64) -> f64 {
        if self.is_largest { value * times } else { value / times }
    }
}

/// The lines of a file that are no test, without spaces around them.
pub(crate) fn code(path: &Path) -> Result<Vec<String>, Failure> {
    let text = in_file(path, fs::read_to_string(path))?;
    Ok(text.lines().map(|line| line.trim().to_owned()).take_while(|line| line != "#[cfg(test)]").collect())
}

/// Whether a line has what looks like a bound on rounding.
pub(crate) fn is_suspect(line: &str) -> bool {
    let has_small_number = || {
        line.match_indices("e-").any(|(at, _)| {
            let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
            is_digit(line[..at].chars().next_back()) && is_digit(line[at + 2..].chars().next())
        })
    };
    const WORDS: [&str; 12] = [
        "EPSILON",
        "MIN_POSITIVE",
        "next_up",
        "next_down",
        ".powi(-",
        "(1u64 <<",
        "(1u128 <<",
        " as f32",
        "0x1p",
        "* U ",
        "::from_bits((",
        ".recip()",
    ];
    !line.starts_with("//") && (WORDS.iter().any(|word| line.contains(word)) || has_small_number())
}

/// What is wrong with the table: lines that the sources do not have, and lines of the sources that it does not have.
pub(crate) fn problems(entries: &[Entry]) -> Result<Vec<String>, Failure> {
    let mut problems = Vec::new();
    let mut listed: BTreeMap<&str, Vec<&String>> = BTreeMap::new();
    for entry in entries {
        let path = root().join(&entry.file);
        let code = if path.is_file() { code(&path)? } else { Vec::new() };
        for line in entry.lines.iter().filter(|line| !code.contains(line)) {
            problems.push(format!("{}: {} does not have the line {line:?}", entry.name, entry.file));
        }
        listed.entry(&entry.file).or_default().extend(&entry.lines);
        problems.extend(unfounded(entry)?.map(|problem| format!("{}: {problem}", entry.name)));
    }
    for path in sources()? {
        let name = path.strip_prefix(root()).unwrap_or(&path).to_string_lossy().into_owned();
        let known = listed.get(name.as_str()).map_or(&[][..], Vec::as_slice);
        for line in code(&path)?.iter().filter(|line| is_suspect(line) && !known.contains(line)) {
            problems.push(format!("{name}: {line:?} is not in the table"));
        }
    }
    Ok(problems)
}

/// What a claim lacks.
fn unfounded(entry: &Entry) -> Result<Option<String>, Failure> {
    Ok(match &entry.claim {
        Claim::Gappa(proof) if !entry.lines.iter().any(|line| line.contains(&proof.constant)) => {
            Some(format!("no line has {}", proof.constant))
        }
        Claim::Gappa(proof) => proof.trials().and_then(|_| proof.script(1.0)).err(),
        Claim::Written { file, test } => {
            let path = root().join(file);
            let text = if path.is_file() { in_file(&path, fs::read_to_string(&path))? } else { String::new() };
            (!text.contains(&format!("fn {test}("))).then(|| format!("{file} has no test {test}"))
        }
        _ if entry.why.is_empty() => Some("there is no reason".to_owned()),
        _ => None,
    })
}

/// The sources of the deciding code.
fn sources() -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    let mut folders: Vec<PathBuf> = DECIDING.iter().map(|folder| root().join(folder).join("src")).collect();
    folders.push(root().join("shaders/wgsl"));
    while let Some(folder) = folders.pop() {
        for path in files(&folder)? {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() {
                folders.extend((name != "tests").then_some(path));
            } else if (name.ends_with(".rs") && name != "tests.rs") || name.ends_with(".wgsl") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}
