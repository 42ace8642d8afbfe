//! A block under a square light, as a picture in letters, and the rays that it did not take.
//!
//! `cargo run -p sightlines-area-light --example soft_shadow`

use sightlines_area_light::{LightOptions, Shade, Shadows, Sides, shown};
use sightlines_from_region::ViewShafts;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::Volume;
use sightlines_multifocal::mesh::{PatchOptions, patches};
use sightlines_visible_surface::{Camera, FaceMask, Faces, RayCaster, RenderInput, VisibleSurface};
use std::error::Error;

/// A closed box.
fn cuboid(min: Point3, max: Point3) -> Vec<[Point3; 3]> {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 0 { min[k] } else { max[k] });
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]].map(|t| t.map(corner))).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let triangles = [cuboid([-8., -8., -1.], [8., 8., 0.]), cuboid([-2., -2., 1.], [2., 2., 2.])].concat();
    let faces = Faces::new(triangles.clone())?;
    let light = Volume::new(Aabb { min: [-1., -1., 6.], max: [1., 1., 6.] })?;
    let eye = [7., -13., 9.];
    // Letters are twice as high as wide.
    let camera = Camera::look_at(eye, [0., 0., 0.], [0., 0., 1.], 45., [144, 72])?;
    let image = RayCaster::build(&faces)
        .picture(&RenderInput { faces: &faces, camera: &camera, mask: &FaceMask::all(&faces) })
        .0;

    let shadows = Shadows::new(&faces);
    let mut method = ViewShafts::new(patches(&triangles, &PatchOptions::default()));
    println!("depth   umbra     lit  doubt   rays of those that tracing all takes");
    for max_depth in [2, 4, 6, 8, 10, 12] {
        let options = LightOptions { max_depth, sides: Sides::Towards(eye), ..LightOptions::default() };
        let lighting = shadows.classify(&shown(&faces, &image), &light, &mut method, &options)?;
        let picture = shadows.picture(&lighting, &camera, &image, 64);
        let areas = lighting.areas();
        let percent = [areas.umbra, areas.lit, areas.in_doubt].map(|a| 100.0 * a / areas.total());
        let rays = 100.0 * picture.n_rays as f64 / picture.n_rays_else as f64;
        println!("{max_depth:5} {:6.1}% {:6.1}% {:5.1}% {rays:6.1}%", percent[0], percent[1], percent[2]);
        if max_depth == 12 {
            println!("\n#: umbra, blank: lit, digits: tenths of the light in doubt, by rays");
            for row in picture.shades.chunks(288) {
                let letters = row[..144].iter().map(|shade| match shade {
                    Shade::Nothing => '.',
                    Shade::Umbra => '#',
                    Shade::Lit => ' ',
                    Shade::Traced(share) => char::from(b'0' + (share * 9.0) as u8),
                });
                println!("{}", letters.collect::<String>());
            }
        }
    }
    Ok(())
}
