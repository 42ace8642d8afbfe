//! Cell-to-cell visibility of an office floor, the stab tree of one cell, and why a pair is hidden.
//!
//! Run as `cargo run -p sightlines-stabtree --example stab_tree`.

use sightlines_cells::{CellGraph, CellId, Planar};
use sightlines_geometry::Adaptive;
use sightlines_pvs::BitMatrix;
use sightlines_scenes::{OfficeOptions, office};
use sightlines_sightline::{Funnel, Verdict};
use sightlines_stabtree::{
    Barrier, PlanPath, PlanProof, SearchLimit, SearchOptions, Sight, StabTree, Zones, explain, plan_visibility,
};

/// A cell and its position.
fn place(graph: &CellGraph<Planar>, cell: CellId) -> String {
    let bounds = graph.cell(cell).bounds();
    format!("cell {cell} from {:?} to {:?}", bounds.min, bounds.max)
}

fn print_tree(graph: &CellGraph<Planar>, root: CellId, seen: &BitMatrix) -> Result<(), Box<dyn std::error::Error>> {
    let tree = StabTree::build(graph, root, &mut Funnel::new(Adaptive), |exit| graph.crossing(exit), 100_000)?;
    let (n_nodes, cells) = (tree.nodes().len(), tree.cells());
    println!("the stab tree of {}: {n_nodes} nodes, {} different cells", place(graph, root), cells.len());
    let in_row: Vec<CellId> = seen.iter_ones(root.idx()).map(|cell| CellId(cell as u32)).collect();
    println!("  the search for all cells found the same: {}", cells == in_row);
    let longest = (0..n_nodes).max_by_key(|&node| tree.portals_to(node).len()).unwrap_or(0);
    let n_portals = tree.portals_to(longest).len();
    println!("  its longest sequence passes {n_portals} portals into {}", place(graph, tree.nodes()[longest].cell));
    Ok(())
}

fn print_explanation(graph: &CellGraph<Planar>, from: CellId, to: CellId) {
    println!("does cell {from} see {}?", place(graph, to));
    match explain(graph, from, to, 1, 1_000_000) {
        Verdict::Visible(Sight::SameCell) => println!("  it is the same cell"),
        Verdict::Visible(Sight::Along(PlanPath { portals, doors, witness })) => {
            println!("  yes, through {} portals", portals.len());
            if let Some([p, q]) = witness.rounded(&doors) {
                println!("  along the line from {p} to {q}");
            }
        }
        Verdict::Hidden(Barrier::NotConnected) => println!("  no: no portals lead there"),
        Verdict::Hidden(Barrier::Blocked(PlanProof { n_blocked, blocked })) => {
            println!("  no: {n_blocked} sequences of portals are blocked");
            for sequence in blocked {
                let cause = sequence.certificate.portals();
                println!("  for example {} portals, of which {cause:?} let no line pass", sequence.portals.len());
            }
        }
        Verdict::Undecided(SearchLimit(limit)) => println!("  undecided after {limit} cells"),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let floor =
        office(OfficeOptions { seed: 3, rooms_x: 8, rooms_y: 2, furniture: false, ..OfficeOptions::default() })?;
    let (graph, _) = sightlines_triangulation::subdivide(&floor)?;
    let zones = Zones::cells(&graph);
    let (seen, summary) = plan_visibility(&graph, &zones, &SearchOptions::default())?;
    let n = graph.n_cells() as u64;
    let n_visible = (seen.count_ones() - n) / 2;
    println!("{n} cells, {} portals: {n_visible} of {} pairs see each other", graph.portals().len(), n * (n - 1) / 2);
    println!("the search pushed {} portals", summary.n_pushes);

    // The cell that sees the fewest others; the last that it sees, and the first that it does not.
    let fewest = graph.cell_ids().min_by_key(|cell| seen.count_row(cell.idx()));
    let root = fewest.ok_or("the floor has no cells")?;
    print_tree(&graph, root, &seen)?;
    let last_seen = graph.cell_ids().filter(|cell| seen.get(root.idx(), cell.idx())).last();
    let first_hidden = graph.cell_ids().find(|cell| !seen.get(root.idx(), cell.idx()));
    for to in [last_seen, first_hidden].into_iter().flatten() {
        print_explanation(&graph, root, to);
    }
    Ok(())
}
