//! Names of files that are being written, and what is done with those that nobody finishes.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

/// Nobody is between making a file and locking it for longer than this.
const MINUTE: Duration = Duration::from_secs(60);
/// Nobody writes a file for longer than this without adding to it.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// The name of a file that is to become `name`: hidden, with the machine and the process that write it.
pub(crate) fn hidden(name: &OsStr, attempt: u32) -> OsString {
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}-{attempt}.tmp", process_mark()));
    hidden
}

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

/// Whether nobody writes a file any more. Its writer holds a lock on it; where its machine or the file system may know nothing of that, age decides alone.
fn is_left(path: &Path, is_of_this_machine: bool) -> bool {
    let Ok(file) = File::options().write(true).open(path) else { return false };
    let age = || file.metadata().ok()?.modified().ok()?.elapsed().ok();
    let Some(age) = age() else { return false };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => false,
        Ok(()) if is_of_this_machine => age > MINUTE,
        Ok(()) | Err(TryLockError::Error(_)) => age > DAY,
    }
}

/// Removes files that were to become `target`, and that nobody will finish.
pub(crate) fn remove(target: &Path) {
    let (Some(name), Some(folder)) = (target.file_name(), target.parent()) else { return };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Some(begin) = name.to_str().map(|name| format!(".{name}.")) else { return };
    // A folder that cannot be listed may still be written to.
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let found = entry.file_name();
        let mark = found.to_str().and_then(|found| found.strip_prefix(&begin)?.strip_suffix(".tmp"));
        let Some(machine_of) = mark.and_then(parse) else { continue };
        if is_left(&entry.path(), machine_of == machine()) {
            // Somebody else may have removed it by now.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The machine in `MACHINE-PID-ATTEMPT`.
fn parse(mark: &str) -> Option<&str> {
    let (mark, attempt) = mark.rsplit_once('-')?;
    attempt.parse::<u32>().ok()?;
    let (machine, pid) = mark.rsplit_once('-')?;
    let (name, digits) = machine.rsplit_once('-')?;
    let is_machine = !name.is_empty() && digits.len() == 8 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    pid.parse::<u32>().is_ok_and(|_| is_machine).then_some(machine)
}
