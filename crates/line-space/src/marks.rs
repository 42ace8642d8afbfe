//! Marks that are forgotten all at once.

/// A value for some of `n` indices.
#[derive(Debug)]
pub(crate) struct Marks<T> {
    epoch: u32,
    /// The epoch that the value is of; in epoch 0 nothing is marked.
    of: Vec<(u32, T)>,
}

impl<T: Copy + Default> Marks<T> {
    pub(crate) fn new(n: usize) -> Self {
        Self { epoch: 1, of: vec![(0, T::default()); n] }
    }

    /// O(1), but once in 2^32 times.
    pub(crate) fn forget(&mut self) {
        if self.epoch == u32::MAX {
            self.of.fill((0, T::default()));
            self.epoch = 0;
        }
        self.epoch += 1;
    }

    pub(crate) fn get(&self, i: u32) -> Option<T> {
        let (epoch, value) = self.of[i as usize];
        (epoch == self.epoch).then_some(value)
    }

    pub(crate) fn set(&mut self, i: u32, value: T) {
        self.of[i as usize] = (self.epoch, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_forgotten_also_when_epochs_begin_anew() {
        let mut marks = Marks::new(2);
        assert_eq!(marks.get(1), None);
        marks.set(1, 7);
        assert_eq!([marks.get(0), marks.get(1)], [None, Some(7)]);
        marks.forget();
        assert_eq!(marks.get(1), None);
        marks.epoch = u32::MAX;
        marks.set(0, 5);
        marks.of[1] = (1, 3);
        marks.forget();
        assert_eq!([marks.get(0), marks.get(1)], [None; 2]);
    }
}
