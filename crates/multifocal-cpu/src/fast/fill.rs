//! One row of one umbra.

use sightlines_multifocal::{Form, Forms};
use std::ops::Range;

/// Raises the values of row `y` to those of a form.
pub(super) fn fill(forms: &Forms, form: &Form, y: i32, row: &mut [u32]) {
    let span = span(forms.edges_of(form), form.bounds, y);
    if span.is_empty() {
        return;
    }
    let texels = &mut row[span.start as usize..span.end as usize];
    raise(texels, form.floor);
    let (dx, dy) = (span.start - form.bounds[0], y - form.bounds[1]);
    for &[p, q, r] in forms.slopes_of(form) {
        raise_along(texels, r + p * dx + q * dy, p);
    }
}

/// The texels of a row that pass all edges.
fn span(edges: &[[i32; 3]], [mut x0, _, mut x1, _]: [i32; 4], y: i32) -> Range<i32> {
    for &[a, b, c] in edges {
        let rest = b * y + c;
        if a > 0 {
            x0 = x0.max((-rest).div_euclid(a) + i32::from((-rest).rem_euclid(a) != 0));
        } else if a < 0 {
            x1 = x1.min(rest.div_euclid(-a) + 1);
        } else if rest < 0 {
            return 0..0;
        }
    }
    x0..x1.max(x0)
}

fn raise(texels: &mut [u32], value: u32) {
    for v in texels {
        *v = (*v).max(value);
    }
}

/// Raises to a value that changes by `step` from texel to texel, and may be negative.
fn raise_along(texels: &mut [u32], start: i32, step: i32) {
    for (i, v) in (0i32..).zip(texels) {
        *v = (*v).max((start + step * i).max(0) as u32);
    }
}
