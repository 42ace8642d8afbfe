//! Cell-to-cell visibility of an office floor, the stab tree of one cell, and why a pair is hidden.
//!
//! Run as `cargo run -p sightlines-stabtree --example stab_tree`; with a name, `-- OUT.svg`, it draws the stab tree of a small plan beside the plan.

use sightlines_cells::{CellGraph, CellId, Planar};
use sightlines_geometry::Adaptive;
use sightlines_pvs::BitMatrix;
use sightlines_scenes::{OfficeOptions, office};
use sightlines_sightline::{Funnel, Verdict};
use sightlines_stabtree::{
    Barrier, PlanarPath, PlanarProof, SearchLimit, SearchOptions, Sight, StabTree, Zones, explain, planar_visibility,
};
use std::fmt::Write;

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
        Verdict::Visible(Sight::Along(PlanarPath { portals, doors, witness })) => {
            println!("  yes, through {} portals", portals.len());
            if let Some([p, q]) = witness.rounded(&doors) {
                println!("  along the line from {p} to {q}");
            }
        }
        Verdict::Hidden(Barrier::NotConnected) => println!("  no: no portals lead there"),
        Verdict::Hidden(Barrier::Blocked(PlanarProof { n_blocked, blocked })) => {
            println!("  no: {n_blocked} sequences of portals are blocked");
            for sequence in blocked {
                let cause = sequence.certificate.portals();
                println!("  for example {} portals, of which {cause:?} let no line pass", sequence.portals.len());
            }
        }
        Verdict::Undecided(SearchLimit(limit)) => println!("  undecided after {limit} cells"),
    }
}

/// The colour of a cell by how many portals away it is first reached; from the root on.
const COLOURS: [&str; 6] = ["#f0701a", "#5fa8ea", "#84bff4", "#a6d1f8", "#c5e1fa", "#dfeefc"];

fn text(out: &mut String, [x, y]: [f64; 2], size: u32, anchor: &str, words: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"#1c2733\">{words}</text>"
    );
}

fn line(out: &mut String, [[x1, y1], [x2, y2]]: [[f64; 2]; 2], style: &str) {
    let _ = writeln!(out, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>");
}

/// How many portals each node is away from the root.
fn depths(tree: &StabTree) -> Vec<usize> {
    let mut depths: Vec<usize> = Vec::new();
    for node in tree.nodes() {
        depths.push(node.parent.map_or(0, |parent| depths[parent as usize] + 1));
    }
    depths
}

fn colour(tree: &StabTree, cell: CellId) -> &'static str {
    let nodes = tree.nodes().iter().zip(depths(tree));
    let first = nodes.filter(|(node, _)| node.cell == cell).map(|(_, depth)| depth).min();
    first.map_or("#eceef1", |depth| COLOURS[depth.min(COLOURS.len() - 1)])
}

/// The plan, to the left: the cells of the tree in their colours, with their numbers.
fn draw_plan(out: &mut String, graph: &CellGraph<Planar>, tree: &StabTree) -> Result<(), &'static str> {
    let bounds = graph.cell_ids().map(|cell| graph.cell(cell).bounds()).reduce(|a, b| a.united(b)).ok_or("no cells")?;
    let [wide, high] = [0, 1].map(|k| bounds.max[k] - bounds.min[k]);
    let scale = (460.0 / wide).min(500.0 / high);
    let place = |[x, y]: [f64; 2]| [20.0 + (x - bounds.min[0]) * scale, 60.0 + (bounds.max[1] - y) * scale];
    for cell in graph.cell_ids() {
        let corners = graph.cell(cell).polygon.iter().map(|p| place([p.x, p.y]));
        let points: Vec<String> = corners.map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let (points, fill) = (points.join(" "), colour(tree, cell));
        let style = format!("fill=\"{fill}\" stroke=\"#1c2733\" stroke-width=\"2\"");
        let _ = writeln!(out, "<polygon class=\"cell\" points=\"{points}\" {style}/>");
    }
    for portal in graph.portals() {
        let ends = [portal.shape.left, portal.shape.right].map(|p| place([p.x, p.y]));
        line(out, ends, "stroke=\"#fff\" stroke-width=\"2.5\"");
    }
    for cell in tree.cells() {
        let corners = &graph.cell(cell).polygon;
        let n = corners.len() as f64;
        let [x, y] = place(corners.iter().fold([0.0, 0.0], |[x, y], p| [x + p.x / n, y + p.y / n]));
        text(out, [x, y + 5.0], 13, "middle", &cell.to_string());
    }
    Ok(())
}

/// The tree, to the right: a level for each portal, leaves from top to bottom.
fn draw_tree(out: &mut String, tree: &StabTree) {
    let (nodes, depths) = (tree.nodes(), depths(tree));
    let children = |k: usize| (0..nodes.len()).filter(move |&child| nodes[child].parent == Some(k as u32));
    let leaves: Vec<usize> = (0..nodes.len()).filter(|&k| children(k).next().is_none()).collect();
    let mut heights = vec![0.0; nodes.len()];
    for (place, &leaf) in leaves.iter().enumerate() {
        heights[leaf] = 60.0 + 500.0 * (place as f64 + 0.5) / leaves.len() as f64;
    }
    // Parents come before their children.
    for k in (0..nodes.len()).rev().filter(|k| !leaves.contains(k)) {
        let below: Vec<f64> = children(k).map(|child| heights[child]).collect();
        heights[k] = below.iter().sum::<f64>() / below.len() as f64;
    }
    let deepest = depths.iter().copied().max().unwrap_or(1).max(1) as f64;
    let at = |k: usize| [530.0 + 440.0 * depths[k] as f64 / deepest, heights[k]];
    for (k, node) in nodes.iter().enumerate() {
        if let Some(parent) = node.parent {
            line(out, [at(parent as usize), at(k)], "class=\"branch\" stroke=\"#9aa5b1\" stroke-width=\"1.5\"");
        }
    }
    let radius = (230.0 / leaves.len() as f64).clamp(4.0, 14.0);
    for (k, node) in nodes.iter().enumerate() {
        let ([x, y], fill) = (at(k), colour(tree, node.cell));
        let style = format!("r=\"{radius:.1}\" fill=\"{fill}\" stroke=\"#1c2733\"");
        let _ = writeln!(out, "<circle class=\"node\" cx=\"{x:.1}\" cy=\"{y:.1}\" {style}/>");
        if radius > 9.0 {
            text(out, [x, y + 4.5], 12, "middle", &node.cell.to_string());
        }
    }
}

/// A small stab tree of an office, beside its plan.
///
/// # Errors
/// None that this office has.
pub(crate) fn picture() -> Result<String, Box<dyn std::error::Error>> {
    let options = OfficeOptions { seed: 4, rooms_x: 4, rooms_y: 4, furniture: false, ..OfficeOptions::default() };
    let (graph, _) = sightlines_triangulation::subdivide(&office(options)?)?;
    let build = |root| StabTree::build(&graph, root, &mut Funnel::new(Adaptive), |exit| graph.crossing(exit), 100_000);
    let trees = graph.cell_ids().map(build).collect::<Result<Vec<StabTree>, _>>()?;
    // One in which cells are reached in several ways and over several portals.
    let shows = |tree: &&StabTree| {
        tree.nodes().len() > tree.cells().len() + 1 && depths(tree).iter().max().is_some_and(|&most| most > 3)
    };
    let tree = trees.iter().filter(shows).min_by_key(|tree| tree.nodes().len()).ok_or("no tree shows enough")?;
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\" height=\"640\" viewBox=\"0 0 1000 640\" font-family=\"sans-serif\">\n\
         <title>A stab tree beside its plan</title>\n<rect width=\"1000\" height=\"640\" fill=\"#fff\"/>\n",
    );
    let (root, n_nodes, n_cells) = (tree.nodes()[0].cell, tree.nodes().len(), tree.cells().len());
    let title = format!("The stab tree of cell {root}: all sequences of portals that a line can pass");
    text(&mut out, [20.0, 32.0], 20, "start", &title);
    draw_plan(&mut out, &graph, tree)?;
    draw_tree(&mut out, tree);
    let told = format!("{n_nodes} nodes for {n_cells} cells: a cell that is reached in several ways is several nodes");
    text(&mut out, [20.0, 595.0], 15, "start", &told);
    let labels = ["the cell", "1 portal away", "2", "3", "4", "5 and more", "not seen"];
    let places = [0.0, 120.0, 270.0, 330.0, 390.0, 450.0, 580.0];
    for ((fill, label), x) in COLOURS.iter().chain([&"#eceef1"]).zip(labels).zip(places) {
        let style = format!("width=\"24\" height=\"16\" fill=\"{fill}\" stroke=\"#1c2733\"");
        let _ = writeln!(out, "<rect x=\"{}\" y=\"608\" {style}/>", x + 20.0);
        text(&mut out, [x + 52.0, 621.0], 14, "start", label);
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(path) = std::env::args().nth(1) {
        return Ok(std::fs::write(path, picture()?)?);
    }
    let floor =
        office(OfficeOptions { seed: 3, rooms_x: 8, rooms_y: 2, furniture: false, ..OfficeOptions::default() })?;
    let (graph, _) = sightlines_triangulation::subdivide(&floor)?;
    let zones = Zones::cells(&graph);
    let (seen, summary) = planar_visibility(&graph, &zones, &SearchOptions::default())?;
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
