//! The commands, one module for each: its arguments, what it does, what it prints.

pub(crate) mod build;
pub(crate) mod demo;
pub(crate) mod draw;
pub(crate) mod explain;
pub(crate) mod export;
pub(crate) mod generate;
pub(crate) mod info;
pub(crate) mod isovist;
pub(crate) mod job;
pub(crate) mod levels;
pub(crate) mod light;
pub(crate) mod multifocal;
pub(crate) mod pack;
pub(crate) mod plan;
pub(crate) mod portals;
pub(crate) mod query;
pub(crate) mod reject;
pub(crate) mod relevance;
pub(crate) mod render;
pub(crate) mod simplify;
pub(crate) mod tiles;
pub(crate) mod verify;
pub(crate) mod vga;
pub(crate) mod view;
pub(crate) mod vis;
pub(crate) mod walk;
