//! Names of files that are being written, and what is done with those that nobody finishes.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

/// Nobody writes a file for longer than this.
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

/// The part of a [mark](process_mark) that all processes which can look for each other share.
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

/// Whether a process of this machine no longer runs; false where that is unknown.
fn is_gone(pid: u32) -> bool {
    let processes = Path::new("/proc");
    processes.join("self").exists() && !processes.join(pid.to_string()).exists()
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
        let Some((machine_of, pid)) = mark.and_then(parse) else { continue };
        let is_dead = machine_of == machine() && is_gone(pid);
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if is_dead || age().is_some_and(|age| age > DAY) {
            // Somebody else may have removed it by now.
            let _ = fs::remove_file(entry.path());
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
    Some((machine, pid.parse().ok()?)).filter(|_| is_machine)
}
