//! The search of a [`Shaft`] with a record of what it finds: slower, with a proof as the result.

use super::super::octant::{Decision, SMALL_FIRST, decide, decide_in_doubles};
use super::super::rows::{Row, first_and_last, others};
use super::certificate::{BlockedProof, Branch, BranchRow, Bypass, Contradiction};
use super::cuts::{BypassRows, Ends};
use super::ray::Ray;
use super::{BoxTarget, CLEAR_MARGIN, Closer, DEEPEST, Frame, Next, Shaft, Tableau};
use sightlines_geometry::Aabb;

impl Shaft<'_> {
    /// Proves that no open set of lines leads from inside of `from` to `to` without meeting a rectangle in
    /// between; arguments as for [`Shaft::decide`]. Rectangles are named by their indices among the
    /// [`Blockers`](super::Blockers).
    ///
    /// `None` if some do, or if the budget does not suffice. What [`Shaft::decide`] finds blocked with some budget is
    /// proven with the same budget. Slower: every contradiction is expressed in integers, small ones first.
    pub fn certify(&mut self, from: &Aabb<3>, to: &Aabb<3>, target: BoxTarget, budget: u32) -> Option<BlockedProof> {
        self.left = budget;
        self.middle_blockers(from, to, target);
        let guesses = std::mem::take(&mut self.hits);
        let mut octants = Vec::new();
        for octant in 0..8u8 {
            let ends = Ends { from, to, target, octant };
            if !ends.are_in_order() {
                continue;
            }
            let guess = guesses.iter().copied().find(|&g| self.covers(&ends, g));
            let branch = Recorder::new(self, ends).branch(guess)?;
            octants.push(([0, 1, 2].map(|axis| octant >> axis & 1 == 1), branch));
        }
        Some(BlockedProof { octants })
    }
}

/// The search of one octant.
struct Recorder<'s, 'a, 'e> {
    shaft: &'s mut Shaft<'a>,
    ends: Ends<'e>,
    frame: Frame,
    /// The names of the current rows.
    names: Vec<BranchRow>,
}

impl<'s, 'a, 'e> Recorder<'s, 'a, 'e> {
    fn new(shaft: &'s mut Shaft<'a>, ends: Ends<'e>) -> Self {
        let rows: Vec<Row> = ends.rows().collect();
        let per_box = rows.len() / 2;
        let name = |(n, row): (usize, &Row)| BranchRow::End {
            second: n >= per_box,
            early: row.early as u8,
            late: row.late as u8,
        };
        let names = rows.iter().enumerate().map(name).collect();
        let frame = Frame::around(&rows, ends.octant);
        shaft.unit.clear();
        shaft.unit.extend(rows.iter().map(|row| frame.scaled(row)));
        shaft.rows = rows;
        shaft.passed.clear();
        Self { shaft, ends, frame, names }
    }

    /// The proof of the whole octant; `covering` is a rectangle that no way leads past, if one is known.
    fn branch(&mut self, covering: Option<u32>) -> Option<Branch> {
        match covering {
            Some(rectangle) => {
                let ways: Option<_> = self.impossible(rectangle).into_iter().map(|(w, b)| Some((w, b?))).collect();
                Some(Branch::Past { rectangle, ways: ways?, rest: None })
            }
            None => self.search(Tableau::bounded()),
        }
    }

    /// Why there are no lines of the current rows.
    fn contradiction(&mut self) -> Option<Contradiction> {
        match decide(&self.shaft.rows, self.ends.octant, SMALL_FIRST, &mut self.shaft.scratch).0 {
            Decision::Blocked(proof) => Some(named(&proof.terms(), &self.names)),
            Decision::Line(_) | Decision::Fractions(_) => None,
        }
    }

    fn search(&mut self, mut tableau: Tableau) -> Option<Branch> {
        if self.shaft.left == 0 || self.shaft.passed.len() > DEEPEST {
            return None;
        }
        self.shaft.left -= 1;
        self.shaft.counters.n_programs += 1;
        let mut y = tableau.improve(&self.shaft.unit);
        if y[5] <= CLEAR_MARGIN {
            let (octant, scratch) = (self.ends.octant, &mut self.shaft.scratch);
            if let Ok(Decision::Blocked(proof)) = decide_in_doubles(&self.shaft.rows, octant, SMALL_FIRST, scratch) {
                return Some(Branch::Empty(named(&proof.terms(), &self.names)));
            }
            y = Tableau::new([true; 3]).improve(&self.shaft.unit);
        }
        let mut ray = Ray::new(self.frame.starts_and_paces(&y))?;
        let mut fine = None;
        let mut blocker = self.shaft.ahead(&self.ends, &ray);
        if blocker.is_none() && y[5] <= CLEAR_MARGIN {
            match self.shaft.look_closer(self.ends.octant, SMALL_FIRST) {
                Some(Closer::Blocked(proof)) => return Some(Branch::Empty(named(&proof.terms(), &self.names))),
                Some(Closer::Open(found, line)) => (ray, fine) = (found, line),
                // What two doubles do not settle, fractions do.
                None => return self.contradiction().map(Branch::Empty),
            }
            blocker = self.shaft.ahead(&self.ends, &ray);
        }
        let next = blocker.map_or_else(|| self.shaft.free_line(&self.ends, &ray, fine), Next::Past);
        let Next::Past(blocker) = next else { return None };
        let before = self.names.len();
        let branch = self.past(tableau, blocker, &ray);
        self.truncate(before);
        branch
    }

    fn past(&mut self, tableau: Tableau, rectangle: u32, ray: &Ray) -> Option<Branch> {
        let depth = self.shaft.passed.len();
        let mut done: Vec<(Bypass, Branch)> = Vec::new();
        for (way, branch) in self.impossible(rectangle) {
            done.push((way, branch?));
        }
        let axis = self.shaft.blockers.axis(rectangle);
        let mut ways: Vec<(f64, BypassRows)> = Vec::with_capacity(6);
        self.ends.ways_past(self.shaft.blockers.rectangle(rectangle), axis, |way| {
            let late = |row: &Row| ray.time(row.early, row.from) - ray.time(row.late, row.to);
            ways.push((way.rows().iter().map(late).fold(f64::NEG_INFINITY, f64::max), way));
        });
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, way) in ways {
            let (name, own) = (name_of(&way, axis), self.names.len());
            for (row, n) in way.rows().iter().zip(0u8..) {
                self.push(row, BranchRow::Taken { depth, row: n });
            }
            let branch = if way.rows().iter().any(|row| self.shaft.contradicts(row, self.ends.octant)) {
                self.contradiction().map(Branch::Empty)
            } else {
                self.shaft.passed.push(rectangle);
                let branch = self.search(tableau);
                self.shaft.passed.pop();
                branch
            };
            self.truncate(own);
            done.push((name, branch?));
            if let Some(row) = way.complement() {
                self.push(&row, BranchRow::NotTaken { depth, way: name });
                if self.shaft.contradicts(&row, self.ends.octant) {
                    let rest = Some(self.contradiction()?);
                    return Some(Branch::Past { rectangle, ways: done, rest });
                }
            }
        }
        Some(Branch::Past { rectangle, ways: done, rest: None })
    }

    /// The ways beside a rectangle that no line between the boxes takes, whatever else is in the way, and
    /// why; `None` for the reason would be a defect.
    fn impossible(&mut self, rectangle: u32) -> Vec<(Bypass, Option<Branch>)> {
        let (octant, depth) = (self.ends.octant, self.shaft.passed.len());
        let (bounds, own) = (self.shaft.blockers.rectangle(rectangle), self.shaft.blockers.axis(rectangle));
        let at = bounds.min[own];
        let edges = others(own).into_iter().flat_map(|k| {
            let [first, last] = first_and_last(bounds, octant, k);
            let entering = Row { early: own, late: k, from: at, to: first };
            [(k, true, entering), (k, false, Row { early: k, late: own, from: last, to: at })]
        });
        let never: Vec<_> = edges.filter(|(_, _, row)| !self.ends.may_hold(row)).collect();
        let n_ends = self.ends.rows().count();
        let mut why = |row: Row| {
            let rows: Vec<Row> = self.ends.rows().chain([row]).collect();
            match decide(&rows, octant, SMALL_FIRST, &mut self.shaft.scratch).0 {
                Decision::Blocked(proof) => {
                    let mut names = self.names[..n_ends].to_vec();
                    names.push(BranchRow::Taken { depth, row: 0 });
                    Some(Branch::Empty(named(&proof.terms(), &names)))
                }
                Decision::Line(_) | Decision::Fractions(_) => None,
            }
        };
        never.into_iter().map(|(k, entering, row)| (Bypass::Beside { axis: k as u8, entering }, why(row))).collect()
    }

    fn push(&mut self, row: &Row, name: BranchRow) {
        self.shaft.push(&self.frame, row);
        self.names.push(name);
    }

    fn truncate(&mut self, n_rows: usize) {
        self.shaft.truncate(n_rows);
        self.names.truncate(n_rows);
    }
}

fn named(terms: &[(usize, num_bigint::BigInt)], names: &[BranchRow]) -> Contradiction {
    terms.iter().map(|(k, weight)| (names[*k], weight.clone())).collect()
}

/// Which way a set of rows is past a rectangle perpendicular to `axis`.
fn name_of(way: &BypassRows, axis: usize) -> Bypass {
    match way.rows() {
        [row] if row.early == axis => Bypass::Beside { axis: row.late as u8, entering: true },
        [row] => Bypass::Beside { axis: row.early as u8, entering: false },
        rows if rows.iter().all(|row| row.early == axis) => Bypass::Before,
        _ => Bypass::After,
    }
}
