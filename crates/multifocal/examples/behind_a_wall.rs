//! What a bent wall of small triangles hides from a room's worth of eyes.

use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::mesh::{PatchOptions, SheetMethod, patches};
use sightlines_multifocal::{FromRegion, Volume};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // A quarter of a cylinder, in strips of two triangles.
    let corner = |i: u32, z: f64| -> Point3 {
        let angle = f64::from(i) * std::f64::consts::FRAC_PI_2 / 16.0;
        [6.0 * angle.cos(), 6.0 * angle.sin(), z]
    };
    let strip = |i| {
        let [a, b, c, d] = [corner(i, -4.0), corner(i + 1, -4.0), corner(i + 1, 4.0), corner(i, 4.0)];
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[Point3; 3]> = (0..16).flat_map(strip).collect();
    let found = patches(&triangles, &PatchOptions::default());
    println!(
        "{} triangles make {} patches, the largest with {} corners",
        triangles.len(),
        found.len(),
        found[0].outline().len()
    );

    let mut method = SheetMethod::new(&triangles);
    let eyes = Volume::new(Aabb { min: [0.0, 0.0, -0.5], max: [1.0, 1.0, 0.5] })?;
    let mut umbra = method.umbra(&eyes)?;
    for (name, x) in [("behind the wall", 6.0), ("in front of it", 3.0), ("beside it", -6.0)] {
        let target = Aabb { min: [x, 6.0f64.min(x.abs()), 0.0], max: [x + 1.0, 7.0f64.min(x.abs() + 1.0), 1.0] };
        println!("a box {name} is {}", if umbra.hides(&target) { "hidden" } else { "visible, as far as is known" });
    }
    Ok(())
}
