//! Results: standard output, and files that are written as a whole.

// What the types of all results are derived from, and the words for their numbers.
pub(crate) use schemars::JsonSchema;
pub(crate) use serde::Serialize;
pub(crate) use sightlines::report::words::{
    bytes, coordinate, count, distance, percent, point, seconds, seconds_of, share,
};

use crate::error::{Result, StdoutError, anyhow};
use sightlines::formats::{Hidden, WriteError, atomic_write, remove_left};
use std::fmt;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The version of what all commands print with `--json`. It grows when a field is removed, renamed or redefined; new fields do not
/// change it. The report types of the commands define the fields.
pub(crate) const JSON_VERSION: u32 = 3;

/// A result with the version of its form.
#[derive(Serialize, JsonSchema)]
struct Versioned<'a, T> {
    /// Version of these objects, the same for all commands: 3. It grows when a field is removed, renamed, or changes its meaning. New fields leave
    /// it as it is, so ignore fields that you do not know.
    version: u32,
    #[serde(flatten)]
    result: &'a T,
}

/// Prints a result: the fields as one line of JSON if `json`, with their version, otherwise the text.
pub(crate) fn print(json: bool, fields: &impl Serialize, text: &impl fmt::Display) -> Result<()> {
    stdout(|out| {
        if json {
            serde_json::to_writer(&mut *out, &Versioned { version: JSON_VERSION, result: fields })?;
            writeln!(out)
        } else {
            write!(out, "{text}")
        }
    })
}

/// Lets `write` write to standard output.
pub(crate) fn stdout(
    write: impl FnOnce(&mut BufWriter<std::io::StdoutLock<'static>>) -> std::io::Result<()>,
) -> Result<()> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    write(&mut out).and_then(|()| out.flush()).map_err(|error| StdoutError(error).into())
}

/// Words about a number, and none about 0.
pub(crate) fn unless_none(n: usize, words: impl FnOnce(usize) -> String) -> String {
    if n == 0 { String::new() } else { words(n) }
}

/// Whether a name ends so, in any case of letters.
pub(crate) fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Refuses a name that does not end as what is written is called.
pub(crate) fn check_ending(path: &Path, what: &str, ending: &str) -> Result<()> {
    if has_ending(path, ending) {
        return Ok(());
    }
    let (path, format) = (path.display(), ending.to_uppercase());
    Err(anyhow!("{path}: the {what} is written as {format}; give a name that ends in .{ending}"))
}

pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    tracing::debug!("writing {} bytes to {}", bytes.len(), path.display());
    Ok(atomic_write(path, bytes)?)
}

/// Refuses an output that is the input: a slip that would destroy the input.
pub(crate) fn refuse_same(input: &Path, output: &Path) -> Result<()> {
    let same = match (input.canonicalize(), output.canonicalize()) {
        (Ok(a), Ok(b)) => a == b && a.is_file(),
        _ => false,
    };
    if same { Err(same_file(output)) } else { Ok(()) }
}

/// Refuses, before anything is read or computed, outputs that would fail at the end: one that is an input, two that are the same file,
/// and one that cannot be written. Leaves nothing behind.
pub(crate) fn check(inputs: &[&Path], outputs: &[&Path]) -> Result<()> {
    for (k, output) in outputs.iter().enumerate() {
        inputs.iter().try_for_each(|input| refuse_same(input, output))?;
        if outputs[..k].iter().any(|other| is_one_file(other, output)) {
            return Err(two_outputs(output));
        }
        check_writable(output)?;
    }
    Ok(())
}

pub(crate) fn cannot_be_made(path: &Path, error: io::Error) -> anyhow::Error {
    anyhow!("{}: cannot be made: {error}", path.display())
}

pub(crate) fn same_file(path: &Path) -> anyhow::Error {
    anyhow!("{}: the output would replace the input", path.display())
}

pub(crate) fn two_outputs(path: &Path) -> anyhow::Error {
    anyhow!("{}: two outputs would be written to this file", path.display())
}

/// Whether two names are the same file. Special files such as `/dev/null` may be written to twice.
fn is_one_file(a: &Path, b: &Path) -> bool {
    let is_special = fs::metadata(a).is_ok_and(|found| !found.is_file() && !found.is_dir());
    (a == b && !is_special) || refuse_same(a, b).is_err()
}

/// Whether two names are of one place, whether something is there or not.
pub(crate) fn is_one_place(a: &Path, b: &Path) -> bool {
    // A file that is not there yet is in a folder that is.
    let place = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        path.canonicalize().ok().or_else(|| Some(folder.canonicalize().ok()?.join(path.file_name()?)))
    };
    a == b || matches!((place(a), place(b)), (Some(a), Some(b)) if a == b)
}

/// Refuses an output that cannot be written: its folder is not there or refuses new files, or a folder has its name.
///
/// A file is written under another name in the same folder and renamed, so an empty one is created there and removed. What
/// changes before the output is written is reported then.
pub(crate) fn check_writable(path: &Path) -> Result<()> {
    let try_beside = || -> io::Result<()> {
        let target = match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if found.is_file() => fs::canonicalize(path)?,
            // Pipes and terminals are written to as they are; to open some would wait for a reader.
            Ok(_) => return Ok(()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
            Err(error) => return Err(error),
        };
        // Also if this run ends before it writes anything.
        remove_left(&target);
        let beside = Hidden::New.beside(&target, 0).ok_or(io::ErrorKind::InvalidInput)?;
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Ok(file) => {
                drop(file);
                fs::remove_file(&beside)
            }
            // A run that was killed left it, so a file can be created there.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
            Err(error) => Err(error),
        }
    };
    Ok(try_beside().map_err(|source| WriteError { path: path.to_owned(), source })?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_is_refused_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("in"), "in").unwrap();
        let names = || fs::read_dir(folder.path()).unwrap().count();
        let refused = |path: &Path| check(&[&at("in")], &[path]).unwrap_err().to_string();
        assert!(check(&[&at("in")], &[&at("new"), &at("other")]).is_ok());
        assert!(refused(&at("in")).ends_with("the output would replace the input"));
        for bad in [at("no/new"), at("in/new"), folder.path().to_owned(), at("..")] {
            assert!(refused(&bad).contains(": cannot be written: "), "{}", bad.display());
        }
        for twice in [at("new"), at("in")] {
            let error = check(&[], &[&twice, &twice]).unwrap_err().to_string();
            assert!(error.ends_with("two outputs would be written to this file"), "{error}");
        }
        assert_eq!(names(), 1);
        assert!(check_writable(Path::new("/dev/null")).is_ok());
    }
}
