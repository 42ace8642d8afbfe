//! The search in turns: all of it in one, or, with a budget, fair shares of it.
//!
//! With a budget each group of pairs has a share of it, in which it is decided coarsely first. What one leaves goes to those that were
//! not done, in further turns. What is left when the budget is spent counts as visible.

use super::kept;
use super::pairs::Pair;
use super::witness_log::{WitnessLog, Worker};
use super::{AtomicBitMatrix, AxialSearch, PAIRS, PairMask, SLIVER, slivers};
use rayon::prelude::*;
use sightlines_progress::{Allowance, Counter, Halt, Phase, Shares, Units, shares_of};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::ShaftCounters;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The work of some units, and the lines that were found.
type Done = Vec<(ShaftCounters, WitnessLog)>;

impl AxialSearch<'_> {
    /// Makes room for pairs that are not decided.
    pub(super) fn expect_to_leave_pairs(&mut self) {
        let n = self.cell_at.len();
        self.left = Some([AtomicBitMatrix::new(n, n), AtomicBitMatrix::new(self.boxes.len(), n)]);
    }

    /// Decides pairs of groups. What is left when the allowance is over counts as visible.
    pub(super) fn settle_pairs(
        &self,
        all: Vec<Pair>,
        threads: usize,
        allowance: Allowance<'_>,
        counter: &Counter<'_>,
        units: Units<'_>,
    ) -> Result<Done, Halt> {
        let costs: Vec<f64> = all.iter().map(|pair| self.cost_of(*pair)).collect();
        let shares_of_time = shares_of(&costs);
        let (tasks, done) = units.through(&Phase::new(kept::PAIRS, &costs), || {
            let order = units.in_order(kept::PAIRS, 0..all.len());
            let mut tasks: Vec<(usize, Pair)> = order.into_iter().map(|unit| (unit, all[unit])).collect();
            let (mut done, mut is_first) = (Vec::new(), true);
            while is_first || (!tasks.is_empty() && !allowance.is_over()) {
                let shares = Shares::new(allowance, tasks.len(), threads);
                let (begun, next) = (std::mem::take(&mut tasks), AtomicUsize::new(0));
                let turn = (0..begun.len()).into_par_iter().with_max_len(1).map_init(
                    || self.worker(),
                    |worker, _| {
                        // The observer may have cancelled while others were at work.
                        counter.check()?;
                        // Whichever thread is free takes the next one, so that those that come first are done first.
                        let place = next.fetch_add(1, Relaxed);
                        let (unit, task) = begun[place];
                        let before = worker.shaft.counters();
                        let (rest, is_kept) = units.value(
                            (kept::PAIRS, unit, kept::OF),
                            || Ok::<_, Halt>(self.settle_below(task, worker, shares.next_unit(), allowance)),
                            |_| self.result_of_pairs(task),
                            |bytes| self.restore_pairs(task, bytes).map(|()| Vec::new()),
                        )?;
                        let rest = rest.unwrap_or_default();
                        if is_first {
                            counter.step_by(PAIRS * shares_of_time[unit], is_kept)?
                        } else {
                            counter.check()?
                        }
                        Ok((place, (unit, rest), (worker.shaft.counters() - before, worker.take_log())))
                    },
                );
                let mut turn = turn.collect::<Result<Vec<_>, Halt>>()?;
                turn.sort_unstable_by_key(|(place, ..)| *place);
                for (_, (unit, rest), did) in turn {
                    tasks.extend(rest.into_iter().map(|pair| (unit, pair)));
                    done.push(did);
                }
                is_first = false;
            }
            Ok::<_, Halt>((tasks, done))
        })?;
        self.give_up_pairs(tasks.iter().map(|(_, pair)| *pair));
        Ok(done)
    }

    /// Decides a pair of groups, and returns the parts that the allowance was not enough for.
    fn settle_below(&self, task: Pair, worker: &mut Worker<'_>, unit: Allowance<'_>, all: Allowance<'_>) -> Vec<Pair> {
        let mut next = VecDeque::from([task]);
        let mut is_first = true;
        // With a limit the largest groups come first.
        let take = |next: &mut VecDeque<Pair>| if unit.is_limited() { next.pop_front() } else { next.pop_back() };
        while let Some(pair) = take(&mut next) {
            // Each turn decides a pair at least, unless all is spent, so turns come to an end.
            if unit.is_over() && (!is_first || all.is_over()) {
                next.push_front(pair);
                break;
            }
            is_first = false;
            self.settle(pair, worker, &mut |smaller| next.push_back(smaller));
        }
        next.into()
    }

    /// Marks as visible, and as left, all cells of pairs of groups that may see each other and are not known to.
    fn give_up_pairs(&self, pairs: impl Iterator<Item = Pair>) {
        let Some([left, _]) = &self.left else { return };
        let places = |n: u32| {
            let node = &self.tree.nodes()[n as usize];
            node.start as usize..node.end as usize
        };
        for [a, b] in pairs {
            for a in places(a) {
                for b in places(b).filter(|&b| b != a && self.may_see_cell(a, b) && !self.cells.get(a, b)) {
                    left.set(a, b);
                    left.set(b, a);
                }
            }
        }
        for a in 0..self.cell_at.len() {
            left.ones(a).for_each(|b| {
                self.cells.set(a, b);
            });
        }
    }

    /// Whether two cells count as visible only because the allowance was over.
    pub(super) fn is_left(&self, place: usize, other: usize) -> bool {
        self.left.as_ref().is_some_and(|[cells, _]| cells.get(place, other))
    }

    /// Decides which cells see each object, among those that may.
    pub(super) fn settle_objects(
        &self,
        threads: usize,
        allowance: Allowance<'_>,
        counter: &Counter<'_>,
        units: Units<'_>,
    ) -> Result<Done, Halt> {
        let costs: Vec<f64> = (0..self.boxes.len()).map(|object| self.cost_of_object(object)).collect();
        let shares_of_time = shares_of(&costs);
        let (tasks, done) = units.through(&Phase::new(kept::OBJECTS, &costs), || {
            let order = units.in_order(kept::OBJECTS, 0..self.boxes.len());
            let mut tasks: Vec<(usize, Vec<u32>)> = order.into_iter().map(|object| (object, vec![0])).collect();
            let (mut done, mut is_first) = (Vec::new(), true);
            while is_first || (!tasks.is_empty() && !allowance.is_over()) {
                let shares = Shares::new(allowance, tasks.len(), threads);
                let (begun, next) = (std::mem::take(&mut tasks), AtomicUsize::new(0));
                let turn = (0..begun.len()).into_par_iter().with_max_len(4).map_init(
                    || self.worker(),
                    |worker, _| {
                        counter.check()?;
                        let place = next.fetch_add(1, Relaxed);
                        let (object, nodes) = (begun[place].0, begun[place].1.clone());
                        let before = worker.shaft.counters();
                        let (rest, is_kept) = units.value(
                            (kept::OBJECTS, object, kept::OF),
                            || Ok::<_, Halt>(self.settle_object(object, worker, nodes, shares.next_unit(), allowance)),
                            |_| self.result_of_object(object),
                            |bytes| self.restore_object(object, bytes).map(|()| Vec::new()),
                        )?;
                        let rest = rest.unwrap_or_default();
                        if is_first {
                            counter.step_by((1.0 - PAIRS) * shares_of_time[object], is_kept)?
                        } else {
                            counter.check()?
                        }
                        Ok((place, (object, rest), (worker.shaft.counters() - before, worker.take_log())))
                    },
                );
                let mut turn = turn.collect::<Result<Vec<_>, Halt>>()?;
                turn.sort_unstable_by_key(|(place, ..)| *place);
                for (_, rest, did) in turn {
                    tasks.extend(Some(rest).filter(|(_, nodes)| !nodes.is_empty()));
                    done.push(did);
                }
                is_first = false;
            }
            Ok::<_, Halt>((tasks, done))
        })?;
        self.give_up_objects(&tasks);
        Ok(done)
    }

    /// Marks as visible, and as left, objects that cells in groups may see and are not known to.
    fn give_up_objects(&self, tasks: &[(usize, Vec<u32>)]) {
        let Some([_, left]) = &self.left else { return };
        for (object, nodes) in tasks {
            for node in nodes.iter().map(|&n| &self.tree.nodes()[n as usize]) {
                let places = node.start as usize..node.end as usize;
                for place in places.filter(|&p| self.maybe.get(*object, p) && !self.objects.get(*object, p)) {
                    left.set(*object, place);
                }
            }
            left.ones(*object).for_each(|place| {
                self.objects.set(*object, place);
            });
        }
    }

    /// What was left, by cells.
    pub(super) fn left_pairs(&self) -> Option<PairMask> {
        let n = self.graph.n_cells();
        let [of_cells, of_objects] = self.left.as_ref()?;
        let (mut boxes, mut objects) = (BitMatrix::new(n, n), BitMatrix::new(n, self.boxes.len()));
        for (place, &cell) in self.cell_at.iter().enumerate() {
            of_cells.ones(place).for_each(|other| boxes.set(cell as usize, self.cell_at[other] as usize, true));
        }
        for object in 0..self.boxes.len() {
            of_objects.ones(object).for_each(|place| objects.set(self.cell_at[place] as usize, object, true));
        }
        if boxes.count_ones() + objects.count_ones() == 0 {
            return None;
        }
        let none = vec![Vec::new(); n];
        slivers::fill(self.graph, |cell| self.place[cell] == SLIVER, &none, &mut boxes, &mut objects);
        (0..n).for_each(|cell| boxes.set(cell, cell, false));
        Some(PairMask { boxes, objects })
    }
}
