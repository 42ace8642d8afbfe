//! What the precision of depths is worth: wrong pixels of each format, as the nearest depth moves away from what is seen.

use sightlines::scenes::surfaces::{self, DepthPairsOptions, depth_pairs};
use sightlines::visible_surface::{
    Camera, DepthFormat, FaceMask, Faces, RayCaster, RenderInput, VisibleSurface, ZBuffer, compare,
};

/// One over these are the nearest depths; the farthest is [`FAR`].
const NEAR: [u32; 8] = [1, 4, 16, 64, 256, 1024, 4096, 16_384];
const FAR: f64 = 8192.0;

/// Prints wrong pixels for near-to-far ratios. What is exact must have none.
pub(crate) fn print(size: [u32; 2]) {
    let scene = depth_pairs(DepthPairsOptions::default()).expect("in range");
    let faces = Faces::of_scene(&scene).expect("few faces");
    let chosen = FaceMask::all(&faces);
    let caster = RayCaster::build(&faces);
    println!("\nPairs of faces 1/64 apart, from depth 1 to 3,840; farthest depth {FAR}; wrong pixels:\n");
    println!("| nearest depth | far / near | {} |", DepthFormat::ALL.map(DepthFormat::name).join(" | "));
    println!("| --: | --: |{}", " --: |".repeat(DepthFormat::ALL.len()));
    for near in NEAR {
        let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, size)
            .and_then(|camera| camera.with_depths(1.0 / f64::from(near), FAR))
            .expect("generated scenes have an eye");
        let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let reference = caster.picture(&shot).0;
        let wrong = DepthFormat::ALL.map(|format| {
            let found = compare(&shot, &reference, &ZBuffer::new(format).picture(&shot).0);
            assert!(format != DepthFormat::Exact || found.wrong.is_empty(), "exact depths are never wrong");
            found.wrong.len().to_string()
        });
        println!("| 1/{near} | {} | {} |", FAR * f64::from(near), wrong.join(" | "));
    }
}
