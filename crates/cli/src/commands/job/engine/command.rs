//! A command of the user for each shard.

use super::{Engine, Round, pool, quoted};
use crate::commands::job::Error;
use std::path::Path;
use std::process::{Command as Process, Stdio};

/// What a shell runs for each shard, so many at once.
pub(in crate::commands::job) struct Command<'a> {
    pub(in crate::commands::job) program: &'a Path,
    pub(in crate::commands::job) template: &'a str,
    pub(in crate::commands::job) workers: usize,
    pub(in crate::commands::job) show_progress: bool,
}

impl Engine for Command<'_> {
    fn run(&self, round: &Round<'_>, _: u32) -> Result<bool, Error> {
        let job = quoted(round.job.folder());
        let template = self.template.replace("{job}", &job).replace("{program}", &quoted(self.program));
        pool::run(round, self.workers, self.show_progress, |shard| {
            let line = template.replace("{shard}", &shard.to_string());
            let mut command = if cfg!(windows) { Process::new("cmd") } else { Process::new("sh") };
            command.arg(if cfg!(windows) { "/C" } else { "-c" }).arg(line);
            command.stdin(Stdio::null()).stdout(Stdio::null());
            command
        })
    }
}
