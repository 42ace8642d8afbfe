//! Why `job` fails.

use crate::commands::{build, reject, tiles, vis};
use crate::file_error::{FileError, from_file_error};
use crate::kept::KeptError;
use sightlines::checkpoint::JobError;
use std::io;
use std::path::PathBuf;

/// Why `job` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// The folder of a job is damaged, or of something else.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A store cannot be opened.
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// As `build` fails.
    #[error(transparent)]
    Build(#[from] build::Error),
    /// As `vis` fails.
    #[error(transparent)]
    Vis(#[from] vis::Error),
    /// As `reject` fails.
    #[error(transparent)]
    Reject(#[from] reject::Error),
    /// As `tiles` fails.
    #[error(transparent)]
    Tiles(#[from] tiles::Error),
    /// A command that cannot be shared, or is none.
    #[error("{0}")]
    Command(String),
    /// A folder that the commands of a job run in.
    #[error("{}: {source}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    /// A shard that has no units in this bake: the job is damaged.
    #[error("{}: the bake came to its end without shard {shard}; plan the job anew", path.display())]
    NeverBegun { path: PathBuf, shard: usize },
    /// A program cannot be started.
    #[error("{program}: cannot be started: {source}")]
    Start { program: String, source: io::Error },
    /// A program that queues jobs fails.
    #[error("{program}: {message}")]
    Queue { program: &'static str, message: String },
    /// A process that would fail again however often it were tried has said why.
    #[error("{name}: {message}")]
    Process { name: String, message: String },
    /// The program was interrupted.
    #[error("interrupted; parts that are written stay: the same command goes on from there")]
    Interrupted,
    /// The program used too much memory.
    #[error(
        "stopped: {0}; what is done stays: the same command with a larger --memory or fewer --threads goes on from there"
    )]
    Memory(String),
}

from_file_error!(Error);
