//! Slurm: an array job for the shards of a phase, and a job that merges behind it.

use super::{Engine, Round, Shown, quoted};
use crate::commands::job::Error;
use crate::interrupt;
use crate::output;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// How often Slurm is asked for news.
const POLL: Duration = Duration::from_millis(500);
/// How often it may fail to take a job, a poll apart: its controller may be starting again.
const PATIENCE: usize = 60;
/// How often it has to know nothing of a job before that counts as gone.
const GONE: usize = 4;
/// How often all parts have to be there while the merge still waits before nobody waits for it: a node that died may keep tasks that are over.
const WHOLE: usize = 20;

/// Slurm, as the environment configures it.
pub(in crate::commands::job) struct Slurm<'a> {
    pub(in crate::commands::job) program: &'a Path,
    pub(in crate::commands::job) options: &'a [String],
    /// What merges write, if not what was planned.
    pub(in crate::commands::job) output: Option<&'a Path>,
    pub(in crate::commands::job) show_progress: bool,
}

/// The files of an attempt.
struct Files {
    shards: PathBuf,
    merge: PathBuf,
    /// Where the merge writes how it ended.
    end: PathBuf,
}

impl Files {
    fn of(round: &Round<'_>, attempt: u32) -> Self {
        let folder = round.job.folder().join("slurm");
        let name = |what: &str, ending: &str| folder.join(format!("{what}-{}-{attempt}.{ending}", round.phase));
        Self { shards: name("shards", "sh"), merge: name("merge", "sh"), end: name("merge", "end") }
    }
}

impl Slurm<'_> {
    /// Writes the scripts of an attempt into the folder of the job.
    pub(in crate::commands::job) fn write(&self, round: &Round<'_>, attempt: u32) -> Result<Vec<PathBuf>, Error> {
        let files = Files::of(round, attempt);
        let folder = round.job.folder().join("slurm");
        fs::create_dir_all(&folder).map_err(|source| Error::Folder { path: folder.clone(), source })?;
        let (program, job) = (quoted(self.program), quoted(round.job.folder()));
        let options: String = self.options.iter().map(|option| format!("#SBATCH {option}\n")).collect();
        let name = &round.job.manifest().phases[round.phase].name;
        let array = array_of(round.shards);
        // Slurm has no quotes here; what it cannot take has to be given by --chdir.
        let logs = folder.display();
        let shards = format!(
            "#!/bin/sh\n#SBATCH --job-name=sightlines-{name}\n#SBATCH --array={array}\n#SBATCH --requeue\n\
             #SBATCH --output={logs}/shard-%a-{attempt}.log\n#SBATCH --open-mode=append\n{options}\
             exec {program} job shard {job} \"$SLURM_ARRAY_TASK_ID\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n"
        );
        let out = self.output.map_or(String::new(), |out| format!(" -o {}", quoted(out)));
        let end = quoted(&files.end);
        let merge = format!(
            "#!/bin/sh\n#SBATCH --job-name=sightlines-merge\n#SBATCH --requeue\n\
             #SBATCH --output={logs}/merge-{}-{attempt}.log\n#SBATCH --open-mode=append\n{options}\
             {program} job merge {job}{out} --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n\
             code=$?\necho $code > {end}.new && mv {end}.new {end}\nexit $code\n",
            round.phase
        );
        output::save(&files.shards, shards.as_bytes())?;
        output::save(&files.merge, merge.as_bytes())?;
        Ok(vec![files.shards, files.merge])
    }

    /// Queues a script; the number of the job. Tries for a while: the controller may be starting again.
    fn sbatch(&self, script: &Path, after: Option<&str>) -> Result<String, Error> {
        let mut last = String::new();
        for _ in 0..PATIENCE {
            let mut command = Command::new("sbatch");
            command.arg("--parsable").stdin(Stdio::null());
            if let Some(after) = after {
                // Whatever became of the shards: the merge finds out what is missing.
                command.arg(format!("--dependency=afterany:{after}"));
            }
            let program = "sbatch".to_owned();
            let done = command.arg(script).output().map_err(|source| Error::Start { program, source })?;
            let text = String::from_utf8_lossy(&done.stdout);
            if done.status.success() {
                let id = text.trim().split(';').next().unwrap_or_default().to_owned();
                return Ok(id);
            }
            last = String::from_utf8_lossy(&done.stderr).trim().to_owned();
            if !is_of_controller(&last) || interrupt::requested() {
                break;
            }
            std::thread::sleep(POLL);
        }
        Err(Error::Queue { program: "sbatch", message: last })
    }
}

impl Engine for Slurm<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32) -> Result<bool, Error> {
        let _watch = interrupt::watch();
        self.write(round, attempt)?;
        let files = Files::of(round, attempt);
        // What an earlier submission left would be taken for the end of this one.
        let _ = fs::remove_file(&files.end);
        let shards = self.sbatch(&files.shards, None)?;
        let merge = self.sbatch(&files.merge, Some(&shards))?;
        let shown = Shown::new(round, self.show_progress);
        let (mut n_gone, mut n_whole) = (0, 0);
        while n_gone < GONE && !files.end.exists() {
            let is_whole = round.shards.iter().all(|&shard| round.job.part_path(shard).exists());
            n_whole = if is_whole && is_pending(&merge)? { n_whole + 1 } else { 0 };
            if n_whole > WHOLE {
                let _ = Command::new("scancel").args([&merge, &shards]).stdin(Stdio::null()).output();
                return Ok(false);
            }
            if interrupt::requested() {
                // Otherwise the cluster would go on with what nobody waits for.
                let _ = Command::new("scancel").args([&shards, &merge]).stdin(Stdio::null()).output();
                return Err(Error::Interrupted);
            }
            shown.update();
            std::thread::sleep(POLL);
            n_gone = if is_gone(&[&shards, &merge])? { n_gone + 1 } else { 0 };
        }
        shown.update();
        Ok(fs::read_to_string(&files.end).is_ok_and(|code| code.trim() == "0"))
    }
}

/// Whether Slurm knows, and knows nothing of these jobs any more. Nothing follows from silence.
fn is_gone(jobs: &[&str]) -> Result<bool, Error> {
    let asked = Command::new("squeue").args(["-h", "-o", "%i", "-j", &jobs.join(",")]).stdin(Stdio::null()).output();
    let asked = asked.map_err(|source| Error::Start { program: "squeue".to_owned(), source })?;
    let said = String::from_utf8_lossy(&asked.stderr);
    Ok(match asked.status.success() {
        true => asked.stdout.iter().all(u8::is_ascii_whitespace),
        false => said.contains("Invalid job id"),
    })
}

/// Whether Slurm says that a job waits.
fn is_pending(job: &str) -> Result<bool, Error> {
    let asked = Command::new("squeue").args(["-h", "-o", "%T", "-j", job]).stdin(Stdio::null()).output();
    let asked = asked.map_err(|source| Error::Start { program: "squeue".to_owned(), source })?;
    Ok(asked.status.success() && asked.stdout.trim_ascii() == b"PENDING")
}

/// Whether a message is about a controller that does not answer.
fn is_of_controller(message: &str) -> bool {
    ["Unable to contact slurm controller", "timed out", "Connection refused", "Zero Bytes were transmitted"]
        .iter()
        .any(|text| message.contains(text))
}

/// Numbers of shards as Slurm takes them: `0-3,7`.
fn array_of(shards: &[usize]) -> String {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for &shard in shards {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == shard => *last = shard,
            _ => runs.push([shard, shard]),
        }
    }
    let run = |&[first, last]: &[usize; 2]| if first == last { format!("{first}") } else { format!("{first}-{last}") };
    runs.iter().map(run).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_runs() {
        assert_eq!([&[4][..], &[0, 1, 2], &[1, 2, 7, 9, 10]].map(array_of), ["4", "0-2", "1-2,7,9-10"]);
    }

    #[test]
    fn controllers_that_start_again_are_waited_for() {
        let away = "sbatch: error: Batch job submission failed: Unable to contact slurm controller (connect failure)";
        assert!(is_of_controller(away) && !is_of_controller("sbatch: error: invalid partition specified: x"));
    }
}
