//! Tests of the table through its public interface.

mod common;
mod doors;
mod extras;
mod format;
mod frame;
mod kind;
mod object_parts;
mod planes;
mod seen;
mod stab;
mod table;
