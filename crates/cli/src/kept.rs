//! Results of units that outlive the program: so that a bake that was stopped goes on, or is shared.

use crate::error::{Result, anyhow};
use crate::interrupt;
use crate::output::{self, count};
use crate::plain::plain;
use sightlines::checkpoint::{Identity, Inputs, JobStore, Journal, Key, OpenMode, StateError};
use sightlines::progress::{Halt, UnitStore, Units};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The version of the program, which results are of.
pub(crate) const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// What units are, and what their results mean: to be raised when a bake is divided otherwise, decides otherwise, or keeps results as other bytes, between two versions of the program.
pub(crate) const UNITS: u32 = 5;

/// Seconds after which a file of results is made, unless an option says otherwise.
pub(crate) const SAVE_AFTER: u64 = 10;

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
    #[arg(long, help_heading = "Resuming", value_name = "SECONDS", default_value_t = SAVE_AFTER)]
    pub(crate) save_after: u64,
}

impl Default for ResumeArgs {
    /// As if nothing of it was given.
    fn default() -> Self {
        Self { resume: false, state: None, save_after: SAVE_AFTER }
    }
}

impl ResumeArgs {
    pub(crate) fn path(&self, output: &Path) -> PathBuf {
        self.state.clone().unwrap_or_else(|| {
            // Beside a folder too, whose name may end in a slash.
            let mut name = output.components().as_path().as_os_str().to_owned();
            name.push(".state");
            name.into()
        })
    }

    /// Whether anything of it was given, but for the time.
    pub(crate) fn is_given(&self) -> bool {
        self.resume || self.state.is_some()
    }

    fn open(&self, inputs: &Inputs, outputs: &[&Path], key: Key) -> Result<Journal> {
        let path = self.path(outputs.first().copied().unwrap_or(Path::new("out")));
        if inputs.paths().chain(outputs.iter().copied()).any(|other| output::is_one_place(other, &path)) {
            return Err(output::two_outputs(&path));
        }
        let opening = if self.resume { OpenMode::Resume } else { OpenMode::Anew };
        let after = Duration::from_secs(self.save_after);
        let journal = Journal::open(&path, key, PROGRAM, opening, after);
        let journal = journal.map_err(|error| anyhow!("{error}{}", advice(&error)))?.or_in_memory();
        match (self.resume, journal.n_taken_up()) {
            (true, 0) => tracing::warn!("{}: there is nothing to go on from; beginning anew", path.display()),
            (true, n) => tracing::info!("{}: going on from {n} results", path.display()),
            (false, _) => {}
        }
        warn_of_damage(&journal);
        if journal.n_before() > 0 {
            tracing::warn!(
                "{}: beginning without its {}: --resume goes on from them. They go to {} until this run is done",
                path.display(),
                count(journal.n_before() as u64, "result"),
                journal.before_path().display()
            );
        }
        Ok(journal)
    }

    /// Goes on from the results in the file if they are of this key, and begins anew if they are of another. Warns of a file that cannot be used for
    /// results at all.
    fn open_if_it_fits(&self, outputs: &[&Path], key: Key) -> Option<Journal> {
        let path = self.path(outputs.first().copied().unwrap_or(Path::new("out")));
        let after = Duration::from_secs(self.save_after);
        let opened = match Journal::open(&path, key, PROGRAM, OpenMode::Resume, after) {
            Err(error @ (StateError::OtherKey(_) | StateError::OtherProgram { .. } | StateError::OtherForm(_))) => {
                tracing::warn!("{}; beginning anew", plain(&error.to_string()));
                Journal::open(&path, key, PROGRAM, OpenMode::Anew, after)
            }
            opened => opened,
        };
        match opened {
            Ok(journal) => {
                warn_of_damage(&journal);
                Some(journal.or_in_memory())
            }
            Err(error) => {
                tracing::warn!("{}; the results of this run are not kept", plain(&error.to_string()));
                None
            }
        }
    }
}

fn warn_of_damage(journal: &Journal) {
    if journal.n_damaged() > 0 {
        let n = count(journal.n_damaged() as u64, "record");
        tracing::warn!("{}: {n} damaged; the rest is used", journal.path().display());
    }
}

/// What to do about results that cannot be kept, or taken up.
fn advice(error: &StateError) -> &'static str {
    match error {
        StateError::NotState(_) => ", and would be overwritten; name another with --state",
        StateError::InUse(_) => "; wait for it, or name another with --state",
        StateError::OtherKey(_) | StateError::OtherProgram { .. } | StateError::OtherForm(_) => {
            "; without --resume the work begins anew"
        }
        _ => "",
    }
}

/// Looks at files before they are read: at all of their content, if results of units are kept.
pub(crate) fn look<'p>(keeping: Keeping<'_>, paths: impl IntoIterator<Item = &'p Path>) -> Result<Inputs> {
    Ok(match keeping {
        Keeping::Nowhere => Inputs::names(paths),
        Keeping::File(_) | Keeping::FileIfItFits(_) | Keeping::Job(_) => Inputs::look(paths)?,
    })
}

/// What decides the results of a kind of work on the content of files.
pub(crate) fn identity(kind: &str, inputs: &Inputs) -> Identity {
    Identity::new((PROGRAM, UNITS), kind, inputs)
}

/// Opens the store of a job for work with an identity.
pub(crate) type OpenJob<'a> = &'a dyn Fn(&Identity) -> Result<&'a JobStore>;

/// Where the results of units are kept.
#[derive(Clone, Copy)]
pub(crate) enum Keeping<'a> {
    /// In a file beside the output, as the arguments of a command have it.
    File(&'a ResumeArgs),
    /// The same, where an earlier run is gone on from without being asked: what cannot be used is no error.
    FileIfItFits(&'a ResumeArgs),
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
    outputs: Vec<PathBuf>,
    _watch: interrupt::Watch,
}

impl<'a> Kept<'a> {
    /// Opens the store of a run that has read `inputs` and writes `outputs`, of which there is at least one; `identify` is only called if there is a store.
    pub(crate) fn open(
        keeping: Keeping<'a>,
        inputs: &Inputs,
        outputs: &[&Path],
        identify: impl FnOnce() -> Identity,
    ) -> Result<Self> {
        if !matches!(keeping, Keeping::Nowhere) {
            inputs.check()?;
        }
        let (journal, job) = match keeping {
            Keeping::File(args) => (Some(args.open(inputs, outputs, identify().key())?), None),
            Keeping::FileIfItFits(args) => (args.open_if_it_fits(outputs, identify().key()), None),
            Keeping::Job(open) => (None, Some(open(&identify())?)),
            Keeping::Nowhere => (None, None),
        };
        let outputs = outputs.iter().map(|path| path.to_path_buf()).collect();
        Ok(Self { journal, job, outputs, _watch: interrupt::watch() })
    }

    /// What to give to a bake.
    pub(crate) fn units(&self) -> Units<'_> {
        let journal = self.journal.as_ref().map(|journal| journal as &dyn UnitStore);
        Units(journal.or(self.job.map(|job| job as _)))
    }

    /// How many results of an earlier run a file had.
    pub(crate) fn n_taken_up(&self) -> usize {
        self.journal.as_ref().map_or(0, Journal::n_taken_up)
    }

    /// Before anything is written that the command makes: an error if another worker of the job has written it.
    pub(crate) fn before_writing(&self) -> Result<(), Halt> {
        self.before_writing_files(&self.outputs)
    }

    /// The same where it is known only now which files that are.
    pub(crate) fn before_writing_files(&self, files: &[PathBuf]) -> Result<(), Halt> {
        self.job.map_or(Ok(()), |job| job.begin_writing(files))
    }

    /// After the end, if all went well: leaves all results in their file.
    pub(crate) fn leave(self) {
        let Some(journal) = self.journal else { return };
        let failure = journal.failure().or_else(|| journal.flush().err().map(|error| error.to_string()));
        if let Some(failure) = failure {
            tracing::warn!("{}; not all results are kept", plain(&failure));
        }
    }

    /// The end of a run that made this, or failed: an error that says how to go on if it was interrupted.
    pub(crate) fn end<T>(self, made: Result<T>) -> Result<T> {
        self.finish(made.is_ok()).map_or(made, |interrupted| Err(anyhow!("{interrupted}")))
    }

    /// After the end: results are of no use any more if all went well. Otherwise, if the program was interrupted, they are kept; returns what to say of that.
    pub(crate) fn finish(self, is_done: bool) -> Option<String> {
        if let Some(failure) = self.journal.as_ref().and_then(Journal::failure) {
            tracing::warn!("{}; a run that is stopped cannot go on from there", plain(&failure));
        }
        if is_done {
            warn_of_failure(self.job.map(JobStore::end_writing));
            warn_of_failure(self.journal.map(Journal::remove));
            return None;
        }
        if !interrupt::requested() {
            return None;
        }
        let state = self.journal.and_then(|journal| {
            warn_of_failure(Some(journal.flush()));
            journal.is_in_file().then(|| journal.path().to_owned())
        });
        warn_of_failure(self.job.map(JobStore::flush));
        Some(how_to_go_on(state.as_deref()))
    }
}

/// Says what went wrong with results, which is no reason to stop.
fn warn_of_failure<E: ToString>(done: Option<Result<(), E>>) {
    if let Some(Err(error)) = done {
        tracing::warn!("{}", plain(&error.to_string()));
    }
}

/// That the program was interrupted, and how a later run goes on from what is in a file.
fn how_to_go_on(state: Option<&Path>) -> String {
    match (interrupt::memory(), state.map(Path::display)) {
        (None, Some(path)) => format!("interrupted; the same command with --resume goes on from {path}"),
        (None, None) => "interrupted; nothing was written".to_owned(),
        (Some(why), Some(path)) => format!(
            "stopped: {why}; with --resume and a larger --memory, or fewer --threads, the same command goes on from {path}; \
             `job plan` shares it among processes"
        ),
        (Some(why), None) => format!(
            "stopped: {why}; nothing was written. Try a larger --memory, fewer --threads, or `job plan`, which shares the work among processes"
        ),
    }
}
