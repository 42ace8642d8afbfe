//! REJECT lumps of one WAD, or of several whose maps are units of one phase of work.

use super::{Done, MapOutcome, MapStatus, RejectError, RejectOptions, RejectOutcome, do_map, is_readable, kept};
use crate::error::BakeError;
use crate::stopwatch::Stopwatch;
use sightlines_formats::doom::{MapLumps, list_maps};
use sightlines_formats::{Wad, WadError};
use sightlines_progress::{Halt, Observer, Phase, Progress, shares_of};
use std::borrow::Borrow;
use std::convert::Infallible;
use std::ops::ControlFlow;

/// The maps of a WAD that are to be done, as its directory has them. It holds nothing of what is in the maps, so many of these are small.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectMaps {
    all: Vec<MapLumps>,
    /// Indices of those that are to be done, with what they cost.
    chosen: Vec<(usize, f64)>,
    is_named: bool,
}

impl RejectMaps {
    /// Those of these names, whatever their case, in file order; all maps if there are no names. O(lumps).
    pub fn of(wad: &Wad, names: &[String]) -> Self {
        let all = list_maps(wad);
        let is_chosen = |map: &MapLumps| names.is_empty() || names.iter().any(|name| map.name().is(name));
        let chosen = all.iter().enumerate().filter(|(_, map)| is_chosen(map));
        let chosen = chosen.map(|(k, map)| (k, kept::cost(wad, map))).collect();
        Self { all, chosen, is_named: !names.is_empty() }
    }

    /// Number of maps in the file, whether they are to be done or not.
    pub fn n_in_file(&self) -> usize {
        self.all.len()
    }

    /// Whether the file has a map of this name, whatever its case.
    pub fn has(&self, name: &str) -> bool {
        self.all.iter().any(|map| map.name().is(name))
    }

    /// Number of maps that are to be done.
    pub fn len(&self) -> usize {
        self.chosen.len()
    }

    /// Whether there is nothing to be done.
    pub fn is_empty(&self) -> bool {
        self.chosen.is_empty()
    }

    fn maps(&self) -> impl Iterator<Item = &MapLumps> {
        self.chosen.iter().map(|(k, _)| &self.all[*k])
    }

    /// Whether a map that cannot be done is an error of the file. A map may be skipped among others, but to do nothing at all is one.
    fn insists(&self) -> bool {
        self.is_named || !self.maps().any(is_readable)
    }

    fn check(&self, wad: &Wad) -> Result<(), RejectError> {
        if list_maps(wad) == self.all { Ok(()) } else { Err(RejectError::Changed) }
    }
}

/// The tables of a WAD, which are to be written into it.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectTables {
    /// What became of each map that was to be done, in file order.
    pub maps: Vec<MapOutcome>,
    /// Indices of maps that get a table, with its bytes.
    lumps: Vec<(usize, Vec<u8>)>,
}

impl RejectTables {
    /// The WAD with its tables; every other lump is as it was.
    ///
    /// # Errors
    /// [`RejectError::Changed`] if the WAD has other maps than `of`, [`RejectError::Write`] if the new file cannot be laid out.
    pub fn write(&self, wad: &Wad, of: &RejectMaps) -> Result<Vec<u8>, RejectError> {
        of.check(wad)?;
        let lump = |(map, bytes): &(usize, Vec<u8>)| Some((of.all.get(*map)?, bytes.clone()));
        let lumps = self.lumps.iter().map(lump).collect::<Option<Vec<_>>>().ok_or(RejectError::Changed)?;
        Ok(wad.with_rejects(&lumps)?)
    }

    /// Of what was found; an error if that is nothing, or with `insist` if there is a failure.
    fn new(maps: Vec<MapOutcome>, lumps: Vec<(usize, Vec<u8>)>, insist: bool) -> Result<Self, RejectError> {
        let is_done = |m: &MapOutcome| matches!(m.status, MapStatus::Written(_) | MapStatus::KeptHandMade);
        let first_failure = maps.iter().find_map(|m| match &m.status {
            MapStatus::Failed(error) => Some(error),
            _ => None,
        });
        match first_failure {
            Some(error) if insist || !maps.iter().any(is_done) => Err(RejectError::clone(error)),
            _ => Ok(Self { maps, lumps }),
        }
    }
}

/// Why none of several WADs was done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RejectWadsError<E> {
    /// A file cannot be read.
    #[error(transparent)]
    Read(E),
    /// A file cannot be done, and is not to be left out.
    #[error("file {file}: {source}")]
    File {
        /// Its index.
        file: usize,
        /// Why.
        #[source]
        source: RejectError,
    },
    /// The store of units, or the observer, ends the work.
    #[error(transparent)]
    Halted(#[from] Halt),
}

/// Builds the REJECT tables of several WADs. All their maps together are the units of one phase of work, in the order of files. One WAD at a time is in memory,
/// and only if a map of it is to be computed; the tables of all are.
///
/// * `files`: the maps to do of each file, at least one of each
/// * `read`: reads the file of an index; it may be called several times, and gives the same each time
///
/// Returns the tables of each file, or why it cannot be done, as [`reject_wad`] alone would.
///
/// # Errors
/// [`RejectWadsError`]; with [`RejectOptions::strict`] too if a map cannot be done. An effect on a sector that is not there always is an error, and if there is
/// only one file, so is a map that it cannot do without.
pub fn reject_wads<W: Borrow<Wad>, E>(
    files: &[RejectMaps],
    read: impl Fn(usize) -> Result<W, E>,
    options: &RejectOptions<'_>,
) -> Result<Vec<Result<RejectTables, RejectError>>, RejectWadsError<E>> {
    let costs: Vec<f64> = files.iter().flat_map(|file| file.chosen.iter().map(|(_, cost)| *cost)).collect();
    let shares = shares_of(&costs);
    options.units.through(&Phase::new(kept::PHASE, &costs), || {
        let mut pass = Pass { shares: &shares, n_begun: 0, before: 0.0, kept: 0.0, is_one: files.len() == 1 };
        let one = |(k, file): (usize, &RejectMaps)| match pass.file(file, || read(k), options) {
            Ok(tables) => Ok(Ok(tables)),
            Err(Stop::File(error)) => Ok(Err(error)),
            Err(Stop::All(RejectError::Halted(halt))) => Err(halt.into()),
            Err(Stop::All(source)) => Err(RejectWadsError::File { file: k, source }),
            Err(Stop::Read(error)) => Err(RejectWadsError::Read(error)),
        };
        files.iter().enumerate().map(one).collect()
    })
}

/// Builds the REJECT lump of every map of a WAD, or of those named, and leaves every other lump as it
/// was. A map that cannot be done keeps its lumps, and the others are done.
///
/// # Errors
/// [`RejectError`]; then nothing is to be written. A map that cannot be done, or in an unsupported format, is an error if it was
/// named, or if the file has no others that can. With [`RejectOptions::strict`] a map that cannot be done always is; so is an effect
/// on a sector that is not there.
pub fn reject_wad(wad: &Wad, options: &RejectOptions<'_>) -> Result<RejectOutcome, RejectError> {
    let maps = RejectMaps::of(wad, &options.maps);
    if maps.n_in_file() == 0 {
        return Err(RejectError::NoMaps);
    }
    if let Some(missing) = options.maps.iter().find(|name| !maps.has(name)) {
        return Err(RejectError::NoSuchMap(missing.clone()));
    }
    let done = reject_wads(std::slice::from_ref(&maps), |_| Ok::<_, Infallible>(wad), options);
    let tables = done.map_err(|error| match error {
        RejectWadsError::Read(never) => match never {},
        RejectWadsError::File { source, .. } => source,
        RejectWadsError::Halted(halt) => halt.into(),
    })?;
    let tables = tables.into_iter().next().unwrap_or(Err(RejectError::NoMaps))?;
    let bytes = tables.write(wad, &maps)?;
    Ok(RejectOutcome { bytes, maps: tables.maps })
}

/// Why a file is not done.
enum Stop<E> {
    /// It is left out.
    File(RejectError),
    /// Nothing else is done either.
    All(RejectError),
    /// Neither, because it cannot be read.
    Read(E),
}

impl<E> From<Halt> for Stop<E> {
    fn from(halt: Halt) -> Self {
        Self::All(halt.into())
    }
}

/// A pass through all units.
struct Pass<'a> {
    /// Of each unit in what all cost.
    shares: &'a [f64],
    /// Units that have begun.
    n_begun: usize,
    /// Their share, and what of it was not computed here.
    before: f64,
    kept: f64,
    /// Whether there is only one file.
    is_one: bool,
}

impl Pass<'_> {
    /// Does the maps of the next file.
    fn file<W: Borrow<Wad>, E>(
        &mut self,
        file: &RejectMaps,
        read: impl Fn() -> Result<W, E>,
        options: &RejectOptions<'_>,
    ) -> Result<RejectTables, Stop<E>> {
        if file.is_empty() {
            return Err(Stop::File(RejectError::NoMaps));
        }
        let insist = file.insists();
        let is_left_out = !(options.strict || insist && self.is_one);
        let stop = |error| if is_left_out { Stop::File(error) } else { Stop::All(error) };
        let (mut maps, mut lumps, mut n_bytes) = (Vec::with_capacity(file.len()), Vec::new(), 0u64);
        let mut lazy = Lazy { file, read, wad: None };
        let mut too_large = None;
        for &(k, _) in &file.chosen {
            let (start, map) = (Stopwatch::start(), &file.all[k]);
            let done = self.unit(options, map, |options| match do_map(lazy.wad()?, map, insist, options) {
                Ok(done) => Ok(done),
                Err(error) => match halt_of(&error) {
                    Some(halt) => Err(halt.into()),
                    None if is_left_out && !matches!(error, RejectError::Rmb(_)) => {
                        Ok((0, MapStatus::Failed(Box::new(error)), None))
                    }
                    None => Err(Stop::All(error)),
                },
            })?;
            // A map that is for another process.
            let Some((n_sectors, status, bytes)) = done else { continue };
            n_bytes += bytes.as_ref().map_or(0, |b| b.len() as u64);
            // A file with maps that share their lumps may ask for any number of large tables. The other units have their results all the same.
            if too_large.is_none() && i32::try_from(n_bytes).is_err() {
                too_large = Some(RejectError::from(WadError::TooLarge { lump: lumps.len(), end: n_bytes }));
            }
            if too_large.is_some() && !is_left_out {
                break;
            }
            lumps.extend(bytes.filter(|_| too_large.is_none()).map(|bytes| (k, bytes)));
            maps.push(MapOutcome { name: map.name(), n_sectors, status, time: start.elapsed() });
        }
        match too_large {
            Some(error) => Err(stop(error)),
            None => RejectTables::new(maps, lumps, insist).map_err(Stop::File),
        }
    }

    /// Does a map, or takes it from the store; `None` for one that is for another process.
    fn unit<E>(
        &mut self,
        options: &RejectOptions<'_>,
        map: &MapLumps,
        mut do_map: impl FnMut(&RejectOptions<'_>) -> Result<Done, Stop<E>>,
    ) -> Result<Option<Done>, Stop<E>> {
        let (unit, share) = (self.n_begun, self.shares[self.n_begun]);
        let of_map = options.progress.map(|all| OfMap { all, before: self.before, share, kept: self.kept });
        let options = RejectOptions { progress: of_map.as_ref().map(|of_map| of_map as _), ..options.clone() };
        let mut is_computed = false;
        let mut compute = || {
            is_computed = true;
            do_map(&options)
        };
        let done =
            if options.units.are_kept() { kept::get(options.units, unit, compute)? } else { Some(Some(compute()?)) };
        self.n_begun += 1;
        self.before += share;
        self.kept += if is_computed { 0.0 } else { share };
        done.map(|done| done.ok_or_else(|| Stop::All(RejectError::Kept(map.name())))).transpose()
    }
}

/// A WAD that is read once it is needed.
struct Lazy<'a, W, F> {
    file: &'a RejectMaps,
    read: F,
    wad: Option<W>,
}

impl<W: Borrow<Wad>, F> Lazy<'_, W, F> {
    fn wad<E>(&mut self) -> Result<&Wad, Stop<E>>
    where
        F: Fn() -> Result<W, E>,
    {
        let wad = match self.wad.take() {
            Some(wad) => wad,
            None => {
                let wad = (self.read)().map_err(Stop::Read)?;
                self.file.check(wad.borrow()).map_err(Stop::All)?;
                wad
            }
        };
        Ok((*self.wad.insert(wad)).borrow())
    }
}

/// What ends all work, and says nothing of a map.
fn halt_of(error: &RejectError) -> Option<Halt> {
    match error {
        RejectError::Halted(halt) | RejectError::Bake { kind: BakeError::Halted(halt), .. } => Some(halt.clone()),
        RejectError::Bake { kind: BakeError::Cancelled(cancelled), .. } => Some((*cancelled).into()),
        _ => None,
    }
}

/// Reports the progress of a map as a share of all.
struct OfMap<'a> {
    all: &'a dyn Observer,
    before: f64,
    share: f64,
    kept: f64,
}

impl Observer for OfMap<'_> {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        let of_all = |share: f64| self.share * share;
        let share = (self.before + of_all(progress.share)).min(1.0);
        self.all.report(progress.with_share(share).with_kept((self.kept + of_all(progress.kept)).min(share)))
    }
}
