//! WGSL texts of the sightlines crates, with their layouts and constants on the Rust side.
//!
//! Owns: the texts ([`Shader`]), the records that they read, as types that know their layout and turn themselves into
//! bytes ([`Record`]), which bindings an entry point has, workgroup sizes and shared constants.
//! Does not know: devices, scenes, who runs the shaders. Has no dependency.
//! Invariants: plain core WGSL without optional features; at most 256 invocations in a workgroup, 16 KiB of its memory,
//! 4 bind groups, 8 storage buffers. What Rust says of a text is what the text says: the tests parse each one and
//! compare, and are shown to notice a difference.

pub mod multifocal;
pub mod record;

pub use multifocal::ALL;
pub use record::{Field, Kind, Layout, Member, Record};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

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
