//! A job whose shards three processes could do at once: here they follow each other.

use sightlines_checkpoint::{Job, JobProgress, JobRole, JobStore, KeyHasher, Manifest};
use sightlines_progress::{Halt, Phase, Units};
use std::time::Duration;

/// The sum of the squares of the numbers below 12, one unit for each.
fn sum(units: Units<'_>) -> Result<u64, Halt> {
    let costs: Vec<f64> = (0..12).map(f64::from).collect();
    units.through(&Phase::new("squares", &costs), || {
        let mut sum = 0;
        for unit in 0..costs.len() {
            let square = || Ok::<_, Halt>((unit as u64 * unit as u64).to_le_bytes().to_vec());
            if let Some(result) = units.get("squares", unit, square)? {
                let bytes = result.try_into().map_err(|_| Halt::Store(format!("unit {unit} is damaged")))?;
                sum += u64::from_le_bytes(bytes);
            }
        }
        Ok(sum)
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::temp_dir().join(format!("sightlines-shards-{}", std::process::id()));
    let key = KeyHasher::new("1.0").finish();
    let manifest = Manifest::new("1.0", key, vec!["sum".to_owned()], ".".to_owned(), 3);
    let job = Job::create(&folder, manifest)?;

    // The first call finds out which phase there is, and cuts it.
    let planner = JobStore::new(job, JobRole::Merge, Duration::ZERO)?;
    assert_eq!(sum(Units(Some(&planner))), Err(Halt::Shared));
    let job = planner.job();
    for shard in 0..job.manifest().n_shards() {
        println!("shard {shard}: {:?}", job.shard(shard)?.1);
        let store = JobStore::new(job.clone(), JobRole::shard(shard), Duration::ZERO)?;
        assert_eq!(sum(Units(Some(&store))), Err(Halt::Shared));
        assert_eq!(store.outcome(), Some(JobProgress::Done));
    }
    let merger = JobStore::new(job, JobRole::Merge, Duration::ZERO)?;
    println!("the sum is {}", sum(Units(Some(&merger)))?);
    std::fs::remove_dir_all(folder)?;
    Ok(())
}
