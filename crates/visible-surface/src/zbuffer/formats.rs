//! How a depth is kept.

/// Where formats from 0 to 1 begin if the camera sees from depth 0 on.
const NEAR: f64 = 1.0 / 64.0;

/// A form of depth.
pub(super) trait Format: Copy {
    type Depth: Copy + PartialEq;
    /// What is behind everything, or at the farthest depth.
    const FARTHEST: Self::Depth;
    /// What is kept for one over a depth.
    fn depth(self, nearness: f64) -> Self::Depth;
    fn is_nearer(a: Self::Depth, b: Self::Depth) -> bool;
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Double;

impl Format for Double {
    type Depth = f64;
    const FARTHEST: f64 = f64::NEG_INFINITY;
    fn depth(self, nearness: f64) -> f64 {
        nearness
    }
    fn is_nearer(a: f64, b: f64) -> bool {
        a > b
    }
}

/// `1 / near` and `1 / far`; the form from 0 to 1 is linear in between.
#[derive(Debug, Clone, Copy)]
struct Range {
    near: f64,
    far: f64,
}

impl Range {
    fn new([near, far]: [f64; 2]) -> Self {
        let near = if near > 0.0 { near } else { NEAR.min(far / 2.0) };
        Self { near: 1.0 / near, far: 1.0 / far }
    }

    /// 1 at the nearest depth, 0 at the farthest.
    fn reversed(self, nearness: f64) -> f64 {
        ((nearness - self.far) / (self.near - self.far)).clamp(0.0, 1.0)
    }

    /// 0 at the nearest depth, 1 at the farthest.
    fn standard(self, nearness: f64) -> f64 {
        ((self.near - nearness) / (self.near - self.far)).clamp(0.0, 1.0)
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct F32(Range);

impl F32 {
    pub(super) fn new(depths: [f64; 2]) -> Self {
        Self(Range::new(depths))
    }
}

impl Format for F32 {
    type Depth = f32;
    const FARTHEST: f32 = f32::INFINITY;
    fn depth(self, nearness: f64) -> f32 {
        self.0.standard(nearness) as f32
    }
    fn is_nearer(a: f32, b: f32) -> bool {
        a < b
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct F32Reversed(Range);

impl F32Reversed {
    pub(super) fn new(depths: [f64; 2]) -> Self {
        Self(Range::new(depths))
    }
}

impl Format for F32Reversed {
    type Depth = f32;
    const FARTHEST: f32 = f32::NEG_INFINITY;
    fn depth(self, nearness: f64) -> f32 {
        self.0.reversed(nearness) as f32
    }
    fn is_nearer(a: f32, b: f32) -> bool {
        a > b
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct U24(Range);

impl U24 {
    pub(super) fn new(depths: [f64; 2]) -> Self {
        Self(Range::new(depths))
    }
}

impl Format for U24 {
    type Depth = u32;
    const FARTHEST: u32 = u32::MAX;
    fn depth(self, nearness: f64) -> u32 {
        (self.0.standard(nearness) * f64::from((1u32 << 24) - 1)).round() as u32
    }
    fn is_nearer(a: u32, b: u32) -> bool {
        a < b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_go_from_near_to_far() {
        let range = [0.5, 8.0];
        assert_eq!([2.0, 0.125].map(|w| F32::new(range).depth(w)), [0.0, 1.0]);
        assert_eq!([2.0, 0.125].map(|w| F32Reversed::new(range).depth(w)), [1.0, 0.0]);
        assert_eq!([2.0, 0.125].map(|w| U24::new(range).depth(w)), [0, (1 << 24) - 1]);
        // What is nearer than the nearest counts as there; without a nearest depth it is 1/64.
        assert_eq!(F32::new([0.0, f64::INFINITY]).depth(1000.0), 0.0);
        assert_eq!(F32Reversed::new([0.0, f64::INFINITY]).depth(32.0), 0.5);
    }
}
