//! Names of files that are being written, and what is done with those that nobody finishes.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

/// What stands beside a file or folder under a hidden name while it is replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hidden {
    /// What is to take its place.
    New,
    /// What it was: folders cannot replace each other in one step.
    Old,
}

impl Hidden {
    const fn ending(self) -> &'static str {
        match self {
            Self::New => ".tmp",
            Self::Old => ".old",
        }
    }

    /// A path for it, with the machine and the process in the name; `None` for a target without a name.
    ///
    /// * `attempt`: tells those of a process apart, and those of processes of one number in containers that cannot be told apart
    pub fn beside(self, target: &Path, attempt: u32) -> Option<PathBuf> {
        let mut hidden = OsString::from(".");
        hidden.push(target.file_name()?);
        hidden.push(format!(".{}-{attempt}{}", process_mark(), self.ending()));
        Some(target.with_file_name(hidden))
    }
}

/// Nobody is between making a file and locking it for longer than this.
const MINUTE: Duration = Duration::from_secs(60);
/// Nobody writes a file for longer than this without adding to it.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// This process among those of all machines that share a folder: the name of the machine, digits that tell it from others of that name and from what ran on
/// it before it was last started, and the number of the process.
pub fn process_mark() -> String {
    format!("{}-{}", machine(), std::process::id())
}

/// The part of a [mark](process_mark) that all processes of a machine share, whose locks hold for each other.
pub(crate) fn machine() -> String {
    static MACHINE: OnceLock<String> = OnceLock::new();
    MACHINE.get_or_init(read_machine).clone()
}

fn read_machine() -> String {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let name = [read("/proc/sys/kernel/hostname"), std::env::var("COMPUTERNAME").unwrap_or_default()].concat();
    let name: String = name.chars().filter(char::is_ascii_alphanumeric).take(32).collect();
    // Processes in other containers have numbers of their own.
    let numbers = fs::read_link("/proc/self/ns/pid").unwrap_or_default();
    let apart = format!("{} {}", read("/proc/sys/kernel/random/boot_id").trim(), numbers.display());
    // FNV-1a: it only has to differ.
    let digits = apart.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    format!("{}-{digits:08x}", if name.is_empty() { "host" } else { &name })
}

/// Whether a process of this machine is known to have ended.
fn has_ended(pid: u32) -> bool {
    // Where the list of processes is none, is one of another container, or hides those of others, it tells nothing; nor does the number of a process where its
    // container is not known.
    let own = fs::read_link("/proc/self").is_ok_and(|own| own.as_os_str() == &*std::process::id().to_string());
    let is_whole = own && Path::new("/proc/1").exists() && fs::read_link("/proc/self/ns/pid").is_ok();
    is_whole && !Path::new(&format!("/proc/{pid}")).exists()
}

/// Whether nobody writes a file any more. Its writer holds a lock on it; where its machine or the file system may know nothing of that, age decides alone.
fn is_left_file(path: &Path, (machine_of, pid): (&str, u32)) -> bool {
    let Ok(file) = File::options().write(true).open(path) else { return false };
    let Some(age) = age(file.metadata()) else { return false };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => false,
        Ok(()) if machine_of == machine() => age > MINUTE || has_ended(pid),
        Ok(()) | Err(TryLockError::Error(_)) => age > DAY,
    }
}

/// Whether nobody fills a folder any more, or puts it in another place. It cannot be locked everywhere, so that of a process of this machine is left once that has
/// ended. How old that of another machine is tells only of one that is new.
fn is_left_folder(path: &Path, hidden: Hidden, (machine_of, pid): (&str, u32)) -> bool {
    if machine_of == machine() {
        return has_ended(pid);
    }
    hidden == Hidden::New && age(fs::metadata(path)).is_some_and(|age| age > DAY)
}

fn age(of: io::Result<fs::Metadata>) -> Option<Duration> {
    of.ok()?.modified().ok()?.elapsed().ok()
}

/// What processes that have ended left beside `target`.
fn left(target: &Path, hidden: Hidden) -> Vec<PathBuf> {
    let (Some(name), Some(folder)) = (target.file_name(), target.parent()) else { return Vec::new() };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Some(begin) = name.to_str().map(|name| format!(".{name}.")) else { return Vec::new() };
    // A folder that cannot be listed may still be written to.
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let is_left = |entry: &fs::DirEntry| {
        let found = entry.file_name();
        let mark = found.to_str().and_then(|found| found.strip_prefix(&begin)?.strip_suffix(hidden.ending()));
        let Some(writer) = mark.and_then(parse) else { return false };
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => is_left_folder(&entry.path(), hidden, writer),
            Ok(kind) => kind.is_file() && is_left_file(&entry.path(), writer),
            Err(_) => false,
        }
    };
    let mut found: Vec<PathBuf> = entries.flatten().filter(is_left).map(|entry| entry.path()).collect();
    // The newest first: it may be put back.
    found.sort_by_key(|path| std::cmp::Reverse(fs::metadata(path).and_then(|of| of.modified()).ok()));
    found
}

/// Cleans up after processes that ended while they wrote `target`, a file or a folder: what was to become it is removed, and what it was before is put back
/// if there is nothing in its place.
///
/// [`atomic_write`](crate::atomic_write) does it too; this is for what may not be written at all.
pub fn remove_left(target: &Path) {
    // Somebody else may do the same at the same time, so that something fails, and nothing is lost.
    let remove = |path: PathBuf| {
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    };
    left(target, Hidden::New).into_iter().for_each(remove);
    for old in left(target, Hidden::Old) {
        if fs::symlink_metadata(target).is_ok() {
            remove(old);
        } else {
            let _ = fs::rename(&old, target);
        }
    }
}

/// The machine and the process in `MACHINE-PID-ATTEMPT`.
fn parse(mark: &str) -> Option<(&str, u32)> {
    let (mark, attempt) = mark.rsplit_once('-')?;
    attempt.parse::<u32>().ok()?;
    let (machine, pid) = mark.rsplit_once('-')?;
    let (name, digits) = machine.rsplit_once('-')?;
    let is_machine = !name.is_empty() && digits.len() == 8 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    pid.parse().ok().filter(|_| is_machine).map(|pid| (machine, pid))
}
