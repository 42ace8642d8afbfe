//! Proofs as trees of JSON.

use serde_json::{Value, json};
use sightlines_sightline::{Branch, BranchRow, Bypass, Contradiction, ConvexCertificate, ConvexNode, ConvexTerm};
use sightlines_stabtree::Blocking;

/// Why no line passes some portals of clusters.
pub(super) fn certificate(why: &Blocking) -> Value {
    let Blocking::Certificate(certificate) = why else { return json!("behind") };
    match &**certificate {
        ConvexCertificate::Plane(plane) => {
            json!({"plane": {"edge": plane.edge, "corner": plane.corner, "stops": plane.stops}})
        }
        ConvexCertificate::Boxes(proof) => {
            let blocks: Vec<Value> =
                proof.blocks.iter().map(|b| json!({"corner": b.corner, "edges": b.edges})).collect();
            let nodes: Vec<Value> = proof.nodes.iter().map(node).collect();
            json!({"boxes": {"portals": proof.portals, "blocks": blocks, "nodes": nodes}})
        }
        ConvexCertificate::Hulls(proof) => {
            json!({"hulls": {"portals": proof.portals, "terms": proof.terms.iter().map(term).collect::<Vec<_>>()}})
        }
        _ => Value::Null,
    }
}

fn node(node: &ConvexNode) -> Value {
    match node {
        ConvexNode::Split { axis, at, parts } => json!({"axis": axis, "at": at, "parts": parts}),
        ConvexNode::Leaf(terms) => terms.iter().map(term).collect(),
    }
}

fn term(term: &ConvexTerm) -> Value {
    json!({"portal": term.portal, "edge": term.edge, "times": term.multiplier})
}

/// A branch of a proof.
pub(super) fn tree(branch: &Branch) -> Value {
    match branch {
        Branch::Empty(terms) => json!({"contradiction": rows(terms)}),
        Branch::Past { rectangle, ways, rest } => {
            let ways: Vec<Value> =
                ways.iter().map(|(w, branch)| json!({"way": way(*w), "branch": tree(branch)})).collect();
            json!({"wall": rectangle, "ways": ways, "rest": rest.as_ref().map(rows)})
        }
    }
}

fn way(way: Bypass) -> Value {
    match way {
        Bypass::Beside { axis, entering } => json!({"beside": axis, "entering": entering}),
        Bypass::Before => json!("before"),
        Bypass::After => json!("after"),
    }
}

/// Rows with their multipliers, which may have any number of digits.
fn rows(terms: &Contradiction) -> Value {
    let row = |(row, weight): &(BranchRow, _)| {
        let row = match row {
            BranchRow::End { second, early, late } => json!({"end": u8::from(*second), "early": early, "late": late}),
            BranchRow::Taken { depth, row } => json!({"taken": depth, "row": row}),
            BranchRow::NotTaken { depth, way: w } => json!({"not_taken": depth, "way": way(*w)}),
        };
        json!({"row": row, "times": ToString::to_string(weight)})
    };
    terms.iter().map(row).collect()
}
