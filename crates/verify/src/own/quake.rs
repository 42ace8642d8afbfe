//! The visibility lump of a Quake map.

use super::{LumpKind, OwnError, OwnSummary, OwnVisibility, Side, hidden_pairs};
use sightlines_cells::{CellGraph, Convex};
use sightlines_formats::quake::bsp::LeafRow;
use sightlines_formats::quake::visibility::{check_portals, read_visibility};
use sightlines_formats::quake::{Bsp, LeafClusters, Prt, graph_of_prt, rle};
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, CellRecord, Locator, PortalRecord, Table, TableKind, TableParts};

impl OwnVisibility {
    /// What the visibility lump of a map says, for the clusters of its portal file.
    ///
    /// Clusters see each other unless the map hides one from the other, one way or both. A cluster without leafs has no row in the
    /// lump, and nobody in it: it counts as visible from everywhere. Costs O(clusters² + size of the map).
    ///
    /// # Errors
    /// [`OwnError::OtherMap`] if the portals are not those of the map, [`OwnError::Missing`] without a lump,
    /// [`OwnError::Visibility`] for a damaged one.
    pub fn of_bsp(bsp: &Bsp, portals: &Prt) -> Result<Self, OwnError> {
        check_portals(bsp, portals).map_err(|source| OwnError::OtherMap(Box::new(source)))?;
        let leafs = portals.leaf_clusters();
        let seen = read_visibility(bsp, &leafs).map_err(|source| OwnError::Visibility(Box::new(source)))?;
        let seen = seen.ok_or(OwnError::Missing(LumpKind::Visibility))?;
        let graph = graph_of_prt(portals);
        let in_clusters = leafs_of(bsp, &leafs);
        let n = in_clusters.len();
        // A cluster without leafs has no row, and nobody in it.
        let is_real: Vec<bool> = in_clusters.iter().map(|leafs| !leafs.is_empty()).collect();
        let (mut rows, mut hidden) = (BitMatrix::identity(n), BitMatrix::new(n, n));
        for a in 0..n {
            for b in 0..n {
                let is_seen = |from: usize, to: usize| !is_real[from] || !is_real[to] || seen.get(from, to);
                hidden.set(a, b, !is_seen(a, b));
                rows.set(a, b, a == b || (is_seen(a, b) && is_seen(b, a)));
            }
        }
        let [n_hidden_pairs, n_hidden_one_way] = hidden_pairs(&hidden);
        let side =
            |(cluster, leafs): (usize, &Vec<usize>)| Side { name: name(cluster, leafs), has_places: !leafs.is_empty() };
        Ok(Self {
            table: table(bsp, &graph, &in_clusters, rows)
                .expect("boxes around points, and rows that were made symmetric"),
            about: OwnSummary {
                lump: LumpKind::Visibility,
                n_bytes: bsp.visibility().len(),
                n_leafs: Some(bsp.n_visible_leafs()),
                sides: "cluster",
                n_sides: n,
                n_hidden_pairs,
                n_hidden_one_way,
                n_uneven_clusters: (0..leafs.n_clusters()).filter(|&c| is_uneven(bsp, &leafs, c)).count(),
            },
            side_of: (0..n as u32).map(Some).collect(),
            sides: in_clusters.iter().enumerate().map(side).collect(),
            hidden,
        })
    }
}

/// The leafs of each cluster, as the map counts them.
fn leafs_of(bsp: &Bsp, leafs: &LeafClusters) -> Vec<Vec<usize>> {
    if !bsp.format().has_clusters() {
        let of = |cluster| leafs.leafs_of(cluster).iter().map(|&leaf| leaf as usize + 1).collect();
        return (0..leafs.n_clusters()).map(of).collect();
    }
    // Portals that were made from the map may have passages behind its clusters.
    let mut lists = vec![Vec::new(); leafs.n_clusters().max(bsp.n_clusters())];
    for (leaf, record) in bsp.leafs().iter().enumerate() {
        if let Some(list) = record.cluster().and_then(|cluster| lists.get_mut(usize::from(cluster))) {
            list.push(leaf);
        }
    }
    lists
}

/// A leaf by its number, several by that of their cluster too.
fn name(cluster: usize, leafs: &[usize]) -> String {
    const SHOWN: usize = 4;
    let some: Vec<String> = leafs.iter().take(SHOWN).map(usize::to_string).collect();
    match (leafs.len(), leafs.len().saturating_sub(SHOWN)) {
        (0, _) => format!("cluster {cluster}"),
        (1, _) => format!("leaf {}", some[0]),
        (_, 0) => format!("cluster {cluster} (leafs {})", some.join(", ")),
        (_, more) => format!("cluster {cluster} (leafs {} and {more} more)", some.join(", ")),
    }
}

/// Whether the leafs of a cluster do not all see the same.
fn is_uneven(bsp: &Bsp, leafs: &LeafClusters, cluster: usize) -> bool {
    if bsp.format().has_clusters() {
        return false;
    }
    let place = |leaf: u32| bsp.leafs()[leaf as usize + 1].row;
    let row = |leaf: u32| {
        let LeafRow::At(offset) = place(leaf) else { return None };
        let mut row = vec![0; rle::row_len(leafs.n_leafs())];
        rle::decode(bsp.visibility().get(offset as usize..)?, &mut row).ok()?;
        Some(row)
    };
    leafs.leafs_of(cluster).windows(2).any(|w| place(w[0]) != place(w[1]) && row(w[0]) != row(w[1]))
}

/// The table of the clusters, in boxes around their leafs and portals.
fn table(bsp: &Bsp, graph: &CellGraph<Convex>, in_clusters: &[Vec<usize>], rows: BitMatrix) -> Option<Table> {
    let cell = |(k, leafs): (usize, &Vec<usize>)| {
        let mut around: Aabb<3> = graph.cells()[k].bounds;
        for leaf in leafs.iter().filter_map(|&leaf| bsp.leafs().get(leaf)) {
            let corners = [leaf.mins, leaf.maxs].map(|corner| corner.map(f64::from));
            for corner in corners.into_iter().filter(|corner| corner.iter().all(|x| x.is_finite())) {
                // Bounds are whole numbers in most formats, and may have been cut.
                around = around.with(corner.map(|x| x - 1.0)).with(corner.map(|x| x + 1.0));
            }
        }
        let (min, max) = if around.is_empty() { ([0.0; 3], [0.0; 3]) } else { (around.min, around.max) };
        CellRecord { min, max, group: None, polygon: Vec::new() }
    };
    let cells: Vec<CellRecord> = in_clusters.iter().enumerate().map(cell).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    // Tables have corners the other way round.
    let portals = graph.portals().iter().map(|p| PortalRecord {
        cells: p.cells,
        sides: p.sides,
        points: p.shape.reversed().corners().to_vec(),
    });
    Table::new(TableParts {
        portals: portals.collect(),
        rows,
        cell_objects: vec![Vec::new(); cells.len()],
        locator: Locator::build(&bounds, 3),
        cells,
        info: vec![("source".to_owned(), "Quake map, its own visibility".to_owned())],
        ..TableParts::empty(3, TableKind::QuakeMap)
    })
    .ok()
}

#[cfg(test)]
mod tests {
    use super::name;

    #[test]
    fn leafs_are_named_as_maps_count() {
        assert_eq!(name(3, &[4]), "leaf 4");
        assert_eq!(name(3, &[4, 5]), "cluster 3 (leafs 4, 5)");
        assert_eq!(name(3, &[4, 5, 6, 7, 9, 12]), "cluster 3 (leafs 4, 5, 6, 7 and 2 more)");
        assert_eq!(name(3, &[]), "cluster 3");
    }
}
