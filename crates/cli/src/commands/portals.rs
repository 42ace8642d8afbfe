//! `portals`: the portal file of a Quake map that has none.

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::map_portals::{MapPortals, made};
use crate::output::{self, JsonSchema, Serialize, bytes, count};
use sightlines::formats::quake::{LeafClusters, read_bsp};
use std::fmt;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct PortalsArgs {
    /// The map: of Quake, Half-Life, Hexen II, Quake II, Qbism, Quake III or Wolfenstein
    #[arg(value_name = "MAP.bsp")]
    map: PathBuf,
    /// The portal file to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.prt")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &PortalsArgs, _: Verbosity) -> Result<Done> {
    output::check(&[&args.map], &[&args.output])?;
    let bsp = read_bsp(&args.map)?;
    let MapPortals { prt, text, .. } = made(&bsp, &args.map)?;
    output::save(&args.output, &text)?;
    let n_leafs = prt.listed_leafs().map_or(prt.n_clusters() as usize, LeafClusters::n_leafs);
    let outcome = Outcome {
        out: args.output.display().to_string(),
        format: bsp.format().name(),
        portal_format: prt.dialect().name(),
        n_clusters: n_leafs,
        n_portals: prt.n_portals(),
        n_passages: prt.n_clusters() as usize - n_leafs,
        n_bytes: text.len(),
    };
    Ok(Done::new(args.json, outcome))
}

/// The portal file that was written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The portal file that was written.
    out: String,
    /// Format of the map.
    format: &'static str,
    /// Dialect of the portal file.
    portal_format: &'static str,
    /// Clusters that the map knows.
    n_clusters: usize,
    /// Portals.
    n_portals: usize,
    /// Clusters behind those of the map, for what is solid and can be seen through.
    n_passages: usize,
    /// Bytes of the portal file.
    n_bytes: usize,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let clusters = count(self.n_clusters as u64, "cluster");
        writeln!(f, "map            {} with {clusters}", self.format)?;
        write!(f, "portals        {}, as {}", self.n_portals, self.portal_format)?;
        match self.n_passages {
            0 => writeln!(f),
            n => writeln!(f, ", some of them into {}", count(n as u64, "passage")),
        }?;
        match self.n_passages {
            0 => Ok(()),
            _ => writeln!(
                f,
                "passages       faces leave openings into what is solid, through which rooms see each other"
            ),
        }
    }
}
