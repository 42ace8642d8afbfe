//! `build`: from a plan, a scene in space, a portal file or a Quake map to its table.

mod auto;
mod certify;
mod error;
mod options;
pub(crate) mod plan;
mod portals;
mod quake;
mod region;
pub(crate) mod space;
mod stab;
mod view_cells;

pub(crate) use error::Error;
pub(crate) use options::BakeArgs;

use crate::Answer;
use crate::input::{self, Input, refuse};
use crate::output;
use serde::Serialize;
use sightlines::pvs::Table;
use std::fmt;
use std::path::PathBuf;

/// Arguments of `build`.
#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    /// The input: a WAD, a GeoJSON floor plan, a scene as GLB, glTF or OBJ, a Quake map, or its portal file alone
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Option<String>,
    /// Quake maps: the portal file that the compiler wrote [default: beside the map]
    #[arg(long, help_heading = "Input", value_name = "MAP.prt")]
    prt: Option<PathBuf>,
    #[command(flatten)]
    bake: BakeArgs,
    #[command(flatten, next_help_heading = "Method")]
    region: region::RegionArgs,
    /// The table to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.pvs")]
    output: PathBuf,
    /// Store stab trees in the table: for each cell, the sequences of portals that sight lines pass. A tree is
    /// truncated after N nodes, which never hides anything; without N 65536 for plans, 16384 for scenes in space, 4096
    /// for Quake maps and portal files. May take much longer than the table and make it several times as large; the
    /// exact method finds the same cells without trees
    #[arg(long, help_heading = "Output", value_name = "N", num_args = 0..=1, require_equals = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    stab_trees: Option<Option<u32>>,
    #[command(flatten, next_help_heading = "Output")]
    certify: certify::CertifyArgs,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &BuildArgs, show_progress: bool, verbose: bool) -> Result<Answer, Error> {
    let BuildArgs { input: path, output: out, bake, .. } = args;
    output::check(&[path], &[out])?;
    args.certify.check(path, out)?;
    let input = input::read(path, args.map.as_deref())?;
    let chosen = args.region.is_auto().then(|| auto::Chosen::of(&input, &args.region));
    let (auto, region) = match &chosen {
        Some((auto, region)) => (Some(auto), region),
        None => (None, &args.region),
    };
    if !matches!(input, Input::Map(_)) {
        refuse(path, &[("--prt", args.prt.is_some())], "Quake maps", "none")?;
    }
    if !matches!(input, Input::Scene(_)) {
        refuse(path, &region.of_space(), "scenes in space", "none")?;
    }
    let proofs_of = |table: &Table| args.certify.write(path, out, table, bake.threads);
    let stab_of = |table| stab::add(path, table, args.stab_trees, bake.threads, show_progress);
    match input {
        Input::Plan(file) => {
            let mut baked = plan::bake(path, &file, bake, show_progress)?;
            let stab;
            (baked.table, stab) = stab_of(baked.table)?;
            output::save(out, &baked.table.to_bytes())?;
            let (proofs, outcome) = (proofs_of(&baked.table)?, plan::Outcome::new(out, file.map, &baked));
            output::print(args.json, &With { auto, outcome, stab, proofs })?;
        }
        Input::Scene(file) if region.is_given() => {
            refuse(
                path,
                &[("--certify", args.certify.is_given())],
                "scenes by sightlines alone",
                "one by another method, or of boxes",
            )?;
            if region.has_boxes() {
                refuse(
                    path,
                    &[("--stab-trees", args.stab_trees.is_some())],
                    "cells with portals",
                    "to have boxes as cells",
                )?;
            }
            let mut baked = region::bake(path, &file, bake, region, show_progress)?;
            let stab = match args.stab_trees {
                Some(_) => {
                    let (table, stab) = stab_of(baked.table)?;
                    baked.table = table;
                    stab
                }
                None => None,
            };
            output::save(out, &baked.table.to_bytes())?;
            let outcome = region::Outcome::new(out, &file, region, &baked);
            output::print(args.json, &With { auto, outcome, stab, proofs: None })?;
        }
        Input::Scene(file) => {
            let mut baked = space::bake(path, &file, bake, show_progress)?;
            let stab;
            (baked.table, stab) = stab_of(baked.table)?;
            output::save(out, &baked.table.to_bytes())?;
            let (proofs, outcome) = (proofs_of(&baked.table)?, space::Outcome::new(out, &file, bake, &baked));
            output::print(args.json, &With { auto, outcome, stab, proofs })?;
        }
        Input::Portals(prt) => {
            let mut baked = portals::bake(path, &prt, bake, show_progress)?;
            let stab;
            (baked.table, stab) = stab_of(baked.table)?;
            let bytes = baked.table.to_bytes();
            output::save(out, &bytes)?;
            let proofs = proofs_of(&baked.table)?;
            let outcome = portals::Outcome::new(out, &prt, bake, &baked, bytes.len()).verbose(verbose);
            output::print(args.json, &With { auto, outcome, stab, proofs })?;
        }
        Input::Map(bsp) => {
            let portals = quake::Portals::read(path, args.prt.as_deref(), out)?;
            let mut baked = quake::bake(path, &bsp, &portals, bake, show_progress)?;
            let stab;
            (baked.table, stab) = stab_of(baked.table)?;
            let bytes = baked.table.to_bytes();
            output::save(out, &bytes)?;
            let proofs = proofs_of(&baked.table)?;
            let outcome = quake::Outcome::new(out, &bsp, &portals, bake, &baked, bytes.len()).verbose(verbose);
            output::print(args.json, &With { auto, outcome, stab, proofs })?;
        }
    }
    Ok(Answer::Yes)
}

/// What was built, and the stab trees and proofs with it.
#[derive(Debug, Serialize)]
struct With<'a, T> {
    /// What `--method auto` chose.
    #[serde(skip_serializing_if = "Option::is_none")]
    auto: Option<&'a auto::Chosen>,
    #[serde(flatten)]
    outcome: T,
    #[serde(skip_serializing_if = "Option::is_none")]
    stab: Option<stab::Added>,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    proofs: Option<certify::Certified>,
}

impl<T: fmt::Display> fmt::Display for With<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.auto.iter().try_for_each(|auto| write!(f, "{auto}"))?;
        write!(f, "{}", self.outcome)?;
        self.stab.iter().try_for_each(|stab| write!(f, "{stab}"))?;
        self.proofs.iter().try_for_each(|proofs| write!(f, "{proofs}"))
    }
}
