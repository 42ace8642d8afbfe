//! What one eye sees, by all methods.

mod agree;
mod bsp;
mod culling;
mod hides;
mod newell;
mod oracle;
mod pictures;
mod priority;
mod schumacker;
mod soups;
