//! Grids, graphs and measures against oracles that use other methods.

mod dense;
mod grids;
mod measures;
mod python;
mod threads;
mod units;
