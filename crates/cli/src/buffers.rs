//! Multifocal buffers and sheets as arguments.

use crate::named::{measure, one_of};
use sightlines::bake::methods::{Backend, BufferOptions, MethodError};
use sightlines::multifocal::Measure;
use std::path::PathBuf;

/// A from-region method that cannot be prepared for the scene of a file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}{}", path.display(), remedy(source))]
pub(crate) struct MethodFailed {
    pub(crate) path: PathBuf,
    pub(crate) source: MethodError,
}

/// The command that installs what this build of the program lacks.
fn remedy(error: &MethodError) -> &'static str {
    match error {
        MethodError::NotBuiltIn(_) => {
            "; from the project's folder, `cargo install --path crates/cli --features gpu` installs a program that has it"
        }
        _ => "",
    }
}

/// How multifocal buffers and sheets are made.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Multifocal buffers")]
pub(crate) struct BufferArgs {
    /// Multifocal: the measure that buffers store
    #[arg(long, value_name = "WHAT", default_value = Measure::default().name(), value_parser = measure())]
    measure: Measure,
    /// Multifocal: planes on each side of a cell; 0 for none
    #[arg(long, value_name = "N", default_value_t = BufferOptions::default().planes, value_parser = clap::value_parser!(u32).range(0..=256))]
    planes: u32,
    /// Multifocal: texels along the longer side of a plane
    #[arg(long, value_name = "N", default_value_t = BufferOptions::default().texels, value_parser = clap::value_parser!(u32).range(1..=8192))]
    texels: u32,
    /// Multifocal: maximum number of occluders drawn on each side of a cell, the most effective first
    #[arg(long, value_name = "N", default_value_t = BufferOptions::default().occluders)]
    occluders: u32,
    /// Multifocal: do not carry blocked texels over from one plane to the next
    #[arg(long)]
    no_carry: bool,
    /// Multifocal: maximum number of triangle sides examined to find a sheet between a cell and an object; 0 turns
    /// sheets off
    #[arg(long, value_name = "N", default_value_t = BufferOptions::default().sheets)]
    sheets: u32,
    /// Multifocal: the backend that draws the buffers
    #[arg(long, value_name = "WHO", default_value = Backend::Cpu.name(), value_parser = one_of(&Backend::ALL, Backend::name, Backend::about))]
    backend: Backend,
}

impl BufferArgs {
    /// The options. A backend that takes over is a warning.
    pub(crate) fn options(&self) -> BufferOptions {
        let Self { measure, planes, texels, occluders, no_carry, sheets, backend } = *self;
        let warn = |text: &str| tracing::warn!("{text}");
        BufferOptions { measure, planes, texels, occluders, carry: !no_carry, sheets, line_space: false, backend, warn }
    }
}
