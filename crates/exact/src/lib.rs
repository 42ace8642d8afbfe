//! Exact numbers: doubles as dyadic numbers, as integers on a common grid, and as fractions.
//!
//! Owns: the conversion of doubles to big integers ([`decode`], [`Grid`]), to an integer times a power of two
//! ([`Dyadic`]) and to fractions ([`rational`], [`Fraction`]); products of vectors of any such numbers ([`vector`]).
//! Does not know: geometry, filters in floating point, files.
//! Invariants: no result is rounded, except that of [`Dyadic::to_f64`]. Whoever checks results of crates that use this one
//! has an arithmetic of their own (`certificates`, `verify`, `testkit`).

mod decode;
mod dyadic;
mod fraction;
mod grid;
pub mod vector;

pub use decode::{decode, rational};
pub use dyadic::Dyadic;
pub use fraction::Fraction;
pub use grid::Grid;
pub use num_bigint::{BigInt, Sign};
pub use num_rational::BigRational;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
