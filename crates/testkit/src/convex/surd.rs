//! Numbers `a + b √d` with integers `a` and `b` and one `d` for all: what lines that touch four others have as
//! coordinates.

use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};

/// `a + b √d`; who holds it knows `d`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Surd {
    pub(super) a: BigInt,
    pub(super) b: BigInt,
}

impl Surd {
    /// The sign, exactly. `d` is not negative.
    pub(super) fn sign(&self, d: &BigInt) -> i32 {
        let (a, b) = (sign(&self.a), if d.is_zero() { 0 } else { sign(&self.b) });
        if a == b || b == 0 {
            a
        } else if a == 0 {
            b
        } else {
            match (&self.a * &self.a).cmp(&(&self.b * &self.b * d)) {
                std::cmp::Ordering::Greater => a,
                std::cmp::Ordering::Less => b,
                std::cmp::Ordering::Equal => 0,
            }
        }
    }

    /// The sum of some times integers.
    pub(super) fn dot(values: &[Self; 6], factors: &[BigInt; 6]) -> Self {
        let sum = |part: &dyn Fn(&Self) -> &BigInt| values.iter().zip(factors).map(|(v, f)| part(v) * f).sum();
        Self { a: sum(&|v| &v.a), b: sum(&|v| &v.b) }
    }
}

/// Some surds as doubles, all times one factor.
pub(super) fn approximate(values: &[Surd; 6], d: &BigInt) -> [f64; 6] {
    let bits = values.iter().map(|v| v.a.bits().max(v.b.bits() + d.bits().div_ceil(2))).max().unwrap_or(0);
    // Roots of integers are off by less than one, which the shift makes small.
    let shift = 200u64;
    let root = (d << (2 * shift)).sqrt();
    let down = (bits + shift).saturating_sub(900);
    values.each_ref().map(|v| (((&v.a << shift) + &v.b * &root) >> down).to_f64().unwrap_or(f64::NAN))
}

fn sign(x: &BigInt) -> i32 {
    i32::from(x.is_positive()) - i32::from(x.is_negative())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_surds_are_exact() {
        for d in 0i64..20 {
            for a in -30i64..=30 {
                for b in -9i64..=9 {
                    let surd = Surd { a: a.into(), b: b.into() };
                    let value = a as f64 + b as f64 * (d as f64).sqrt();
                    // Values that are no zero are far from it at this size.
                    let expected = if value.abs() < 1e-9 { 0 } else { value.signum() as i32 };
                    assert_eq!(surd.sign(&d.into()), expected, "{a} + {b} √{d}");
                }
            }
        }
    }

    #[test]
    fn surds_have_doubles() {
        let value = |a: i64, b: i64| Surd { a: a.into(), b: b.into() };
        let values = [value(1, 0), value(0, 1), value(-3, 2), value(5, -4), value(0, 0), value(7, 7)];
        let near = approximate(&values, &BigInt::from(2));
        let root = 2f64.sqrt();
        for (x, exact) in near.iter().zip([1.0, root, 2.0 * root - 3.0, 5.0 - 4.0 * root, 0.0, 7.0 + 7.0 * root]) {
            assert!((x / near[0] - exact).abs() < 1e-12, "{x} {exact}");
        }
    }
}
