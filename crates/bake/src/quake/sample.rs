//! Proofs for some of the pairs of a map, as a check of what is about to be written.

use super::VisMap;
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_sightline::Verdict;
use sightlines_stabtree::{ConvexDoubt, ConvexExplainer, ConvexVisibility, MOST_EXPLAINED, check_convex};

/// What was proven of the pairs that were picked.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct SampledProofs {
    /// Of the visible pairs that were picked.
    pub visible: ProvenPairs,
    /// Of the hidden pairs that were picked: those where one cluster is next to another that the other one sees.
    pub hidden: ProvenPairs,
}

/// Proven pairs of a kind.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct ProvenPairs {
    /// Pairs that were picked.
    pub n_picked: usize,
    /// Pairs proven as listed, with a proof that the independent checker accepts.
    pub n_accepted: usize,
    /// Pairs listed as visible but proven hidden: by a fast search, or undecided.
    pub n_loose: usize,
    /// Pairs given up because there were too many sequences of portals.
    pub n_too_many: usize,
    /// Pairs with a sequence of portals that was not decided.
    pub n_undecided: usize,
}

/// A proof about two clusters that contradicts what was found: our bug.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("clusters {} and {} are listed as {}, but {found}", pair[0], pair[1], if *listed { "visible" } else { "hidden" })]
pub struct WrongPair {
    /// The clusters.
    pub pair: [u32; 2],
    /// Whether they were found to see each other.
    pub listed: bool,
    /// What is proven, in words.
    pub found: &'static str,
}

impl VisMap {
    /// Explains `n` visible and `n` hidden pairs, the same ones each time, and checks what it finds by code that shares nothing with the search.
    ///
    /// * `fast`: whether the search was a fast one, which may list hidden pairs as visible
    /// * `report`: takes how many pairs are done, and of how many
    ///
    /// # Errors
    /// [`WrongPair`] if the map is wrong: for a hidden pair with a line, a visible one without (unless it is listed as undecided, or the search was a
    /// fast one), and proofs that do not hold.
    pub fn prove_some(
        &self,
        n: usize,
        fast: bool,
        report: impl FnMut(usize, usize),
    ) -> Result<SampledProofs, WrongPair> {
        sampled(&self.graph, &self.clusters.seen, n, fast, report)
    }
}

/// Explains `n` visible and `n` hidden pairs, the same ones each time, and checks what it finds.
fn sampled(
    graph: &CellGraph<Convex>,
    seen: &ConvexVisibility,
    n: usize,
    fast: bool,
    mut report: impl FnMut(usize, usize),
) -> Result<SampledProofs, WrongPair> {
    let explainer = ConvexExplainer::new(graph);
    let (visible, hidden) = (spread(visible_pairs(seen), n), spread(border_pairs(graph, seen), n));
    let mut certified = SampledProofs::default();
    let all = visible.len() + hidden.len();
    let pairs = visible.iter().map(|p| (p, true)).chain(hidden.iter().map(|p| (p, false)));
    for (done, (&pair, listed)) in pairs.enumerate() {
        report(done, all);
        let [a, b] = pair.map(CellId);
        let explanation = explainer.explain(a, b, MOST_EXPLAINED);
        let proven = if listed { &mut certified.visible } else { &mut certified.hidden };
        proven.n_picked += 1;
        let wrong = |found| Err(WrongPair { pair, listed, found });
        let shown = match explanation {
            Verdict::Undecided(ConvexDoubt::Limit(_)) => {
                proven.n_too_many += 1;
                continue;
            }
            Verdict::Undecided(ConvexDoubt::Chain(_)) => {
                proven.n_undecided += 1;
                continue;
            }
            Verdict::Hidden(_) => false,
            Verdict::Visible(_) => true,
        };
        match (check_convex(graph, a, b, &explanation), listed, shown) {
            (false, _, _) => return wrong("the proof that was found does not hold"),
            (true, false, true) => return wrong("a line joins them"),
            (true, true, false) if !fast && !seen.undecided.contains(&pair) => {
                return wrong("no line joins them");
            }
            (true, true, false) => proven.n_loose += 1,
            (true, _, _) => proven.n_accepted += 1,
        }
    }
    Ok(certified)
}

/// Pairs of different clusters that see each other, lower number first.
fn visible_pairs(seen: &ConvexVisibility) -> Vec<[u32; 2]> {
    let row = |a: usize| seen.cells.iter_ones(a).filter(move |&b| b > a).map(move |b| [a as u32, b as u32]);
    (0..seen.cells.n_rows()).flat_map(row).collect()
}

/// Pairs of clusters that do not see each other, though one borders on a cluster that the other sees.
fn border_pairs(graph: &CellGraph<Convex>, seen: &ConvexVisibility) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for portal in graph.portals() {
        let [c, d] = portal.cells.map(|cell| cell.0);
        for (b, beside) in [(c, d), (d, c)] {
            let sees = seen.cells.iter_ones(beside as usize).map(|a| a as u32);
            pairs.extend(sees.filter(|&a| !seen.cells.get(a as usize, b as usize)).map(|a| [a.min(b), a.max(b)]));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// `n` of the pairs, as far from each other in the list as can be.
fn spread(pairs: Vec<[u32; 2]>, n: usize) -> Vec<[u32; 2]> {
    let n = n.min(pairs.len());
    (0..n).map(|k| pairs[(2 * k + 1) * pairs.len() / (2 * n)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_formats::quake::graph_of_prt;
    use sightlines_formats::quake::prt::parse_prt;
    use sightlines_stabtree::{ConvexOptions, ConvexSearch};

    /// Three rooms in a row, of which the first and the last do not see each other, and a fourth behind the last.
    const ROOMS: &str = "PRT1\n4\n3\n4 0 1 (8 0 0) (8 1 0) (8 1 1) (8 0 1)\n4 1 2 (16 6 0) (16 7 0) (16 7 1) (16 6 1)\n\
                         4 2 3 (17 0 0) (17 1 0) (17 1 1) (17 0 1)\n";

    fn searched() -> (CellGraph<Convex>, ConvexVisibility) {
        let graph = graph_of_prt(&parse_prt(ROOMS.as_bytes()).unwrap());
        let mut search = ConvexSearch::new(&graph, ConvexOptions { fast: false, threads: 1 });
        while search.advance() {}
        (graph, search.finish())
    }

    fn tried(graph: &CellGraph<Convex>, seen: &ConvexVisibility, fast: bool) -> Result<SampledProofs, String> {
        sampled(graph, seen, 99, fast, |_, _| {}).map_err(|error| error.to_string())
    }

    #[test]
    fn tables_are_proven() {
        let (graph, seen) = searched();
        let certified = tried(&graph, &seen, false).unwrap();
        for proven in [&certified.visible, &certified.hidden] {
            assert!(proven.n_picked > 0 && proven.n_accepted == proven.n_picked, "{certified:?}");
        }
        assert_eq!(certified.visible.n_picked + certified.hidden.n_picked, 6);
    }

    /// The impostors: a table with a pair more or less is detected.
    #[test]
    fn tables_that_are_wrong_are_refused() {
        let (graph, seen) = searched();
        let (shown, hidden) = (visible_pairs(&seen), border_pairs(&graph, &seen));
        let with = |[a, b]: [u32; 2], bit: bool| {
            let mut other = seen.clone();
            other.cells.set(a as usize, b as usize, bit);
            other.cells.set(b as usize, a as usize, bit);
            other
        };
        for &pair in &hidden {
            let mut other = with(pair, true);
            let error = tried(&graph, &other, false).unwrap_err();
            assert!(error.ends_with("are listed as visible, but no line joins them"), "{error}");
            // An answer of unknown is not wrong.
            assert_eq!(tried(&graph, &other, true).unwrap().visible.n_loose, 1);
            other.undecided.push(pair);
            assert_eq!(tried(&graph, &other, false).unwrap().visible.n_loose, 1);
        }
        let mut n_refused = 0;
        for &pair in &shown {
            let other = with(pair, false);
            if border_pairs(&graph, &other).contains(&pair) {
                let error = tried(&graph, &other, false).unwrap_err();
                assert!(error.starts_with("clusters ") && error.contains("but a line joins them"), "{error}");
                n_refused += 1;
            }
        }
        assert!(!hidden.is_empty() && n_refused > 2, "{} {n_refused}", hidden.len());
    }

    #[test]
    fn picked_pairs_are_spread() {
        let pairs: Vec<[u32; 2]> = (0..10).map(|k| [k, k + 1]).collect();
        assert_eq!(spread(pairs.clone(), 2), [[2, 3], [7, 8]]);
        assert_eq!(spread(pairs.clone(), 99), pairs);
        assert!(spread(pairs, 0).is_empty() && spread(Vec::new(), 5).is_empty());
    }
}
