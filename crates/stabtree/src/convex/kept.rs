//! A search in units whose results are kept, so that it goes on after a stop, and that several processes share one.
//!
//! The first phase is one unit: bounds, and lines through every portal. Then come beams, [`FEW`] gates to a unit, and then the pairs
//! in doubt, [`CELLS`] cells to a unit. Unlike the steps of a search in one process, a unit knows only what earlier phases
//! have found, and those of its own run ([`UnitStore::runs`](sightlines_progress::UnitStore::runs)). So more is asked, and the same is found, except that pairs
//! may be given up for another reason ([`ConvexVisibility::undecided`](super::ConvexVisibility::undecided)): on none of the real maps that were tried they differ.
//! Beams and pairs are several phases each, so that what the quick ones find serves the slow ones.

use super::beams::Traced;
use super::pairs::PairVerdict;
use super::{ConvexCounters, ConvexSearch, ConvexState, FEW, Gates, N_STAGES, PAIRS};
use sightlines_progress::{Halt, Observer, Phase, Units};
use sightlines_pvs::BitMatrix;
use sightlines_pvs::runs::{read_runs, read_varint, runs_of, write_runs, write_varint};
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

fn unfit(phase: &str, unit: usize) -> Halt {
    Halt::Store(format!("the kept result of unit {unit} of the phase '{phase}' does not fit this bake"))
}

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
                self.restore_first(&bytes).ok_or_else(|| unfit(FIRST, 0))?;
            }
            Ok(())
        })
    }

    /// The state behind the first two stages.
    fn first_result(&self) -> Vec<u8> {
        let mut out = Vec::new();
        write_varint(u64::from(self.state.stage), &mut out);
        [&self.order, &self.rank].into_iter().flatten().for_each(|&x| write_varint(u64::from(x), &mut out));
        for matrix in [&self.state.visible, &self.state.possible, &self.state.through] {
            (0..matrix.n_rows()).for_each(|row| write_row(matrix.row(row), &mut out));
        }
        write_counters(self.state.counters, &mut out);
        out
    }

    fn restore_first(&mut self, mut bytes: &[u8]) -> Option<()> {
        let stage = u32::try_from(read_varint(&mut bytes)?).ok().filter(|stage| [2, N_STAGES].contains(stage))?;
        let mut below = |n: usize| -> Option<Vec<u32>> {
            (0..n).map(|_| read_varint(&mut bytes).filter(|x| *x < n as u64).map(|x| x as u32)).collect()
        };
        (self.order, self.rank) = (below(self.gates.len())?, below(self.gates.n_cells())?);
        let state = &mut self.state;
        for matrix in [&mut state.visible, &mut state.possible, &mut state.through] {
            (0..matrix.n_rows()).try_for_each(|row| read_row(&mut bytes, matrix, row))?;
        }
        // What all later phases keep, and what tables of them rely on.
        if ![&state.visible, &state.possible].iter().all(|matrix| matrix.is_symmetric()) {
            return None;
        }
        (state.counters, state.stage, state.done) = (read_counters(&mut bytes)?, stage, 0);
        bytes.is_empty().then_some(())
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
        let (mut found, n_cells) = (None, self.gates.n_cells());
        let result = units.get(phase, unit, || {
            let (traced, counters): (Vec<Traced>, Vec<ConvexCounters>) =
                self.beams_of(range.clone()).into_iter().unzip();
            let mut all = ConvexCounters::default();
            counters.into_iter().for_each(|counters| all += counters);
            let bytes = beams_to_bytes(&traced, all);
            found = Some((traced, all));
            Ok::<_, Halt>(bytes)
        })?;
        let found = match (found, result) {
            (None, Some(bytes)) => {
                let read = beams_from_bytes(&bytes, range.len(), n_cells, &self.gates);
                Some(read.ok_or_else(|| unfit(phase, unit))?)
            }
            (found, _) => found,
        };
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
                            self.restore_cells(cells, &bytes).ok_or_else(|| unfit(phase, unit))?;
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
        let mut all = ConvexCounters::default();
        let (mut out, mut n) = (Vec::new(), 0);
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
        let mut bytes = Vec::new();
        write_varint(n, &mut bytes);
        bytes.append(&mut out);
        write_counters(all, &mut bytes);
        bytes
    }

    fn restore_cells(&mut self, cells: &[u32], mut bytes: &[u8]) -> Option<()> {
        for _ in 0..read_varint(&mut bytes)? {
            let (pair, sight) = read_verdict(&mut bytes, &self.gates).filter(|([a, _], _)| cells.contains(a))?;
            self.apply_verdict(pair, &sight);
        }
        self.state.counters += read_counters(&mut bytes)?;
        bytes.is_empty().then_some(())
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

fn write_counters(counters: ConvexCounters, out: &mut Vec<u8>) {
    let ConvexCounters { clips, lines, programs, beams, sequences } = counters;
    [clips, lines, programs, beams, sequences].into_iter().for_each(|n| write_varint(n, out));
}

fn read_counters(bytes: &mut &[u8]) -> Option<ConvexCounters> {
    let mut next = || read_varint(bytes);
    Some(ConvexCounters { clips: next()?, lines: next()?, programs: next()?, beams: next()?, sequences: next()? })
}

fn write_chain(chain: &[u32], out: &mut Vec<u8>) {
    write_varint(chain.len() as u64, out);
    chain.iter().for_each(|&gate| write_varint(u64::from(gate), out));
}

fn read_chain(bytes: &mut &[u8], gates: &Gates) -> Option<Vec<u32>> {
    let n = usize::try_from(read_varint(bytes)?).ok().filter(|n| *n <= bytes.len())?;
    let chain: Option<Vec<u32>> =
        (0..n).map(|_| read_varint(bytes).filter(|gate| *gate < gates.len() as u64).map(|gate| gate as u32)).collect();
    // A line goes from cell to cell.
    chain.filter(|chain| chain.windows(2).all(|pair| gates.get(pair[0]).to == gates.get(pair[1]).from))
}

fn beams_to_bytes(traced: &[Traced], counters: ConvexCounters) -> Vec<u8> {
    let mut out = Vec::new();
    for Traced { hidden, chains } in traced {
        write_row(hidden, &mut out);
        write_varint(chains.len() as u64, &mut out);
        chains.iter().for_each(|chain| write_chain(chain, &mut out));
    }
    write_counters(counters, &mut out);
    out
}

fn beams_from_bytes(
    mut bytes: &[u8],
    n: usize,
    n_cells: usize,
    gates: &Gates,
) -> Option<(Vec<Traced>, ConvexCounters)> {
    let mut all = Vec::with_capacity(n);
    for _ in 0..n {
        let mut hidden = vec![0u64; n_cells.div_ceil(64)];
        let runs = read_runs(&mut bytes, n_cells as u32)?;
        runs.into_iter().flatten().for_each(|cell| hidden[cell as usize / 64] |= 1 << (cell % 64));
        let n_chains = usize::try_from(read_varint(&mut bytes)?).ok().filter(|n| *n <= bytes.len())?;
        let chains: Option<Vec<Vec<u32>>> = (0..n_chains).map(|_| read_chain(&mut bytes, gates)).collect();
        all.push(Traced { hidden, chains: chains? });
    }
    let counters = read_counters(&mut bytes)?;
    bytes.is_empty().then_some((all, counters))
}

fn write_verdict([a, b]: [u32; 2], sight: &PairVerdict, out: &mut Vec<u8>) {
    [a, b].into_iter().for_each(|cell| write_varint(u64::from(cell), out));
    match sight {
        Verdict::Hidden(()) => write_varint(0, out),
        Verdict::Undecided(LimitReached) => write_varint(1, out),
        Verdict::Visible(chain) => {
            write_varint(2, out);
            write_chain(chain, out);
        }
    }
}

fn read_verdict(bytes: &mut &[u8], gates: &Gates) -> Option<([u32; 2], PairVerdict)> {
    let mut cell = || read_varint(bytes).filter(|cell| *cell < gates.n_cells() as u64).map(|cell| cell as u32);
    let pair = [cell()?, cell()?];
    let sight = match read_varint(bytes)? {
        0 => Verdict::Hidden(()),
        1 => Verdict::Undecided(LimitReached),
        2 => Verdict::Visible(read_chain(bytes, gates)?),
        _ => return None,
    };
    (pair[0] != pair[1]).then_some((pair, sight))
}
