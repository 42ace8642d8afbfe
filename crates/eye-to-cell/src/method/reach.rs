//! The methods that look at each cell or portal by itself.

use super::query::Query;

/// Keeps the cells whose box the view may meet.
pub(super) fn disjoint(query: &mut Query<'_>) {
    for cell in 0..query.subgraph.cells.len() as u32 {
        if query.cell_in_view(cell) {
            query.keep(cell);
        }
    }
}

/// Keeps the cells that are reached through cells whose box the view may meet, through open portals.
pub(super) fn connected(query: &mut Query<'_>) {
    let passes = |query: &mut Query<'_>, way: u32| {
        let local = query.way(way);
        query.doors.is_open(local.portal) && query.cell_in_view(local.to)
    };
    follow(query, &passes, &|query, cell| query.keep(cell));
}

/// Keeps the cells that are reached through open portals that the view may meet.
pub(super) fn incident(query: &mut Query<'_>) {
    follow(query, &|query, way| query.way_in_view(way), &|query, cell| query.keep(cell));
}

/// The cells that are reached through open portals that the view may meet, into `scratch.wanted`, each once.
pub(super) fn incident_cells(query: &mut Query<'_>) {
    query.scratch.wanted.clear(query.subgraph.cells.len());
    follow(query, &|query, way| query.way_in_view(way), &|query, cell| {
        query.scratch.wanted.add(cell);
    });
}

/// Keeps the cells that are reached from the root through ways that pass: along the stab trees, if there are any.
fn follow(query: &mut Query<'_>, passes: &impl Fn(&mut Query<'_>, u32) -> bool, keep: &impl Fn(&mut Query<'_>, u32)) {
    query.scratch.reached.clear(query.subgraph.cells.len());
    let root = query.subgraph.root;
    keep(query, root);
    match &query.subgraph.trees {
        None => {
            query.scratch.reached.add(root);
            query.scratch.pending.clear();
            query.scratch.pending.push(root);
            flood(query, passes, keep);
        }
        Some(_) => follow_trees(query, passes, keep),
    }
}

/// Goes on from the pending cells through all ways that pass.
fn flood(query: &mut Query<'_>, passes: &impl Fn(&mut Query<'_>, u32) -> bool, keep: &impl Fn(&mut Query<'_>, u32)) {
    while let Some(cell) = query.scratch.pending.pop() {
        for way in query.subgraph.ways_of(cell) {
            let to = query.way(way).to;
            if !query.scratch.reached.has(to) && passes(query, way) {
                query.scratch.reached.add(to);
                keep(query, to);
                query.scratch.pending.push(to);
            }
        }
    }
}

/// Goes along the nodes of the stab trees; where a tree was cut, on through all ways that pass.
fn follow_trees(
    query: &mut Query<'_>,
    passes: &impl Fn(&mut Query<'_>, u32) -> bool,
    keep: &impl Fn(&mut Query<'_>, u32),
) {
    let Some(trees) = &query.subgraph.trees else { return };
    query.scratch.reached_nodes.clear(trees.n_nodes());
    query.scratch.pending.clear();
    let mut nodes = std::mem::take(&mut query.scratch.nodes);
    nodes.clear();
    nodes.push(trees.root());
    while let Some(node) = nodes.pop() {
        let cell = if node == trees.root() { query.subgraph.root } else { query.way(trees.way(node)).to };
        for &child in trees.children(node) {
            let way = trees.way(child);
            if !query.scratch.reached_nodes.has(child) && passes(query, way) {
                query.scratch.reached_nodes.add(child);
                let to = query.way(way).to;
                keep(query, to);
                nodes.push(child);
            }
        }
        if trees.is_open(node) && query.scratch.reached.add(cell) {
            query.scratch.pending.push(cell);
        }
    }
    query.scratch.nodes = nodes;
    flood(query, passes, keep);
}
