//! Single occluders: what they block with room to spare must be found.

use super::pair::{Pair, render};
use super::scene::Scene;
use super::{Slack, Violation};
use crate::{Buffer, Job, Measure, Occluder, Plane};

/// Clause 2, for each of a few occluders of the scene alone, on its nearest plane.
pub(super) fn compare(pair: &mut Pair<'_>, scene: &Scene, measure: Measure) -> Result<(), Violation> {
    scene.occluders.iter().take(2).try_for_each(|occluder| {
        let one = std::slice::from_ref(occluder);
        compare_one(pair, scene, one, measure)
    })
}

fn job<'a>(scene: &Scene, plane: Plane, one: &'a [Occluder], measure: Measure) -> Job<'a> {
    Job::new(scene.volume, vec![plane], one, measure, false).expect("part of a scene makes a job")
}

fn compare_one(pair: &mut Pair<'_>, scene: &Scene, one: &[Occluder], measure: Measure) -> Result<(), Violation> {
    let plane = scene.planes[0];
    let this = job(scene, plane, one, measure);
    let by_corner = job(scene, plane, one, Measure::VertexHeight);
    let [got] = only(render(pair.backend, scene, &this, Vec::new())?);
    let [exact] = only(render(pair.reference, scene, &this, Vec::new())?);
    let [corner] = only(render(pair.reference, scene, &by_corner, Vec::new())?);
    let spare = spare(pair, scene, one)?;
    // Units are powers of two, so the quotient is exact.
    let per_unit = by_corner.unit() / this.unit();
    let parallel = is_parallel(&one[0], &plane) && measure.is_height();
    let follows = pair.slack.exact || parallel;
    pair.report.jobs += 1;
    for (i, _) in spare.iter().enumerate().filter(|&(_, &spare)| spare) {
        let (got, exact) = (got.values()[i], exact.values()[i]);
        let lowest = (f64::from(corner.values()[i] - 1) * per_unit) as u32 + 1;
        let wanted = least(if follows { exact } else { lowest.min(exact) }, pair.slack);
        if got < wanted {
            let width = plane.texels()[0];
            let place = scene.place(measure, 0, [i as u32 % width, i as u32 / width]);
            return Err(Violation::Loose { place, got, wanted });
        }
        pair.report.tight += 1;
        pair.report.valued += usize::from(follows);
        if measure == Measure::SectionHeight && exact > lowest {
            pair.report.section += f64::from(exact - lowest);
            pair.report.section_kept += f64::from(got.saturating_sub(lowest));
        }
    }
    Ok(())
}

/// A blocked texel has at least 1.
fn least(value: u32, slack: &Slack) -> u32 {
    value.saturating_sub(slack.value).max(1)
}

fn only(buffers: Vec<Buffer>) -> [Buffer; 1] {
    buffers.try_into().expect("a job with one plane has one buffer")
}

/// Which texels are still blocked when they are enlarged by the slack on all sides, and moved towards the viewers.
///
/// The points of space that one occluder hides are a convex set. So it contains the grown texel if it contains the
/// texel moved by the slack in each of the four diagonal directions, on the plane and on one as much nearer; and a
/// window that is moved has all texels moved.
fn spare(pair: &mut Pair<'_>, scene: &Scene, one: &[Occluder]) -> Result<Vec<bool>, Violation> {
    let plane = scene.planes[0];
    let [w, h] = plane.texels();
    let mut spare = vec![true; w as usize * h as usize];
    let e = pair.slack.edge;
    let diagonals = [[-e, -e], [e, -e], [-e, e], [e, e]];
    let all = diagonals.map(|[x, y]| [[x, y, 0.0], [x, y, e]]);
    let moves = if e > 0.0 { all.as_flattened() } else { &[[0.0; 3]] };
    for &by in moves {
        let Some(plane) = moved(&plane, by) else { return Ok(Vec::new()) };
        let job = job(scene, plane, one, Measure::VertexHeight);
        let [buffer] = only(render(pair.reference, scene, &job, Vec::new())?);
        spare.iter_mut().zip(buffer.values()).for_each(|(spare, &value)| *spare &= value > 0);
    }
    Ok(spare)
}

/// The plane with its window moved by so many texels, and towards the viewers by so many of their longer sides. `None`
/// if the grid would change.
fn moved(plane: &Plane, by: [f64; 3]) -> Option<Plane> {
    let ([u, v], [a, b]) = (plane.origin(), plane.step());
    let low = [u + by[0] * a, v + by[1] * b];
    let [w, h] = plane.texels().map(f64::from);
    let high = [low[0] + w * a, low[1] + h * b];
    let nearer = by[2] * a.max(b);
    let at = if plane.positive() { plane.at() - nearer } else { plane.at() + nearer };
    let moved = Plane::new(plane.axis(), plane.positive(), at, low, high, plane.texels()).ok()?;
    (moved.origin() == low && moved.step() == plane.step()).then_some(moved)
}

fn is_parallel(occluder: &Occluder, plane: &Plane) -> bool {
    let b = occluder.bounds();
    b.min[plane.axis()] == b.max[plane.axis()]
}
