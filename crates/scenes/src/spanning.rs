//! A random spanning tree of a grid of rooms, with a few more passages.

use crate::rng::Rng;

/// Which neighbours in a grid of `w` times `h` rooms are joined.
#[derive(Debug, Clone)]
pub(crate) struct Passages {
    w: usize,
    /// `east[y * w + x]`: whether room (x, y) is joined with (x + 1, y).
    east: Vec<bool>,
    /// `north[y * w + x]`: whether room (x, y) is joined with (x, y + 1).
    north: Vec<bool>,
}

impl Passages {
    /// Joins all rooms by a tree, found depth first, then every other pair once in `loops` times.
    pub(crate) fn random(rng: &mut Rng, w: usize, h: usize, loops: usize) -> Self {
        let mut passages = Self { w, east: vec![false; w * h], north: vec![false; w * h] };
        let mut seen = vec![false; w * h];
        let start = rng.below(w * h);
        seen[start] = true;
        let mut stack = vec![start];
        while let Some(&room) = stack.last() {
            let next: Vec<usize> = neighbours(room, w, h).into_iter().flatten().filter(|&n| !seen[n]).collect();
            if next.is_empty() {
                stack.pop();
                continue;
            }
            let to = next[rng.below(next.len())];
            passages.join(room, to);
            seen[to] = true;
            stack.push(to);
        }
        for room in 0..w * h {
            passages.east[room] |= room % w + 1 < w && rng.one_in(loops);
            passages.north[room] |= room / w + 1 < h && rng.one_in(loops);
        }
        passages
    }

    fn join(&mut self, a: usize, b: usize) {
        let (low, high) = (a.min(b), a.max(b));
        if high - low == 1 && self.w > 1 {
            self.east[low] = true;
        } else {
            self.north[low] = true;
        }
    }

    /// Whether (x, y) is joined with (x + 1, y).
    pub(crate) fn east(&self, x: usize, y: usize) -> bool {
        self.east[y * self.w + x]
    }

    /// Whether (x, y) is joined with (x, y + 1).
    pub(crate) fn north(&self, x: usize, y: usize) -> bool {
        self.north[y * self.w + x]
    }
}

fn neighbours(room: usize, w: usize, h: usize) -> [Option<usize>; 4] {
    let (x, y) = (room % w, room / w);
    [
        (x + 1 < w).then_some(room + 1),
        (y + 1 < h).then_some(room + w),
        (x > 0).then(|| room - 1),
        (y > 0).then(|| room - w),
    ]
}
