//! Where a property begins to hold, found with few questions.

/// The first index from `start` to before `end` that has a property which all later ones have too; `end` if none has.
/// Looks first where it is expected, then in growing steps around that. O(log distance) questions.
///
/// If the property is not monotone, some index that has it, or `end`.
pub(super) fn first_true(start: u32, end: u32, guess: u32, mut has: impl FnMut(u32) -> bool) -> u32 {
    // `low` and what is before it has not, as far as known; `high` has.
    let (mut low, mut high) = (start, end);
    let mut step = 1;
    if guess < end && has(guess) {
        high = guess;
        while low < high {
            let at = high.saturating_sub(step).max(low);
            if !has(at) {
                low = at + 1;
                break;
            }
            (high, step) = (at, 2 * step);
        }
    } else {
        low = (guess + 1).min(end).max(start);
        if guess >= end {
            // Most often there still is none.
            low = start;
            if start < end && !has(end - 1) {
                return end;
            }
            high = if start < end { end - 1 } else { end };
        }
        while low < high {
            let at = (low + step - 1).min(high - 1);
            if has(at) {
                high = at;
                break;
            }
            (low, step) = (at + 1, 2 * step);
        }
    }
    while low < high {
        let middle = low + (high - low) / 2;
        if has(middle) { high = middle } else { low = middle + 1 }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_found_wherever_they_are_expected() {
        let mut n_cases = 0;
        for (start, end) in (0..12).flat_map(|start| (start..12).map(move |end| (start, end))) {
            for (guess, first) in (start..=end).flat_map(|guess| (start..=end).map(move |first| (guess, first))) {
                let mut n_asked = 0;
                let found = first_true(start, end, guess, |at| {
                    assert!((start..end).contains(&at));
                    n_asked += 1;
                    at >= first
                });
                assert_eq!(found, first, "from {start} to {end}, expected at {guess}");
                assert!(n_asked <= 2 || guess != first, "{n_asked} questions");
                n_cases += 1;
            }
        }
        assert_eq!(n_cases, 2366);
    }
}
