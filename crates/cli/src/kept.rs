//! Results of units that outlive the program: so that a bake that was stopped goes on, or is shared.

use crate::error::{InputError, OutputError};
use crate::interrupt;
use crate::plain::plain;
use sightlines::checkpoint::{InputFile, Job, JobError, JobStore, Journal, Key, KeyHasher, Opening, StateError};
use sightlines::progress::{UnitStore, Units};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

/// The version of the program, which results are of.
pub(crate) const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// What units are, and what their results mean: to be raised when a bake is divided otherwise, or decides otherwise, between two versions of the program.
pub(crate) const UNITS: u32 = 1;

/// Whether a bake goes on from an earlier run, and where its results are kept.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ResumeArgs {
    /// Go on from where an earlier run of the same command on the same input was stopped, by Ctrl-C for example
    #[arg(long, help_heading = "Resuming")]
    pub(crate) resume: bool,
    /// File for the results of a run that is not over [default: beside the output, with .state at the end]
    #[arg(long, help_heading = "Resuming", value_name = "FILE")]
    state: Option<PathBuf>,
    /// Seconds after which that file is made; a run that is over sooner leaves none
    #[arg(long, help_heading = "Resuming", value_name = "SECONDS", default_value_t = 10)]
    pub(crate) save_after: u64,
}

impl ResumeArgs {
    pub(crate) fn path(&self, output: &Path) -> PathBuf {
        self.state.clone().unwrap_or_else(|| {
            let mut name = output.as_os_str().to_owned();
            name.push(".state");
            name.into()
        })
    }

    /// Whether anything of it was given, but for the time.
    pub(crate) fn is_given(&self) -> bool {
        self.resume || self.state.is_some()
    }
}

/// Why results cannot be kept, or taken up.
#[derive(Debug, thiserror::Error)]
pub(crate) enum KeptError {
    /// A file of results that cannot be used.
    #[error("{source}{}", advice(source))]
    State {
        #[from]
        source: StateError,
    },
    /// A job that cannot be used.
    #[error(transparent)]
    Job(#[from] JobError),
    /// An input that is not the one that a job was planned for.
    #[error("{}: the file is not what it was when the job in {} was planned", path.display(), job.display())]
    OtherInput { path: PathBuf, job: PathBuf },
    /// A job whose key cannot be that of the command.
    #[error("{}: the command and what it reads are not what they were when the job was planned", .0.display())]
    OtherKey(PathBuf),
    /// An input that cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A state that would replace something.
    #[error(transparent)]
    Output(#[from] OutputError),
}

fn advice(error: &StateError) -> &'static str {
    match error {
        StateError::NotState(_) => ", and would be overwritten; name another with --state",
        StateError::OtherKey(_) | StateError::OtherProgram { .. } => "; without --resume the work begins anew",
        _ => "",
    }
}

/// What decides the results of a command: a key, and the files whose content is part of it.
#[derive(Debug)]
pub(crate) struct Identity {
    hasher: KeyHasher,
    pub(crate) inputs: Vec<InputFile>,
}

impl Identity {
    /// Of a kind of work.
    pub(crate) fn new(kind: &str) -> Self {
        let mut hasher = KeyHasher::new(PROGRAM);
        hasher.value("kind", kind.as_bytes());
        hasher.value("units", &UNITS.to_le_bytes());
        Self { hasher, inputs: Vec::new() }
    }

    /// Adds the content of a file.
    pub(crate) fn file(&mut self, path: &Path) -> Result<(), InputError> {
        let hashed = self.hasher.file("file", path);
        let (n_bytes, key) = hashed.map_err(|source| InputError::Open { path: path.to_owned(), source })?;
        self.inputs.push(InputFile { path: path.display().to_string(), n_bytes, key: key.to_string() });
        Ok(())
    }

    /// Adds a value.
    pub(crate) fn debug(&mut self, name: &str, value: &dyn std::fmt::Debug) {
        self.hasher.debug(name, value);
    }

    pub(crate) fn key(&self) -> Key {
        self.hasher.finish()
    }
}

/// Opens the store of a job for work with an identity.
pub(crate) type OpenJob<'a> = &'a dyn Fn(&Identity) -> Result<&'a JobStore, KeptError>;

/// Where the results of units are kept.
#[derive(Clone, Copy)]
pub(crate) enum Keeping<'a> {
    /// In a file beside the output, as the arguments of a command have it.
    File(&'a ResumeArgs),
    /// In the folder of a job.
    Job(OpenJob<'a>),
    /// Nowhere.
    Nowhere,
}

/// The store of a run.
#[derive(Debug)]
pub(crate) struct Kept<'a> {
    journal: Option<Journal>,
    job: Option<&'a JobStore>,
    _watch: interrupt::Watch,
}

impl<'a> Kept<'a> {
    /// Opens the store of a run that writes `output`; `identify` is only called if there is one.
    pub(crate) fn open(
        keeping: Keeping<'a>,
        output: &Path,
        inputs: &[&Path],
        identify: impl FnOnce() -> Result<Identity, InputError>,
    ) -> Result<Self, KeptError> {
        let (journal, job) = match keeping {
            Keeping::File(args) => {
                let path = args.path(output);
                for other in inputs.iter().copied().chain([output]) {
                    if other == path {
                        return Err(OutputError::TwoOutputs(path).into());
                    }
                }
                let opening = if args.resume { Opening::Resume } else { Opening::Anew };
                let after = Duration::from_secs(args.save_after);
                let journal = Journal::open(&path, identify()?.key(), PROGRAM, opening, after)?.or_in_memory();
                match (args.resume, journal.n_taken_up()) {
                    (true, 0) => {
                        tracing::warn!("{}: there is nothing to go on from; beginning anew", path.display());
                    }
                    (true, n) => tracing::info!("{}: going on from {n} results", path.display()),
                    (false, _) => {}
                }
                (Some(journal), None)
            }
            Keeping::Job(open) => (None, Some(open(&identify()?)?)),
            Keeping::Nowhere => (None, None),
        };
        Ok(Self { journal, job, _watch: interrupt::watch() })
    }

    /// What to give to a bake.
    pub(crate) fn units(&self) -> Units<'_> {
        let journal = self.journal.as_ref().map(|journal| journal as &dyn UnitStore);
        Units(journal.or(self.job.map(|job| job as _)))
    }

    /// After the end: results are of no use any more if all went well. Otherwise, if the program was interrupted, they are kept; returns what to say of that.
    pub(crate) fn finish(self, is_done: bool) -> Option<Interrupted> {
        if let Some(failure) = self.journal.as_ref().and_then(Journal::failure) {
            tracing::warn!("{}; a run that is stopped cannot go on from there", plain(&failure));
        }
        if is_done {
            if let Some(Err(error)) = self.journal.map(Journal::remove) {
                tracing::warn!("{}", plain(&error.to_string()));
            }
            return None;
        }
        if !interrupt::requested() {
            return None;
        }
        let state = self.journal.and_then(|journal| {
            if let Err(error) = journal.flush() {
                tracing::warn!("{}", plain(&error.to_string()));
            }
            journal.is_in_file().then(|| journal.path().to_owned())
        });
        if let Some(Err(error)) = self.job.map(JobStore::flush) {
            tracing::warn!("{}", plain(&error.to_string()));
        }
        Some(Interrupted { state })
    }
}

/// The program was interrupted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Interrupted {
    /// What a later run can go on from.
    pub(crate) state: Option<PathBuf>,
}

impl std::fmt::Display for Interrupted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.state {
            Some(path) => {
                write!(f, "interrupted; the same command with --resume goes on from {}", path.display())
            }
            None => f.write_str("interrupted; nothing was written"),
        }
    }
}

/// Opens a job for the work of a command, once.
#[derive(Debug, Default)]
pub(crate) struct JobSlot(OnceLock<JobStore>);

impl JobSlot {
    /// The store, if it was opened.
    pub(crate) fn store(&self) -> Option<&JobStore> {
        self.0.get()
    }

    /// Takes the store that `open` opens, of a job with the key of `identity`.
    pub(crate) fn open(
        &self,
        identity: &Identity,
        open: impl FnOnce() -> Result<JobStore, KeptError>,
    ) -> Result<&JobStore, KeptError> {
        let store = open()?;
        let job: Job = store.job();
        if job.key() != identity.key() {
            return Err(KeptError::OtherKey(job.folder().to_owned()));
        }
        Ok(self.0.get_or_init(|| store))
    }
}
