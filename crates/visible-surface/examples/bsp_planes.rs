//! A binary space partition from above: walls, the planes that cut them, the tree of these planes, and the order that it gives an eye.
//!
//! `cargo run -p sightlines-visible-surface --example bsp_planes -- OUT.svg`

use sightlines_visible_surface::bsp::{BspOptions, FaceBsp, FaceBspNode, Heuristic};
use sightlines_visible_surface::{Camera, Counters, FaceMask, Faces, RenderInput, RenderOutput, VisibleSurface};
use std::error::Error;
use std::fmt::Write;

/// Walls from above, each from one end to the other.
const WALLS: [[[f64; 2]; 2]; 6] = [
    [[2.0, 5.0], [7.0, 5.5]],
    [[4.0, 1.0], [4.5, 8.0]],
    [[7.5, 1.5], [8.5, 4.0]],
    [[1.0, 7.0], [3.0, 9.0]],
    [[6.0, 7.5], [9.0, 7.0]],
    [[1.0, 1.5], [2.5, 3.5]],
];
/// The side of the square around them.
const SIDE: f64 = 10.0;
const EYE: [f64; 2] = [9.0, 0.7];
/// Pixels for a unit, and the upper left corner of the plan.
const UNIT: f64 = 42.0;
const AT: [f64; 2] = [20.0, 60.0];

fn letter(node: usize) -> char {
    char::from(b'A' + node as u8)
}

fn place([x, y]: [f64; 2]) -> [f64; 2] {
    [AT[0] + x * UNIT, AT[1] + (SIDE - y) * UNIT]
}

fn text(out: &mut String, [x, y]: [f64; 2], size: u32, words: &str) {
    let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"#1c2733\">{words}</text>");
}

fn line(out: &mut String, ends: [[f64; 2]; 2], style: &str) {
    let [[x1, y1], [x2, y2]] = ends;
    let _ = writeln!(out, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>");
}

/// A label in a circle.
fn disc(out: &mut String, [x, y]: [f64; 2], label: char) {
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"12\" fill=\"#fff\" stroke=\"#12a594\" stroke-width=\"2\"/>"
    );
    let _ =
        writeln!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"14\" text-anchor=\"middle\">{label}</text>", y + 5.0);
}

/// Which side of the line through a wall a point is on; positive in front of the wall's face.
fn side(wall: usize, [x, y]: [f64; 2]) -> f64 {
    let [[x0, y0], [x1, y1]] = WALLS[wall];
    (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
}

/// The part of a convex region on one side of a wall's line, and the line's part within the region.
fn cut(region: &[[f64; 2]], wall: usize, sign: f64) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let (mut part, mut chord) = (Vec::new(), Vec::new());
    for i in 0..region.len() {
        let (a, b) = (region[i], region[(i + 1) % region.len()]);
        let (sa, sb) = (sign * side(wall, a), sign * side(wall, b));
        if sa >= 0.0 {
            part.push(a);
        }
        if (sa < 0.0) != (sb < 0.0) {
            let t = sa / (sa - sb);
            let p = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
            part.push(p);
            chord.push(p);
        }
    }
    (part, chord)
}

/// The nodes below one, the farthest from the eye first: those on the other side of the plane, the node, those on the eye's side.
fn back_to_front(nodes: &[FaceBspNode], node: usize) -> Vec<usize> {
    let [behind, front] = nodes[node].children;
    let is_in_front = side(nodes[node].faces[0] as usize, EYE) > 0.0;
    let [far, near] = if is_in_front { [behind, front] } else { [front, behind] };
    let below = |child: Option<u32>| child.map_or(Vec::new(), |child| back_to_front(nodes, child as usize));
    [below(far), vec![node], below(near)].concat()
}

/// The picture.
///
/// # Errors
/// None that these walls have.
pub(crate) fn picture() -> Result<String, Box<dyn Error>> {
    // Upright triangles, whose planes are upright too: x to the right, y up, z into the plan.
    let faces = Faces::new(WALLS.map(|[[x0, z0], [x1, z1]]| [[x0, 0.0, z0], [x1, 0.0, z1], [x0, 2.0, z0]]).to_vec())?;
    let options = BspOptions { heuristic: Heuristic::FirstFace, axis_above: usize::MAX, ..BspOptions::default() };
    let bsp = FaceBsp::build(&faces, &options);
    let nodes: Vec<FaceBspNode> = bsp.nodes().collect();
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\" height=\"620\" viewBox=\"0 0 1000 620\" \
         font-family=\"sans-serif\">\n<title>A BSP and its planes</title>\n<rect width=\"1000\" height=\"620\" fill=\"#fff\"/>\n",
    );
    text(&mut out, [20.0, 30.0], 20, "A BSP from above: each wall's plane cuts what is left of the space");
    text(&mut out, [500.0, 75.0], 16, "The tree: left behind the plane, right in front of it");
    // Each node with its region, its depth, and the stretch of the tree's width that is its own.
    let square = vec![[0.0, 0.0], [SIDE, 0.0], [SIDE, SIDE], [0.0, SIDE]];
    let mut todo = vec![(0usize, square, 0u32, [490.0, 980.0], None)];
    let mut discs = Vec::new();
    while let Some((node, region, depth, [low, high], parent)) = todo.pop() {
        let wall = nodes[node].faces[0] as usize;
        let (_, chord) = cut(&region, wall, 1.0);
        if let [a, b] = chord[..] {
            line(
                &mut out,
                [place(a), place(b)],
                "class=\"plane\" stroke=\"#12a594\" stroke-width=\"1.5\" stroke-dasharray=\"6 4\"",
            );
            // Beside the middle of what the plane cuts.
            discs.push((place([0.7 * a[0] + 0.3 * b[0], 0.7 * a[1] + 0.3 * b[1]]), letter(node)));
        }
        let here = [0.5 * (low + high), 120.0 + 75.0 * f64::from(depth)];
        if let Some(parent) = parent {
            line(&mut out, [parent, here], "class=\"branch\" stroke=\"#9aa5b1\" stroke-width=\"2\"");
        }
        discs.push((here, letter(node)));
        let shares = [[low, here[0]], [here[0], high]];
        for ((child, sign), share) in nodes[node].children.into_iter().zip([-1.0, 1.0]).zip(shares) {
            if let Some(child) = child {
                todo.push((child as usize, cut(&region, wall, sign).0, depth + 1, share, Some(here)));
            }
        }
    }
    for wall in WALLS {
        line(
            &mut out,
            wall.map(place),
            "class=\"wall\" stroke=\"#1c2733\" stroke-width=\"5\" stroke-linecap=\"round\"",
        );
    }
    discs.into_iter().for_each(|(at, label)| disc(&mut out, at, label));
    let [x, y] = place(EYE);
    let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\" fill=\"#d6246e\"/>");
    // The order for the eye, by the crate itself.
    let camera = Camera::look_at([EYE[0], 1.0, EYE[1]], [5.0, 1.0, 5.0], [0.0, 1.0, 0.0], 170.0, [64, 64])?;
    let chosen = FaceMask::all(&faces);
    let seen = bsp.see(&RenderInput { faces: &faces, camera: &camera, mask: &chosen }, &mut Counters::default());
    let RenderOutput::BackToFront(fragments) = seen else { return Err("the order is from back to front".into()) };
    let order = back_to_front(&nodes, 0);
    if !order.iter().map(|&node| nodes[node].faces[0]).eq(fragments.iter().map(|fragment| fragment.face())) {
        return Err("the tree has another order than its walk".into());
    }
    let order: Vec<String> = order.into_iter().map(|node| letter(node).to_string()).collect();
    let stats = bsp.stats();
    text(
        &mut out,
        [20.0, 520.0],
        15,
        &format!("{} walls, {} pieces; splits: {}", stats.faces, stats.fragments, stats.splits),
    );
    text(
        &mut out,
        [20.0, 545.0],
        15,
        &format!("Pieces from back to front for the eye, by the plane they lie in: {}", order.join(" ")),
    );
    line(&mut out, [[20.0, 585.0], [60.0, 585.0]], "stroke=\"#1c2733\" stroke-width=\"5\"");
    text(&mut out, [70.0, 590.0], 14, "wall");
    line(
        &mut out,
        [[150.0, 585.0], [190.0, 585.0]],
        "stroke=\"#12a594\" stroke-width=\"1.5\" stroke-dasharray=\"6 4\"",
    );
    text(&mut out, [200.0, 590.0], 14, "plane, within the region that it cuts");
    out.push_str("<circle cx=\"490\" cy=\"585\" r=\"7\" fill=\"#d6246e\"/>\n");
    text(&mut out, [505.0, 590.0], 14, "eye");
    out.push_str("</svg>\n");
    Ok(out)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("the name of the picture to write is missing")?;
    Ok(std::fs::write(path, picture()?)?)
}
