//! Carried planes.

use super::{Pair, Violation};
use sightlines_multifocal::{Buffer, BufferJob, BufferPlane};

impl Pair<'_> {
    /// Clause 2 for carrying: a backend is compared with its own buffers. If everything that a texel's lines cross on the
    /// previous plane is blocked there, the texel must be blocked too.
    pub(super) fn compare_carried(&mut self, job: &BufferJob<'_>, got: &[Buffer]) -> Result<(), Violation> {
        let scene = self.scene;
        let apart = BufferJob::new(*job.volume(), job.planes().to_vec(), &scene.occluders, job.measure(), false)
            .expect("planes that are carried over can be left apart");
        let alone = self.exact(&apart)?;
        for (idx, (planes, buffers)) in job.planes().windows(2).zip(got.windows(2)).enumerate() {
            let ([nearer, plane], [known, stored]) = (planes, buffers) else { continue };
            // Both are exact for the suite's planes.
            let rise = (plane.height(nearer.corner(0, 0)) / job.unit()).floor() as u32;
            let [columns, rows] = [0, 1].map(|k| footprints(job, [nearer, plane], k, self.slack.edge));
            let width = stored.texels()[0];
            for (i, &got) in stored.values().iter().enumerate() {
                let (x, y) = (i as u32 % width, i as u32 / width);
                let (Some([x0, x1]), Some([y0, y1])) = (columns[x as usize], rows[y as usize]) else { continue };
                let crossed = (y0..y1).flat_map(|y| &known.row(y)[x0 as usize..x1 as usize]);
                let least = crossed.min().copied().unwrap_or(0);
                if least == 0 {
                    continue;
                }
                self.is_tight([idx + 1, i], least + rise, got)?;
                self.report.count("texels that a plane before blocks", 1);
                let is_fused = alone[idx + 1].values()[i] == 0;
                self.report.count("texels that only a plane before blocks", usize::from(is_fused));
            }
        }
        Ok(())
    }
}

/// For each texel of a plane along axis `k`, a superset of the texels of the nearer plane that lines to it cross:
/// enlarged by the slack, and by 2^-20 texels for the rounding of doubles. `None` where they leave the window.
fn footprints(job: &BufferJob<'_>, [nearer, plane]: [&BufferPlane; 2], k: usize, slack: f64) -> Vec<Option<[u32; 2]>> {
    let between = plane.height(nearer.corner(0, 0));
    let eyes = job.volume().corners();
    let crossing = |i: u32| {
        let p = plane.origin()[k] + plane.step()[k] * f64::from(i);
        let at = eyes.map(|v| p + (v[plane.across()[k]] - p) * (between / plane.height(v)));
        let at = at.map(|x| (x - nearer.origin()[k]) / nearer.step()[k]);
        at.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let margin = slack + 1.0 / (1u32 << 20) as f64;
    let of_texel = |i: u32| {
        let [low, high] = [(crossing(i)[0] - margin).floor(), (crossing(i + 1)[1] + margin).ceil()];
        let is_within = low >= 0.0 && high <= f64::from(nearer.texels()[k]);
        is_within.then_some([low as u32, high as u32])
    };
    (0..plane.texels()[k]).map(of_texel).collect()
}
