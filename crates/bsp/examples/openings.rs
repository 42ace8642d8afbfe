//! Two rooms with a pillar between them, as a tree of planes: which regions meet, and in what area.

use sightlines_bsp::{Child, Node, Plane, Tree, TreeError, openings};

fn main() -> Result<(), TreeError> {
    let node = |normal: [f64; 3], distance: f64, front: Child, back: Child| Node {
        plane: Plane { normal, distance },
        children: [front, back],
    };
    // Leaf 0 is solid: what is beyond the box of 8 units, and the pillar from 3 to 5 in x and y.
    let (solid, west, east, south, north) =
        (Child::Leaf(0), Child::Leaf(1), Child::Leaf(2), Child::Leaf(3), Child::Leaf(4));
    let mut nodes = Vec::new();
    for (k, axis) in [0, 0, 1, 1, 2, 2].into_iter().enumerate() {
        let mut normal = [0.0; 3];
        normal[axis] = if k % 2 == 0 { 1.0 } else { -1.0 };
        nodes.push(node(normal, if k % 2 == 0 { 0.0 } else { -8.0 }, Child::Node(k as u32 + 1), solid));
    }
    nodes.push(node([1.0, 0.0, 0.0], 5.0, east, Child::Node(7)));
    nodes.push(node([1.0, 0.0, 0.0], 3.0, Child::Node(8), west));
    nodes.push(node([0.0, 1.0, 0.0], 5.0, north, Child::Node(9)));
    nodes.push(node([0.0, 1.0, 0.0], 3.0, solid, south));
    let tree = Tree::new(nodes)?;

    let is_open = |leaf: u32| leaf != 0;
    let found = openings(&tree, 64.0, |regions| regions.iter().all(|region| is_open(region.leaf)));
    for opening in found.expect("ten nodes take few cuts") {
        let [front, back] = opening.regions.map(|region| region.leaf);
        println!("leafs {front} and {back} meet in {:?}", opening.corners);
    }
    Ok(())
}
