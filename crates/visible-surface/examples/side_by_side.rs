//! Three bars, each in front of the next one, as text: what the ray caster sees, and what each method makes of it.
//!
//! `cargo run -p sightlines-visible-surface --example side_by_side`

use sightlines_visible_surface::{
    BspOptions, Camera, DepthFormat, FaceBsp, FaceMask, Faces, Image, NOTHING, Newell, Painter, RayCaster, RenderInput,
    Schumacker, SchumackerOptions, VisibleSurface, ZBuffer, compare,
};
use std::error::Error;

/// A digit for each face, a dot where nothing is, a cross for each pixel that is wrong.
fn text(image: &Image, wrong: &[[u32; 2]]) -> String {
    let [width, height] = image.size();
    let letter = |x: u32, y: u32| match image.at(x, y) {
        _ if wrong.contains(&[x, y]) => 'X',
        NOTHING => '.',
        face => char::from_digit(face, 36).unwrap_or('?'),
    };
    (0..height).map(|y| (0..width).map(|x| letter(x, y)).chain(['\n']).collect::<String>()).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    // Each bar goes past the middle on its left side, its tip half as far away as its other end.
    let bar = |[x, y]: [f64; 2]| {
        let place = |along: f64, aside: f64, z: f64| [(along * x - aside * y) * z, (along * y + aside * x) * z, z];
        [place(-0.8, 0.05, 6.0), place(-0.8, 0.45, 6.0), place(0.8, 0.25, 3.0)]
    };
    let faces = Faces::new([[1.0, 0.0], [-0.5, 0.875], [-0.5, -0.875]].map(bar).to_vec())?;
    // Letters are about twice as high as wide, so there are twice as many to the right.
    let pixel = 0.05;
    let camera = Camera::new([0.0; 3], [-0.9, 0.8, 1.0], [pixel / 2.0, 0., 0.], [0., -pixel, 0.], [72, 32])?;
    let chosen = FaceMask::all(&faces);
    let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let tree = FaceBsp::build(&faces, &BspOptions::default());
    let methods: Vec<Box<dyn VisibleSurface>> = vec![
        Box::new(Painter),
        Box::new(Newell),
        Box::new(Schumacker::build(&faces, &SchumackerOptions::default())),
        Box::new(tree.clone()),
        Box::new(tree.front_to_back()),
        Box::new(ZBuffer::new(DepthFormat::Exact)),
    ];
    let caster = RayCaster::build(&faces);
    let (truth, _) = caster.picture(&input);
    println!("{}\n{}", caster.name(), text(&truth, &[]));
    for method in &methods {
        let (image, counters) = method.picture(&input);
        let differs = compare(&input, &truth, &image);
        println!(
            "{}: {} wrong pixels, {} fragments, {} splits, each covered pixel written {:.2} times",
            method.name(),
            differs.wrong.len(),
            counters.fragments,
            counters.splits,
            counters.overdraw()
        );
        if !differs.wrong.is_empty() {
            println!("{}", text(&image, &differs.wrong));
        }
    }
    Ok(())
}
