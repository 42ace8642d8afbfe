//! Surfaces under a light, against rays that another program casts.

mod check;
mod closed_form;
mod common;
mod nasty;
mod pictures;
mod random;
mod real;
mod scenes;
