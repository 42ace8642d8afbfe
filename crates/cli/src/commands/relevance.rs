//! `relevance`: from which reach on bodies in two cells may see each other.

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::output::{self, JsonSchema, Serialize, bytes, count, percent};
use sightlines::relevance::{ReachOptions, Reaches, Ways, WhoMoves};
use std::fmt;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct RelevanceArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// Reaches to tell apart, in scene units, ascending, at most 14 [default: 0.25,0.5,1,2,4,8,16; of Quake and Doom maps 32 times
    /// that]
    #[arg(long, help_heading = "Method", value_name = "R,R,...", value_delimiter = ',')]
    ladder: Vec<f64>,
    /// The first of two bodies moves, and the second holds still; for two that both move such reaches tell nothing
    #[arg(long, help_heading = "Method")]
    one_moves: bool,
    /// Bodies go through the portals of the table only, all doors open, in place of anywhere: for games without teleporters in which nobody passes what
    /// hides
    #[arg(long, help_heading = "Method")]
    by_walking: bool,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    threads: usize,
    /// The reaches of all pairs of cells to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.rel")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &RelevanceArgs, _: Verbosity) -> Result<Done> {
    output::check(&[&args.table], &[&args.output])?;
    let table = input::table(&args.table)?;
    let options = ReachOptions {
        ladder: args.ladder.clone(),
        movers: if args.one_moves { WhoMoves::One } else { WhoMoves::Both },
        ways: if args.by_walking { Ways::Portals } else { Ways::Straight },
        threads: args.threads,
    };
    let reaches = Reaches::of(&table, &options).in_file(&args.table)?;
    let written = reaches.to_bytes();
    output::save(&args.output, &written)?;
    let shares = reaches.hidden_shares();
    let outcome = Outcome {
        out: args.output.display().to_string(),
        n_cells: reaches.n_cells(),
        n_bytes: written.len() as u64,
        one_moves: args.one_moves,
        by_walking: args.by_walking,
        reaches: reaches.ladder().iter().zip(shares).map(|(&reach, hidden)| Reach { reach, hidden }).collect(),
    };
    Ok(Done::new(args.json, outcome))
}

/// The reaches of pairs of cells.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The file that was written.
    out: String,
    /// Cells.
    n_cells: usize,
    /// Bytes of the file.
    n_bytes: u64,
    /// Whether the second of two bodies holds still.
    one_moves: bool,
    /// Whether bodies go through portals only.
    by_walking: bool,
    /// The reaches, ascending from 0.
    reaches: Vec<Reach>,
}

/// A reach.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Reach {
    /// How far bodies move, in scene units.
    reach: f64,
    /// Of all ordered pairs of different cells, the share of those from which bodies within this reach do not see each other.
    hidden: f64,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}, {}", self.out, bytes(self.n_bytes), count(self.n_cells as u64, "cell"))?;
        let who = if self.one_moves { "the first moves" } else { "both move" };
        let ways = if self.by_walking { "through portals" } else { "on straight ways" };
        writeln!(f, "bodies         {who}, {ways}")?;
        for Reach { reach, hidden } in &self.reaches {
            writeln!(f, "reach {reach:<8} {} of all pairs of cells do not see each other", percent(*hidden))?;
        }
        Ok(())
    }
}
