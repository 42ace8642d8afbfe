//! Prediction of the eye's path.

/// Follows an eye and extrapolates its motion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Path {
    last: Option<[f64; 3]>,
    /// Scene units a frame, smoothed.
    velocity: [f64; 3],
}

impl Path {
    /// The eye of a new frame.
    pub(crate) fn follow(&mut self, eye: [f64; 3]) {
        if let Some(last) = self.last {
            for k in 0..3 {
                let step = eye[k] - last[k];
                // Half of the old value: a turn is followed within a few frames, and jitter averages out.
                self.velocity[k] = 0.5 * (self.velocity[k] + step);
            }
        }
        self.last = Some(eye);
    }

    /// The predicted position of the eye some frames ahead.
    pub(crate) fn ahead(&self, frames: f64) -> Option<[f64; 3]> {
        let last = self.last?;
        let place = std::array::from_fn(|k| last[k] + frames * self.velocity[k]);
        place.iter().all(|x: &f64| x.is_finite()).then_some(place)
    }

    /// Whether the eye moves.
    pub(crate) fn moves(&self) -> bool {
        self.velocity.iter().any(|v| *v != 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_ways_are_foreseen() {
        let mut path = Path::default();
        assert_eq!(path.ahead(1.0), None);
        for x in 0..20 {
            path.follow([f64::from(x), 0.0, 1.0]);
        }
        let ahead = path.ahead(10.0).unwrap();
        assert!((ahead[0] - 29.0).abs() < 0.01 && ahead[1] == 0.0 && ahead[2] == 1.0);
        assert!(path.moves());
        (0..2000).for_each(|_| path.follow([19.0, 0.0, 1.0]));
        assert!(!path.moves());
    }
}
