//! Exact numbers against two other methods: `i128` on small grids, and the fractions of `num-rational`.

use proptest::prelude::*;
use sightlines_exact::{BigInt, BigRational, Dyadic, Fraction, Grid, decode, rational, vector};

/// Doubles of very different sizes.
fn number() -> impl Strategy<Value = f64> {
    (-1000i32..1000, -140i32..140).prop_map(|(m, e)| f64::from(m) * 2f64.powi(e))
}

/// Sixteenths below 4096 in magnitude, and how many of them.
fn sixteenths() -> impl Strategy<Value = [(f64, i128); 3]> {
    prop::array::uniform3((-65_536i64..65_536).prop_map(|n| (n as f64 / 16.0, i128::from(n))))
}

fn sign(x: &BigRational) -> i32 {
    x.cmp(&BigRational::from_integer(0.into())) as i32
}

fn determinant_i128([a, b, c]: [[i128; 3]; 3]) -> i128 {
    // The rule of Sarrus, not the product of vectors that the crate uses.
    a[0] * b[1] * c[2] + a[1] * b[2] * c[0] + a[2] * b[0] * c[1]
        - a[2] * b[1] * c[0]
        - a[1] * b[0] * c[2]
        - a[0] * b[2] * c[1]
}

proptest! {
    #[test]
    fn dyadic_numbers_are_not_rounded(x in number(), y in number(), z in number()) {
        let [a, b, c] = [x, y, z].map(Dyadic::new);
        let got = &(&(&a * &b) + &c) - &(&b * &c);
        let want = rational(x) * rational(y) + rational(z) - rational(y) * rational(z);
        prop_assert_eq!(got.sign(), sign(&want));
        prop_assert_eq!((-got.clone()).sign(), -sign(&want));
        // The double beside it is as near as is promised.
        let off = rational(got.to_f64()) - &want;
        let magnitude = |x: BigRational| if sign(&x) < 0 { -x } else { x };
        prop_assert!(magnitude(off) <= magnitude(want) * rational(2f64.powi(-52)));
    }

    /// On a small grid `i128` holds everything: all three forms of a determinant agree with it.
    #[test]
    fn determinants_agree_with_small_integers(a in sixteenths(), b in sixteenths(), c in sixteenths(), flat in any::<bool>()) {
        // Half of the cases have a row that depends on the others, where rounding would show.
        let c = if flat { [0, 1, 2].map(|k| (a[k].0 + b[k].0, a[k].1 + b[k].1)) } else { c };
        let rows = [a, b, c].map(|row| row.map(|x| x.0));
        let want = determinant_i128([a, b, c].map(|row| row.map(|x| x.1)));
        let [u, v, w] = rows.map(Dyadic::vector);
        prop_assert_eq!(vector::determinant(&u, &v, &w).sign(), want.signum() as i32);
        let [u, v, w] = rows.map(|row| row.map(rational));
        let sixteenths_cubed = BigRational::from_integer(BigInt::from(4096));
        prop_assert_eq!(vector::determinant(&u, &v, &w) * sixteenths_cubed, BigRational::from_integer(want.into()));
        let grid = Grid::of(rows.into_iter().flatten().chain([0.0625])).expect("finite");
        prop_assert_eq!(grid.exponent(), -4);
        let [u, v, w] = rows.map(|row| grid.vector(row));
        prop_assert_eq!(vector::determinant(&u, &v, &w), BigInt::from(want));
    }

    #[test]
    fn normals_agree_with_small_integers(a in sixteenths(), b in sixteenths(), c in sixteenths()) {
        let grid = Grid::of([0.0625]).expect("finite");
        let corners = [a, b, c].map(|p| grid.vector(p.map(|x| x.0)));
        let normal = vector::normal(&corners);
        for (k, component) in normal.iter().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let at = |p: [(f64, i128); 3], k: usize| p[k].1 - a[k].1;
            prop_assert_eq!(component, &BigInt::from(at(b, i) * at(c, j) - at(b, j) * at(c, i)));
        }
        // A point of the plane: the normal does not see it.
        prop_assert_eq!(vector::dot(&normal, &vector::sub(&corners[1], &corners[0])), BigInt::ZERO);
        let twice = vector::scale(&normal, &BigInt::from(2));
        prop_assert_eq!(vector::cross(&normal, &twice), [BigInt::ZERO, BigInt::ZERO, BigInt::ZERO]);
    }

    /// Every double, subnormal ones too, is what its parts say.
    #[test]
    fn doubles_are_their_parts(bits in any::<u64>()) {
        let x = f64::from_bits(bits);
        let Some((mantissa, exponent)) = decode(x) else {
            prop_assert!(!x.is_finite());
            return Ok(());
        };
        prop_assert!(mantissa == 0 || mantissa % 2 != 0);
        let two = BigRational::from_integer(2.into());
        prop_assert_eq!(BigRational::from_integer(mantissa.into()) * two.pow(exponent), rational(x));
    }

    #[test]
    fn fractions_have_the_order_of_their_values(a in -50i64..50, b in 1i64..50, c in -50i64..50, d in 1i64..50) {
        let fraction = |n: i64, d: i64| Fraction::new(n.into(), d.into());
        let (p, q) = (fraction(a, b), fraction(c, d));
        prop_assert_eq!(p.cmp(&q), (a * d).cmp(&(c * b)));
        prop_assert_eq!(p == q, a * d == c * b);
        prop_assert!(p.clone().min(q.clone()) <= p.max(q));
    }
}

#[test]
fn numbers_beyond_doubles_are_kept() {
    let huge = Dyadic::new(2f64.powi(1000));
    let product = &(&huge * &huge) * &Dyadic::new(-3.0);
    assert_eq!(product.sign(), -1);
    assert_eq!(product.to_f64(), f64::NEG_INFINITY);
    let tiny = Dyadic::new(2f64.powi(-1000));
    assert_eq!((&(&tiny * &tiny) * &tiny).sign(), 1);
    assert_eq!((&product - &product).sign(), 0);
    assert_eq!(Dyadic::new(0.0).to_f64(), 0.0);
}

#[test]
fn coordinates_become_integers() {
    let grid = Grid::of([0.125, 1e6]).expect("finite");
    for (x, integer) in [(0.0, 0), (-0.0, 0), (1.0, 8), (-2.5, -20), (0.125, 1), (1e6, 8_000_000)] {
        assert_eq!(grid.integer(x), BigInt::from(integer), "{x}");
    }
    let fine = Grid::of([2f64.powi(-140)]).expect("finite");
    assert_eq!(fine.integer(2f64.powi(100)), BigInt::from(1) << 240u32);
    assert_eq!(Grid::of([]).map(Grid::exponent), Some(0));
    assert_eq!(Grid::of([0.0, 96.0]).map(Grid::exponent), Some(5));
    assert_eq!(Grid::of([1.0, f64::NAN]), None);
    assert_eq!((decode(f64::INFINITY), decode(-0.0), decode(-6.0)), (None, Some((0, 0)), Some((-3, 1))));
}

#[test]
#[should_panic(expected = "the grid divides its numbers")]
fn a_number_beside_the_grid_is_refused() {
    let _ = Grid::of([0.5]).expect("finite").integer(0.25);
}
