//! Answers about single bodies, times and paths.

use crate::body::Body;
use crate::distance::rounded_down;
use crate::relevance::Relevance;
use sightlines_geometry::Aabb;
use sightlines_pvs::bits::or_words;

/// A span of time, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// When it begins.
    pub from: f64,
    /// When it ends.
    pub to: f64,
}

/// When somebody on a path may be seen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Exposure {
    /// The spans of time in which they may be, ascending, apart from each other. Outside of these they are hidden.
    pub spans: Vec<Span>,
}

impl Exposure {
    /// An upper bound of the seconds in which they are seen.
    pub fn seconds(&self) -> f64 {
        self.spans.iter().map(|s| s.to - s.from).sum()
    }

    /// When they may first be seen; none if never.
    pub fn first(&self) -> Option<f64> {
        self.spans.first().map(|s| s.from)
    }
}

impl Relevance {
    /// Whether `a` certainly does not see `b` within their reaches, wherever in their cells they are: what reaches of cells say alone. `false` if nothing is
    /// known of one of them. O(cells that they touch).
    pub fn are_hidden_by_cells(&mut self, a: &Body, b: &Body) -> bool {
        let [mut here, mut there] = [Vec::new(), Vec::new()];
        self.boxes_in_cells(a, b, &mut here, &mut there).is_some()
            && self.world.are_hidden(&here, a.eye_reach(), a.arm != 0.0, &there, b.reach)
    }

    /// The boxes of the eyes of `a` and of what is seen of `b`, and the cells that these touch; none if nothing is known of one.
    fn boxes_in_cells(
        &mut self,
        a: &Body,
        b: &Body,
        here: &mut Vec<u32>,
        there: &mut Vec<u32>,
    ) -> Option<[Aabb<3>; 2]> {
        let boxes = [self.world.valid(&a.eyes)?, self.world.valid(&b.seen)?];
        if !a.has_lengths() || !b.has_lengths() {
            return None;
        }
        for (b, cells) in boxes.iter().zip([here, there]) {
            self.world.touching(b, &mut self.pending, cells);
            if !self.world.is_known(b, cells) {
                return None;
            }
        }
        Some(boxes)
    }

    /// Whether `a` may see `b` within their reaches; `false` is certain, as far as both stay in cells of the table. Keeps nothing.
    ///
    /// Cost: reaches, O(cells that they touch); if these do not suffice, O(cells near `a` × words of cells near `b`).
    pub fn may_see_within(&mut self, a: &Body, b: &Body) -> bool {
        let [mut here, mut there] = [Vec::new(), Vec::new()];
        let Some([eyes, seen]) = self.boxes_in_cells(a, b, &mut here, &mut there) else {
            return true;
        };
        let (world, reaches) = (&self.world, [a.eye_reach(), b.reach]);
        if world.are_hidden(&here, reaches[0], a.arm != 0.0, &there, reaches[1]) {
            return false;
        }
        world.near(&eyes, (a.arm == 0.0).then_some(&here), reaches[0], &mut self.pending, &mut self.found);
        let mut sees = vec![0; world.n_cells().div_ceil(64)];
        self.found.iter().for_each(|&cell| or_words(&mut sees, world.row(cell)));
        world.near(&seen, Some(&there), reaches[1], &mut self.pending, &mut self.found);
        self.found.iter().any(|&cell| sees[cell as usize / 64] >> (cell % 64) & 1 == 1)
    }

    /// A lower bound of the seconds until `a` may see `b`, if they move no faster than these speeds (scene units a second) and have no reach but
    /// that; the arm of `a` counts. 0 if they may see each other now, or if nothing is known; infinite if never, which is so only if both hold still.
    ///
    /// The nearest of all pairs of cells that see each other counts, each by how long the slower of the two takes to get there; and the reaches. O(n log n + n² / 64).
    pub fn time_to_sight(&mut self, a: &Body, b: &Body, speeds: [f64; 2]) -> f64 {
        let still = |body: &Body| Body { reach: 0.0, ..*body };
        if speeds.iter().any(|v| v.is_nan() || *v < 0.0) || self.may_see_within(&still(a), &still(b)) {
            return 0.0;
        }
        let straight = self.straight_time(a, b, speeds);
        // A rung holds for all places in both cells; on ways through portals it says more than the straight distance.
        let slower_than = |reach: f64| rounded_down(rounded_down(reach) - a.arm) / speeds[0].max(speeds[1]);
        let [mut here, mut there] = [Vec::new(), Vec::new()];
        if self.boxes_in_cells(&still(a), &still(b), &mut here, &mut there).is_none() {
            return 0.0;
        }
        let is_hidden = |reach: f64| {
            self.world.are_hidden(&here, reach, a.arm != 0.0, &there, if speeds[1] == 0.0 { 0.0 } else { reach })
        };
        let by_rungs = self.reaches().ladder().iter().rev().find(|&&reach| is_hidden(reach));
        by_rungs.map_or(straight, |&reach| straight.max(slower_than(reach)))
    }

    fn straight_time(&self, a: &Body, b: &Body, speeds: [f64; 2]) -> f64 {
        // No sooner than this, rounded down.
        let time =
            |far: f64, speed: f64| if far <= 0.0 { 0.0 } else { far / speed * (1.0 - 1.0 / (1u64 << 40) as f64) };
        let n = self.world.n_cells() as u32;
        let times = |b: &Aabb<3>, arm: f64, speed: f64| {
            let mut times: Vec<(f64, u32)> =
                (0..n).map(|cell| (time(rounded_down(self.world.far(b, cell)) - arm, speed), cell)).collect();
            times.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
            times
        };
        let (Some(eyes), Some(seen)) = (self.world.valid(&a.eyes), self.world.valid(&b.seen)) else {
            return 0.0;
        };
        let (eyes, seen) = (times(&eyes, a.arm, speeds[0]), times(&seen, 0.0, speeds[1]));
        let words = (n as usize).div_ceil(64);
        let (mut visible, mut there) = (vec![0; words], vec![0; words]);
        let (mut i, mut j) = (0, 0);
        // Cells come in by time, of both; the first that sees one of the other's ends it.
        while i < eyes.len() || j < seen.len() {
            let takes_eye = j == seen.len() || i < eyes.len() && eyes[i].0 <= seen[j].0;
            let (at, cell) = if takes_eye { eyes[i] } else { seen[j] };
            if at.is_infinite() {
                break;
            }
            let meet = if takes_eye {
                i += 1;
                or_words(&mut visible, self.world.row(cell));
                self.world.row(cell).iter().zip(&there).any(|(row, there): (&u64, &u64)| row & there != 0)
            } else {
                j += 1;
                there[cell as usize / 64] |= 1 << (cell % 64);
                visible[cell as usize / 64] >> (cell % 64) & 1 == 1
            };
            if meet {
                return at;
            }
        }
        f64::INFINITY
    }

    /// For each object of the table a lower bound of the seconds until `a` may see it, at a speed (scene units a second): by when it has to be there. 0 for all if
    /// nothing is known of where the body is; infinite for what is seen from nowhere. O(n log n + objects seen).
    pub fn deadlines(&mut self, a: &Body, speed: f64) -> Vec<f64> {
        let table = self.table().clone();
        let unknown = vec![0.0; table.objects().len()];
        let Some(eyes) = self.world.valid(&a.eyes) else {
            return unknown;
        };
        self.world.touching(&eyes, &mut self.pending, &mut self.found);
        if speed.is_nan() || speed < 0.0 || !a.has_lengths() || !self.world.is_known(&eyes, &self.found) {
            return unknown;
        }
        let mut cells: Vec<(f64, u32)> = (0..self.world.n_cells() as u32)
            .map(|cell| (rounded_down(self.world.far(&eyes, cell)) - a.arm, cell))
            .collect();
        cells.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut deadlines = vec![f64::INFINITY; table.objects().len()];
        for (far, cell) in cells {
            let at = if far <= 0.0 { 0.0 } else { rounded_down(far / speed) };
            for object in table.visible_objects(sightlines_pvs::CellId(cell)) {
                let known = &mut deadlines[object.idx()];
                *known = known.min(at);
            }
        }
        deadlines
    }

    /// When somebody on a path may be seen by somebody who watches.
    ///
    /// * `path`: times in seconds, ascending, with the box of what is seen of them then; between two they are in the box around both
    /// * `watchers`: their reach is not used
    /// * `speed`: how fast watchers may move from the first time on, scene units a second
    pub fn exposure(&mut self, path: &[(f64, Aabb<3>)], watchers: &[Body], speed: f64) -> Exposure {
        let mut exposure = Exposure::default();
        // A path of one place is a moment.
        let legs = path.windows(2).map(|leg| [leg[0], leg[1]]).chain((path.len() == 1).then(|| [path[0]; 2]));
        for [(from, start), (to, end)] in legs {
            let moved = speed * (to - path[0].0);
            let is_known = self.world.valid(&start).is_some() && self.world.valid(&end).is_some();
            let there = Body::new(start.united(end), start.united(end));
            let sees = |w: &Body, told: &mut Self| told.may_see_within(&Body { reach: moved, ..*w }, &there);
            if !watchers.is_empty() && (!is_known || watchers.iter().any(|w| sees(w, self))) {
                match exposure.spans.last_mut() {
                    Some(last) if last.to == from => last.to = to,
                    _ => exposure.spans.push(Span { from, to }),
                }
            }
        }
        exposure
    }
}
