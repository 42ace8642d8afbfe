//! A process on this machine, and what it prints.

use crate::error::{Result, anyhow};
use std::io::{self, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long it takes until the end of a process is noticed, at most.
pub(super) const TICK: Duration = Duration::from_millis(10);

/// The exit code of a process that would fail again: bad input, or a disk that is full.
const HOPELESS: i32 = 2;

/// A process that runs.
pub(super) struct Process {
    /// What it is at.
    name: String,
    child: Child,
    said: Option<JoinHandle<Vec<u8>>>,
    printed: Option<JoinHandle<Vec<u8>>>,
}

/// What became of a process.
pub(super) enum End {
    /// It ended well, or failed in a way that may not happen again; what it printed.
    Passed(Vec<u8>),
    /// It would fail again.
    Hopeless(anyhow::Error),
}

impl Process {
    /// Starts one. What it prints is kept until it ends.
    pub(super) fn start(name: String, command: &mut Command) -> Result<Self> {
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = child.map_err(|source| {
            let program = command.get_program().to_string_lossy().into_owned();
            anyhow!("{program}: cannot be started: {source}")
        })?;
        let (said, printed) = (child.stderr.take().map(read_all), child.stdout.take().map(read_all));
        Ok(Self { name, child, said, printed })
    }

    /// What became of it; `None` while it runs. Passes on what it has said on standard error.
    pub(super) fn look(&mut self) -> Option<End> {
        let status = match self.child.try_wait() {
            Ok(status) => status?,
            Err(error) => {
                tracing::warn!("{}: {error}", self.name);
                return Some(End::Passed(Vec::new()));
            }
        };
        let read = |from: &mut Option<JoinHandle<Vec<u8>>>| from.take().and_then(|from| from.join().ok());
        let (said, printed) = (read(&mut self.said), read(&mut self.printed));
        Some(self.ended(status, &said.unwrap_or_default(), printed.unwrap_or_default()))
    }

    fn ended(&self, status: ExitStatus, said: &[u8], printed: Vec<u8>) -> End {
        if status.code() == Some(HOPELESS) {
            let said = String::from_utf8_lossy(said);
            let said = said.trim();
            let message = said.strip_prefix("error: ").unwrap_or(said);
            let message = if message.is_empty() { status.to_string() } else { message.to_owned() };
            return End::Hopeless(anyhow!("{name}: {message}", name = self.name));
        }
        // Nothing is left to do if standard error is closed.
        let _ = io::stderr().write_all(said);
        if !status.success() {
            tracing::warn!("{}: {status}", self.name);
        }
        End::Passed(printed)
    }

    /// Ends it. What it computed a while ago is in its journals.
    pub(super) fn kill(mut self) {
        let ended: io::Result<()> = self.child.kill().and_then(|()| self.child.wait().map(drop));
        if let Err(error) = ended {
            tracing::debug!("a process cannot be ended: {error}");
        }
    }
}

fn read_all(mut from: impl Read + Send + 'static) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut all = Vec::new();
        // What cannot be read is not passed on.
        let _: io::Result<usize> = from.read_to_end(&mut all);
        all
    })
}
