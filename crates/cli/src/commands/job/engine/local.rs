//! Processes of this program on this machine.

use super::{Engine, Round, pool};
use crate::commands::job::Error;
use std::path::Path;
use std::process::{Command, Stdio};

/// So many processes with a thread each.
pub(in crate::commands::job) struct Local<'a> {
    pub(in crate::commands::job) program: &'a Path,
    pub(in crate::commands::job) workers: usize,
    pub(in crate::commands::job) show_progress: bool,
}

impl Engine for Local<'_> {
    fn run(&self, round: &Round<'_>, _: u32) -> Result<bool, Error> {
        pool::run(round, self.workers, self.show_progress, |shard| {
            let mut command = Command::new(self.program);
            command.args(["job", "shard"]).arg(round.job.folder()).arg(shard.to_string()).args([
                "--threads",
                "1",
                "-q",
            ]);
            command.stdin(Stdio::null()).stdout(Stdio::null());
            command
        })
    }
}
