//! A command of the user for each shard, or for several.

use super::{Did, Engine, Round, pool, quoted};
use crate::commands::job::numbers::Run;
use crate::error::Result;
use sightlines::checkpoint::batch;
use std::path::Path;
use std::process::Command as Process;

/// What a shell runs for each shard, or for some of them, so many at once.
pub(in crate::commands::job) struct Command<'a> {
    pub(in crate::commands::job) program: &'a Path,
    pub(in crate::commands::job) template: &'a str,
    pub(in crate::commands::job) workers: usize,
    pub(in crate::commands::job) show_progress: bool,
}

impl Engine for Command<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32) -> Result<Did> {
        let job = quoted(round.job.folder());
        let template = self.template.replace("{job}", &job).replace("{program}", &quoted(self.program));
        let takes_several = template.contains("{shards}");
        let size = |left| if takes_several && attempt == 1 { batch(left, round.shards.len(), self.workers) } else { 1 };
        pool::run(round, self.workers, self.show_progress, size, |shards| {
            let runs: Vec<String> = Run::all(shards).into_iter().map(Run::text).collect();
            let line = template.replace("{shards}", &runs.join(" "));
            let line = shards.first().map_or(line.clone(), |shard| line.replace("{shard}", &shard.to_string()));
            let mut command = if cfg!(windows) { Process::new("cmd") } else { Process::new("sh") };
            command.arg(if cfg!(windows) { "/C" } else { "-c" }).arg(line);
            command
        })?;
        Ok(Did::Shards)
    }
}
