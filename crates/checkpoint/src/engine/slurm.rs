//! Slurm: an array job for the shards of a phase, and a job that merges behind it.

mod queue;

use super::{Did, Engine, EngineError, Host, Round, Shown, quoted};
use crate::job::{JobError, ShardRun, in_words};
use queue::{Watch, cancel, is_gone, is_pending, sbatch};
use sightlines_formats::{atomic_write, process_mark};
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

/// How often Slurm is asked for news.
const POLL: Duration = Duration::from_millis(500);
/// How often it has to know nothing of a job before that counts as gone.
const GONE: usize = 4;
/// How often all parts have to be there while the merge still waits before nobody waits for it: a node that died may keep tasks that are over.
const WHOLE: usize = 20;

/// Slurm, as the environment configures it. Command lines are for a shell; in both, `$SLURM_CPUS_PER_TASK` is the number of threads, if it is set.
#[derive(Debug, Clone, Copy)]
pub struct Slurm<'a> {
    /// The command line that does the shards `"$first-$last"`, and ends with exit code 2 if it would fail again.
    pub shards: &'a str,
    /// The command line that merges and writes the output.
    pub merge: &'a str,
    /// Options for `sbatch`.
    pub options: &'a [String],
    /// Shards of a task.
    pub per_task: usize,
}

/// The files of an attempt. Another submission of the same job has others.
struct Files {
    folder: PathBuf,
    /// What tells the attempt from all others.
    name: String,
}

impl Files {
    fn of(round: &Round<'_>, attempt: u32) -> Self {
        let mark = match attempt {
            // Scripts to be read, which are not run.
            0 => String::new(),
            _ => format!("-{}", process_mark()),
        };
        Self { folder: round.job.folder().join("slurm"), name: format!("{}-{attempt}{mark}", round.phase) }
    }

    fn script(&self, what: &str) -> PathBuf {
        self.folder.join(format!("{what}-{}.sh", self.name))
    }

    /// Where a job writes what became of it. Its name has the number of the job, which the script takes from a variable.
    fn end(&self, what: &str, job: &str) -> PathBuf {
        self.folder.join(format!("{what}-{}-{job}.end", self.name))
    }

    /// The same for a shell; the number of the job is in a variable.
    fn end_in_shell(&self, what: &str, variable: &str) -> String {
        format!("{}\"${variable}\".end", quoted(&self.folder.join(format!("{what}-{}-", self.name))))
    }

    /// What the tasks of an array have said that would fail again: the number of the task, and the message.
    fn hopeless(&self, array: &str) -> Option<(usize, String)> {
        let begin = format!("task-{}-{array}-", self.name);
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut found: Vec<(usize, PathBuf)> = entries
            .filter_map(|entry| {
                let name = entry.file_name();
                let task = name.to_str()?.strip_prefix(&begin)?.strip_suffix(".end")?;
                Some((task.parse().ok()?, entry.path()))
            })
            .collect();
        found.sort();
        found.into_iter().next().map(|(task, path)| (task, fs::read_to_string(path).unwrap_or_default()))
    }
}

impl Slurm<'_> {
    /// The places, within the phase, of the tasks that have one of these shards.
    fn tasks(&self, round: &Round<'_>) -> Vec<usize> {
        let first = round.job.manifest().shards_of(round.phase).start;
        let mut tasks: Vec<usize> = round.shards.iter().map(|shard| (shard - first) / self.per_task).collect();
        tasks.dedup();
        tasks
    }

    /// The shards of a task.
    fn shards_of(&self, round: &Round<'_>, task: usize) -> Vec<usize> {
        let all = round.job.manifest().shards_of(round.phase);
        let first = all.start.saturating_add(task.saturating_mul(self.per_task));
        (first..all.end).take(self.per_task).collect()
    }

    /// Writes the scripts of an attempt into the folder of the job, and starts nothing; their paths. Attempt 0 is for scripts that are only to be read.
    ///
    /// # Errors
    /// [`EngineError::Job`].
    pub fn write(&self, round: &Round<'_>, attempt: u32) -> Result<[PathBuf; 2], EngineError> {
        let files = Files::of(round, attempt);
        let folder = &files.folder;
        fs::create_dir_all(folder).map_err(|source| JobError::Read { path: folder.clone(), source })?;
        let options: String = self.options.iter().map(|option| format!("#SBATCH {option}\n")).collect();
        let name = &round.job.manifest().phases[round.phase].name;
        let array = ShardRun::texts(&self.tasks(round)).join(",");
        let all = round.job.manifest().shards_of(round.phase);
        let (first, last, n) = (all.start, all.end.saturating_sub(1), self.per_task);
        // Slurm has no quotes here; what it cannot take has to be given by --chdir.
        let logs = folder.display();
        let end = files.end_in_shell("task", "SLURM_ARRAY_JOB_ID-$SLURM_ARRAY_TASK_ID");
        let shards = format!(
            "#!/bin/sh\n#SBATCH --job-name=sightlines-{name}\n#SBATCH --array={array}\n#SBATCH --requeue\n\
             #SBATCH --output={logs}/shards-%A-%a.log\n#SBATCH --open-mode=append\n{options}\
             first=$(({first} + SLURM_ARRAY_TASK_ID * {n}))\nlast=$((first + {n} - 1))\n\
             if [ \"$last\" -gt {last} ]; then last={last}; fi\nsaid={end}\n\
             {command} 2> \"$said.new\"\n\
             code=$?\ncat \"$said.new\" >&2\n\
             if [ $code -eq 2 ]; then mv \"$said.new\" \"$said\"; else rm -f \"$said.new\"; fi\nexit $code\n",
            command = self.shards
        );
        let end = files.end_in_shell("merge", "SLURM_JOB_ID");
        let merge = format!(
            "#!/bin/sh\n#SBATCH --job-name=sightlines-merge\n#SBATCH --requeue\n\
             #SBATCH --output={logs}/merge-%j.log\n#SBATCH --open-mode=append\n{options}\
             {command}\ncode=$?\nend={end}\necho $code > \"$end.new\" && mv \"$end.new\" \"$end\"\nexit $code\n",
            command = self.merge
        );
        let paths = ["shards", "merge"].map(|what| files.script(what));
        for (path, text) in paths.iter().zip([shards, merge]) {
            atomic_write(path, text.as_bytes()).map_err(JobError::from)?;
        }
        Ok(paths)
    }
}

impl Engine for Slurm<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32, host: &Host<'_>) -> Result<Did, EngineError> {
        let shown = Shown::new(*round, host);
        let [shards, merge] = self.write(round, attempt)?;
        let files = Files::of(round, attempt);
        let shards = sbatch(&shards, None, host.stop)?;
        let merge = sbatch(&merge, Some(&shards), host.stop)?;
        let end = files.end("merge", &merge);
        let (mut n_gone, mut n_whole, mut watch) = (0, 0, Watch::default());
        while n_gone < GONE && !end.exists() {
            let is_whole = round.shards.iter().all(|&shard| round.job.part_path(shard).exists());
            n_whole = if is_whole && is_pending(&merge)? { n_whole + 1 } else { 0 };
            if n_whole > WHOLE {
                cancel(&[&merge, &shards]);
                return Ok(Did::Shards);
            }
            if let Some((task, message)) = files.hopeless(&shards) {
                cancel(&[&shards, &merge]);
                return Err(EngineError::failed(in_words(&self.shards_of(round, task)), &message));
            }
            if (host.stop)() {
                // Otherwise the cluster would go on with what nobody waits for.
                cancel(&[&shards, &merge]);
                return Err(EngineError::Stopped);
            }
            if let Some(stuck) = watch.look(&shards) {
                let stuck = stuck.join(", ");
                (host.warn)(&format!("Slurm keeps what will never end: {stuck}; it is cancelled and sent again"));
                cancel(&[&shards, &merge]);
                return Ok(Did::Shards);
            }
            shown.update();
            std::thread::sleep(POLL);
            n_gone = if is_gone(&[&shards, &merge])? { n_gone + 1 } else { 0 };
        }
        shown.update();
        let is_written = fs::read_to_string(&end).is_ok_and(|code| code.trim() == "0");
        Ok(if is_written { Did::Output(None) } else { Did::Shards })
    }
}
