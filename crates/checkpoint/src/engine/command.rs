//! A command for a shell for each shard, or for several.

use super::{Did, Engine, EngineError, Host, Round, pool, quoted};
use crate::job::{ShardRun, batch};
use std::path::Path;
use std::process::Command;

/// What a shell runs for each shard, or for some of them.
#[derive(Debug, Clone, Copy)]
pub struct ShellCommand<'a> {
    /// The command line: `{shard}` stands for the number of a shard, `{shards}` for those of several ([`ShardRun`]), `{job}` for the folder of
    /// the job, `{program}` for the program.
    pub template: &'a str,
    /// The program.
    pub program: &'a Path,
    /// How many run at once.
    pub workers: usize,
}

impl Engine for ShellCommand<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32, host: &Host<'_>) -> Result<Did, EngineError> {
        let job = quoted(round.job.folder());
        let template = self.template.replace("{job}", &job).replace("{program}", &quoted(self.program));
        let takes_several = template.contains("{shards}");
        let size = |left| if takes_several && attempt == 1 { batch(left, round.shards.len(), self.workers) } else { 1 };
        pool::run(round, host, self.workers, size, |shards| {
            let line = template.replace("{shards}", &ShardRun::texts(shards).join(" "));
            let line = line.replace("{shard}", &shards[0].to_string());
            let (shell, option) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
            let mut command = Command::new(shell);
            command.arg(option).arg(line);
            command
        })?;
        Ok(Did::Shards)
    }
}
