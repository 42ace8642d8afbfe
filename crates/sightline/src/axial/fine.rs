//! The linear program of one octant in numbers of two doubles: for lines through slits of a few units in the last place.
//!
//! It is the program of [`simplex`](super::simplex), with coordinates that are exact: they are moved by a coordinate and
//! scaled by a power of two. The basis that doubles find is its start, so a few exchanges are enough. Its line is
//! checked exactly, and its weights become integers that are checked exactly; so what it decides is certain, and at worst
//! it decides nothing.

use super::proof::{self, Proof, sign_of_sum};
use super::rows::{Octant, Row, is_forward, misses, sign};
use super::simplex::{self, Column, FAR, N};
use super::witness::AxialWitness;
use crate::wide::Wide;
use num_rational::BigRational;
use sightlines_exact::rational;
use sightlines_geometry::AxialDoor;

/// Violations below this are rounding.
const VIOLATED: Wide = Wide::of(1.0 / (1u128 << 94) as f64);
/// Entries of smaller magnitude are not used as pivots.
const PIVOT: f64 = 1e-18;
/// Weights below this are rounding.
const WEIGHT: f64 = 1e-22;
/// Number of exchanges after which it gives up.
const MAX_EXCHANGES: usize = 60;
/// Slownesses below this are not used: products with them could leave the range of doubles.
const SLOWEST: f64 = 1e-30;

/// What the program found; both are exact.
#[derive(Debug)]
pub(super) enum Fine {
    /// A line obeys every row strictly.
    Open(FineLine),
    /// None does.
    Blocked(Proof),
}

/// A directed line, by the time at which it reaches each coordinate. It can pass where no line through two points in
/// doubles does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FineLine {
    /// Some place on each axis.
    origin: [f64; 3],
    /// Time that a unit takes on each axis, in the axis's direction.
    slowness: [Wide; 3],
    /// Time at which it reaches the origin of each axis, negated.
    offset: [Wide; 3],
}

impl FineLine {
    fn time_terms(&self, axis: usize, x: f64) -> (Wide, Wide, Wide) {
        (self.slowness[axis], Wide::difference(x, self.origin[axis]), self.offset[axis])
    }

    /// Whether it obeys a row strictly. Exact.
    ///
    /// The difference of two times has two products and two sums, which err by less than 2^-100 of the magnitudes. What
    /// is within that is added up exactly.
    pub(super) fn obeys(&self, row: &Row) -> bool {
        let (s, u, q) = self.time_terms(row.early, row.from);
        let (z, v, r) = self.time_terms(row.late, row.to);
        let (first, second) = (s * u, z * v);
        let late = (first - q) - (second - r);
        let sizes = first.high.abs() + q.high.abs() + second.high.abs() + r.high.abs();
        if late.high.abs() > sizes * (1.0 / (1u128 << 97) as f64) {
            return late.high < 0.0;
        }
        let product = |a: Wide, b: Wide| [(a.high, b.high), (a.high, b.low), (a.low, b.high), (a.low, b.low)];
        let terms = product(s, u).into_iter().chain(product(-z, v)).chain(product(-q, Wide::ONE));
        sign_of_sum(terms.chain(product(r, Wide::ONE))) < 0.0
    }

    /// Some place on each axis, from which the others are computed.
    pub(super) const fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Where it is on each axis at time 0, and the time that a unit takes there; rounded.
    pub(super) fn start_and_pace(&self) -> [[f64; 3]; 2] {
        let start = |i: usize| (Wide::of(self.origin[i]) + self.offset[i] / self.slowness[i]).high;
        [[0, 1, 2].map(start), self.slowness.map(|s| s.high)]
    }

    /// Whether it crosses the plane of a door in the door's direction and meets the closed rectangle. Exact.
    pub fn touches(&self, door: &AxialDoor) -> bool {
        let octant = (0..3).map(|i| u8::from(self.slowness[i].high > 0.0) << i).sum();
        let axis = usize::from(door.axis);
        door.forward == is_forward(octant, axis) && !misses(&door.extent, axis, octant, |row| self.obeys(row))
    }

    /// The same line in fractions.
    pub(super) fn witness(&self) -> AxialWitness {
        let exact = |x: Wide| rational(x.high) + rational(x.low);
        let direction: [BigRational; 3] = self.slowness.map(|s| exact(s).recip());
        let point = [0, 1, 2].map(|i| rational(self.origin[i]) + exact(self.offset[i]) * &direction[i]);
        AxialWitness::new(point, direction)
    }
}

/// A row in the coordinates of the program.
#[derive(Debug, Clone, Copy)]
struct FineRow {
    early: usize,
    late: usize,
    from: Wide,
    to: Wide,
}

/// Where the coordinates of the program begin on each axis, and the powers of two that they are multiplied by, with the sign
/// of the octant.
struct FineFrame {
    origin: [f64; 3],
    scale: [f64; 3],
}

impl FineFrame {
    fn around(rows: &[Row], octant: Octant) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for row in rows {
            for (axis, x) in [(row.early, row.from), (row.late, row.to)] {
                low[axis] = low[axis].min(x);
                high[axis] = high[axis].max(x);
            }
        }
        let (mut origin, mut scale) = ([0.0; 3], [1.0; 3]);
        for axis in (0..3).filter(|&axis| low[axis] <= high[axis]) {
            let size = high[axis] - low[axis];
            // The exponent of the size: more than half of the box is in use.
            let power = if size > 0.0 { f64::from_bits((2045 - (size.to_bits() >> 52)) << 52) } else { 1.0 };
            origin[axis] = if sign(octant, axis) > 0.0 { low[axis] } else { high[axis] };
            scale[axis] = sign(octant, axis) * power;
        }
        Self { origin, scale }
    }

    fn row(&self, row: &Row) -> FineRow {
        let place = |axis: usize, x: f64| Wide::difference(x, self.origin[axis]).scaled(self.scale[axis]);
        FineRow { early: row.early, late: row.late, from: place(row.early, row.from), to: place(row.late, row.to) }
    }

    /// The line of the unknowns.
    fn line(&self, y: &[Wide; N]) -> Option<FineLine> {
        let usable = y[..3].iter().all(|s| s.high > SLOWEST);
        // Any line will do, so parts that are out of proportion are left out.
        let plain = |x: Wide| if x.low.abs() < SLOWEST * SLOWEST { Wide::of(x.high) } else { x };
        let slowness = [0, 1, 2].map(|i| plain(y[i]).scaled(self.scale[i]));
        usable.then_some(FineLine { origin: self.origin, slowness, offset: [Wide::ZERO, plain(y[3]), plain(y[4])] })
    }
}

/// A basis of the program, with the inverse of its matrix; the weights are its last column.
struct Basis {
    columns: [Column; N],
    inverse: [[Wide; N]; N],
    total: [bool; 3],
}

impl Basis {
    /// `None` if the columns do not determine it, or weights are negative.
    fn new(columns: [Column; N], rows: &[FineRow], total: [bool; 3]) -> Option<Self> {
        // Rows of the matrix are unknowns; beside it, the unit matrix becomes the inverse.
        let mut left = [[Wide::ZERO; N]; N];
        for (k, column) in columns.iter().enumerate() {
            for (row, a) in left.iter_mut().zip(coefficients(*column, rows, total)) {
                row[k] = a;
            }
        }
        let mut right = [[Wide::ZERO; N]; N];
        (0..N).for_each(|i| right[i][i] = Wide::ONE);
        for k in 0..N {
            let pivot = (k..N).max_by(|&a, &b| left[a][k].high.abs().total_cmp(&left[b][k].high.abs()))?;
            if left[pivot][k].high.abs() < PIVOT {
                return None;
            }
            left.swap(k, pivot);
            right.swap(k, pivot);
            let head = left[k][k];
            for x in left[k].iter_mut().chain(&mut right[k]) {
                *x = *x / head;
            }
            let (own, beside) = (left[k], right[k]);
            for i in (0..N).filter(|&i| i != k) {
                let factor = left[i][k];
                if factor.high == 0.0 {
                    continue;
                }
                for j in 0..N {
                    left[i][j] = left[i][j] - factor * own[j];
                    right[i][j] = right[i][j] - factor * beside[j];
                }
            }
        }
        let fits = |i: usize| columns[i] == Column::Total || right[i][N - 1].high > -PIVOT;
        (0..N).all(fits).then_some(Self { columns, inverse: right, total })
    }

    fn unknowns(&self) -> [Wide; N] {
        let mut y = [Wide::ZERO; N];
        for (column, row) in self.columns.iter().zip(&self.inverse) {
            let cost = match column {
                Column::Total => Wide::ONE,
                Column::Offset(..) => Wide::of(FAR),
                _ => continue,
            };
            for (y, r) in y.iter_mut().zip(row) {
                *y = *y + cost * *r;
            }
        }
        y
    }

    /// Continues to an optimum; `None` if it is not reached.
    fn improve(&mut self, rows: &[FineRow]) -> Option<[Wide; N]> {
        for _ in 0..MAX_EXCHANGES {
            let y = self.unknowns();
            let Some(entering) = most_violated(&y, rows) else { return Some(y) };
            self.exchange(entering, rows)?;
        }
        None
    }

    fn exchange(&mut self, entering: Column, rows: &[FineRow]) -> Option<()> {
        let a = coefficients(entering, rows, self.total);
        let image = self.inverse.map(|row| {
            let terms = row.into_iter().zip(a).filter(|(_, a)| a.high != 0.0);
            terms.fold(Wide::ZERO, |sum, (r, a)| sum + r * a)
        });
        let mut leaving: Option<(usize, Wide)> = None;
        for i in (0..N).filter(|&i| image[i].high > PIVOT && self.columns[i] != Column::Total) {
            let ratio = self.inverse[i][N - 1] / image[i];
            let better = |&(k, best): &(usize, Wide)| ratio < best || (ratio == best && image[i] > image[k]);
            if leaving.as_ref().is_none_or(better) {
                leaving = Some((i, ratio));
            }
        }
        let (out, _) = leaving?;
        let scaled = self.inverse[out].map(|r| r / image[out]);
        for i in (0..N).filter(|&i| i != out) {
            for (r, s) in self.inverse[i].iter_mut().zip(&scaled) {
                *r = *r - image[i] * *s;
            }
        }
        (self.inverse[out], self.columns[out]) = (scaled, entering);
        Some(())
    }

    /// The rows with positive weights.
    fn support(&self) -> Vec<(usize, Wide)> {
        let weights = self.columns.iter().zip(&self.inverse).map(|(column, row)| (column, row[N - 1]));
        let heavy = weights.filter(|(_, w)| w.high > WEIGHT);
        heavy.filter_map(|(column, w)| if let Column::Row(k) = column { Some((*k, w)) } else { None }).collect()
    }
}

fn value(y: &[Wide; N], row: &FineRow) -> Wide {
    let q = [Wide::ZERO, y[3], y[4]];
    (y[row.early] * row.from - q[row.early]) - (y[row.late] * row.to - q[row.late]) + y[5]
}

fn most_violated(y: &[Wide; N], rows: &[FineRow]) -> Option<Column> {
    let mut worst = (VIOLATED, None);
    let mut offer = |violation: Wide, column: Column| {
        if violation > worst.0 {
            worst = (violation, Some(column));
        }
    };
    for (i, slowness) in y[..3].iter().enumerate() {
        offer(y[5] - *slowness, Column::Sign(i));
    }
    for axis in [1, 2] {
        offer(y[axis + 2] - Wide::of(FAR), Column::Offset(axis, 1.0));
        offer(-y[axis + 2] - Wide::of(FAR), Column::Offset(axis, -1.0));
    }
    for (k, row) in rows.iter().enumerate() {
        offer(value(y, row), Column::Row(k));
    }
    worst.1
}

fn coefficients(column: Column, rows: &[FineRow], total: [bool; 3]) -> [Wide; N] {
    let (mut a, one) = ([Wide::ZERO; N], Wide::ONE);
    match column {
        Column::Total => (0..3).filter(|&i| total[i]).for_each(|i| a[i] = one),
        Column::Sign(i) => (a[i], a[5]) = (-one, one),
        Column::Floor(i) => a[i] = -one,
        Column::Cap => a[5] = one,
        Column::Offset(axis, sign) => a[axis + 2] = Wide::of(sign),
        Column::Row(k) => {
            let row = &rows[k];
            a[row.early] = row.from;
            a[row.late] = -row.to;
            if row.early > 0 {
                a[row.early + 2] = -one;
            }
            if row.late > 0 {
                a[row.late + 2] = one;
            }
            a[5] = one;
        }
    }
    a
}

/// Decides whether a line of the octant obeys all rows strictly, if the digits suffice. Exact.
///
/// Cost: that of the program in doubles several times over; some thousandths of that in fractions.
pub(super) fn decide(rows: &[Row], octant: Octant) -> Option<Fine> {
    let frame = FineFrame::around(rows, octant);
    let fine: Vec<FineRow> = rows.iter().map(|row| frame.row(row)).collect();
    let (basis, y) = solve(&fine, [true; 3])?;
    if y[5].high > 0.0
        && let Some(line) = frame.line(&y).filter(|line| rows.iter().all(|row| line.obeys(row)))
    {
        return Some(Fine::Open(line));
    }
    let support = basis.support();
    let signs = [0, 1, 2].map(|i| {
        let weights = basis.columns.iter().zip(&basis.inverse);
        weights.into_iter().any(|(column, row)| *column == Column::Sign(i) && row[N - 1].high > WEIGHT)
    });
    let doubles: Vec<(usize, f64)> = support.iter().map(|(k, w)| (*k, w.high)).collect();
    proof::by_fine_cycles(rows, octant, &support)
        .or_else(|| proof::by_fine_cycles(rows, octant, &two_axes(rows, &fine, &support)?))
        .or_else(|| proof::by_elimination(rows, octant, &doubles, signs))
        .map(Fine::Blocked)
}

/// An optimum: from the basis that doubles find, or else from the first one.
fn solve(rows: &[FineRow], total: [bool; 3]) -> Option<(Basis, [Wide; N])> {
    let rounded: Vec<Row> =
        rows.iter().map(|r| Row { early: r.early, late: r.late, from: r.from.high, to: r.to.high }).collect();
    let first = simplex::Tableau::new(total);
    let mut near = first;
    let _ = near.improve(&rounded);
    let from = |columns: [Column; N]| {
        let mut basis = Basis::new(columns, rows, total)?;
        let y = basis.improve(rows)?;
        Some((basis, y))
    };
    from(near.columns()).or_else(|| from(first.columns()))
}

/// Solves the program again without the slowness of one axis, as [`octant::two_axes`](super::octant::two_axes) does.
fn two_axes(rows: &[Row], fine: &[FineRow], support: &[(usize, Wide)]) -> Option<Vec<(usize, Wide)>> {
    let places = |axis: usize| support.iter().filter_map(move |&(k, _)| rows[k].term(axis)).map(|(_, x)| x);
    let idle = (0..3).find(|&axis| places(axis).all(|x| Some(x) == places(axis).next()))?;
    let place = places(idle).next();
    let stays = |row: &Row| row.term(idle).is_none_or(|(_, x)| Some(x) == place);
    let kept: Vec<usize> = (0..rows.len()).filter(|&k| stays(&rows[k])).collect();
    let fine: Vec<FineRow> = kept.iter().map(|&k| fine[k]).collect();
    let (basis, _) = solve(&fine, [0, 1, 2].map(|axis| axis != idle))?;
    Some(basis.support().into_iter().map(|(k, weight)| (kept[k], weight)).collect())
}

#[cfg(test)]
mod tests {
    use super::super::exact::{self, Exact};
    use super::super::octant::{FINE, decide_in_doubles};
    use super::super::rows::{door_rows, is_forward};
    use super::super::{certificate, octant_proof};
    use super::*;
    use proptest::prelude::*;
    use sightlines_geometry::Aabb;
    use sightlines_testkit::{any_axial_doors, axial_corridor, draw};

    /// Doors that fix all signs, and their octant.
    fn octant_of(doors: &[AxialDoor]) -> Option<Octant> {
        let mut fits = (0..8).filter(|&o| doors.iter().all(|d| is_forward(o, usize::from(d.axis)) == d.forward));
        fits.next().filter(|_| fits.next().is_none())
    }

    fn rows_of(doors: &[AxialDoor], octant: Octant) -> Vec<Row> {
        doors.iter().flat_map(|door| door_rows(door, octant)).collect()
    }

    /// Moves a coordinate by some units in the last place.
    fn by_units(x: f64, n: i8) -> f64 {
        let step = |x: f64| if n > 0 { x.next_up() } else { x.next_down() };
        if x == 0.0 { 0.0 } else { (0..n.unsigned_abs()).fold(x, |x, _| step(x)) }
    }

    /// The doors elsewhere, where rounding has moved what was aligned, with some sides moved by up to four units in the
    /// last place.
    fn thin(doors: &[AxialDoor], scale: f64, by: f64, nudges: &[i8]) -> Vec<AxialDoor> {
        let mut nudges = nudges.iter().cycle().map(|n| n % 5);
        let mut place = |x: f64, nudge: bool| {
            let n = nudges.next().unwrap_or(0);
            by_units(x * scale + by, if nudge { n } else { 0 })
        };
        let door = |door: &AxialDoor| {
            let axis = usize::from(door.axis);
            let extent = Aabb {
                min: [0, 1, 2].map(|k| place(door.extent.min[k], k != axis)),
                max: [0, 1, 2].map(|k| place(door.extent.max[k], k != axis)),
            };
            AxialDoor { extent, ..*door }
        };
        doors.iter().map(door).collect()
    }

    fn any_thin() -> impl Strategy<Value = Vec<AxialDoor>> {
        let place = (prop::sample::select(vec![1.0, 0.1, 0.3, 7e-4]), prop::sample::select(vec![0.0, 0.7, 1e5]));
        let doors = prop_oneof![axial_corridor(), any_axial_doors()];
        let aligned = (doors, place, any::<[i8; 7]>()).prop_map(|(doors, (scale, by), n)| thin(&doors, scale, by, &n));
        prop_oneof![aligned, slits()]
    }

    /// Doors of some units in the last place around places of one line, behind two large ones that fix its signs.
    fn slits() -> impl Strategy<Value = Vec<AxialDoor>> {
        let start = (0.1f64..9.0, 0.1f64..9.0);
        let slope = || prop_oneof![0.1f64..2.0, -2.0f64..-0.1];
        let widths = prop::collection::vec((1.0f64..9.0, any::<[i8; 4]>()), 2..5);
        (start, slope(), slope(), widths).prop_map(|((y, z), b, d, widths)| {
            let at = |x: f64| [x, y + b * x, z + d * x];
            let before = at(-1.0);
            let wide = |axis: usize, slope: f64| {
                let (mut min, mut max) = (before.map(|x| x - 0.5), before.map(|x| x + 0.5));
                (min[axis], max[axis]) = (before[axis], before[axis]);
                AxialDoor { axis: axis as u8, forward: slope > 0.0, extent: Aabb { min, max } }
            };
            let slit = |&(x, n): &(f64, [i8; 4])| {
                let [x, y, z] = at(x);
                let n = n.map(|n| 1 + (n % 4).abs());
                let min = [x, by_units(y, -n[0]), by_units(z, -n[1])];
                let max = [x, by_units(y, n[2]), by_units(z, n[3])];
                AxialDoor { axis: 0, forward: true, extent: Aabb { min, max } }
            };
            [wide(1, b), wide(2, d)].into_iter().chain(widths.iter().map(slit)).collect()
        })
    }

    /// How a question was answered.
    #[derive(Debug, PartialEq, Eq, Clone, Copy)]
    enum Answer {
        Open,
        Blocked,
        None,
    }

    /// Compares the answer about rows with that of fractions about doors.
    fn compare(doors: &[AxialDoor], octant: Octant, rows: &[Row]) -> Result<Answer, String> {
        let open = matches!(exact::decide(&rows_of(doors, octant), octant, &[]), Exact::Open(_));
        match decide(rows, octant) {
            Some(Fine::Open(line)) => {
                let passes = doors.iter().all(|door| line.witness().passes(door));
                if open && passes { Ok(Answer::Open) } else { Err(format!("{line:?}")) }
            }
            Some(Fine::Blocked(proof)) => {
                let holds = certificate(doors, vec![octant_proof(doors, octant, rows, &proof)]).holds(doors);
                if !open && holds { Ok(Answer::Blocked) } else { Err(format!("{proof:?}")) }
            }
            None => Ok(Answer::None),
        }
    }

    proptest! {
        /// Invariant: an answer is that of fractions; a line given passes and a proof given holds.
        #[test]
        fn answers_are_those_of_fractions(doors in any_thin()) {
            let Some(octant) = octant_of(&doors) else { return Ok(()) };
            let answer = compare(&doors, octant, &rows_of(&doors, octant));
            prop_assert!(answer.is_ok(), "{:?} of {:?}", answer, doors);
        }

        /// Invariant: rows are compared as fractions compare them, also where they are equal but for some units in the last
        /// place.
        #[test]
        fn rows_are_compared_as_in_fractions(doors in any_thin(), n in -4..=4i8) {
            let Some(octant) = octant_of(&doors) else { return Ok(()) };
            let Some(Fine::Open(line)) = decide(&rows_of(&doors, octant), octant) else { return Ok(()) };
            let witness = line.witness();
            for door in &doors {
                let axis = usize::from(door.axis);
                let Some(place) = witness.crossing(door) else { continue };
                for late in (0..3).filter(|&k| k != axis) {
                    let row = Row { early: axis, late, from: door.at(), to: by_units(place[late], n) };
                    let time = |k: usize, x: f64| (rational(x) - &witness.point()[k]) / &witness.direction()[k];
                    prop_assert_eq!(line.obeys(&row), time(axis, row.from) < time(late, row.to), "{:?} {:?}", line, row);
                }
            }
        }
    }

    /// Tightness: next to nothing is left open, and much of it is what doubles leave open.
    #[test]
    fn little_is_left_open() {
        let (mut open, mut blocked, mut none, mut more) = (0, 0, 0, 0);
        for doors in draw(&any_thin(), 500) {
            let Some(octant) = octant_of(&doors) else { continue };
            let rows = rows_of(&doors, octant);
            let answer = compare(&doors, octant, &rows).unwrap_or_else(|error| panic!("{error} of {doors:?}"));
            match answer {
                Answer::Open => open += 1,
                Answer::Blocked => blocked += 1,
                Answer::None => none += 1,
            }
            let in_doubles = decide_in_doubles(&rows, octant, FINE, &mut Vec::new());
            more += usize::from(answer != Answer::None && in_doubles.is_err());
        }
        eprintln!("{open} open, {blocked} blocked, {none} neither; {more} that doubles leave open");
        assert!(open > 100 && blocked > 50 && more > 100, "{open} {blocked} {more}");
        assert!(100 * none <= open + blocked, "{none} of {open} and {blocked}");
    }

    /// Three slits of 1 to 4 units in the last place, one behind the other: whether a line passes is a sum of three
    /// integers. Those that only touch are blocked.
    #[test]
    fn slits_of_some_units_are_decided() {
        let unit = f64::EPSILON;
        let (mut n_open, mut n_blocked, mut n_touching) = (0, 0, 0);
        for width in 1..=4i32 {
            for (first, middle) in (-5..=5).flat_map(|a| (-5..=5).map(move |b| (a, b))) {
                let slit = |x: f64, low: i32| {
                    let side = |n: i32| 1.0 + f64::from(n + 8) * unit;
                    let extent = Aabb { min: [x, side(low), 0.1], max: [x, side(low + width), 0.9] };
                    AxialDoor { axis: 0, forward: true, extent }
                };
                let doors = [slit(0.0, first), slit(1.0, middle), slit(2.0, 0)];
                // The line that passes the outer slits is anywhere between the sums of their sides.
                let off = (2 * middle - first).abs();
                let expected = if off < 2 * width { Answer::Open } else { Answer::Blocked };
                n_touching += usize::from(off == 2 * width);
                let answers = [1u8, 3, 5, 7].map(|octant| decide(&rows_of(&doors, octant), octant));
                let open = answers.iter().any(|answer| matches!(answer, Some(Fine::Open(_))));
                let all_blocked = answers.iter().all(|answer| matches!(answer, Some(Fine::Blocked(_))));
                match expected {
                    Answer::Open => assert!(open, "{width} {first} {middle}"),
                    _ => assert!(all_blocked, "{width} {first} {middle}: {answers:?}"),
                }
                *(if open { &mut n_open } else { &mut n_blocked }) += 1;
            }
        }
        assert!(n_open > 100 && n_blocked > 50 && n_touching > 10, "{n_open} {n_blocked} {n_touching}");
    }

    /// Comparisons that have to fail: a row is forgotten, or a line is rounded to one double for each number.
    #[test]
    fn impostors_are_noticed() {
        let (mut forgotten, mut rounded) = (0, 0);
        for doors in draw(&any_thin(), 50) {
            let Some(octant) = octant_of(&doors) else { continue };
            let rows = rows_of(&doors, octant);
            for k in 0..rows.len() {
                let mut fewer = rows.clone();
                // A row that says what another one says.
                fewer[k] = rows[(k + 1) % rows.len()];
                forgotten += usize::from(compare(&doors, octant, &fewer).is_err());
            }
            if let Some(Fine::Open(mut line)) = decide(&rows, octant) {
                line.slowness.iter_mut().chain(&mut line.offset).for_each(|x| x.low = 0.0);
                rounded += usize::from(!doors.iter().all(|door| line.witness().passes(door)));
            }
        }
        assert!(forgotten > 20 && rounded > 5, "{forgotten} {rounded}");
    }
}
