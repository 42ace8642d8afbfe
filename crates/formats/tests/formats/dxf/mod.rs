//! Drawings as plans: every entity, curves against their formulas, inserts against another way to place points, damaged files.

mod clip_siblings;
mod clips;
mod compound;
mod curves;
mod damaged;
mod entities;
mod inserts;
mod layers;

use sightlines_formats::Malformed;
use sightlines_formats::dxf::parse_dxf;
use sightlines_formats::{PlanFile, PlanReadOptions};

fn read(bytes: &[u8]) -> PlanFile {
    parse_dxf(bytes, &PlanReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(bytes: &[u8]) -> Malformed {
    parse_dxf(bytes, &PlanReadOptions::default()).expect_err("it should be refused")
}

/// The lines of a plan.
fn lines(file: &PlanFile) -> Vec<[f64; 4]> {
    file.plan.lines().iter().map(|l| [l.a.x, l.a.y, l.b.x, l.b.y]).collect()
}

/// The vertices of the lines of a plan that are joined one behind the other.
fn vertices(file: &PlanFile) -> Vec<[f64; 2]> {
    let all = lines(file);
    assert!(all.windows(2).all(|pair| pair[0][2..] == pair[1][..2]), "{all:?}");
    all[..1].iter().map(|l| [l[0], l[1]]).chain(all.iter().map(|l| [l[2], l[3]])).collect()
}
