//! Single occluders: what they block with room to spare must be found.

use super::{Pair, Violation};
use sightlines_multifocal::{Buffer, BufferJob, BufferPlane, Measure, Occluder};

impl Pair<'_> {
    /// Clause 2, for each of a few occluders of the scene alone, on its nearest plane.
    pub(super) fn compare_single_occluders(&mut self) -> Result<(), Violation> {
        let scene = self.scene;
        scene.occluders.iter().take(2).try_for_each(|one| self.compare_one(one))
    }

    fn alone<'a>(&self, plane: BufferPlane, one: &'a Occluder, measure: Measure) -> BufferJob<'a> {
        BufferJob::new(self.scene.volume, vec![plane], [one], measure, false).expect("part of a scene makes a job")
    }

    fn compare_one(&mut self, one: &Occluder) -> Result<(), Violation> {
        let (plane, measure) = (self.scene.planes[0], self.measure);
        let this = self.alone(plane, one, measure);
        let by_corner = self.alone(plane, one, Measure::VertexHeight);
        let [got] = only(self.own(&this, Vec::new())?);
        let [[exact], [corner]] = [only(self.exact(&this)?), only(self.exact(&by_corner)?)];
        let spare = self.spare(one)?;
        // Units are powers of two, so the quotient is exact.
        let per_unit = by_corner.unit() / this.unit();
        let follows = self.slack.exact || (is_parallel(one, &plane) && measure.is_height());
        self.report.count("jobs", 1);
        for (i, _) in spare.iter().enumerate().filter(|&(_, &spare)| spare) {
            let (got, exact) = (got.values()[i], exact.values()[i]);
            let lowest = (f64::from(corner.values()[i] - 1) * per_unit) as u32 + 1;
            self.is_tight([0, i], if follows { exact } else { lowest.min(exact) }, got)?;
            self.report.count("texels that one occluder blocks", 1);
            self.report.count("texels with values to compare", usize::from(follows));
            if measure == Measure::SectionHeight && exact > lowest {
                self.report.count("units above lowest corners", (exact - lowest) as usize);
                self.report.count("units above lowest corners found", got.saturating_sub(lowest) as usize);
            }
        }
        Ok(())
    }

    /// Which texels are still blocked when they are enlarged by the slack on all sides, and moved towards the viewers.
    ///
    /// The points of space that one occluder hides are a convex set. So it contains the grown texel if it contains the
    /// texel moved by the slack in each of the four diagonal directions, on the plane and on one as much nearer; and a
    /// window that is moved has all texels moved.
    fn spare(&mut self, one: &Occluder) -> Result<Vec<bool>, Violation> {
        let plane = self.scene.planes[0];
        let [w, h] = plane.texels();
        let mut spare = vec![true; w as usize * h as usize];
        let e = self.slack.edge;
        let diagonals = [[-e, -e], [e, -e], [-e, e], [e, e]];
        let all = diagonals.map(|[x, y]| [[x, y, 0.0], [x, y, e]]);
        let moves = if e > 0.0 { all.as_flattened() } else { &[[0.0; 3]] };
        for &by in moves {
            let Some(plane) = moved(&plane, by) else { return Ok(Vec::new()) };
            let [buffer] = only(self.exact(&self.alone(plane, one, Measure::VertexHeight))?);
            spare.iter_mut().zip(buffer.values()).for_each(|(spare, &value)| *spare &= value > 0);
        }
        Ok(spare)
    }
}

fn only(buffers: Vec<Buffer>) -> [Buffer; 1] {
    buffers.try_into().expect("a job with one plane has one buffer")
}

/// The plane with its window moved by so many texels, and towards the viewers by so many of their longer sides. `None`
/// if the grid would change.
fn moved(plane: &BufferPlane, by: [f64; 3]) -> Option<BufferPlane> {
    let ([u, v], [a, b]) = (plane.origin(), plane.step());
    let low = [u + by[0] * a, v + by[1] * b];
    let [w, h] = plane.texels().map(f64::from);
    let high = [low[0] + w * a, low[1] + h * b];
    let nearer = by[2] * a.max(b);
    let at = if plane.positive() { plane.at() - nearer } else { plane.at() + nearer };
    let moved = BufferPlane::new(plane.axis(), plane.positive(), at, low, high, plane.texels()).ok()?;
    (moved.origin() == low && moved.step() == plane.step()).then_some(moved)
}

fn is_parallel(occluder: &Occluder, plane: &BufferPlane) -> bool {
    let b = occluder.bounds();
    b.min[plane.axis()] == b.max[plane.axis()]
}
