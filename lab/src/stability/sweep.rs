//! What a sweep is, and how its answers are counted.

use super::method::{Answer, Decide, Outcome, SweepMethod};
use super::table::Row;
use rayon::prelude::*;
use sightlines::geometry::Random;
use std::cell::Cell;
use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

/// The first unsafe failure or error of a method at a level.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name of the sweep.
    pub sweep: &'static str,
    /// Name of the method.
    pub method: &'static str,
    /// The parameter.
    pub level: f64,
    /// Unsafe, or an error.
    pub outcome: Outcome,
    /// The case with its coordinates, which Rust prints so that they can be read back exactly.
    pub case: String,
}

#[derive(Debug, Clone, Default)]
struct Tally {
    cases: u64,
    open: u64,
    n_unsafe: u64,
    loose: u64,
    errors: u64,
    finding: Option<(Outcome, String)>,
}

/// Where a batch of cases writes what the methods answered.
#[derive(Debug)]
pub struct Board {
    tallies: Vec<Tally>,
}

impl Board {
    /// A board for some methods.
    pub fn new(n_methods: usize) -> Self {
        Self { tallies: vec![Tally::default(); n_methods] }
    }

    /// Counts a case for one method, by its index in the sweep. `open`: whether an open set of lines sees it. A panic
    /// of `answer` is caught and counts as [`Answer::Failed`]. `case` is printed if it is the first finding.
    pub fn ask(&mut self, method: usize, open: bool, case: &dyn Debug, answer: impl FnOnce() -> Answer) {
        let outcome = Outcome::of(open, caught(answer));
        self.count(method, open, outcome, case);
    }

    /// The same for an outcome that is known already.
    pub fn count(&mut self, method: usize, open: bool, outcome: Outcome, case: &dyn Debug) {
        let tally = &mut self.tallies[method];
        tally.cases += 1;
        tally.open += u64::from(open);
        match outcome {
            Outcome::Right => return,
            Outcome::Loose => {
                tally.loose += 1;
                return;
            }
            Outcome::Unsafe => tally.n_unsafe += 1,
            Outcome::Error => tally.errors += 1,
        }
        if tally.finding.is_none() {
            tally.finding = Some((outcome, format!("{case:?}")));
        }
    }

    /// Adds what another board counted, after what this one did.
    fn add(&mut self, other: Self) {
        for (sum, tally) in self.tallies.iter_mut().zip(other.tallies) {
            sum.cases += tally.cases;
            sum.open += tally.open;
            sum.n_unsafe += tally.n_unsafe;
            sum.loose += tally.loose;
            sum.errors += tally.errors;
            sum.finding = sum.finding.take().or(tally.finding);
        }
    }
}

thread_local! {
    /// Whether a panic of this thread is expected and need not be reported.
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Calls a method; a panic becomes [`Answer::Failed`], and is not printed.
pub fn caught(answer: impl FnOnce() -> Answer) -> Answer {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                before(info);
            }
        }));
    });
    let was = QUIET.replace(true);
    let answer = catch_unwind(AssertUnwindSafe(answer)).unwrap_or(Answer::Failed);
    QUIET.set(was);
    answer
}

/// One batch of cases at a level: draws them and asks all methods.
type Batch = Box<dyn Fn(f64, &mut Random, &mut Board) + Send + Sync>;

/// A parameter with its levels, and methods that run at each.
pub struct Sweep {
    /// Name of its files: lower-case words with hyphens, the family first, as `plane-distance`.
    pub name: &'static str,
    /// What is swept and what the truth is, in a sentence or two for the page.
    pub about: &'static str,
    /// The parameter, with its unit.
    pub parameter: &'static str,
    /// Its values, ascending.
    pub levels: Vec<f64>,
    /// Calls of `batch` at each level; they run in parallel, each with its own seed.
    pub batches: usize,
    /// The methods.
    pub methods: Vec<SweepMethod>,
    /// Asks.
    pub batch: Batch,
}

impl Debug for Sweep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sweep").field("name", &self.name).field("levels", &self.levels).finish_non_exhaustive()
    }
}

/// Cases of one batch of a sweep made by [`Sweep::of_cases`].
const CASES_PER_BATCH: usize = 25;

impl Sweep {
    /// A sweep whose methods answer one question each about a case.
    ///
    /// * `cases`: at each level, rounded up to whole batches of 25.
    /// * `methods`: with what they answer.
    /// * `make`: draws a case at a level, with whether it is open, that is, seen through an open set of lines; `None`
    ///   for a draw that is no case, which is drawn again.
    pub fn of_cases<C: Debug + 'static>(
        [name, about, parameter]: [&'static str; 3],
        levels: Vec<f64>,
        cases: usize,
        methods: Vec<Decide<C>>,
        make: impl Fn(f64, &mut Random) -> Option<(C, bool)> + Send + Sync + 'static,
    ) -> Self {
        let names = methods.iter().map(|(method, _)| *method).collect();
        let batch = move |level: f64, random: &mut Random, board: &mut Board| {
            for _ in 0..CASES_PER_BATCH {
                // A sweep of which next to no draw is a case is a mistake, and seen by its count of cases.
                let Some((case, open)) = (0..1000).find_map(|_| make(level, random)) else { continue };
                for (k, (_, decide)) in methods.iter().enumerate() {
                    board.ask(k, open, &case, || decide(&case));
                }
            }
        };
        let batches = cases.div_ceil(CASES_PER_BATCH);
        Self { name, about, parameter, levels, batches, methods: names, batch: Box::new(batch) }
    }

    /// Asks everything. The rows are by level, then by method; they depend on nothing but the sweep, not on the
    /// number of threads.
    pub fn measure(&self) -> (Vec<Row>, Vec<Finding>) {
        let jobs: Vec<(usize, usize)> =
            (0..self.levels.len()).flat_map(|level| (0..self.batches).map(move |batch| (level, batch))).collect();
        let boards: Vec<Board> = jobs
            .into_par_iter()
            .map(|(level, batch)| {
                let mut random = Random::new(seed(self.name, level, batch));
                let mut board = Board::new(self.methods.len());
                (self.batch)(self.levels[level], &mut random, &mut board);
                board
            })
            .collect();
        let (mut rows, mut findings) = (Vec::new(), Vec::new());
        let mut boards = boards.into_iter();
        for &level in &self.levels {
            let mut sum = Board::new(self.methods.len());
            boards.by_ref().take(self.batches).for_each(|board| sum.add(board));
            for (method, tally) in self.methods.iter().zip(sum.tallies) {
                rows.push(Row {
                    sweep: self.name.to_owned(),
                    method: method.name.to_owned(),
                    kind: method.kind,
                    parameter: level,
                    cases: tally.cases,
                    open: tally.open,
                    n_unsafe: tally.n_unsafe,
                    loose: tally.loose,
                    errors: tally.errors,
                });
                findings.extend(tally.finding.map(|(outcome, case)| Finding {
                    sweep: self.name,
                    method: method.name,
                    level,
                    outcome,
                    case,
                }));
            }
        }
        (rows, findings)
    }
}

/// A seed for a batch, from the name of its sweep: FNV-1a, so that a new sweep changes no other.
fn seed(sweep: &str, level: usize, batch: usize) -> u64 {
    let numbers = [level as u64, batch as u64].map(u64::to_le_bytes);
    let bytes = sweep.bytes().chain(numbers.into_iter().flatten());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}
