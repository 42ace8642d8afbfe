//! From portals to text.

use super::{LeafList, Prt};
use std::fmt::Write;

/// Writes a portal file, in the layout of the compilers. Read again it is the same, bit for bit: coordinates are
/// the shortest decimals that read back as the same double.
pub fn write_prt(prt: &Prt) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_to(prt, &mut text);
    text
}

fn write_to(prt: &Prt, out: &mut String) -> std::fmt::Result {
    writeln!(out, "{}", prt.dialect())?;
    match &prt.leafs {
        None => writeln!(out, "{}\n{}", prt.n_clusters(), prt.n_portals())?,
        Some((LeafList::PerCluster, leafs)) => {
            writeln!(out, "{}\n{}\n{}", leafs.n_leafs(), prt.n_clusters(), prt.n_portals())?;
        }
        Some((LeafList::PerLeaf, leafs)) => {
            writeln!(out, "{}\n{}\n{}", prt.n_clusters(), prt.n_portals(), leafs.n_leafs())?;
        }
    }
    for portal in prt.portals() {
        write!(out, "{} {} {} ", portal.points.len(), portal.clusters[0], portal.clusters[1])?;
        for [x, y, z] in portal.points {
            write!(out, "({x} {y} {z}) ")?;
        }
        out.push('\n');
    }
    match &prt.leafs {
        None => {}
        Some((LeafList::PerCluster, leafs)) => {
            for cluster in 0..leafs.n_clusters() {
                for leaf in leafs.leafs_of(cluster) {
                    write!(out, "{leaf} ")?;
                }
                out.push_str("-1\n");
            }
        }
        Some((LeafList::PerLeaf, leafs)) => {
            for cluster in leafs.cluster_of_leaf() {
                writeln!(out, "{cluster}")?;
            }
        }
    }
    Ok(())
}
