//! Global measures: how many steps all other points are away.

use crate::functions::log2;
use crate::search::{WIDTH, depths};
use crate::{UNDEFINED, VisibilityGraph, WorkOptions};
use sightlines_progress::Halt;

/// Global measures of all points, a value for each point in every list. A step leads from a point to one that it sees; depth is the
/// smallest number of steps. What cannot be reached does not count.
///
/// With n the points reached within the radius, the point itself included, and D the sum of their depths:
///
/// # Source
/// Hillier and Hanson 1984 (mean depth, relative asymmetry and its normalization by a diamond-shaped graph); Krüger 1989, after
/// Teklenburg, Timmermans and van Wagenberg 1993 (the formula of the diamond); Teklenburg et al. (the logarithmic form); Turner 2001
/// (entropy and relativised entropy). Corner cases are those of depthmapX, `VGAVisualGlobal::run` and `dvalue`, `pvalue`, `teklinteg` in
/// genlib/pafmath.h.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GlobalMeasures {
    /// n.
    pub node_count: Vec<u32>,
    /// D, which depthmapX keeps to itself.
    pub total_depth: Vec<u64>,
    /// Mean depth: D / (n - 1). [`UNDEFINED`] for n = 1, as everything below.
    pub mean_depth: Vec<f64>,
    /// Integration \[HH\]: the D-value over the relative asymmetry 2 (MD - 1) / (n - 2), where the D-value is
    /// 2 (n (log2((n + 2) / 3) - 1) + 1) / ((n - 1) (n - 2)). [`UNDEFINED`] for n < 3 and where the mean depth is 1, as the next two are.
    pub integration_hh: Vec<f64>,
    /// Integration \[Tekl\]: log(n / 2 - 1) / log(D - n + 1). [`UNDEFINED`] also where D - n + 1 is at most 1.
    pub integration_tekl: Vec<f64>,
    /// Integration \[P-value\]: as \[HH\], with 2 (n - log2 n - 1) / ((n - 1) (n - 2)) in place of the D-value.
    pub integration_p: Vec<f64>,
    /// Entropy: sum of -p log2 p over the depths k from 1 on, where p is the share of depth k among the n - 1 other points.
    pub entropy: Vec<f64>,
    /// Relativised entropy: sum of p log2(p / q), with q = MD^k exp(-MD) / (k + 1)!. The factorial is that of depthmapX; Turner 2001 has
    /// k! there.
    pub relativised_entropy: Vec<f64>,
}

impl GlobalMeasures {
    /// Computes the global measures.
    ///
    /// * `radius`: the most steps that count; `None` for any number
    ///
    /// # Errors
    /// [`Halt`] by the observer, or by the store of units.
    ///
    /// # Cost
    /// O(depth · runs) for every 256 points, on all threads, and 32 · 10 bytes for each point and thread. No libm: the same bits everywhere.
    pub fn of(graph: &VisibilityGraph, radius: Option<u32>, effort: &WorkOptions<'_>) -> Result<Self, Halt> {
        let n = graph.n_points();
        let of_point = depths(graph, radius, effort)?;
        let mut all = Self::default();
        let mut counts = Vec::new();
        for point in 0..n {
            counts.clear();
            of_point[point / WIDTH].of(point % WIDTH, &mut counts);
            all.push(&counts);
        }
        Ok(all)
    }

    /// Adds a point from the numbers of points at each depth, 1 at depth 0.
    fn push(&mut self, counts: &[u32]) {
        let n: u32 = counts.iter().sum();
        let total: u64 = counts.iter().zip(0u64..).map(|(&count, depth)| u64::from(count) * depth).sum();
        let row = row(n, total, counts);
        self.node_count.push(n);
        self.total_depth.push(total);
        let columns = [
            &mut self.mean_depth,
            &mut self.integration_hh,
            &mut self.integration_tekl,
            &mut self.integration_p,
            &mut self.entropy,
            &mut self.relativised_entropy,
        ];
        columns.into_iter().zip(row).for_each(|(column, value)| column.push(value));
    }
}

/// The values of a point in the order of the fields, from the mean depth on.
fn row(n: u32, total: u64, counts: &[u32]) -> [f64; 6] {
    if n < 2 {
        return [UNDEFINED; 6];
    }
    let (x, others) = (f64::from(n), f64::from(n - 1));
    let mean = total as f64 / others;
    let [mut hh, mut tekl, mut p] = [UNDEFINED; 3];
    if n > 2 && total > u64::from(n - 1) {
        let asymmetry = 2.0 * (mean - 1.0) / (x - 2.0);
        let pairs = others * (x - 2.0);
        hh = 2.0 * (x * (log2((x + 2.0) / 3.0) - 1.0) + 1.0) / pairs / asymmetry;
        p = 2.0 * (x - log2(x) - 1.0) / pairs / asymmetry;
        let beyond = total - u64::from(n - 1);
        if beyond > 1 {
            tekl = log2(0.5 * (x - 2.0)) / log2(beyond as f64);
        }
    }
    let (mut entropy, mut relative, mut log_factorial) = (0.0, 0.0, 0.0);
    let log_mean = log2(mean);
    for (depth, &count) in counts.iter().enumerate().skip(1) {
        log_factorial += log2(depth as f64 + 1.0);
        if count > 0 {
            let share = f64::from(count) / others;
            let log_share = log2(share);
            entropy -= share * log_share;
            let log_q = depth as f64 * log_mean - log_factorial - mean * std::f64::consts::LOG2_E;
            relative += share * (log_share - log_q);
        }
    }
    [mean, hh, tekl, p, entropy, relative]
}
