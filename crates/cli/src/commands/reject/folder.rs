//! `reject` of a folder: all WADs in it, whose maps are units of one work.

use super::outcome::{FileOutcome, FileStatus, FolderOutcome};
use super::{BAR, Map, RejectArgs, warn, warn_of_lost};
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::interrupt;
use crate::kept::{self, Keeping, Kept};
use crate::output::{self, cannot_be_made, has_ending};
use crate::progress::Bar;
use sightlines::bake::{RejectError, RejectMaps, RejectTables, RejectWadsError, reject_wads};
use sightlines::checkpoint::Inputs;
use sightlines::formats::{ReadErrorKind, Wad};
use sightlines::progress::memory;
use sightlines::progress::{Cancelled, Halt};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Reads, builds and writes. Nothing is written before the tables of all are there.
pub(super) fn make(args: &RejectArgs, keeping: Keeping<'_>, show_progress: bool) -> Result<FolderOutcome> {
    if args.rmb.is_some() {
        bail!(
            "{}: --rmb is for one WAD, and this is a folder: its effects are on sectors by number, which are others in each file",
            args.input.display()
        );
    }
    let paths = list(&args.input)?;
    if paths.is_empty() {
        bail!("{}: there are no WADs in the folder", args.input.display());
    }
    let names: Vec<&OsStr> = paths.iter().filter_map(|path| path.file_name()).collect();
    let outs: Vec<PathBuf> = names.iter().map(|name| args.output.join(name)).collect();
    check_outputs(args, &paths, &outs)?;
    let inputs = kept::look(keeping, paths.iter().map(PathBuf::as_path))?;
    let mut folder = Folder { args, paths: &paths, outs: &outs, inputs: &inputs, files: Vec::new(), todo: Vec::new() };
    let maps = folder.find()?;
    let outputs: Vec<&Path> = std::iter::once(&args.output).chain(&outs).map(PathBuf::as_path).collect();
    let kept = Kept::open(keeping, &inputs, &outputs, || args.identity(&inputs, &names))?;
    let made = folder.build(&maps, &kept, show_progress).and_then(|built| folder.write(&maps, built, &kept));
    let made = made.map(|()| FolderOutcome {
        out: args.output.display().to_string(),
        files: folder.files,
        peak_bytes: memory::peak_bytes(),
    });
    kept.end(made)
}

/// The WADs in a folder, in the order of their names; hidden ones are none.
fn list(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).in_file(folder)? {
        let path = entry.in_file(folder)?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        // What cannot be looked at is an error once it is read.
        if has_ending(&path, "wad") && !is_hidden && fs::metadata(&path).map_or(true, |found| found.is_file()) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Refuses, before anything is read, outputs that would fail at the end, and those that are inputs. Leaves nothing behind.
fn check_outputs(args: &RejectArgs, paths: &[PathBuf], outs: &[PathBuf]) -> Result<()> {
    let failed = |error| cannot_be_made(&args.output, error);
    match fs::metadata(&args.output) {
        Ok(found) if found.is_dir() => {}
        Ok(_) => return Err(failed(io::ErrorKind::NotADirectory.into())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return output::check_writable(&args.output),
        Err(error) => return Err(failed(error)),
    }
    if output::is_one_place(&args.input, &args.output) {
        return Err(output::same_file(&args.output));
    }
    let read: BTreeSet<PathBuf> = paths.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let mut written = BTreeSet::new();
    for (k, out) in outs.iter().enumerate() {
        // Names may be links.
        if let Ok(found) = out.canonicalize() {
            if read.contains(&found) {
                return Err(output::same_file(out));
            }
            if !written.insert(found) {
                return Err(output::two_outputs(out));
            }
        }
        if k == 0 || out.is_dir() {
            output::check_writable(out)?;
        }
    }
    Ok(())
}

/// A folder of WADs that are done.
struct Folder<'a> {
    args: &'a RejectArgs,
    paths: &'a [PathBuf],
    outs: &'a [PathBuf],
    inputs: &'a Inputs,
    /// What becomes of each.
    files: Vec<FileOutcome>,
    /// Those that have maps to do.
    todo: Vec<usize>,
}

impl Folder<'_> {
    /// Finds the maps to do, and reads no more of them than that.
    fn find(&mut self) -> Result<Vec<RejectMaps>> {
        let mut all = Vec::new();
        for (k, path) in self.paths.iter().enumerate() {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let mut file = FileOutcome { name, out: None, status: FileStatus::Skipped, reason: None, maps: Vec::new() };
            match Wad::read(path).inspect(|wad| warn_of_lost(path, wad)).map(|wad| RejectMaps::of(&wad, &self.args.map))
            {
                Ok(maps) if maps.n_in_file() == 0 => file.reason = Some("it has no maps".to_owned()),
                Ok(maps) if maps.is_empty() => file.reason = Some("it has no map of that name".to_owned()),
                Ok(maps) => {
                    self.todo.push(k);
                    all.push(maps);
                }
                // What cannot be read now may be a WAD.
                Err(error) if self.args.strict || matches!(error.kind, ReadErrorKind::Io(_)) => {
                    return Err(error.into());
                }
                Err(error) => file.fail(&error.kind),
            }
            self.files.push(file);
        }
        let is_missing = |name: &&String| !all.iter().any(|maps: &RejectMaps| maps.has(name));
        match self.args.map.iter().find(is_missing) {
            Some(name) => Err(anyhow!(
                "{}: map {name} is in none of the WADs in the folder that can be read",
                self.args.input.display()
            )),
            None if all.is_empty() => Err(self.none_done()),
            None => Ok(all),
        }
    }

    /// Builds the tables of all; of a WAD that cannot be done why.
    fn build(
        &self,
        maps: &[RejectMaps],
        kept: &Kept<'_>,
        show_progress: bool,
    ) -> Result<Vec<Result<RejectTables, RejectError>>> {
        let bar = Bar::new(BAR, show_progress);
        let built = reject_wads(maps, |file| self.read(self.todo[file]), &self.args.options(&bar, kept));
        built.map_err(|error| match error {
            RejectWadsError::Read(error) => error,
            RejectWadsError::File { file, source } => self.error(self.todo[file], source),
            RejectWadsError::Halted(halt) => anyhow::Error::from(halt),
            // The error of a bake can get more kinds.
            other => anyhow!("{}", Halt::Store(other.to_string())),
        })
    }

    fn write(
        &mut self,
        maps: &[RejectMaps],
        built: Vec<Result<RejectTables, RejectError>>,
        kept: &Kept<'_>,
    ) -> Result<()> {
        let mut done = Vec::new();
        for ((&k, maps), built) in self.todo.iter().zip(maps).zip(built) {
            match built {
                Ok(tables) => done.push((k, maps, tables)),
                Err(error) => self.files[k].fail(&error),
            }
        }
        if done.is_empty() {
            return Err(self.none_done());
        }
        let outs: Vec<PathBuf> = done.iter().map(|(k, ..)| self.outs[*k].clone()).collect();
        kept.before_writing_files(&outs)?;
        if self.args.strict {
            // Nothing is written if one of them cannot be.
            for (k, maps, tables) in &done {
                tables.write(&self.read(*k)?, maps).map_err(|source| self.error(*k, source))?;
            }
        }
        let failed = |error| cannot_be_made(&self.args.output, error);
        fs::create_dir_all(&self.args.output).map_err(failed)?;
        for (k, maps, tables) in done {
            // Those that are written stay.
            if interrupt::requested() {
                return Err(anyhow::Error::from(Halt::from(Cancelled)));
            }
            match tables.write(&self.read(k)?, maps) {
                Ok(bytes) => {
                    output::save(&self.outs[k], &bytes)?;
                    warn(&self.paths[k], &tables.maps);
                    let file = &mut self.files[k];
                    file.status = FileStatus::Written;
                    file.out = Some(self.outs[k].display().to_string());
                    file.maps = tables.maps.iter().map(Map::from).collect();
                }
                Err(source) if self.args.strict || source == RejectError::Changed => return Err(self.error(k, source)),
                Err(error) => self.files[k].fail(&error),
            }
        }
        for (file, path) in self.files.iter().zip(self.paths).filter(|(file, _)| file.status == FileStatus::Failed) {
            tracing::warn!("{}: not done: {}", path.display(), file.reason.as_deref().unwrap_or_default());
        }
        if self.files.iter().any(|file| file.status == FileStatus::Written) { Ok(()) } else { Err(self.none_done()) }
    }

    /// A WAD as it was when it was looked at.
    fn read(&self, k: usize) -> Result<Wad> {
        let wad = Wad::read(&self.paths[k])?;
        self.inputs.check_file(k)?;
        Ok(wad)
    }

    fn error(&self, k: usize, source: RejectError) -> anyhow::Error {
        anyhow!("{}: {source}", self.paths[k].display())
    }

    /// Names the first that failed.
    fn none_done(&self) -> anyhow::Error {
        let failed = self.files.iter().zip(self.paths).find(|(file, _)| file.status == FileStatus::Failed);
        let why = match failed {
            Some((FileOutcome { reason: Some(reason), .. }, path)) => {
                format!("can be done; the first that fails is {}: {reason}", path.display())
            }
            _ => "has maps".to_owned(),
        };
        anyhow!("{}: none of the WADs in the folder {why}", self.args.input.display())
    }
}

impl FileOutcome {
    fn fail(&mut self, error: &dyn std::fmt::Display) {
        (self.status, self.reason) = (FileStatus::Failed, Some(error.to_string()));
    }
}
