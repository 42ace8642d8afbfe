#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the device and what runs on it ([`Gpu`]), the backend with three pipelines ([`GpuBackend`], [`GpuPath`]), jobs in flight
//!   ([`Ticket`]), and results that stay on the device ([`Values`]) with what can be done there.
//!   A backend that takes over when the device fails: [`WithFallback`](sightlines_multifocal::WithFallback).
//! - **Out of scope**: how occluders become integers (`multifocal`), the shader sources (`shaders`), windows, files.
//! - **Invariants**: [`GpuPath::Compute`] and [`GpuPath::Raster`] have the bits that the integer form says, on any device; nothing
//!   but [`Gpu::open`] and the blocking calls named so waits for a device; no error of a device is a panic.

mod backend;
mod context;
mod draw;
mod error;
mod flags;
mod float;
mod jobs;
mod open;
mod outline;
mod pack;
mod path;
mod pipelines;
mod recording;

pub use backend::GpuBackend;
pub use context::Gpu;
pub use error::OpenError;
pub use flags::DrawRecords;
pub use jobs::Ticket;
pub use pack::PlaneForms;
pub use path::GpuPath;
pub use recording::Values;
pub use wgpu;
