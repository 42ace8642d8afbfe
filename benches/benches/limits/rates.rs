//! What this machine does in a second, on one thread.

use std::hint::black_box;
use std::time::Instant;

/// Rates that bounds are made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rates {
    /// Bytes a second, from memory.
    pub(crate) memory: f64,
    /// Bytes a second, from the first caches.
    pub(crate) cache: f64,
    /// Seconds for an orientation of three points in plain doubles.
    pub(crate) orient2: f64,
    /// Seconds for an orientation of four points in plain doubles.
    pub(crate) orient3: f64,
}

/// The least time of several runs, in seconds; at least three, and for about a quarter of a second.
pub(crate) fn least(mut act: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let (mut least, mut n) = (f64::INFINITY, 0);
    while n < 3 || begin.elapsed().as_secs_f64() < 0.25 {
        let start = Instant::now();
        act();
        least = least.min(start.elapsed().as_secs_f64());
        n += 1;
    }
    least
}

fn read(words: &[u64], times: usize) -> f64 {
    let seconds = least(|| {
        for _ in 0..times {
            let sum = |words: &[u64]| words.iter().fold(0u64, |sum, w| sum.wrapping_add(*w));
            black_box(sum(black_box(words)));
        }
    });
    (words.len() * 8 * times) as f64 / seconds
}

impl Rates {
    pub(crate) fn measure(short: bool) -> Self {
        let words = vec![1u64; if short { 1 << 20 } else { 1 << 25 }];
        let n = 4096usize;
        let numbers: Vec<f64> = (0..n + 16).map(|i| (i as f64 * 0.37).fract()).collect();
        let orient2 = least(|| {
            let mut sum = 0.0;
            for i in 0..n {
                let p = &black_box(&numbers)[i..i + 6];
                sum += (p[0] - p[4]) * (p[3] - p[5]) - (p[1] - p[5]) * (p[2] - p[4]);
            }
            black_box(sum);
        });
        let orient3 = least(|| {
            let mut sum = 0.0;
            for i in 0..n {
                let p = &black_box(&numbers)[i..i + 12];
                let d = |a: usize, k: usize| p[3 * a + k] - p[9 + k];
                let minor = |b: usize, c: usize, i: usize, j: usize| d(b, i) * d(c, j) - d(b, j) * d(c, i);
                sum += d(0, 0) * minor(1, 2, 1, 2) - d(0, 1) * minor(1, 2, 0, 2) + d(0, 2) * minor(1, 2, 0, 1);
            }
            black_box(sum);
        });
        Self {
            memory: read(&words, 1),
            cache: read(&words[..2048], 1000),
            orient2: orient2 / n as f64,
            orient3: orient3 / n as f64,
        }
    }
}
