//! Lines of sight for the pairs of a table: few lines, each of which passes through many cells.
//!
//! A line through portals shows not only that its first cell sees its last, but the same of any two cells that it passes. So far pairs
//! are asked first, and what their lines pass is not asked again: in buildings one pair in six or seven has to be, in plans of small rooms every
//! second.

#[cfg(feature = "viewer")]
mod page;

pub use crate::explain::SightLine;

use crate::explain::{Answer, ExplainOptions, Explainer, Reason};
use rayon::prelude::*;
use sightlines_cells::{CellId, PortalId};
use sightlines_geometry::Aabb;
use sightlines_progress::{Cancelled, Observer, Progress};
use sightlines_pvs::Table;
use std::collections::HashSet;

/// Why no line joins two cells.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// No chain of portals leads from one to the other.
    NotConnected,
    /// Every chain is stopped; the first place where one is: portals that no line passes in this order.
    Portals(Vec<PortalId>),
    /// Every line meets one of these walls, the most important first.
    Walls(Vec<Aabb<3>>),
}

/// Two cells that do not see each other.
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenPair {
    /// The cells, the lower number first.
    pub cells: [CellId; 2],
    /// Why.
    pub obstacle: Obstacle,
}

/// How much is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineOptions {
    /// The most visible pairs that are asked for.
    pub max_lines: usize,
    /// The most hidden pairs that are asked for: the nearest of those of which one cell adjoins what the other sees.
    pub max_hidden: usize,
}

impl Default for LineOptions {
    fn default() -> Self {
        Self { max_lines: 20_000, max_hidden: 5_000 }
    }
}

/// Lines of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lines {
    /// The lines, in the order in which they were found; with ends in the first portal and the last where the cells have none in doubles.
    pub lines: Vec<SightLine>,
    /// Hidden pairs that were asked for, with the reason.
    pub hidden: Vec<HiddenPair>,
    /// Visible pairs of two different cells.
    pub n_pairs: usize,
    /// Those that some line joins.
    pub n_joined: usize,
}

/// A pair of cells, the lower number first.
type Pair = [u32; 2];

/// Finds lines for the visible pairs of a table, and reasons for hidden ones; `None` for a table without portals. The observer is told how far
/// it is, and may cancel. Each answer is
/// that of the engine that explains the pair alone.
///
/// The same for any number of threads. A tenth to a third of a millisecond for each pair that is asked, on one thread.
///
/// # Errors
/// [`Cancelled`] if the observer says so.
pub fn lines(table: &Table, options: LineOptions, observer: Option<&dyn Observer>) -> Result<Option<Lines>, Cancelled> {
    let Some(graph) = crate::from_table::graph(table) else { return Ok(None) };
    let Some(explainer) = Explainer::new(&graph) else { return Ok(None) };
    let n_pairs = n_visible_pairs(table);
    let step = n_pairs.div_ceil(MOST_PAIRS).max(1);
    let mut visible = visible_pairs(table, step);
    let mut found = Lines { n_pairs, ..Lines::default() };
    let hidden = nearest_hidden(table, options.max_hidden, step);
    visible.sort_by(|a, b| distance(table, *b).total_cmp(&distance(table, *a)).then(a.cmp(b)));
    let mut joined = HashSet::new();
    let (mut at, mut n_asked) = (0, 0);
    let total = visible.len() + hidden.len();
    while at < visible.len() && n_asked < options.max_lines {
        tell(observer, at, total)?;
        let mut chunk = Vec::new();
        while at < visible.len() && chunk.len() < CHUNK.min(options.max_lines - n_asked) {
            if !joined.contains(&visible[at]) {
                chunk.push(visible[at]);
            }
            at += 1;
        }
        n_asked += chunk.len();
        let answers: Vec<_> = chunk.par_iter().map(|pair| line(&explainer, *pair)).collect();
        for (pair, line) in chunk.iter().zip(answers) {
            // Another pair of the same chunk may have found the way.
            if let Some(line) = line.filter(|_| !joined.contains(pair)) {
                joined.extend(pairs_along(&line));
                found.lines.push(line);
            }
        }
    }
    for (k, chunk) in hidden.chunks(CHUNK).enumerate() {
        tell(observer, visible.len() + k * CHUNK, total)?;
        let answers: Vec<_> = chunk.par_iter().map(|pair| obstacle(&explainer, *pair)).collect();
        let pairs = chunk.iter().zip(answers).filter_map(|(pair, obstacle)| Some((pair, obstacle?)));
        found.hidden.extend(pairs.map(|(pair, obstacle)| HiddenPair { cells: pair.map(CellId), obstacle }));
    }
    found.n_joined = joined.iter().filter(|[a, b]| table.sees(CellId(*a), CellId(*b))).count();
    Ok(Some(found))
}

/// Less than where one pair is asked for alone.
const OPTIONS: ExplainOptions = ExplainOptions {
    max_visits: 100_000,
    max_programs: 2_000,
    max_questions: 1_000,
    n_rays: 0,
    max_blocked: 1,
    check: false,
};

/// The most walls that are named.
const MAX_WALLS: usize = 12;

fn line(explainer: &Explainer<'_>, pair: Pair) -> Option<SightLine> {
    match explainer.explain(pair.map(CellId), &OPTIONS).answer {
        // Without points in the cells, those in the first and the last portal.
        Answer::Visible(line, exact) => Some(SightLine { ends: line.ends.or_else(|| exact.outer_crossings()), ..line }),
        _ => None,
    }
}

fn obstacle(explainer: &Explainer<'_>, pair: Pair) -> Option<Obstacle> {
    match explainer.explain(pair.map(CellId), &OPTIONS).answer {
        Answer::Hidden(Reason::NotConnected) => Some(Obstacle::NotConnected),
        Answer::Hidden(Reason::Blocked { blocked, .. }) => {
            blocked.into_iter().next().map(|first| Obstacle::Portals(first.way.portals))
        }
        Answer::Hidden(Reason::Walls(found)) => {
            Some(Obstacle::Walls(found.most_important().iter().take(MAX_WALLS).map(|(wall, _)| *wall).collect()))
        }
        _ => None,
    }
}

/// Pairs that are asked at once.
const CHUNK: usize = 64;

/// Of more pairs than these, only those of every second cell are thought of, or of fewer: a list of pairs takes eight bytes for each.
const MOST_PAIRS: usize = 16_000_000;

fn tell(observer: Option<&dyn Observer>, done: usize, total: usize) -> Result<(), Cancelled> {
    let report =
        |observer: &dyn Observer| observer.report(Progress::new("lines", done as u64, total as u64)).is_break();
    if observer.is_some_and(report) { Err(Cancelled) } else { Ok(()) }
}

fn ordered(a: CellId, b: CellId) -> Pair {
    [a.0.min(b.0), a.0.max(b.0)]
}

fn n_visible_pairs(table: &Table) -> usize {
    (0..).take(table.n_cells()).map(CellId).map(|a| table.visible(a).filter(|b| a < *b).count()).sum()
}

/// Those of every `step`-th cell.
fn visible_pairs(table: &Table, step: usize) -> Vec<Pair> {
    let cells = (0..).take(table.n_cells()).step_by(step).map(CellId);
    cells.flat_map(|a| table.visible(a).filter(move |b| a < *b).map(move |b| ordered(a, b))).collect()
}

/// All pairs of cells that a line passes.
fn pairs_along(line: &SightLine) -> impl Iterator<Item = Pair> {
    let ahead = line.cells.iter().enumerate().flat_map(|(k, a)| line.cells[k + 1..].iter().map(move |b| (a, b)));
    ahead.map(|(a, b)| ordered(*a, *b))
}

/// The squared distance of the middles of two cells. Only the order of what is asked depends on it.
fn distance(table: &Table, [a, b]: Pair) -> f64 {
    let middle = |cell: u32, k: usize| {
        let cell = &table.cells()[cell as usize];
        0.5 * (cell.min[k] + cell.max[k])
    };
    (0..3).map(|k| middle(a, k) - middle(b, k)).map(|x| x * x).sum()
}

/// The nearest pairs that do not see each other, though one adjoins what the other sees, of every `step`-th cell.
fn nearest_hidden(table: &Table, most: usize, step: usize) -> Vec<Pair> {
    if most == 0 {
        return Vec::new();
    }
    let mut neighbours = vec![Vec::new(); table.n_cells()];
    for portal in table.portals() {
        let [a, b] = portal.cells;
        neighbours[a.idx()].push(b);
        neighbours[b.idx()].push(a);
    }
    let mut pairs: Vec<(f64, Pair)> = Vec::new();
    for a in (0..).take(table.n_cells()).step_by(step).map(CellId) {
        let beside: HashSet<CellId> = table.visible(a).flat_map(|b| neighbours[b.idx()].iter().copied()).collect();
        let hidden = beside.into_iter().filter(|b| !table.sees(a, *b)).map(|b| ordered(a, b));
        pairs.extend(hidden.map(|pair| (distance(table, pair), pair)));
        // Now and then only the nearest are kept, so that memory stays small; each pair may occur twice.
        if pairs.len() > 8 * most.max(1_000) {
            keep_nearest(&mut pairs, most);
        }
    }
    keep_nearest(&mut pairs, most);
    pairs.into_iter().map(|(_, pair)| pair).collect()
}

fn keep_nearest(pairs: &mut Vec<(f64, Pair)>, most: usize) {
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    pairs.dedup_by_key(|(_, pair)| *pair);
    pairs.truncate(most);
}
