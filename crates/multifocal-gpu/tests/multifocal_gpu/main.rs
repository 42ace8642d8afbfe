//! The backend on a graphics device.

mod common;
mod conformance;
mod flags;
mod float;
mod forms;
mod jobs;
