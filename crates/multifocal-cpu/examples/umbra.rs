//! The umbra of two walls on three planes, with what is known on a plane carried to the next one and without.

use sightlines_geometry::Aabb;
use sightlines_multifocal::{Buffer, BufferJob, BufferPlane, Measure, MultifocalBackend, Occluder, Volume};
use sightlines_multifocal_cpu::Reference;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wall = |x0: f64, x1: f64, z: f64| {
        let outline = [[x0, -1.5, z], [x0, 1.5, z], [x1, 1.5, z], [x1, -1.5, z]];
        let triangles = [[outline[0], outline[1], outline[2]], [outline[0], outline[2], outline[3]]];
        Occluder::patch(outline.to_vec(), &triangles)
    };
    let walls = [wall(-2.5, 0.3125, 4.0)?, wall(-0.0625, 2.5, 4.25)?];
    let volume = Volume::new(Aabb { min: [-0.5, -0.5, -0.5], max: [0.5, 0.5, 0.5] })?;
    let plane = |z: f64| BufferPlane::new(2, true, z, [-6.0, -4.0], [6.0, 4.0], [48, 16]);
    for carry in [false, true] {
        let planes = vec![plane(4.5)?, plane(6.0)?, plane(8.0)?];
        let job = BufferJob::new(volume, planes, &walls, Measure::SectionHeight, carry)?;
        let mut buffers = Vec::new();
        Reference.render(&job, &mut buffers)?;
        println!("the farthest of three planes, {}", if carry { "carried over" } else { "each by itself" });
        draw(&buffers[2], job.unit());
    }
    Ok(())
}

/// Heights in whole scene units, `.` where nothing is known to block.
fn draw(buffer: &Buffer, unit: f64) {
    for y in (0..buffer.texels()[1]).rev() {
        let digit = |&v: &u32| if v == 0 { ".".to_owned() } else { format!("{:.0}", f64::from(v - 1) * unit) };
        println!("{}", buffer.row(y).iter().map(digit).collect::<String>());
    }
}
