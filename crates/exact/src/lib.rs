#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the conversion of doubles to big integers ([`decode`], [`Grid`]), to an integer times a power of two
//!   ([`Dyadic`]) and to fractions ([`rational`], [`Fraction`]); products of vectors of any such numbers ([`vector`]).
//! - **Out of scope**: geometry, filters in floating point, files.
//! - **Invariants**: no result is rounded, except that of [`Dyadic::to_f64`]. The crates that check results of this one
//!   have their own arithmetic (`certificates`, `verify`, `testkit`).

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
