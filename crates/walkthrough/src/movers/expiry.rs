//! When volumes expire.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A time with a slot; the earliest is the greatest, ties by slot.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Entry {
    time: f64,
    slot: u32,
    stamp: u64,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time).then(other.slot.cmp(&self.slot)).then(other.stamp.cmp(&self.stamp))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The volumes that expire, the earliest first. A cancelled entry stays in the heap until its time comes or the heap is
/// swept.
#[derive(Debug, Clone, Default)]
pub(super) struct Expiries {
    heap: BinaryHeap<Entry>,
    /// For each slot the stamp of the valid entry; 0 for none.
    stamps: Vec<u64>,
    last_stamp: u64,
    n_set: usize,
}

impl Expiries {
    /// From now on the volume of a slot expires after `time`; never, if that is infinite. O(log n).
    pub(super) fn set(&mut self, slot: u32, time: f64) {
        self.unset(slot);
        if time == f64::INFINITY {
            return;
        }
        if self.stamps.len() <= slot as usize {
            self.stamps.resize(slot as usize + 1, 0);
        }
        self.last_stamp += 1;
        self.stamps[slot as usize] = self.last_stamp;
        self.n_set += 1;
        self.heap.push(Entry { time, slot, stamp: self.last_stamp });
        // The entries cancelled since the last sweep pay for each sweep.
        if self.heap.len() > 2 * self.n_set + 64 {
            let stamps = &self.stamps;
            self.heap.retain(|entry| stamps[entry.slot as usize] == entry.stamp);
        }
    }

    /// The slot no longer has a volume. O(1).
    pub(super) fn unset(&mut self, slot: u32) {
        if let Some(stamp) = self.stamps.get_mut(slot as usize)
            && *stamp != 0
        {
            *stamp = 0;
            self.n_set -= 1;
        }
    }

    /// Removes a slot whose volume expired before `now`, the earliest first. O(log n).
    pub(super) fn pop(&mut self, now: f64) -> Option<u32> {
        while let Some(&Entry { time, slot, stamp }) = self.heap.peek() {
            let counts = self.stamps[slot as usize] == stamp;
            if counts && time >= now {
                return None;
            }
            self.heap.pop();
            if counts {
                self.unset(slot);
                return Some(slot);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Invariant: popped slots are those of a plain list, and the heap does not grow with cancelled entries.
        #[test]
        fn pops_are_those_of_a_list(steps in prop::collection::vec((0u32..6, 0u32..30, any::<bool>()), 1..400)) {
            let mut expiries = Expiries::default();
            let mut list = [f64::INFINITY; 6];
            for (k, (slot, span, unset)) in steps.into_iter().enumerate() {
                let now = k as f64;
                let mut expected: Vec<(f64, u32)> =
                    (0u32..).zip(list).filter(|(_, time)| *time < now).map(|(slot, time)| (time, slot)).collect();
                expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
                let popped: Vec<u32> = std::iter::from_fn(|| expiries.pop(now)).collect();
                prop_assert_eq!(&popped, &expected.iter().map(|e| e.1).collect::<Vec<_>>());
                popped.iter().for_each(|&slot| list[slot as usize] = f64::INFINITY);
                let time = if unset || span == 29 { f64::INFINITY } else { now + f64::from(span) };
                list[slot as usize] = time;
                match unset {
                    true => expiries.unset(slot),
                    false => expiries.set(slot, time),
                }
                prop_assert_eq!(expiries.n_set, list.iter().filter(|time| time.is_finite()).count());
                prop_assert!(expiries.heap.len() <= 2 * 6 + 66);
            }
        }
    }
}
