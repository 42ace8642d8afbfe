//! What is hidden from a volume: methods against rays, on generated scenes and real ones.

mod benchmark;
mod common;
mod fronts;
mod pieces;
mod random;
mod tables;
