//! `isovist` of a scene in space: volumes, and how much is seen of each object.

use super::IsovistArgs;
use crate::command::Done;
use crate::error::{Result, bail};
use crate::input::{self, refuse};
use crate::output::{self, JsonSchema, Serialize, bytes, count};
use crate::output_kind::OutputKind as Kind;
use crate::same_scene::difference;
use sightlines::isovist::{Estimate, Surroundings};
use sightlines::report::{SeenInSpace, seen_csv};
use std::fmt;

pub(super) fn run(args: &IsovistArgs, kind: Kind) -> Result<Done> {
    let path = &args.plan;
    let given = [
        ("--points", args.points.is_some()),
        ("--radius", args.radius.is_some()),
        ("--dir", args.dir.is_some()),
        ("--fov", args.fov.is_some()),
    ];
    refuse(path, &given, "plans", "a scene in space")?;
    refuse(path, &args.gap.given(), "plans", "a scene in space")?;
    if kind != Kind::Csv {
        bail!(
            "{}: isovists of scenes in space are written as CSV; give a name that ends in .csv",
            args.output.display()
        );
    }
    let file = input::scene(path, &args.surfaces.options())?;
    let table = args.table.as_ref().map(|path| input::table(path)).transpose()?;
    if let (Some(table), Some(table_path)) = (&table, &args.table)
        && let Some(difference) = difference(table, &file.scene)
    {
        bail!("{} is not of {}: {difference}", table_path.display(), path.display());
    }
    let around = Surroundings::new(&file.scene);
    let numbers = |Estimate { value, low, high }: Estimate| [value, low, high];
    let mut all = Vec::new();
    for (seed, point) in (1u64..).zip(&args.at) {
        let eye = point.spatial(path)?;
        let volume = numbers(around.volume(eye, args.rays, seed));
        let shares = around.visible_shares(eye, table.as_ref(), (args.rays / 16).max(64), seed);
        all.push(SeenInSpace { eye, volume, shares: shares.into_iter().map(numbers).collect() });
    }
    let names: Vec<&str> = file.scene.objects().iter().map(|object| object.name.as_str()).collect();
    let text = seen_csv(&all, &names);
    output::save(&args.output, text.as_bytes())?;
    let n = all.len() as f64;
    let outcome = Outcome {
        out: args.output.display().to_string(),
        n_bytes: text.len() as u64,
        n_objects: names.len(),
        n_isovists: all.len(),
        n_rays: args.rays,
        mean_volume: all.iter().map(|seen| seen.volume[0]).sum::<f64>() / n,
        mean_half_interval: all.iter().map(|seen| (seen.volume[2] - seen.volume[1]) / 2.0).sum::<f64>() / n,
        n_seen: all.iter().map(|seen| seen.shares.iter().filter(|share| share[0] > 0.0).count()).sum::<usize>() as f64
            / n,
    };
    Ok(Done::new(args.json, outcome))
}

/// Isovists of a scene, by rays.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The file that was written.
    out: String,
    /// Bytes of the file.
    n_bytes: u64,
    /// Objects of the scene.
    n_objects: usize,
    /// Points that were looked from.
    n_isovists: usize,
    /// Rays of each.
    n_rays: u32,
    /// Mean volume that is seen, in cubic units of the scene.
    mean_volume: f64,
    /// Half of the interval in which a volume lies with a probability of 95 %, on average.
    mean_half_interval: f64,
    /// Objects of which something was seen, on average.
    n_seen: f64,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes))?;
        writeln!(f, "isovists       {}, each by {} rays", self.n_isovists, self.n_rays)?;
        writeln!(f, "mean volume    {:.3} \u{b1} {:.3}", self.mean_volume, self.mean_half_interval)?;
        writeln!(f, "objects        {:.1} of {} seen on average", self.n_seen, count(self.n_objects as u64, "object"))
    }
}
