//! Hot paths beside what no implementation can go below on this machine: memory traffic, or operations.
//!
//! A bound is a count times a rate. Rates are measured in the same run: bytes a second that one thread reads from memory and
//! from its cache, and the time of an orientation of three points, and of four, in plain doubles without exactness. Counts are of what any
//! correct method has to do: the bytes of the answer, a predicate for each thing that is decided. So a bound is low on purpose; what is between it and
//! the time is what exactness and finding the way cost.

mod paths;
mod rates;

use clap::Parser;
use paths::Path;
use rates::Rates;
use sightlines_benches::program::Common;

/// Hot paths beside their lower bounds.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
}

fn main() {
    let args = Args::parse();
    if !args.common.is_wanted("limits") {
        return;
    }
    let rates = Rates::measure(args.common.test);
    println!(
        "one thread reads {:.1} GB/s from memory and {:.1} GB/s from its cache; an orientation takes {:.2} ns in the plane, {:.2} ns in space, \
         in plain doubles\n",
        rates.memory / 1e9,
        rates.cache / 1e9,
        rates.orient2 * 1e9,
        rates.orient3 * 1e9
    );
    println!("| path | of | time | bound | time / bound | what the bound counts |");
    println!("| --- | --- | ---: | ---: | ---: | --- |");
    for path in paths::all(args.common.test) {
        let Path { name, of, seconds, bound, counts } = path(&rates);
        assert!(seconds > 0.0 && bound > 0.0, "{name} takes time");
        println!("| {name} | {of} | {} | {} | {:.1} | {counts} |", time(seconds), time(bound), seconds / bound);
    }
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{:.1} ns", s * 1e9),
        s if s < 1e-3 => format!("{:.1} us", s * 1e6),
        s => format!("{:.2} ms", s * 1e3),
    }
}
