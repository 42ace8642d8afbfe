//! Shortest paths through the graph, by length and by turns.

use crate::bytes::fits_values;
use crate::functions::{quarter_turns, quarter_turns_at_least};
use crate::work::Stage;
use crate::{Points, Run, VisibilityGraph, WorkOptions};
use sightlines_progress::Halt;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Points of a unit of work: each is a search through the graph.
const UNIT: usize = 64;

/// At which points a path may turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Turns {
    /// At those whose pixel, or one of the eight around it, touches a wall, as in depthmapX. Paths may be a little longer than the shortest
    /// ones of the graph. Points that are of no grid all count as such.
    #[default]
    NearWalls,
    /// At any point: the shortest paths of the graph.
    Anywhere,
}

impl Turns {
    /// Both.
    pub const ALL: [Self; 2] = [Self::NearWalls, Self::Anywhere];

    /// Its name: `near-walls`, `anywhere`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NearWalls => "near-walls",
            Self::Anywhere => "anywhere",
        }
    }
}

/// Metric measures of all points, a value for each point in every list; means over all points reached, the point itself among them.
///
/// # Source
/// Turner 2007 (metric depth in visibility graphs); definitions are those of depthmapX, `VGAMetric::run`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MetricMeasures {
    /// Points reached, the point itself among them.
    pub node_count: Vec<u32>,
    /// Mean length of the shortest paths, in scene units.
    pub mean_path_length: Vec<f64>,
    /// Mean sum of the turns of these paths, in right angles. Of paths equally long, that found first counts: that of the point before the
    /// end that is nearest, then lowest in number.
    pub mean_path_angle: Vec<f64>,
    /// Mean straight-line distance, in scene units.
    pub mean_straight_distance: Vec<f64>,
}

/// Angular measures of all points, a value for each point in every list; means over all points reached, the point itself among them.
///
/// The depth of a point is the sum of the turns, in right angles, along a path that was made longer point by point where it turned least:
/// each point keeps one path, so that a path that turns less may be missed.
///
/// # Source
/// Definitions are those of depthmapX, `VGAAngular::run`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AngularMeasures {
    /// Points reached, the point itself among them.
    pub node_count: Vec<u32>,
    /// Sum of all depths.
    pub total_depth: Vec<f64>,
    /// Mean depth.
    pub mean_depth: Vec<f64>,
}

impl MetricMeasures {
    /// Computes the metric measures.
    ///
    /// * `radius`: the longest paths that count, in scene units; `None` for any
    ///
    /// # Errors
    /// [`Halt`] by the observer, or by the store of units.
    ///
    /// # Panics
    /// If the points are not as many as those of the graph.
    ///
    /// # Cost
    /// Dijkstra's algorithm for each point, on all threads: for each at most O(points seen by all points at which paths may turn). Square
    /// roots and own angles only: the same bits everywhere.
    pub fn of(
        graph: &VisibilityGraph,
        points: &Points,
        turns: Turns,
        radius: Option<f64>,
        effort: &WorkOptions<'_>,
    ) -> Result<Self, Halt> {
        assert_eq!(graph.n_points(), points.len(), "one row for each point");
        let radius = radius.map_or(f64::INFINITY, |radius| radius / points.unit());
        let one = |room: &mut Room, point: usize| {
            let point = point as u32;
            let (mut n, mut length, mut angle, mut straight) = (0u32, 0.0, 0.0, 0.0);
            room.begin(point);
            while let Some((cost, at, before)) = room.pop(radius) {
                n += 1;
                length += cost;
                angle += room.angles[at as usize];
                straight += points.distance(point, at);
                if at == point || turns == Turns::Anywhere || points.is_near_wall(at) {
                    room.each_open(graph.row(at), |room, next| {
                        let ([x, y], open) = (points.offset(at, next), room.costs[next as usize]);
                        let square = x * x + y * y;
                        // Most are no improvement. If the square root is at least the gap and a few roundings, the sum below is not less than
                        // what it is compared with, and need not be computed.
                        let gap = (open - cost) * (1.0 + 4.0 * f64::EPSILON);
                        if square >= gap * gap * (1.0 + 4.0 * f64::EPSILON) {
                            return;
                        }
                        let reached = cost + square.sqrt();
                        if reached < open {
                            room.angles[next as usize] = room.angles[at as usize] + turn(points, before, at, next);
                            room.push(reached, next, at);
                        }
                    });
                    if at == point {
                        room.close(graph.row(at));
                    }
                }
            }
            let mean = |sum: f64| sum / f64::from(n);
            Ok::<_, Halt>((n, [mean(length) * points.unit(), mean(angle), mean(straight) * points.unit()]))
        };
        let (cost, fits) = (&|_| 1.0, &|row: &_, _| fits_values(row, points.len()));
        let stage = Stage { title: "metric depths", phase: "metric-paths", size: UNIT, cost, fits };
        let rows = effort.each(&stage, points.len(), || Room::new(points.len()), one)?;
        let column = |k: usize| rows.iter().map(|(_, values)| values[k]).collect();
        Ok(Self {
            node_count: rows.iter().map(|&(n, _)| n).collect(),
            mean_path_length: column(0),
            mean_path_angle: column(1),
            mean_straight_distance: column(2),
        })
    }
}

impl AngularMeasures {
    /// Computes the angular measures.
    ///
    /// * `radius`: the largest depth that counts, in right angles; `None` for any
    ///
    /// # Errors
    /// [`Halt`] by the observer, or by the store of units.
    ///
    /// # Panics
    /// If the points are not as many as those of the graph.
    ///
    /// # Cost
    /// As [`MetricMeasures::of`]; from all points that are seen directly paths go on, too.
    pub fn of(
        graph: &VisibilityGraph,
        points: &Points,
        turns: Turns,
        radius: Option<f64>,
        effort: &WorkOptions<'_>,
    ) -> Result<Self, Halt> {
        assert_eq!(graph.n_points(), points.len(), "one row for each point");
        let radius = radius.unwrap_or(f64::INFINITY);
        let one = |room: &mut Room, point: usize| {
            let point = point as u32;
            let (mut n, mut total) = (0u32, 0.0);
            room.begin(point);
            while let Some((cost, at, before)) = room.pop(radius) {
                n += 1;
                total += cost;
                if cost == 0.0 || turns == Turns::Anywhere || points.is_near_wall(at) {
                    room.each_open(graph.row(at), |room, next| {
                        let open = room.costs[next as usize];
                        if open <= cost || !may_turn_less(points, before, at, next, open - cost) {
                            return;
                        }
                        let reached = cost + turn(points, before, at, next);
                        if reached < open {
                            room.push(reached, next, at);
                        }
                    });
                    if at == point {
                        room.close(graph.row(at));
                    }
                }
            }
            Ok::<_, Halt>((n, [total]))
        };
        let (cost, fits) = (&|_| 1.0, &|row: &_, _| fits_values(row, points.len()));
        let stage = Stage { title: "angular depths", phase: "angular-paths", size: UNIT, cost, fits };
        let rows = effort.each(&stage, points.len(), || Room::new(points.len()), one)?;
        Ok(Self {
            node_count: rows.iter().map(|&(n, _)| n).collect(),
            total_depth: rows.iter().map(|&(_, [total])| total).collect(),
            mean_depth: rows.iter().map(|&(n, [total])| total / f64::from(n)).collect(),
        })
    }
}

/// The turn of a path at a point, in right angles; 0 at its first point.
fn turn(points: &Points, before: u32, at: u32, next: u32) -> f64 {
    if before == NOTHING {
        return 0.0;
    }
    let ([a, b], [c, d]) = (points.offset(before, at), points.offset(at, next));
    quarter_turns(a * c + b * d, a * d - b * c)
}

/// Whether the turn may be less than `most`; false only if it is not.
fn may_turn_less(points: &Points, before: u32, at: u32, next: u32, most: f64) -> bool {
    if before == NOTHING {
        return true;
    }
    let ([a, b], [c, d]) = (points.offset(before, at), points.offset(at, next));
    quarter_turns_at_least(a * c + b * d, a * d - b * c) < most
}

/// No point.
const NOTHING: u32 = u32::MAX;

/// Memory of a thread, and the state of one search.
struct Room {
    /// The least cost found.
    costs: Vec<f64>,
    angles: Vec<f64>,
    /// Bits of points to which no better path leads: those that are settled, and those that are seen from the first.
    closed: Vec<u64>,
    settled: Vec<bool>,
    /// Cost, point and the point before it. Costs are not negative, so their bits are in their order.
    open: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl Room {
    fn new(n: usize) -> Self {
        Self {
            costs: vec![0.0; n],
            angles: vec![0.0; n],
            closed: vec![0; n.div_ceil(64)],
            settled: vec![false; n],
            open: BinaryHeap::new(),
        }
    }

    fn begin(&mut self, point: u32) {
        self.costs.fill(f64::INFINITY);
        self.angles.fill(0.0);
        self.closed.fill(0);
        self.settled.fill(false);
        self.open.clear();
        self.push(0.0, point, NOTHING);
    }

    fn push(&mut self, cost: f64, point: u32, before: u32) {
        self.costs[point as usize] = cost;
        self.open.push(Reverse((cost.to_bits(), point, before)));
    }

    /// Calls `each` for all points of a row that are not closed.
    fn each_open(&mut self, row: &[Run], mut each: impl FnMut(&mut Self, u32)) {
        for &run in row {
            for (word, bits) in words(run) {
                let mut rest = bits & !self.closed[word];
                while rest != 0 {
                    each(self, 64 * word as u32 + rest.trailing_zeros());
                    rest &= rest - 1;
                }
            }
        }
    }

    fn close(&mut self, row: &[Run]) {
        for &run in row {
            words(run).for_each(|(word, bits)| self.closed[word] |= bits);
        }
    }

    /// Settles the next point, of least cost and then lowest number, up to a cost.
    fn pop(&mut self, most: f64) -> Option<(f64, u32, u32)> {
        while let Some(Reverse((bits, point, before))) = self.open.pop() {
            let cost = f64::from_bits(bits);
            if cost > most {
                return None;
            }
            if !std::mem::replace(&mut self.settled[point as usize], true) {
                self.close(&[Run { start: point, end: point + 1 }]);
                return Some((cost, point, before));
            }
        }
        None
    }
}

/// The words of bits in which a run lies, each with the bits of the run.
fn words(Run { start, end }: Run) -> impl Iterator<Item = (usize, u64)> {
    let last = (end - 1) / 64;
    (start / 64..=last).map(move |word| {
        let below = if word == start / 64 { !0 << (start % 64) } else { !0 };
        let above = if word == last { !0 >> (63 - (end - 1) % 64) } else { !0 };
        (word as usize, below & above)
    })
}
