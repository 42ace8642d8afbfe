//! `pack` and `unpack`: tables as small files for programs that read them piece by piece, and back.

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result};
use crate::output::{self, JsonSchema, Serialize, bytes, count, percent};
use crate::tables::{CACHE, size_class};
use crate::{input, tables};
use sightlines::packed::{PackOptions, Packed, SizeClass, pack_report};
use sightlines::pvs::Table;
use std::fmt;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct PackArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// The packed table to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.pvz")]
    output: PathBuf,
    /// Maximum size of the file, in bytes: visibility rows are merged until it fits, so more is reported visible, never
    /// less [default: lossless]
    #[arg(long, help_heading = "Output", value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    max_bytes: Option<u64>,
    /// Layout of the file: small keeps the places of all cells in memory, large reads them on demand [default: large above
    /// 65,536 cells]
    #[arg(long, help_heading = "Output", value_parser = size_class())]
    class: Option<SizeClass>,
    #[command(flatten)]
    json: JsonArg,
}

#[derive(Debug, clap::Args)]
pub(crate) struct UnpackArgs {
    /// The packed table
    #[arg(value_name = "FILE.pvz")]
    packed: PathBuf,
    /// The table to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.pvs")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn pack(args: &PackArgs, _: Verbosity) -> Result<Done> {
    output::check(&[&args.table], &[&args.output])?;
    let table = input::table(&args.table)?;
    let (packed, report) =
        pack_report(&table, &PackOptions { max_bytes: args.max_bytes, class: args.class }).in_file(&args.table)?;
    let n_visible = table.parts().rows.count_ones();
    let n_packed_bytes = packed.len() as u64;
    let mut outcome = Outcome {
        out: args.output.display().to_string(),
        class: report.class.name(),
        n_plain_bytes: table.to_bytes().len() as u64,
        n_packed_bytes,
        n_row_bytes: report.row_bytes,
        n_cells: table.n_cells(),
        n_rows: report.n_classes,
        n_merges: report.n_merges,
        over_estimation: 1.0,
    };
    if report.n_merges > 0 {
        let back: Table = Packed::open(packed.clone(), CACHE).and_then(|p| p.to_table()).in_file(&args.output)?;
        outcome.over_estimation = back.parts().rows.count_ones() as f64 / n_visible.max(1) as f64;
    }
    output::save(&args.output, &packed)?;
    Ok(Done::new(args.json, outcome))
}

pub(crate) fn unpack(args: &UnpackArgs, _: Verbosity) -> Result<Done> {
    output::check(&[&args.packed], &[&args.output])?;
    input::refuse_source(&args.packed)?;
    let packed = tables::packed(&args.packed, CACHE)?;
    let table = packed.to_table().in_file(&args.packed)?;
    let plain = table.to_bytes();
    output::save(&args.output, &plain)?;
    let out = args.output.display().to_string();
    Ok(Done::new(args.json, Unpacked { out, n_plain_bytes: plain.len() as u64, n_cells: table.n_cells() }))
}

/// The packed table.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The packed table that was written.
    out: String,
    /// Layout of the file, `small` or `large`.
    class: &'static str,
    /// Bytes of the table.
    n_plain_bytes: u64,
    /// Bytes of the packed table.
    n_packed_bytes: u64,
    /// Of these, bytes of the visibility rows.
    n_row_bytes: u64,
    /// Cells.
    n_cells: usize,
    /// Different visibility rows; of a large file, which has one for each cell, the cells.
    n_rows: usize,
    /// Merges of different rows, to fit into `--max-bytes`.
    n_merges: usize,
    /// Visible pairs after packing, for each one before; 1 without merges.
    over_estimation: f64,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [packed, plain] = [self.n_packed_bytes, self.n_plain_bytes];
        let share = percent(packed as f64 / plain.max(1) as f64);
        writeln!(f, "wrote {}, {}, {share} of {}", self.out, bytes(packed), bytes(plain))?;
        let (row_bytes, cells) = (bytes(self.n_row_bytes), count(self.n_cells as u64, "cell"));
        if self.class == SizeClass::Large.name() {
            writeln!(f, "visibility     {row_bytes}, a row for each of {cells}")?;
        } else {
            writeln!(f, "visibility     {row_bytes}, {} of {cells}", count(self.n_rows as u64, "different row"))?;
        }
        match self.n_merges {
            0 => writeln!(f, "lost           nothing"),
            n => {
                let n = count(n as u64, "merge");
                writeln!(f, "lost           {n}: {:.3} times as many visible pairs", self.over_estimation)
            }
        }
    }
}

/// The plain table.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Unpacked {
    /// The table that was written.
    out: String,
    /// Bytes of the table.
    n_plain_bytes: u64,
    /// Cells.
    n_cells: usize,
}

impl fmt::Display for Unpacked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells = count(self.n_cells as u64, "cell");
        writeln!(f, "wrote {}, {}, the table of {cells}", self.out, bytes(self.n_plain_bytes))
    }
}
