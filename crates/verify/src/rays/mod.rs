//! Rays against the real geometry: random ones, then ones that are aimed at what the table hides.

mod sampled;
mod seen;
mod suspects;
mod trees;
mod ways;

use crate::findings::{Findings, Violation};
use crate::options::VerifyOptions;
use crate::oracle::{MapWorld, PlanWorld, PortalWorld, RayOracle, SolidWorld};
use crate::sight::{SightSegment, Target};
use crate::truth::Truth;
use rayon::prelude::*;
use seen::{Seen, Tally};
use sightlines_geometry::Random;
use sightlines_progress::{Cancelled, Counter, Observer, Progress};
use sightlines_pvs::{CellId, Table};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use trees::Absent;
use ways::Ways;

/// Rays that one thread shoots in a row; violations are counted after every [`BATCH`] of them.
const CHUNK: u64 = 256;
const BATCH: u64 = 64;

/// Shoots rays, and adds to the findings what they found.
///
/// * `follow`: whether segments are followed through the table, and portals and stab trees looked at
pub(crate) fn check(
    table: &Table,
    truth: &Truth<'_>,
    follow: bool,
    options: &VerifyOptions<'_>,
    findings: &mut Findings,
) -> Result<(), Cancelled> {
    if table.n_cells() == 0 {
        findings.no_rays = Some("the table has no cells");
        return Ok(());
    }
    if findings.by_kind.contains_key("count") {
        findings.no_rays = Some("the table is not of this scene");
        return Ok(());
    }
    match truth {
        Truth::Plan(plan) => match PlanWorld::new(table, plan) {
            Some(world) => shoot_all(&world, table, follow, options, findings),
            None => {
                findings.no_rays = Some("the table was stripped of the outlines of its cells");
                Ok(())
            }
        },
        Truth::Scene(scene) => shoot_all(&SolidWorld::new(table, scene), table, follow, options, findings),
        Truth::Portals(graph) => shoot_all(&PortalWorld::new(graph), table, follow, options, findings),
        Truth::World(graph, tree) => shoot_all(&MapWorld::new(table, graph, tree), table, follow, options, findings),
    }
}

/// A part of all rays: the share that its reports give is that of all of them.
struct Part<'a> {
    observer: &'a dyn Observer,
    begin: f64,
    end: f64,
}

impl<'a> Part<'a> {
    /// One part after the other, as long as it costs.
    fn all(observer: &'a dyn Observer, costs: [f64; 5]) -> [Self; 5] {
        let all = costs.iter().sum::<f64>().max(1.0);
        let mut begin = 0.0;
        costs.map(|cost| {
            let end = begin + cost / all;
            Self { observer, begin: std::mem::replace(&mut begin, end), end }
        })
    }
}

impl Observer for Part<'_> {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        let share = self.begin + (self.end - self.begin) * progress.share;
        self.observer.report(progress.with_share(share.min(1.0)))
    }
}

fn shoot_all<R: RayOracle>(
    world: &R,
    table: &Table,
    follow: bool,
    options: &VerifyOptions<'_>,
    findings: &mut Findings,
) -> Result<(), Cancelled> {
    let seen = Seen::of(table);
    let tally = Tally::new(table);
    let mut hidden: BTreeMap<(CellId, Target), SightSegment> = BTreeMap::new();
    let n_chunks = options.rays.div_ceil(CHUNK);
    let ways = if follow { Ways::of(table) } else { None };
    let absent = ways.as_ref().zip(table.stab());
    let most = options.pairs.saturating_mul(trees::FOR_EACH_PAIR);
    let absent = absent.map_or_else(Vec::new, |(ways, stab)| ways.absent(stab, most));
    findings.n_sequences = absent.len() as u64;
    let n_borders = ways.as_ref().map_or(0, |_| table.n_cells());
    // About how many rays they cost: some thirty short segments for the border of a cell.
    let tries = f64::from(options.tries);
    let costs = [
        32.0 * n_borders as f64,
        absent.len() as f64 * tries,
        options.rays as f64,
        options.pairs as f64 * tries,
        // Most end at the first border.
        if follow { f64::from(options.segments) * table.n_cells() as f64 } else { 0.0 },
    ];
    let parts = options.progress.map(|observer| Part::all(observer, costs));
    let part = |k: usize| parts.as_ref().map(|parts| &parts[k] as &dyn Observer);
    let mut astray: BTreeMap<(&'static str, Vec<CellId>), Violation> = BTreeMap::new();
    if let Some(ways) = &ways {
        let found = missing_portals(world, ways, n_borders, part(0))?;
        let sequences = missing_sequences(world, ways, &absent, options, part(1))?;
        found.into_iter().chain(sequences).for_each(|v| note(&mut astray, v));
    }
    let counter = Counter::new(part(2), "random rays", n_chunks as usize);
    let mut chunk = 0;
    while chunk < n_chunks && hidden.len() < VerifyOptions::MOST_VIOLATIONS {
        let end = (chunk + BATCH).min(n_chunks);
        let shoot = |k: u64| {
            let n = CHUNK.min(options.rays - k * CHUNK);
            let found = shoot_chunk(world, &seen, &tally, ways.as_ref(), n, mixed(options.seed, k));
            counter.step().map(|()| found)
        };
        let found: Vec<_> = (chunk..end).into_par_iter().map(shoot).collect::<Result<_, Cancelled>>()?;
        for Shot { sights, astray: lost, n_rays, n_followed } in found {
            findings.n_rays += n_rays;
            findings.n_followed += n_followed;
            lost.into_iter().for_each(|v| note(&mut astray, v));
            // Of several for a pair the first ray counts.
            sights.into_iter().for_each(|s| {
                hidden.entry(key(&s)).or_insert(s);
            });
        }
        chunk = end;
    }
    let suspects = suspects::most(world, table, &seen, options.pairs);
    if hidden.len() < VerifyOptions::MOST_VIOLATIONS {
        let counter = Counter::new(part(3), "aimed rays", suspects.len());
        let aim = |s: &suspects::Suspect| {
            let mut random = Random::new(mixed(options.seed, s.hash));
            let tries = if s.is_surrounded { options.tries.saturating_mul(8) } else { options.tries };
            let found = world.aim(table, s.from.0, s.target, tries, &mut random);
            counter.step().map(|()| found)
        };
        let found: Vec<_> = suspects.par_iter().map(aim).collect::<Result<_, Cancelled>>()?;
        found.into_iter().flatten().for_each(|s| {
            hidden.entry(key(&s)).or_insert(s);
        });
        let of_cells = suspects.iter().filter(|s| matches!(s.target, Target::Cell(_))).count() as u64;
        (findings.cells.aimed, findings.objects.aimed) = (of_cells, suspects.len() as u64 - of_cells);
    }
    if follow && hidden.len() < VerifyOptions::MOST_VIOLATIONS {
        let (found, sampled) = sampled::shoot(world, table, &seen, ways.as_ref(), options, part(4))?;
        findings.sampled = sampled;
        found.into_iter().for_each(|s| {
            hidden.entry(key(&s)).or_insert(s);
        });
    }
    tally.write(&seen, findings);
    findings.remarks.cells_without_places = (0..table.n_cells() as u32)
        .into_par_iter()
        .filter(|&cell| {
            let mut random = Random::new(mixed(options.seed, u64::from(cell)));
            (0..4).all(|_| world.shoot(cell, &mut random, &mut |_| {}).is_none())
        })
        .count() as u64;
    for ((from, target), sight) in hidden {
        let segment = sight.segment;
        findings.add(match target {
            Target::Cell(to) => Violation::HiddenCell { cells: [from, to], segment },
            Target::Object(object) => Violation::HiddenObject { cell: from, object, segment },
        });
    }
    astray.into_values().for_each(|violation| findings.add(violation));
    Ok(())
}

/// Looks at the borders of all cells.
fn missing_portals<R: RayOracle>(
    world: &R,
    ways: &Ways<'_>,
    n_cells: usize,
    observer: Option<&dyn Observer>,
) -> Result<Vec<Violation>, Cancelled> {
    let counter = Counter::new(observer, "borders of cells", n_cells);
    let look = |cell: u32| {
        let found = ways.missing_portal(world, CellId(cell));
        counter.step().map(|()| found)
    };
    let found: Vec<_> = (0..n_cells as u32).into_par_iter().map(look).collect::<Result<_, Cancelled>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Aims along sequences that stab trees do not have.
fn missing_sequences<R: RayOracle>(
    world: &R,
    ways: &Ways<'_>,
    absent: &[Absent],
    options: &VerifyOptions<'_>,
    observer: Option<&dyn Observer>,
) -> Result<Vec<Violation>, Cancelled> {
    let counter = Counter::new(observer, "sequences of portals", absent.len());
    let aim = |(k, absent): (usize, &Absent)| {
        let found = ways.aim(world, absent, options.tries, &mut Random::new(mixed(options.seed, k as u64)));
        counter.step().map(|()| found)
    };
    let found: Vec<_> = absent.par_iter().enumerate().map(aim).collect::<Result<_, Cancelled>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Keeps the first violation of a kind for each cell.
fn note(astray: &mut BTreeMap<(&'static str, Vec<CellId>), Violation>, violation: Violation) {
    astray.entry((violation.kind(), violation.cells())).or_insert(violation);
}

/// What some random rays found.
#[derive(Debug, Default)]
struct Shot {
    /// What they see that is hidden.
    sights: Vec<SightSegment>,
    /// Faults of the table along their ways.
    astray: Vec<Violation>,
    n_rays: u64,
    n_followed: u64,
}

/// A pair of cells, whichever of them is looked from, or of a cell and an object.
fn key(s: &SightSegment) -> (CellId, Target) {
    match s.target {
        Target::Cell(to) if to < s.from => (to, Target::Cell(s.from)),
        target => (s.from, target),
    }
}

/// Shoots some rays, and follows each through the table as far as it sees.
fn shoot_chunk<R: RayOracle>(
    world: &R,
    seen: &Seen,
    tally: &Tally,
    ways: Option<&Ways<'_>>,
    n: u64,
    seed: u64,
) -> Shot {
    let mut random = Random::new(seed);
    let mut hidden: BTreeMap<(CellId, Target), SightSegment> = BTreeMap::new();
    let mut shot = Shot::default();
    for _ in 0..n {
        let from = random.below(seen.n_cells()) as u32;
        let mut farthest: Option<(f64, SightSegment)> = None;
        let is_shot = world.shoot(from, &mut random, &mut |s: SightSegment| {
            let key = key(&s);
            if s.target == Target::Cell(s.from) {
                return;
            }
            if matches!(s.target, Target::Cell(_)) {
                let [p, q] = s.segment;
                let reach = (0..3).map(|k| (q[k] - p[k]).powi(2)).sum();
                if farthest.is_none_or(|(most, _)| reach > most) {
                    farthest = Some((reach, s));
                }
            }
            if seen.has(key.0, key.1) {
                // What was confirmed before need not be again; in which order changes nothing.
                if !tally.has(key.0, key.1) && world.proves(&s) {
                    tally.confirm(key.0, key.1);
                }
            } else if !hidden.contains_key(&key) && world.proves(&s) {
                hidden.insert(key, s);
            }
        });
        shot.n_rays += u64::from(is_shot.is_some());
        if let (Some(ways), Some((_, sight))) = (ways, farthest) {
            let (n_followed, violation) = ways.follow(world, &sight);
            shot.n_followed += n_followed;
            shot.astray.extend(violation);
        }
    }
    Shot { sights: hidden.into_values().collect(), ..shot }
}

/// A seed for a part of the work.
fn mixed(seed: u64, part: u64) -> u64 {
    Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ part).bits()
}
