//! The priority of the process.

/// Lets other programs go first.
///
/// By the system's own program `renice`, as the standard library has no call for it. It concerns the calling thread and those that it starts, so it is called
/// before there are others. Fails, with the reason, where there is no such program.
#[cfg(unix)]
pub(super) fn lower() -> Result<(), String> {
    use crate::plain::plain;
    use std::process::{Command, Stdio, id};
    let mut renice = Command::new("renice");
    renice.args(["-n", "10", "-p", &id().to_string()]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match renice.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("renice failed, {status}")),
        Err(error) => Err(format!("renice does not run: {}", plain(&error.to_string()))),
    }
}

/// There is no way here that needs no code of the system's own.
#[cfg(not(unix))]
pub(super) fn lower() -> Result<(), String> {
    Err("it is not supported on this system".to_owned())
}
