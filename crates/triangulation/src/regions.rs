//! Regions between lines, and the groups that lines name for them.

use crate::mesh::{Mesh, OUTSIDE};

/// Which region a triangle belongs to, and the groups of each region.
#[derive(Debug)]
pub(crate) struct Regions {
    /// Region of each triangle.
    pub(crate) of_triangle: Vec<u32>,
    /// Groups of each region, ascending. More than one where its lines disagree; then sight into the
    /// region is sight into each of them.
    pub(crate) groups: Vec<Vec<u32>>,
}

/// Flood-fills triangles across edges that are not lines, and collects the groups that the surrounding lines name.
pub(crate) fn label(mesh: &Mesh, everywhere: &[u32]) -> Regions {
    let mut of_triangle = vec![u32::MAX; mesh.n_triangles()];
    let mut n_regions = 0u32;
    let mut stack = Vec::new();
    for start in 0..mesh.n_triangles() {
        if of_triangle[start] != u32::MAX {
            continue;
        }
        of_triangle[start] = n_regions;
        stack.push(start);
        while let Some(t) = stack.pop() {
            for edge in &mesh.edges[3 * t..3 * t + 3] {
                if edge.line.is_none() && edge.twin != OUTSIDE {
                    let neighbour = edge.twin as usize / 3;
                    if of_triangle[neighbour] == u32::MAX {
                        of_triangle[neighbour] = n_regions;
                        stack.push(neighbour);
                    }
                }
            }
        }
        n_regions += 1;
    }
    let mut groups = vec![Vec::new(); n_regions as usize];
    for &(triangle, group) in &mesh.named {
        groups[of_triangle[triangle as usize] as usize].push(group);
    }
    for list in &mut groups {
        list.extend(everywhere);
        list.sort_unstable();
        list.dedup();
    }
    Regions { of_triangle, groups }
}
