//! Fields of results as JSON has them.

use serde::Serializer;
use sightlines_geometry::Point3;
use sightlines_pvs::CellId;
use std::fmt::Display;

pub(crate) fn pairs<S: Serializer>(pairs: &[[CellId; 2]], out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(pairs.iter().map(|pair| pair.map(|cell| cell.0)))
}

pub(crate) fn places<S: Serializer>(places: &[(CellId, Point3)], out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(places.iter().map(|(cell, point)| (cell.0, point)))
}

pub(crate) fn text<S: Serializer>(shown: &impl Display, out: S) -> Result<S::Ok, S::Error> {
    out.collect_str(shown)
}

pub(crate) fn texts<T: Display, S: Serializer>(shown: &[T], out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(shown.iter().map(ToString::to_string))
}
