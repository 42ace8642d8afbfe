//! Packed tables against the tables that were packed.

mod budget;
mod cache;
mod common;
mod damage;
mod round_trip;
