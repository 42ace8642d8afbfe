//! A search in units whose results are kept, so that it goes on after a stop, and that several processes share one.
//!
//! The first phase is one unit: bounds, and lines through every portal. Then come beams, [`FEW`] gates to a unit, and then the pairs
//! in doubt, [`CELLS`] cells to a unit. Unlike the steps of a search in one process, a unit knows only what earlier phases
//! have found, and those of its own run ([`UnitStore::runs`](sightlines_progress::UnitStore::runs)). So more is asked, and the same is found, except that pairs
//! may be given up for another reason ([`ConvexVisibility::undecided`](super::ConvexVisibility::undecided)): on none of the real maps that were tried they differ.
//! Beams and pairs are several phases each, so that what the quick ones find serves the slow ones.

use super::beams::Traced;
use super::pairs::PairVerdict;
use super::{ConvexSearch, ConvexSearchCounters, ConvexState, FEW, Gates, N_STAGES, PAIRS};
use sightlines_progress::{Halt, Kept, Observer, Phase, Units, kept_struct, read_whole};
use sightlines_pvs::BitMatrix;
use sightlines_pvs::runs::{read_runs, runs_of, write_runs};
use sightlines_sightline::{LimitReached, Verdict};
use std::ops::Range;

const FIRST: &str = "first";
/// Phases of beams, each with the share of gates that comes before its end. The last gates take most time, with its square.
const BEAMS: [(&str, f64); 4] = [("beams", 0.4), ("beams-again", 0.65), ("more-beams", 0.84), ("last-beams", 1.0)];
/// Phases of pairs, each with the share of cells that comes before its end.
const SEQUENCES: [(&str, f64); 3] = [("sequences", 0.2), ("more-sequences", 0.55), ("last-sequences", 1.0)];

/// The units of some phases: which of `n` things each has, `size` to a unit.
fn divided<const K: usize>(
    phases: [(&'static str, f64); K],
    n: usize,
    size: usize,
) -> Vec<(&'static str, Vec<Range<usize>>)> {
    let mut start = 0;
    let phase = |(name, share): (&'static str, f64)| {
        let end = ((n as f64 * share) as usize).next_multiple_of(size).min(n);
        let units = (start..end).step_by(size).map(|first| first..end.min(first + size)).collect();
        start = start.max(end);
        (name, units)
    };
    phases.map(phase).into()
}

/// What earlier phases have found, which every run of units begins with.
#[derive(Default)]
struct Before(Option<ConvexState>);

impl Before {
    /// The runs of a pass through a phase with so many units. A store that has runs may ask for several passes.
    fn runs(&mut self, state: &ConvexState, runs: Option<Vec<Range<usize>>>, n_units: usize) -> Vec<Range<usize>> {
        if runs.is_some() && self.0.is_none() {
            self.0 = Some(state.clone());
        }
        runs.unwrap_or_else(|| std::iter::once(0..n_units).collect())
    }

    /// A run begins: forgets what others have found.
    fn restore(&self, state: &mut ConvexState) {
        if let Some(before) = &self.0 {
            state.clone_from(before);
        }
    }
}

/// Cells of a unit of pairs.
const CELLS: usize = 16;

/// What results are of.
const OF: &str = "this bake";

kept_struct!(ConvexSearchCounters { clips, lines, programs, beams, sequences });

impl ConvexSearch {
    /// Takes all steps of a search that has not begun, with results that are kept; reports as [`ConvexSearch::run`] does.
    ///
    /// # Errors
    /// [`Halt`] by the observer or the store.
    pub fn run_in_units(&mut self, observer: Option<&dyn Observer>, units: Units<'_>) -> Result<(), Halt> {
        self.first_in_units(observer, units)?;
        if self.is_done() {
            return Ok(());
        }
        self.beams_in_units(observer, units)?;
        self.sequences_in_units(observer, units)
    }

    fn tell(&self, observer: Option<&dyn Observer>) -> Result<(), Halt> {
        let stop = observer.is_some_and(|observer| observer.report(self.progress()).is_break());
        if stop { Err(Halt::Cancelled(sightlines_progress::Cancelled)) } else { Ok(()) }
    }

    fn first_in_units(&mut self, observer: Option<&dyn Observer>, units: Units<'_>) -> Result<(), Halt> {
        units.through(&Phase::new(FIRST, &[1.0]), || {
            let mut is_computed = false;
            let result = units.get(FIRST, 0, || {
                is_computed = true;
                while self.state.stage < 2 {
                    self.tell(observer)?;
                    self.advance();
                }
                Ok::<_, Halt>(self.first_result())
            })?;
            if let Some(bytes) = result.filter(|_| !is_computed) {
                self.restore_first(&bytes).ok_or_else(|| Halt::unfit(FIRST, 0, OF))?;
            }
            Ok(())
        })
    }

    /// The state behind the first two stages.
    fn first_result(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.state.stage.write(&mut out);
        [&self.order, &self.rank].into_iter().for_each(|all| u32::write_all(all, &mut out));
        for matrix in [&self.state.visible, &self.state.possible, &self.state.through] {
            (0..matrix.n_rows()).for_each(|row| write_row(matrix.row(row), &mut out));
        }
        self.state.counters.write(&mut out);
        out
    }

    fn restore_first(&mut self, mut bytes: &[u8]) -> Option<()> {
        let stage = u32::read(&mut bytes).filter(|stage| [2, N_STAGES].contains(stage))?;
        let mut below = |n: usize| u32::read_all(&mut bytes, n).filter(|all| all.iter().all(|x| (*x as usize) < n));
        (self.order, self.rank) = (below(self.gates.len())?, below(self.gates.n_cells())?);
        let state = &mut self.state;
        for matrix in [&mut state.visible, &mut state.possible, &mut state.through] {
            (0..matrix.n_rows()).try_for_each(|row| read_row(&mut bytes, matrix, row))?;
        }
        // What all later phases keep, and what tables of them rely on.
        if ![&state.visible, &state.possible].iter().all(|matrix| matrix.is_symmetric()) {
            return None;
        }
        (state.counters, state.stage, state.done) = (ConvexSearchCounters::from_bytes(bytes)?, stage, 0);
        Some(())
    }

    fn beams_in_units(&mut self, observer: Option<&dyn Observer>, units: Units<'_>) -> Result<(), Halt> {
        let mut is_done = vec![false; self.order.len()];
        for (phase, ranges) in divided(BEAMS, self.order.len(), FEW) {
            // Time grows with the square of what lies behind a gate.
            let cost = |&gate: &u32| (self.state.through.count_row(gate as usize) as f64).powi(2);
            let costs: Vec<f64> = ranges.iter().map(|range| self.order[range.clone()].iter().map(cost).sum()).collect();
            let (mut before, were_done) = (Before::default(), is_done.clone());
            units.through(&Phase::new(phase, &costs), || {
                for run in before.runs(&self.state, units.runs(phase), ranges.len()) {
                    before.restore(&mut self.state);
                    is_done.clone_from(&were_done);
                    for unit in run {
                        self.beams_in_unit((phase, unit), ranges[unit].clone(), &mut is_done, units)?;
                        self.tell(observer)?;
                    }
                }
                Ok::<_, Halt>(())
            })?;
        }
        self.set_possible();
        self.next_stage();
        Ok(())
    }

    fn beams_in_unit(
        &mut self,
        (phase, unit): (&'static str, usize),
        range: Range<usize>,
        is_done: &mut [bool],
        units: Units<'_>,
    ) -> Result<(), Halt> {
        let compute = || {
            let (traced, counters): (Vec<Traced>, Vec<ConvexSearchCounters>) =
                self.beams_of(range.clone()).into_iter().unzip();
            let mut all = ConvexSearchCounters::default();
            counters.into_iter().for_each(|counters| all += counters);
            Ok::<_, Halt>((traced, all))
        };
        let read = |bytes: &[u8]| beams_from_bytes(bytes, range.len(), &self.gates);
        let (found, _) = units.value((phase, unit, OF), compute, beams_to_bytes, read)?;
        self.state.done = range.end as u64;
        if let Some((traced, counters)) = found {
            self.state.counters += counters;
            self.order[range.clone()].iter().for_each(|&gate| is_done[gate as usize] = true);
            self.apply_beams(range, &traced, is_done);
        }
        Ok(())
    }

    fn sequences_in_units(&mut self, observer: Option<&dyn Observer>, units: Units<'_>) -> Result<(), Halt> {
        for (phase, ranges) in divided(SEQUENCES, self.scattered.len(), CELLS) {
            let chunks: Vec<Vec<u32>> = ranges.into_iter().map(|range| self.scattered[range].to_vec()).collect();
            let cost = |cells: &Vec<u32>| cells.iter().map(|&cell| self.pairs_in_doubt(cell).len() as f64).sum();
            let costs: Vec<f64> = chunks.iter().map(cost).collect();
            let mut before = Before::default();
            units.through(&Phase::new(phase, &costs), || {
                for run in before.runs(&self.state, units.runs(phase), chunks.len()) {
                    before.restore(&mut self.state);
                    for unit in run {
                        let (cells, mut is_computed) = (&chunks[unit], false);
                        let result = units.get(phase, unit, || {
                            is_computed = true;
                            Ok::<_, Halt>(self.decide_cells(cells))
                        })?;
                        if let Some(bytes) = result.filter(|_| !is_computed) {
                            self.restore_cells(cells, &bytes).ok_or_else(|| Halt::unfit(phase, unit, OF))?;
                        }
                        self.state.done += cells.len() as u64;
                        self.tell(observer)?;
                    }
                }
                Ok::<_, Halt>(())
            })?;
        }
        self.next_stage();
        Ok(())
    }

    /// Decides the pairs in doubt of some cells, and returns the verdicts.
    fn decide_cells(&mut self, cells: &[u32]) -> Vec<u8> {
        let mut all = ConvexSearchCounters::default();
        let (mut out, mut n) = (Vec::new(), 0_u64);
        let pairs: Vec<[u32; 2]> = cells.iter().flat_map(|&cell| self.pairs_in_doubt(cell)).collect();
        for batch in pairs.chunks(PAIRS) {
            // A line of an earlier batch may have settled some.
            let is_open = |&[a, b]: &[u32; 2]| !self.state.visible.get(a as usize, b as usize);
            let batch: Vec<[u32; 2]> = batch.iter().copied().filter(is_open).collect();
            for (pair, (sight, counters)) in batch.iter().zip(self.verdicts_on(&batch)) {
                all += counters;
                self.apply_verdict(*pair, &sight);
                write_verdict(*pair, &sight, &mut out);
                n += 1;
            }
        }
        self.state.counters += all;
        let mut bytes = n.to_bytes();
        bytes.append(&mut out);
        all.write(&mut bytes);
        bytes
    }

    fn restore_cells(&mut self, cells: &[u32], mut bytes: &[u8]) -> Option<()> {
        for _ in 0..u64::read(&mut bytes)? {
            let (pair, sight) = read_verdict(&mut bytes, &self.gates).filter(|([a, _], _)| cells.contains(a))?;
            self.apply_verdict(pair, &sight);
        }
        self.state.counters += ConvexSearchCounters::from_bytes(bytes)?;
        Some(())
    }
}

fn write_row(words: &[u64], out: &mut Vec<u8>) {
    write_runs(&runs_of(sightlines_pvs::bits::ones(words).map(|col| col as u32)), out);
}

fn read_row(bytes: &mut &[u8], matrix: &mut BitMatrix, row: usize) -> Option<()> {
    let runs = read_runs(bytes, matrix.n_cols() as u32)?;
    matrix.row_mut(row).fill(0);
    runs.into_iter().flatten().for_each(|col| matrix.set(row, col as usize, true));
    Some(())
}

fn read_chain(bytes: &mut &[u8], gates: &Gates) -> Option<Vec<u32>> {
    let is_gate = |chain: &Vec<u32>| chain.iter().all(|gate| (*gate as usize) < gates.len());
    // A line goes from cell to cell.
    let is_line = |chain: &Vec<u32>| chain.windows(2).all(|pair| gates.get(pair[0]).to == gates.get(pair[1]).from);
    Vec::read(bytes).filter(is_gate).filter(is_line)
}

fn beams_to_bytes((traced, counters): &(Vec<Traced>, ConvexSearchCounters)) -> Vec<u8> {
    let mut out = Vec::new();
    for Traced { hidden, chains } in traced {
        write_row(hidden, &mut out);
        chains.write(&mut out);
    }
    counters.write(&mut out);
    out
}

fn beams_from_bytes(bytes: &[u8], n: usize, gates: &Gates) -> Option<(Vec<Traced>, ConvexSearchCounters)> {
    let n_cells = gates.n_cells();
    let traced = |bytes: &mut &[u8]| {
        let mut hidden = vec![0u64; n_cells.div_ceil(64)];
        let runs = read_runs(bytes, n_cells as u32)?;
        runs.into_iter().flatten().for_each(|cell| hidden[cell as usize / 64] |= 1 << (cell % 64));
        let n_chains = usize::read(bytes)?;
        let chains = (0..n_chains).map(|_| read_chain(bytes, gates)).collect::<Option<_>>()?;
        Some(Traced { hidden, chains })
    };
    read_whole(bytes, |bytes| Some(((0..n).map(|_| traced(bytes)).collect::<Option<_>>()?, Kept::read(bytes)?)))
}

fn write_verdict(pair: [u32; 2], sight: &PairVerdict, out: &mut Vec<u8>) {
    pair.write(out);
    match sight {
        Verdict::Hidden(()) => out.push(0),
        Verdict::Undecided(LimitReached) => out.push(1),
        Verdict::Visible(chain) => {
            out.push(2);
            chain.write(out);
        }
    }
}

fn read_verdict(bytes: &mut &[u8], gates: &Gates) -> Option<([u32; 2], PairVerdict)> {
    let pair = <[u32; 2]>::read(bytes).filter(|pair| pair.iter().all(|cell| (*cell as usize) < gates.n_cells()))?;
    let sight = match u8::read(bytes)? {
        0 => Verdict::Hidden(()),
        1 => Verdict::Undecided(LimitReached),
        2 => Verdict::Visible(read_chain(bytes, gates)?),
        _ => return None,
    };
    (pair[0] != pair[1]).then_some((pair, sight))
}
