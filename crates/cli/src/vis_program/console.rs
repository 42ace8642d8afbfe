//! What `sightlines-vis` prints, and the log of it.

use super::arguments::VisProgramArgs;
use crate::error::{Result, anyhow};
use crate::output;
use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use tracing_subscriber::filter::LevelFilter;

/// A kind of line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Printed in any case.
    Always,
    /// What is going on.
    Progress,
    /// Numbers about the map.
    Statistics,
}

/// Prints lines to standard output, those that the options ask for, and writes them to the log if there is one.
#[derive(Debug)]
pub(super) struct Console {
    progress: bool,
    statistics: bool,
    verbose: bool,
    colours: bool,
    log: Option<Log>,
}

impl Console {
    /// As the options say, for a map. A log that is there is replaced.
    pub(super) fn new(args: &VisProgramArgs, map: &Path) -> Result<Self> {
        let log = if args.log { Some(Log::beside(map)?) } else { None };
        Ok(Self {
            progress: !(args.quiet || args.noprogress),
            statistics: !(args.quiet || args.nostat),
            verbose: args.verbose,
            colours: !args.nocolor && io::stderr().is_terminal(),
            log,
        })
    }

    /// Prints a line, or several, if it is of a kind that the options ask for.
    pub(super) fn say(&self, kind: Kind, line: &str) -> Result<()> {
        let is_said = match kind {
            Kind::Always => true,
            Kind::Progress => self.progress,
            Kind::Statistics => self.statistics,
        };
        if !is_said {
            return Ok(());
        }
        if let Some(log) = &self.log {
            log.line(line);
        }
        match output::stdout(|out| writeln!(out, "{line}")) {
            // An editor that stops reading still wants its map.
            Err(error) if crate::is_closed_pipe(&error) => Ok(()),
            said => said,
        }
    }

    /// Lets warnings go to standard error and to the log from now on.
    pub(super) fn log_warnings(&self) {
        let log = self.log.clone();
        let writer = move || Both { log: log.clone() };
        tracing_subscriber::fmt()
            .with_writer(writer)
            .with_ansi(self.colours && self.log.is_none())
            .with_max_level(if self.verbose { LevelFilter::INFO } else { LevelFilter::WARN })
            .with_target(false)
            .without_time()
            .init();
    }

    /// Writes what went wrong to the log.
    pub(super) fn log_error(&self, error: &anyhow::Error) {
        if let Some(log) = &self.log {
            log.line(&format!("error: {error}"));
        }
    }
}

/// The file with what is printed.
#[derive(Debug, Clone)]
struct Log(Arc<Mutex<File>>);

impl Log {
    /// The log of a map: `MAP-vis.log`.
    fn beside(map: &Path) -> Result<Self> {
        let mut name = map.file_stem().unwrap_or_default().to_owned();
        name.push("-vis.log");
        let path = map.with_file_name(name);
        match File::create(&path) {
            Ok(file) => Ok(Self(Arc::new(Mutex::new(file)))),
            Err(source) => Err(anyhow!("{}: the log cannot be written: {source}", path.display())),
        }
    }

    fn line(&self, line: &str) {
        // A log that is cut short is no reason to give up a map.
        let _ = writeln!(self.0.lock().unwrap_or_else(PoisonError::into_inner), "{line}");
    }
}

/// Standard error, and the log.
struct Both {
    log: Option<Log>,
}

impl Write for Both {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        if let Some(Log(file)) = &self.log {
            let _ = file.lock().unwrap_or_else(PoisonError::into_inner).write_all(text);
        }
        io::stderr().write_all(text)?;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
