//! Units of work whose results are kept: so that a stopped bake goes on where it was, and so that several processes share one.

use crate::Cancelled;
use std::fmt;
use std::ops::Range;

/// A phase of a bake: units whose results depend on the input, the options and the results of earlier phases, and not on each other,
/// unless they are a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase<'a> {
    /// Its name, different from that of any other phase of the bake: lower-case letters and hyphens.
    pub name: &'static str,
    /// The predicted cost of each unit, in proportion to time; its length is the number of units. Finite, and not negative.
    pub costs: &'a [f64],
    /// Whether each unit depends on the results of all units before it. Then one process goes through all of them, in order.
    pub is_chain: bool,
}

impl<'a> Phase<'a> {
    /// A phase whose units do not depend on each other.
    pub const fn new(name: &'static str, costs: &'a [f64]) -> Self {
        Self { name, costs, is_chain: false }
    }

    /// A phase each of whose units depends on those before it.
    pub const fn chain(name: &'static str, costs: &'a [f64]) -> Self {
        Self { name, costs, is_chain: true }
    }
}

/// Why a bake with a store of units ends early.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Halt {
    /// The store, or an observer, ends the bake.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// This process has done all that it should of a phase; what is missing is for others.
    #[error("the other units of this phase are for other processes")]
    Shared,
    /// A result cannot be read or written.
    #[error("{0}")]
    Store(String),
}

impl Halt {
    /// What is kept of a unit is no result of it.
    ///
    /// * `of`: what it should be a result of
    pub fn unfit(phase: &str, unit: usize, of: &str) -> Self {
        Self::Store(format!("the kept result of unit {unit} of the phase '{phase}' does not fit {of}"))
    }

    /// This of a search without a store, which only an observer ends.
    pub fn without_store(self) -> Cancelled {
        Cancelled
    }
}

/// Whether a process goes through a phase once more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// It does not: the pass that ends has all results.
    Last,
    /// It does, from the beginning of the phase. What the pass has found counts for nothing, but for the results that are kept.
    Again,
}

/// Keeps the results of units, and says which of them a process computes.
///
/// A bake calls [`UnitStore::begin`] once for each phase, in order; then, for its units in any order and from any thread,
/// [`UnitStore::load`], and where that has nothing and [`UnitStore::wants`] says so, [`UnitStore::save`] with the result; then
/// [`UnitStore::end`], which may ask for the same once more ([`Units::through`]). A phase of one unit is what all later ones need: whoever divides the others among processes computes it first. A phase that is a chain
/// ([`Phase::is_chain`]) has one process, which asks for its units in order. Equal input, options and program give equal phases and equal results, whoever computes them.
pub trait UnitStore: Sync {
    /// A phase begins.
    ///
    /// # Errors
    /// [`Halt`] ends the bake.
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt>;

    /// Whether this process computes a unit that has no result.
    fn wants(&self, phase: &'static str, unit: usize) -> bool;

    /// The result of a unit, if there is one.
    ///
    /// # Errors
    /// [`Halt`] ends the bake.
    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt>;

    /// Keeps the result of a unit.
    ///
    /// # Errors
    /// [`Halt`] ends the bake.
    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt>;

    /// All units of a phase that are wanted have results.
    ///
    /// # Errors
    /// [`Halt::Shared`] if others are missing, which ends the bake; any other [`Halt`] does too.
    fn end(&self, phase: &'static str) -> Result<Pass, Halt>;

    /// The units of a phase that has begun that this process goes through, as runs, in order. The results of a run may not depend on what the process found
    /// in another. `None` for all units, in any order.
    fn runs(&self, _phase: &'static str) -> Option<Vec<Range<usize>>> {
        None
    }

    /// Whether the costs of the phase that begins next matter; if not, any finite ones will do.
    fn needs_costs(&self) -> bool {
        true
    }

    /// Whether the pass under way through a phase has the results of all units in the end, so that it is the last one.
    fn has_all(&self, _phase: &'static str) -> bool {
        true
    }
}

/// The store of a bake; none keeps nothing, and wants everything.
#[derive(Clone, Copy, Default)]
pub struct Units<'a>(pub Option<&'a dyn UnitStore>);

impl fmt::Debug for Units<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Units").field(&self.0.is_some()).finish()
    }
}

/// The share of each unit in what all of them cost; equal shares if they cost nothing.
pub fn shares_of(costs: &[f64]) -> Vec<f64> {
    let all: f64 = costs.iter().sum();
    let equal = 1.0 / costs.len().max(1) as f64;
    costs.iter().map(|cost| if all > 0.0 { cost / all } else { equal }).collect()
}

impl Units<'_> {
    /// Whether results are kept at all. If not, callers need not encode them.
    pub const fn are_kept(&self) -> bool {
        self.0.is_some()
    }

    /// As [`UnitStore::needs_costs`]; nobody needs them without a store.
    pub fn need_costs(&self) -> bool {
        self.0.is_some_and(UnitStore::needs_costs)
    }

    /// As [`UnitStore::runs`].
    pub fn runs(&self, phase: &'static str) -> Option<Vec<Range<usize>>> {
        self.0?.runs(phase)
    }

    /// The units that this process goes through: those of its [runs](Self::runs) in their order, or else all of them as `any_order` has them.
    pub fn in_order(&self, phase: &'static str, any_order: impl Iterator<Item = usize>) -> Vec<usize> {
        match self.runs(phase) {
            Some(runs) => runs.into_iter().flatten().collect(),
            None => any_order.collect(),
        }
    }

    /// As [`UnitStore::has_all`].
    pub fn has_all(&self, phase: &'static str) -> bool {
        self.0.is_none_or(|store| store.has_all(phase))
    }

    /// Goes through a phase: begins it, calls `pass`, and ends it; and calls `pass` again as often as the store asks for it. Returns what the last pass found.
    /// Each pass goes through all units as if none had been before.
    ///
    /// # Errors
    /// [`Halt`] of the store, or an error of `pass`.
    pub fn through<T, E: From<Halt>>(&self, phase: &Phase<'_>, mut pass: impl FnMut() -> Result<T, E>) -> Result<T, E> {
        self.begin(phase)?;
        loop {
            let found = pass()?;
            if self.end(phase.name)? == Pass::Last {
                return Ok(found);
            }
        }
    }

    /// As [`UnitStore::begin`].
    ///
    /// # Errors
    /// [`Halt`] of the store.
    pub fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        self.0.map_or(Ok(()), |store| store.begin(phase))
    }

    /// The result of a unit: kept, or computed and then kept; `None` for one that is for another process.
    ///
    /// # Errors
    /// [`Halt`] of the store, or an error of `compute`.
    pub fn get<E: From<Halt>>(
        &self,
        phase: &'static str,
        unit: usize,
        compute: impl FnOnce() -> Result<Vec<u8>, E>,
    ) -> Result<Option<Vec<u8>>, E> {
        let Some(store) = self.0 else { return compute().map(Some) };
        if let Some(kept) = store.load(phase, unit)? {
            return Ok(Some(kept));
        }
        if !store.wants(phase, unit) {
            return Ok(None);
        }
        let result = compute()?;
        store.save(phase, unit, &result)?;
        Ok(Some(result))
    }

    /// As [`UnitStore::end`].
    ///
    /// # Errors
    /// [`Halt`] of the store.
    pub fn end(&self, phase: &'static str) -> Result<Pass, Halt> {
        self.0.map_or(Ok(Pass::Last), |store| store.end(phase))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use std::sync::Mutex;

    /// Keeps results in memory, and wants even units.
    #[derive(Default)]
    struct Even(Mutex<HashMap<usize, Vec<u8>>>, Mutex<usize>);

    impl UnitStore for Even {
        fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
            *self.1.lock().unwrap() = phase.costs.len();
            Ok(())
        }

        fn wants(&self, _: &'static str, unit: usize) -> bool {
            unit.is_multiple_of(2)
        }

        fn load(&self, _: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
            Ok(self.0.lock().unwrap().get(&unit).cloned())
        }

        fn save(&self, _: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
            self.0.lock().unwrap().insert(unit, result.to_vec());
            Ok(())
        }

        fn end(&self, _: &'static str) -> Result<Pass, Halt> {
            if self.0.lock().unwrap().len() == *self.1.lock().unwrap() { Ok(Pass::Last) } else { Err(Halt::Shared) }
        }
    }

    #[test]
    fn results_are_computed_once_and_only_where_they_are_wanted() {
        let store = Even::default();
        let units = Units(Some(&store));
        units.begin(&Phase::new("numbers", &[1.0; 4])).unwrap();
        let n_computed = Mutex::new(0);
        let get = |unit: usize| {
            let result = units.get("numbers", unit, || {
                *n_computed.lock().unwrap() += 1;
                Ok::<_, Halt>(vec![unit as u8])
            });
            result.unwrap()
        };
        assert_eq!([0, 1, 0, 2].map(get), [Some(vec![0]), None, Some(vec![0]), Some(vec![2])]);
        assert_eq!(*n_computed.lock().unwrap(), 2);
        assert_eq!(units.end("numbers"), Err(Halt::Shared));
        [1, 3].iter().for_each(|&unit| store.save("numbers", unit, &[9]).unwrap());
        assert_eq!((units.end("numbers"), get(1)), (Ok(Pass::Last), Some(vec![9])));
    }

    #[test]
    fn runs_decide_the_order() {
        /// Two runs, the later one first.
        struct Runs;
        impl UnitStore for Runs {
            fn begin(&self, _: &Phase<'_>) -> Result<(), Halt> {
                Ok(())
            }
            fn wants(&self, _: &'static str, _: usize) -> bool {
                true
            }
            fn load(&self, _: &'static str, _: usize) -> Result<Option<Vec<u8>>, Halt> {
                Ok(None)
            }
            fn save(&self, _: &'static str, _: usize, _: &[u8]) -> Result<(), Halt> {
                Ok(())
            }
            fn end(&self, _: &'static str) -> Result<Pass, Halt> {
                Ok(Pass::Last)
            }
            fn runs(&self, _: &'static str) -> Option<Vec<Range<usize>>> {
                Some(vec![5..7, 1..3])
            }
        }
        let any = || [3, 1, 2].into_iter();
        assert_eq!(Units(Some(&Runs)).in_order("numbers", any()), [5, 6, 1, 2]);
        let even = Even::default();
        for units in [Units(Some(&even)), Units::default()] {
            assert_eq!((units.runs("numbers"), units.in_order("numbers", any())), (None, vec![3, 1, 2]));
        }
        assert_eq!((Units(Some(&even)).need_costs(), Units::default().need_costs()), (true, false));
    }

    /// A store that asks for three passes: the last one has what the others have found.
    #[test]
    fn passes_go_on_until_the_store_has_enough() {
        #[derive(Default)]
        struct Thrice(Even, Mutex<usize>);
        impl UnitStore for Thrice {
            fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
                self.0.begin(phase)
            }
            fn wants(&self, _: &'static str, unit: usize) -> bool {
                unit == *self.1.lock().unwrap()
            }
            fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
                self.0.load(phase, unit)
            }
            fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
                self.0.save(phase, unit, result)
            }
            fn end(&self, _: &'static str) -> Result<Pass, Halt> {
                let mut n = self.1.lock().unwrap();
                *n += 1;
                Ok(if *n < 3 { Pass::Again } else { Pass::Last })
            }
            fn has_all(&self, _: &'static str) -> bool {
                *self.1.lock().unwrap() == 2
            }
        }
        let store = Thrice::default();
        let units = Units(Some(&store));
        let (mut n_passes, mut n_last) = (0, 0);
        let found = units.through(&Phase::new("numbers", &[1.0; 3]), || {
            n_passes += 1;
            n_last += usize::from(units.has_all("numbers"));
            (0..3).map(|unit| units.get("numbers", unit, || Ok::<_, Halt>(vec![unit as u8]))).collect()
        });
        let all: Vec<Option<Vec<u8>>> = (0..3).map(|unit| Some(vec![unit])).collect();
        assert_eq!((found, n_passes, n_last), (Ok(all), 3, 1));
        assert_eq!(Units::default().through(&Phase::new("numbers", &[]), || Ok::<_, Halt>(7)), Ok(7));
    }

    #[test]
    fn shares_add_up() {
        assert_eq!(shares_of(&[1.0, 0.0, 3.0]), [0.25, 0.0, 0.75]);
        assert_eq!((shares_of(&[0.0; 4]), shares_of(&[])), (vec![0.25; 4], vec![]));
    }

    #[test]
    fn without_a_store_everything_is_computed() {
        let units = Units::default();
        assert!(!units.are_kept());
        units.begin(&Phase::new("numbers", &[])).unwrap();
        assert_eq!(units.get("numbers", 7, || Ok::<_, Halt>(vec![1])), Ok(Some(vec![1])));
        assert_eq!(units.get("numbers", 7, || Err(Halt::Cancelled(Cancelled))), Err(Halt::Cancelled(Cancelled)));
        assert_eq!((units.end("numbers"), units.has_all("numbers")), (Ok(Pass::Last), true));
    }
}
