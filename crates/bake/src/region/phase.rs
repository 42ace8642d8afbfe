//! A phase of a bake: units of work, the results of which may be kept.

use super::RegionBakeOptions;
use crate::error::BakeError;
use crate::threads;
use rayon::prelude::*;
use sightlines_progress::{Counter, Halt, Phase, Work, scattered, shares_of};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Decides all units of a phase, in an order of which every beginning is a sample; in what is found they are in any order, and those
/// without a result were not begun within the budget, or are done by others.
///
/// * `costs`: what each unit is predicted to cost, in some unit of time
/// * `to_bytes`, `from_bytes`: how a result is kept; the second is `None` for bytes that are no result of this bake
///
/// # Errors
/// Those of `decide`, and [`Halt`] as the store and the observer have it.
pub(crate) fn decide<T: Send>(
    phase: &'static str,
    costs: &[f64],
    options: &RegionBakeOptions<'_>,
    (to_bytes, from_bytes): (fn(&T) -> Vec<u8>, impl Fn(&[u8]) -> Option<T> + Sync),
    decide: impl Fn(usize) -> Result<T, BakeError> + Sync,
) -> Result<Vec<(usize, Option<T>)>, BakeError> {
    let shares = shares_of(costs);
    let pass = || {
        let counter = Counter::new(options.progress, phase, costs.len()).of(Work::Deciding);
        let units = options.units.in_order(phase, scattered(costs.len()));
        let next = AtomicUsize::new(0);
        let one = || {
            counter.check()?;
            // Whichever thread is free takes the next one, so that those that come first are done first.
            let unit = units[next.fetch_add(1, Relaxed)];
            if options.budget.is_over() {
                counter.step_by(shares[unit], false)?;
                return Ok((unit, None));
            }
            let mut computed = None;
            let kept = options.units.get(phase, unit, || {
                let found = decide(unit)?;
                let bytes = if options.units.are_kept() { to_bytes(&found) } else { Vec::new() };
                computed = Some(found);
                Ok::<_, BakeError>(bytes)
            })?;
            let is_kept = computed.is_none();
            let unfit = || Halt::unfit(phase, unit, "this bake");
            let found = match (computed, kept) {
                (None, Some(bytes)) => Some(from_bytes(&bytes).ok_or_else(unfit)?),
                (computed, _) => computed,
            };
            counter.step_by(shares[unit], is_kept)?;
            Ok((unit, found))
        };
        threads::on(options.threads, || {
            units.par_iter().with_max_len(1).map(|_| one()).collect::<Result<Vec<_>, BakeError>>()
        })
    };
    // If others have units to do, this may end the bake.
    options.units.through(&Phase::new(phase, costs), pass)
}
