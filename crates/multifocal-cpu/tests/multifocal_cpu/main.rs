//! The backend on the processor.

mod common;
mod conformance;
mod definition;
mod fast;
