//! Errors that several commands share. What only one command can meet is in its own module.

mod input;
mod output;

pub(crate) use input::{InputError, of_map};
pub(crate) use output::{OutputError, StdoutError};
