//! Tests of the table through its public interface.

mod common;
mod format;
mod seen;
mod table;
