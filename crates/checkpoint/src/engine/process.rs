//! Processes on this machine, and what they print.

use super::{EngineError, Host};
use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long it takes until the end of a process is noticed, at most.
const TICK: Duration = Duration::from_millis(10);

/// The exit code of a process that would fail again: bad input, or a disk that is full.
const HOPELESS: i32 = 2;

/// A process that runs.
struct Process {
    /// What it is at.
    name: String,
    child: Child,
    said: JoinHandle<Vec<u8>>,
    printed: JoinHandle<Vec<u8>>,
}

/// What became of a process.
pub(super) enum End {
    /// It ended well, or failed in a way that may not happen again; what it printed.
    Passed(Vec<u8>),
    /// It would fail again.
    Hopeless(EngineError),
}

/// Processes that run at once. Those that still do when it is dropped are ended; what they computed a while ago is in their journals.
pub(super) struct Processes<'a> {
    host: &'a Host<'a>,
    running: Vec<Process>,
}

impl<'a> Processes<'a> {
    pub(super) fn new(host: &'a Host<'a>) -> Self {
        Self { host, running: Vec::new() }
    }

    /// How many run.
    pub(super) fn len(&self) -> usize {
        self.running.len()
    }

    /// Starts one. What it prints is kept until it ends.
    pub(super) fn start(&mut self, name: String, command: &mut Command) -> Result<(), EngineError> {
        if (self.host.stop)() {
            return Err(EngineError::Stopped);
        }
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = child.map_err(|source| EngineError::start(command.get_program().to_string_lossy(), source))?;
        let (said, printed) = (read_all(child.stderr.take()), read_all(child.stdout.take()));
        self.running.push(Process { name, child, said, printed });
        Ok(())
    }

    /// Waits for a tick; what became of those that have ended meanwhile. Passes on what they have said on standard error.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub(super) fn wait(&mut self) -> Result<Vec<End>, EngineError> {
        thread::sleep(TICK);
        if (self.host.stop)() {
            return Err(EngineError::Stopped);
        }
        let mut ends = Vec::new();
        for k in (0..self.running.len()).rev() {
            match self.running[k].child.try_wait() {
                Ok(None) => {}
                Ok(Some(status)) => ends.push(self.running.remove(k).ended(status, self.host)),
                Err(error) => {
                    (self.host.warn)(&format!("{}: {error}", self.running[k].name));
                    self.running.remove(k);
                }
            }
        }
        Ok(ends)
    }
}

impl Drop for Processes<'_> {
    fn drop(&mut self) {
        for Process { child, .. } in &mut self.running {
            // One that cannot be ended has ended by itself.
            let _: io::Result<_> = child.kill().and_then(|()| child.wait());
        }
    }
}

impl Process {
    fn ended(self, status: ExitStatus, host: &Host<'_>) -> End {
        let [said, printed] = [self.said, self.printed].map(|read| read.join().unwrap_or_default());
        if status.code() == Some(HOPELESS) {
            let said = String::from_utf8_lossy(&said);
            let message = if said.trim().is_empty() { status.to_string() } else { said.into_owned() };
            return End::Hopeless(EngineError::failed(self.name, &message));
        }
        (host.said)(&said);
        if !status.success() {
            (host.warn)(&format!("{}: {status}", self.name));
        }
        End::Passed(printed)
    }
}

fn read_all(from: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut all = Vec::new();
        // What cannot be read is not passed on.
        let _ = from.map(|mut from| from.read_to_end(&mut all));
        all
    })
}
