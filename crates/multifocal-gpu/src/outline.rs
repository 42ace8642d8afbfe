//! Polygons around forms, for the rasteriser.

use sightlines_multifocal::{Form, Forms};

/// Texels that a polygon reaches beyond the middles of those that pass: far more than the rasteriser's grid of 1/16
/// texel or finer, and what floats lose of places up to 2^13.
const BEYOND: f64 = 0.75;

/// Appends the corners of triangles that cover the middles of all texels of `form`, with room to spare: places in
/// normalised device coordinates, as bytes, each with `form_idx`.
///
/// The polygon is the window of the form, reaching beyond it, cut by its edges, moved outwards.
pub(crate) fn put_triangles(forms: &Forms, form: &Form, form_idx: u32, texels: [u32; 2], out: &mut Vec<u8>) {
    let polygon = polygon(forms, form);
    let [w, h] = texels.map(f64::from);
    for i in 2..polygon.len() {
        for [x, y] in [polygon[0], polygon[i - 1], polygon[i]] {
            let place = [(2.0 * x / w - 1.0) as f32, (1.0 - 2.0 * y / h) as f32];
            place.iter().for_each(|z| out.extend_from_slice(&z.to_le_bytes()));
            out.extend_from_slice(&form_idx.to_le_bytes());
        }
    }
}

/// In texels, convex; fewer than three corners if it is empty.
fn polygon(forms: &Forms, form: &Form) -> Vec<[f64; 2]> {
    let [x0, y0, x1, y1] = form.bounds.map(f64::from);
    let (x0, y0, x1, y1) = (x0 - BEYOND, y0 - BEYOND, x1 + BEYOND, y1 + BEYOND);
    let mut polygon = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    let mut cut = Vec::new();
    for &[a, b, c] in forms.edges_of(form) {
        let (a, b, c) = (f64::from(a), f64::from(b), f64::from(c));
        // The integers ask at a texel's lower corner, the rasteriser at its middle.
        let c = c - (a + b) / 2.0 + BEYOND * a.hypot(b);
        cut_off(&polygon, |[x, y]| a * x + b * y + c, &mut cut);
        std::mem::swap(&mut polygon, &mut cut);
    }
    polygon
}

/// The part where `f` is not negative.
fn cut_off(polygon: &[[f64; 2]], f: impl Fn([f64; 2]) -> f64, out: &mut Vec<[f64; 2]>) {
    out.clear();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (fp, fq) = (f(p), f(q));
        if fp >= 0.0 {
            out.push(p);
        }
        if (fp >= 0.0) != (fq >= 0.0) {
            let t = fp / (fp - fq);
            out.push([p[0] + (q[0] - p[0]) * t, p[1] + (q[1] - p[1]) * t]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(edges: Vec<[i32; 3]>, bounds: [i32; 4]) -> Forms {
        let form = Form { bounds, first_edge: 0, n_edges: edges.len() as u32, floor: 1, first_slope: 0, n_slopes: 0 };
        Forms { forms: vec![form], edges, slopes: Vec::new() }
    }

    #[test]
    fn a_polygon_covers_what_passes_and_not_much_more() {
        // Texels (x, y) with x + y <= 5 within 8 x 8.
        let forms = sample(vec![[-1, -1, 5]], [0, 0, 8, 8]);
        let polygon = polygon(&forms, &forms.forms[0]);
        assert!(polygon.len() == 3, "{polygon:?}");
        let area: f64 = (0..3)
            .map(|i| {
                let (p, q) = (polygon[i], polygon[(i + 1) % 3]);
                (p[0] * q[1] - p[1] * q[0]) / 2.0
            })
            .sum();
        // The 21 texels that pass, and a border of less than two around them.
        assert!(area > 21.0 && area < 45.0, "{area}");
    }

    #[test]
    fn an_edge_that_nothing_passes_leaves_nothing() {
        let forms = sample(vec![[1, 0, -100]], [0, 0, 8, 8]);
        let mut bytes = Vec::new();
        put_triangles(&forms, &forms.forms[0], 0, [8, 8], &mut bytes);
        assert!(bytes.is_empty());
    }
}
