//! The section of the plane tree.

use super::container::Section;
use super::error::{DecodeError, DecodeErrorKind as Kind};
use super::reader::{Reader, read};
use super::writer::Writer;
use crate::{CellId, PlaneChild, PlaneNode, PlaneTree, TableError};

/// Flag of a child that is a cell; without it, a child is a node, or nothing if it is 0, as the root is no node's
/// child.
const CELL: u32 = 1 << 31;
/// Bytes of a node.
const NODE: usize = 40;

pub(super) fn write(out: &mut Writer, planes: &PlaneTree) {
    out.floats(&[planes.slack()]);
    out.count(planes.nodes().len());
    for PlaneNode { normal, offset, children } in planes.nodes() {
        out.floats(normal);
        out.floats(&[*offset]);
        for child in children {
            // Both are below 2^31, which was checked when the tree was made.
            out.u32(match *child {
                PlaneChild::Nothing => 0,
                PlaneChild::Node(node) => node,
                PlaneChild::Cell(cell) => CELL | cell.0,
            });
        }
    }
}

pub(super) fn parse(section: Section<'_>) -> Result<PlaneTree, DecodeError> {
    let (nodes, slack) = read(section, parts)?;
    let whole = Reader::new(section);
    PlaneTree::new(nodes, slack).map_err(|error| whole.fail(0, Kind::Table(TableError::Planes(error))))
}

fn parts(r: &mut Reader<'_>) -> Result<(Vec<PlaneNode>, f64), DecodeError> {
    let slack = r.f64()?;
    let n = r.count(NODE)?;
    let mut nodes = Vec::with_capacity(n);
    for _ in 0..n {
        let (normal, offset) = (r.point(3)?, r.f64()?);
        let children = [child(r.u32()?), child(r.u32()?)];
        nodes.push(PlaneNode { normal, offset, children });
    }
    Ok((nodes, slack))
}

fn child(code: u32) -> PlaneChild {
    match code {
        0 => PlaneChild::Nothing,
        _ if code & CELL != 0 => PlaneChild::Cell(CellId(code ^ CELL)),
        _ => PlaneChild::Node(code),
    }
}
