//! Vectors in space of any numbers with operators on references: [`BigInt`](crate::BigInt),
//! [`BigRational`](crate::BigRational), [`Dyadic`](crate::Dyadic). Nothing is rounded, so no order of operations matters.

use std::ops::{Add, Mul, Sub};

/// `a - b`.
pub fn sub<T>(a: &[T; 3], b: &[T; 3]) -> [T; 3]
where
    for<'a> &'a T: Sub<Output = T>,
{
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

/// `a` times a number.
pub fn scale<T>(a: &[T; 3], by: &T) -> [T; 3]
where
    for<'a> &'a T: Mul<Output = T>,
{
    [0, 1, 2].map(|k| &a[k] * by)
}

/// The scalar product.
pub fn dot<T>(a: &[T; 3], b: &[T; 3]) -> T
where
    for<'a> &'a T: Add<Output = T> + Mul<Output = T>,
{
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

/// The vector product, by the right-hand rule.
pub fn cross<T>(a: &[T; 3], b: &[T; 3]) -> [T; 3]
where
    for<'a> &'a T: Sub<Output = T> + Mul<Output = T>,
{
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &(&a[i] * &b[j]) - &(&a[j] * &b[i]))
}

/// The determinant of three rows: positive if they are right-handed.
pub fn determinant<T>(a: &[T; 3], b: &[T; 3], c: &[T; 3]) -> T
where
    for<'a> &'a T: Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    dot(a, &cross(b, c))
}

/// The normal of a triangle by the right-hand rule, `(b - a) × (c - a)`; twice its area long.
pub fn normal<T>([a, b, c]: &[[T; 3]; 3]) -> [T; 3]
where
    for<'a> &'a T: Sub<Output = T> + Mul<Output = T>,
{
    cross(&sub(b, a), &sub(c, a))
}
