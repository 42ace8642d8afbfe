//! Packed tables against the tables that were packed.

mod budget;
mod cache;
mod common;
mod damage;
mod large;
mod round_trip;
mod stream;
