//! Says which adapter there is; fails if there is none.

fn main() -> Result<(), sightlines_multifocal_gpu::OpenError> {
    let gpu = sightlines_multifocal_gpu::Gpu::open()?;
    println!("{}", gpu.name());
    Ok(())
}
