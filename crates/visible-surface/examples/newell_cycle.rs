//! Newell's cycle: three bars, each in front of the next one. The painter's sort is wrong somewhere whatever it draws last; Newell splits a bar.
//!
//! `cargo run -p sightlines-visible-surface --example newell_cycle -- OUT.svg`

use sightlines_visible_surface::{
    Camera, FaceMask, Faces, Image, Newell, Painter, RayCaster, RenderInput, VisibleSurface, compare,
};
use std::error::Error;
use std::fmt::Write;

const SIZE: [u32; 2] = [300, 280];
const COLOURS: [&str; 3] = ["#5b9fdc", "#b4d9fa", "#2f6da8"];

/// A picture at a place, with a rim around its wrong pixels.
fn panel(out: &mut String, [left, top]: [u32; 2], title: &str, image: &Image, wrong: &[[u32; 2]]) {
    let _ = writeln!(out, "<text x=\"{left}\" y=\"{}\" font-size=\"16\" fill=\"#1c2733\">{title}</text>", top - 10);
    let _ = writeln!(out, "<g transform=\"translate({left} {top})\" shape-rendering=\"crispEdges\">");
    for (face, colour) in (0u32..).zip(COLOURS) {
        let mut path = String::new();
        for y in 0..SIZE[1] {
            let mut x = 0;
            while x < SIZE[0] {
                let end = (x..SIZE[0]).find(|&end| image.at(end, y) != image.at(x, y)).unwrap_or(SIZE[0]);
                if image.at(x, y) == face {
                    let _ = write!(path, "M{x} {y}h{0}v1h-{0}z", end - x);
                }
                x = end;
            }
        }
        let _ = writeln!(out, "<path class=\"bar\" d=\"{path}\" fill=\"{colour}\"/>");
    }
    // Edges of the pixels that are wrong, towards those that are not.
    let mut rim = String::new();
    let is_wrong =
        |x: i64, y: i64| u32::try_from(x).is_ok_and(|x| u32::try_from(y).is_ok_and(|y| wrong.contains(&[x, y])));
    for &[x, y] in wrong {
        let (a, b) = (i64::from(x), i64::from(y));
        for (is_inner, edge) in [
            (is_wrong(a, b - 1), format!("M{x} {y}h1")),
            (is_wrong(a, b + 1), format!("M{x} {}h1", y + 1)),
            (is_wrong(a - 1, b), format!("M{x} {y}v1")),
            (is_wrong(a + 1, b), format!("M{} {y}v1", x + 1)),
        ] {
            rim += if is_inner { "" } else { &edge };
        }
    }
    if !rim.is_empty() {
        let _ = writeln!(out, "<path class=\"rim\" d=\"{rim}\" stroke=\"#d6246e\" stroke-width=\"2\" fill=\"none\"/>");
    }
    let _ =
        writeln!(out, "<rect width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#9aa5b1\"/>\n</g>", SIZE[0], SIZE[1]);
}

/// The picture.
///
/// # Errors
/// None that these bars have.
pub(crate) fn picture() -> Result<String, Box<dyn Error>> {
    // Each bar goes past the middle on its left side, its tip half as far away as its other end.
    let bar = |[x, y]: [f64; 2]| {
        let place = |along: f64, aside: f64, z: f64| [(along * x - aside * y) * z, (along * y + aside * x) * z, z];
        [place(-0.8, 0.05, 6.0), place(-0.8, 0.45, 6.0), place(0.8, 0.25, 3.0)]
    };
    let faces = Faces::new([[1.0, 0.0], [-0.5, 0.875], [-0.5, -0.875]].map(bar).to_vec())?;
    let pixel = 0.0072;
    let corner = [-0.5 * pixel * f64::from(SIZE[0]), 0.5 * pixel * f64::from(SIZE[1]), 1.0];
    let camera = Camera::new([0.0; 3], corner, [pixel, 0.0, 0.0], [0.0, -pixel, 0.0], SIZE)?;
    let chosen = FaceMask::all(&faces);
    let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let (truth, _) = RayCaster::build(&faces).picture(&input);
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\" height=\"440\" viewBox=\"0 0 1000 440\" \
         font-family=\"sans-serif\">\n<title>Newell's cycle</title>\n<rect width=\"1000\" height=\"440\" fill=\"#fff\"/>\n\
         <text x=\"25\" y=\"32\" font-size=\"20\" fill=\"#1c2733\">Newell's cycle: each bar is in front of the next one, \
         so none can be drawn first</text>\n",
    );
    let methods: [(&str, &dyn VisibleSurface); 2] = [("painter's sort", &Painter), ("Newell", &Newell)];
    for (k, (name, method)) in (0u32..).zip(methods) {
        let (image, counters) = method.picture(&input);
        let wrong = compare(&input, &truth, &image).wrong;
        let title = format!("{name}: wrong pixels {}, splits {}", wrong.len(), counters.splits);
        panel(&mut out, [25 + 325 * k, 85], &title, &image, &wrong);
    }
    panel(&mut out, [675, 85], "what rays meet: the truth", &truth, &[]);
    let legend = COLOURS.iter().zip(["bar 1", "bar 2", "bar 3"]);
    for (k, (colour, label)) in (0u32..).zip(legend) {
        let x = 25 + 110 * k;
        let _ = writeln!(out, "<rect x=\"{x}\" y=\"395\" width=\"24\" height=\"16\" fill=\"{colour}\"/>");
        let _ = writeln!(out, "<text x=\"{}\" y=\"409\" font-size=\"15\" fill=\"#1c2733\">{label}</text>", x + 32);
    }
    out.push_str("<path d=\"M365 403h24\" stroke=\"#d6246e\" stroke-width=\"2\"/>\n");
    out.push_str("<text x=\"397\" y=\"409\" font-size=\"15\" fill=\"#1c2733\">around pixels that show the wrong bar</text>\n</svg>\n");
    Ok(out)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("the name of the picture to write is missing")?;
    Ok(std::fs::write(path, picture()?)?)
}
