#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the sources ([`Shader`]), the records that they read, as types with a layout and a conversion to
//!   bytes ([`Record`]), the bindings of each entry point, workgroup sizes and shared constants.
//! - **Out of scope**: devices, scenes, running the shaders. It has no dependency.
//! - **Invariants**: plain core WGSL without optional features; at most 256 invocations in a workgroup, 16 KiB of its memory,
//!   4 bind groups, 8 storage buffers. The Rust side matches the WGSL: the tests parse each source and
//!   compare, and impostors show that they notice a difference.

pub mod multifocal;
pub mod record;

pub use multifocal::ALL;
pub use record::{Field, Kind, Layout, Member, Record};

/// How a shader uses a binding of group 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// A uniform buffer.
    Uniform,
    /// A storage buffer that is only read.
    Read,
    /// A storage buffer that is also written.
    Write,
}

/// One text with one compute entry point, or a vertex and a fragment entry point, and what Rust has to know of it.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// Lower-case name, for labels and messages.
    pub name: &'static str,
    /// The whole WGSL text.
    pub text: &'static str,
    /// Entry points, with the size of a workgroup, or zeros for those that have none.
    pub entry_points: &'static [(&'static str, [u32; 3])],
    /// Bindings of group 0, in order from 0.
    pub bindings: &'static [Access],
    /// Records by their names in the text.
    pub layouts: &'static [Layout],
    /// Constants that Rust uses as well.
    pub constants: &'static [(&'static str, i64)],
}
