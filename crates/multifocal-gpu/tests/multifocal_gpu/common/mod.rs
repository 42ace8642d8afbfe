//! A device for tests, chance, and what buffers should hold.

pub(crate) mod scene;

use sightlines_geometry::Random;
use sightlines_multifocal::{Buffer, Carry, Form, Forms};
use sightlines_multifocal_gpu::{Gpu, PlaneForms};
use std::io::Write;
use std::sync::OnceLock;

/// The device, shared by the tests of a program; None, loudly, if there is none.
///
/// With `SIGHTLINES_GPU=require` there has to be one, with `off` none is looked for. The line on standard output is
/// counted by `cargo xtask test`.
pub(crate) fn gpu(test: &str) -> Option<Gpu> {
    static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
    let wish = std::env::var("SIGHTLINES_GPU").unwrap_or_default();
    assert!(["", "auto", "off", "require"].contains(&wish.as_str()), "SIGHTLINES_GPU={wish} is no wish");
    let off = || Err("SIGHTLINES_GPU=off".to_owned());
    let opened = GPU.get_or_init(|| if wish == "off" { off() } else { Gpu::open().map_err(|e| e.to_string()) });
    match opened {
        Ok(gpu) => Some(gpu.clone()),
        Err(reason) => {
            assert_ne!(wish, "require", "a GPU is required: {reason}");
            // Not captured, unlike print.
            let _ = writeln!(std::io::stdout(), "\nGPU test not run: {test}: {reason}");
            None
        }
    }
}

/// Pseudorandom numbers of ranges.
#[derive(Debug, Clone)]
pub(crate) struct Chance(Random);

impl Chance {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(Random::new(seed))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0.bits()
    }

    /// From `low` to before `high`.
    pub(crate) fn int(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % (high - low) as u64) as i64
    }

    /// From `low` to before `high`.
    pub(crate) fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The value of a texel, straight from the words of the integer form.
fn value(forms: &Forms, form: &Form, x: i32, y: i32) -> u32 {
    let [x0, y0, x1, y1] = form.bounds;
    let inside = x0 <= x && x < x1 && y0 <= y && y < y1;
    if !inside || forms.edges_of(form).iter().any(|&[a, b, c]| a * x + b * y + c < 0) {
        return 0;
    }
    let slope = |&[p, q, r]: &[i32; 3]| (r + p * (x - x0) + q * (y - y0)).max(0) as u32;
    forms.slopes_of(form).iter().map(slope).fold(form.floor, u32::max)
}

/// What is carried over to a texel.
fn carried(carry: &Carry, before: &Buffer, x: u32, y: u32) -> u32 {
    let ([x0, x1], [y0, y1]) = (carry.columns[x as usize], carry.rows[y as usize]);
    let all = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| before.get(x, y)));
    match all.min() {
        Some(least) if least > 0 => least + carry.rise,
        _ => 0,
    }
}

/// What the buffers of a job should hold.
pub(crate) fn expected(planes: &[PlaneForms]) -> Vec<Buffer> {
    let mut out: Vec<Buffer> = Vec::new();
    for plane in planes {
        let mut buffer = Buffer::default();
        buffer.reset(plane.texels);
        let [w, h] = plane.texels;
        for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
            let direct = plane.forms.forms.iter().map(|f| value(&plane.forms, f, x as i32, y as i32)).max();
            let over = plane.carry.as_ref().zip(out.last()).map(|(carry, before)| carried(carry, before, x, y));
            buffer.values_mut()[(y * w + x) as usize] = direct.unwrap_or(0).max(over.unwrap_or(0));
        }
        out.push(buffer);
    }
    out
}

/// Forms as they may come out of any scene, and stranger ones: slivers, edges through corners of tiles, many edges,
/// bounds of one texel.
pub(crate) fn random_forms(chance: &mut Chance, texels: [u32; 2], n: usize) -> Forms {
    let mut out = Forms::default();
    for _ in 0..n {
        let bounds = random_bounds(chance, texels);
        let n_edges = [0, 1, 3, 4, 4, 5, 40][chance.int(0, 7) as usize];
        let n_slopes = [0, 0, 1, 2][chance.int(0, 4) as usize];
        let first_edge = out.edges.len() as u32;
        let first_slope = out.slopes.len() as u32;
        let largest = (1 << 28) / i64::from(texels[0].max(texels[1]));
        for i in 0..n_edges {
            // Through a texel of the bounds, mostly with its middle on the inner side.
            let [x0, y0, x1, y1] = bounds.map(i64::from);
            let scale = if i % 3 == 0 { 8 } else { largest };
            let (mut a, mut b) = (chance.int(-scale, scale + 1), chance.int(-scale, scale + 1));
            let (x, y) = (chance.int(x0, x1), chance.int(y0, y1));
            if a * ((x0 + x1) / 2 - x) + b * ((y0 + y1) / 2 - y) < 0 && chance.int(0, 8) > 0 {
                (a, b) = (-a, -b);
            }
            let c = (-a * x - b * y).clamp(-(1 << 29), 1 << 29);
            out.edges.push([a as i32, b as i32, c as i32]);
        }
        for _ in 0..n_slopes {
            let steep = (1 << 26) / i64::from(texels[0].max(texels[1]));
            let slope = [chance.int(-steep, steep + 1), chance.int(-steep, steep + 1), chance.int(-1000, 1 << 26)];
            out.slopes.push(slope.map(|n| n as i32));
        }
        let floor = if chance.int(0, 4) == 0 { 1 } else { chance.int(1, 1 << 27) as u32 };
        out.forms.push(Form { bounds, first_edge, n_edges, floor, first_slope, n_slopes });
    }
    out
}

fn random_bounds(chance: &mut Chance, texels: [u32; 2]) -> [i32; 4] {
    let mut side = |n: u32| {
        let n = i64::from(n);
        let a = chance.int(0, n);
        let b = if chance.int(0, 3) == 0 { chance.int(a, n.min(a + 4)) } else { chance.int(a, n) };
        if chance.int(0, 8) == 0 { (0, n as i32) } else { (a as i32, b as i32 + 1) }
    };
    let ((x0, x1), (y0, y1)) = (side(texels[0]), side(texels[1]));
    [x0, y0, x1, y1]
}

/// A carry between windows: ranges that move along like projections, some of them outside, some of any shape.
pub(crate) fn random_carry(chance: &mut Chance, before: [u32; 2], after: [u32; 2]) -> Carry {
    let mut ranges = |k: usize| {
        let (n, length) = (i64::from(before[k]), chance.int(0, 40));
        let one = |i: u32| {
            let first = i64::from(i) * n / i64::from(after[k]) - length / 2;
            let last = first + length;
            match chance.int(0, 12) {
                0 => [1, 0],
                1 => {
                    let a = chance.int(0, n);
                    [a as u32, chance.int(a, n) as u32]
                }
                _ if first < 0 || last >= n => [1, 0],
                _ => [first as u32, last as u32],
            }
        };
        (0..after[k]).map(one).collect()
    };
    Carry { columns: ranges(0), rows: ranges(1), rise: chance.int(0, 1000) as u32 }
}
