//! Multifocal buffers and sheets as arguments.

use crate::error::anyhow;
use crate::named::one_of;
use sightlines::bake::BufferRequest;
use sightlines::bake::methods::{Backend, BufferOptions, MethodError};
use std::path::Path;

/// A from-region method that cannot be prepared for the scene of a file.
pub(crate) fn method_failed(path: &Path, error: MethodError) -> anyhow::Error {
    match error {
        MethodError::NotBuiltIn(_) => anyhow!(
            "{}: {error}; from the project's folder, `cargo install --path crates/cli --features gpu` installs a program that has it",
            path.display()
        ),
        error => anyhow!("{}: {error}", path.display()),
    }
}

/// How multifocal buffers and sheets are made.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Multifocal buffers")]
pub(crate) struct BufferArgs {
    /// Multifocal: planes on each side of a cell; 0 for none [default: 9]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=256))]
    planes: Option<u32>,
    /// Multifocal: texels along the longer side of a plane [default: 128]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8192))]
    texels: Option<u32>,
    /// Multifocal: maximum number of occluders drawn on each side of a cell, the most effective first [default: 500]
    #[arg(long, value_name = "N")]
    occluders: Option<u32>,
    /// Multifocal: do not carry blocked texels over from one plane to the next
    #[arg(long)]
    no_carry: bool,
    /// Multifocal: maximum number of triangle sides examined to find a sheet between a cell and an object; 0 turns
    /// sheets off [default: 1024]
    #[arg(long, value_name = "N")]
    sheets: Option<u32>,
    /// Multifocal: the backend that draws the buffers [default: cpu]
    #[arg(long, value_name = "WHO", value_parser = one_of(&Backend::ALL, Backend::name, Backend::about))]
    backend: Option<Backend>,
}

impl BufferArgs {
    pub(crate) fn request(&self) -> BufferRequest {
        let Self { planes, texels, occluders, no_carry, sheets, backend } = *self;
        let carry = no_carry.then_some(false);
        BufferRequest { planes, texels, occluders, carry, sheets, backend }
    }

    /// As a method takes them. A backend that takes over is a warning.
    pub(crate) fn options(&self) -> BufferOptions {
        BufferOptions { warn, ..self.request().options() }
    }
}

/// What a bake says of itself to people.
pub(crate) fn warn(text: &str) {
    tracing::warn!("{text}");
}
