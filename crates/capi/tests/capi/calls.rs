//! Random sequences of calls.

use sightlines_capi::fuzz::drive;

/// Bytes of chance.
fn bytes(seed: u64, n: usize) -> Vec<u8> {
    let mut state = seed;
    let next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 56) as u8
    };
    std::iter::repeat_with(next).take(n).collect()
}

#[test]
fn no_sequence_of_calls_breaks_the_border() {
    let (mut n_calls, mut n_fruitful) = (0, 0);
    for seed in 0..60 {
        let n = drive(&bytes(seed, 5000));
        n_calls += n;
        n_fruitful += usize::from(n > 50);
    }
    assert!(n_calls > 3000 && n_fruitful >= 30, "{n_calls} calls succeeded, in {n_fruitful} sequences many");
}
