//! A bake that several processes share: a folder with a manifest, and a part for each shard.
//!
//! The manifest ([`MANIFEST`]) has the command, the key of its results, and the phases that are known, each cut into shards. A phase is known once all
//! earlier ones are complete, so a job takes as many rounds as its bake has phases. The part of shard `n` is `parts/n.part`, or from 1000 on `parts/k/n.part` with the thousands
//! `k`: the results of its units, in order. Beside it lie journals of processes that are at work on it, or were stopped, and files that workers lock while a shard is theirs.

mod claims;
mod cut;
mod manifest;
mod own;
mod runs;
mod slot;
mod status;
mod store;

pub use claims::batch;
pub use cut::cut;
pub use manifest::{Manifest, PhasePlan, ShardPlan};
pub use runs::{ParseShardRunError, ShardRun, in_words};
pub use slot::JobSlot;
pub use status::PhaseStatus;
pub use store::{JobProgress, JobRole, JobStore};

use crate::error::StateError;
use crate::index::Results;
use crate::key::Key;
use crate::records::{Owner, record};
use sightlines_formats::{WriteError, atomic_write};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The name of the manifest in the folder of a job.
const MANIFEST: &str = "job.json";
/// The folder of parts.
const PARTS: &str = "parts";

/// What is wrong with the folder of a job.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// A file cannot be read, or a folder not made.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A file or folder cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The manifest is damaged.
    #[error("{}: {what}", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// Another version of the program planned the job.
    #[error("{}: planned by version {found} of the program, and this is {expected}; plan it anew", path.display())]
    OtherProgram {
        /// The manifest.
        path: PathBuf,
        /// The version that planned it.
        found: String,
        /// The version that reads it.
        expected: String,
    },
    /// Another job is in the folder.
    #[error("{}: there is another job in the folder; name a new one, or remove it", .0.display())]
    OtherJob(PathBuf),
    /// The work has another key than the job.
    #[error("{}: the command and what it reads are not what they were when the job was planned", .0.display())]
    OtherWork(PathBuf),
    /// A file that the job reads has changed.
    #[error("{}: the file is not what it was when the job in {} was planned", path.display(), folder.display())]
    OtherInput {
        /// The file.
        path: PathBuf,
        /// The folder of the job.
        folder: PathBuf,
    },
    /// The journal of a shard cannot be used.
    #[error(transparent)]
    State(Box<StateError>),
    /// There is no such shard.
    #[error("{}: there is no shard {shard}; there are {n}", path.display())]
    NoShard {
        /// The manifest.
        path: PathBuf,
        /// Its number.
        shard: usize,
        /// How many there are.
        n: usize,
    },
    /// Shards that a process cannot do together.
    #[error("{}: shards {} and {} are of two phases, the second of which has to wait for all of the first", path.display(), shards[0], shards[1])]
    TwoPhases {
        /// The manifest.
        path: PathBuf,
        /// Two of them.
        shards: [usize; 2],
    },
}

/// What there is of a shard.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ShardState {
    /// Nothing.
    Missing,
    /// Results of so many of its units, in journals.
    Partial(usize),
    /// Its part, whole and sound.
    Done,
    /// A part that cannot be used, and why.
    Broken(String),
}

/// The folder of a job.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    folder: PathBuf,
    manifest: Manifest,
    key: Key,
}

impl Job {
    /// Makes the folder of a job, or opens one that has the same job.
    ///
    /// # Errors
    /// [`JobError`] for a folder that cannot be made, or that has another job.
    pub fn create(folder: &Path, manifest: Manifest) -> Result<Self, JobError> {
        let path = folder.join(MANIFEST);
        if path.exists() {
            let found = Self::open(folder, &manifest.program).map_err(|error| match error {
                JobError::OtherProgram { path, .. } => JobError::OtherJob(path),
                error => error,
            })?;
            let is_same = found.manifest.key == manifest.key && found.manifest.command == manifest.command;
            return if is_same { Ok(found) } else { Err(JobError::OtherJob(path)) };
        }
        let parts = folder.join(PARTS);
        fs::create_dir_all(&parts).map_err(|source| WriteError { path: parts, source })?;
        let key = manifest.check().map_err(|what| JobError::Manifest { path, what })?;
        let job = Self { folder: folder.to_owned(), manifest, key };
        job.save()?;
        Ok(job)
    }

    /// Opens a job that a version of the program has planned.
    ///
    /// # Errors
    /// [`JobError`] for a manifest that is missing, damaged, or of another version.
    pub fn open(folder: &Path, program: &str) -> Result<Self, JobError> {
        let path = folder.join(MANIFEST);
        let text = fs::read(&path).map_err(|source| JobError::Read { path: path.clone(), source })?;
        let (manifest, key) = Manifest::parse(&text).map_err(|what| JobError::Manifest { path: path.clone(), what })?;
        if manifest.program != program {
            let (found, expected) = (manifest.program, program.to_owned());
            return Err(JobError::OtherProgram { path, found, expected });
        }
        Ok(Self { folder: folder.to_owned(), manifest, key })
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Its manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The key of its results.
    pub fn key(&self) -> Key {
        self.key
    }

    /// The file of the part of a shard.
    pub fn part_path(&self, shard: usize) -> PathBuf {
        self.folder_of(shard).join(format!("{shard}.part"))
    }

    /// The folder of the part of a shard, of its journals and of its claim: whoever looks for journals lists it. Small jobs have one.
    fn folder_of(&self, shard: usize) -> PathBuf {
        let parts = self.folder.join(PARTS);
        if shard < SHARDS_PER_FOLDER { parts } else { parts.join((shard / SHARDS_PER_FOLDER).to_string()) }
    }

    /// Makes the folder of a shard, if it is not there: somebody may have cleared it.
    fn make_folder_of(&self, shard: usize) -> Result<(), WriteError> {
        let path = self.folder_of(shard);
        fs::create_dir_all(&path).map_err(|source| WriteError { path, source })
    }

    /// The phase of a shard, by its place, and what the shard is.
    ///
    /// # Errors
    /// [`JobError::NoShard`].
    pub fn shard(&self, shard: usize) -> Result<(usize, &ShardPlan), JobError> {
        let n = self.manifest.n_shards();
        self.manifest.shard(shard).ok_or_else(|| JobError::NoShard { path: self.folder.join(MANIFEST), shard, n })
    }

    /// What there is of a shard. Reads all of its part.
    ///
    /// # Errors
    /// [`JobError::NoShard`].
    pub fn state(&self, shard: usize) -> Result<ShardState, JobError> {
        let (phase, plan) = self.shard(shard)?;
        let name = &self.manifest.phases[phase].name;
        Ok(match self.part(shard, name, plan) {
            Ok(Some(_)) => ShardState::Done,
            Err(error) => ShardState::Broken(error.to_string()),
            Ok(None) => {
                let units: BTreeSet<u64> =
                    self.journals(shard).iter().flat_map(|journal| journal.units(name)).collect();
                let n = units.range(plan.begin as u64..plan.end as u64).count();
                if n > 0 { ShardState::Partial(n) } else { ShardState::Missing }
            }
        })
    }

    /// Whether there is a part of a shard that was read, and cannot be used.
    ///
    /// # Errors
    /// [`JobError::NoShard`].
    pub fn has_damaged_part(&self, shard: usize) -> Result<bool, JobError> {
        let (phase, plan) = self.shard(shard)?;
        let part = self.part(shard, &self.manifest.phases[phase].name, plan);
        Ok(part.is_err_and(|error| !matches!(error, StateError::Read { .. })))
    }

    fn owner(&self) -> Owner {
        Owner { key: self.key, program: self.manifest.program.clone() }
    }

    /// The part of a shard, if there is one: checked, with the results of the units of its plan and no others.
    fn part(&self, shard: usize, phase: &str, plan: &ShardPlan) -> Result<Option<Results>, StateError> {
        let path = self.part_path(shard);
        let part = match Results::read(&path, &self.owner()) {
            Err(StateError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => return Ok(None),
            part => part?,
        };
        let Some(part) = part else { return Err(StateError::CutOff { path, offset: 0 }) };
        if !part.is_finished {
            return Err(StateError::CutOff { path, offset: part.end });
        }
        if let Some(&offset) = part.damage.first() {
            return Err(StateError::Damaged { path, offset });
        }
        let is_whole = part.units(phase).into_iter().eq(plan.begin as u64..plan.end as u64);
        if !is_whole || part.has_others(phase) || part.is_torn {
            return Err(StateError::OtherUnits(path));
        }
        Ok(Some(part))
    }

    /// Journals of a shard that can be read.
    fn journals(&self, shard: usize) -> Vec<Results> {
        let owner = self.owner();
        let read = |path: &PathBuf| Results::read(path, &owner).ok().flatten();
        self.journal_paths(shard).iter().filter_map(read).collect()
    }

    fn journal_paths(&self, shard: usize) -> Vec<PathBuf> {
        let begin = format!("{shard}.part.");
        let entries = fs::read_dir(self.folder_of(shard)).into_iter().flatten().flatten();
        let is_one = |name: &str| name.starts_with(&begin) && name.ends_with(JOURNAL);
        let mut paths: Vec<PathBuf> =
            entries.filter(|entry| entry.file_name().to_str().is_some_and(is_one)).map(|entry| entry.path()).collect();
        paths.sort();
        paths
    }

    /// Writes the part of a shard, and removes the journals that it makes superfluous.
    fn save_part(&self, shard: usize, phase: &str, results: &[(u64, Vec<u8>)]) -> Result<(), WriteError> {
        let mut bytes = self.owner().header([0; 16]);
        results.iter().for_each(|(unit, result)| bytes.extend(record(phase, *unit, result)));
        bytes.extend(record("", results.len() as u64, &[]));
        let path = self.part_path(shard);
        self.make_folder_of(shard)?;
        atomic_write(&path, &bytes)?;
        for journal in self.journal_paths(shard) {
            // Another process that is at the same shard goes on with its own, and writes the same part.
            let _ = fs::remove_file(journal);
        }
        Ok(())
    }

    /// Reads the manifest again: another process may have added phases.
    fn read_again(&mut self) -> Result<(), JobError> {
        let found = Self::open(&self.folder, &self.manifest.program)?;
        if found.key != self.key {
            return Err(JobError::OtherJob(self.folder.join(MANIFEST)));
        }
        *self = found;
        Ok(())
    }

    /// Adds a phase, and writes the manifest.
    fn add_phase(&mut self, phase: PhasePlan) -> Result<(), JobError> {
        self.manifest.phases.push(phase);
        self.save()
    }

    fn save(&self) -> Result<(), JobError> {
        Ok(atomic_write(self.folder.join(MANIFEST), self.manifest.to_text().as_bytes())?)
    }
}

/// Shards whose files are in one folder: with each part that is written its folder is listed.
const SHARDS_PER_FOLDER: usize = 1000;

/// How the names of journals end.
const JOURNAL: &str = ".journal";
