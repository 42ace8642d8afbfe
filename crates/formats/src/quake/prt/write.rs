//! From portals to text.

use super::{LeafList, Prt};
use sightlines_cells::Point3;
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
    if let Some(magic) = prt.dialect().magic() {
        writeln!(out, "{magic}")?;
    }
    let (n_clusters, n_portals) = (prt.n_clusters(), prt.n_portals());
    match &prt.leafs {
        Some((LeafList::PerCluster, leafs)) => writeln!(out, "{}\n{n_clusters}\n{n_portals}", leafs.n_leafs())?,
        Some((LeafList::PerLeaf, leafs)) => writeln!(out, "{n_clusters}\n{n_portals}\n{}", leafs.n_leafs())?,
        _ => writeln!(out, "{n_clusters}\n{n_portals}")?,
    }
    if let Some((LeafList::Counts, leafs)) = &prt.leafs {
        (0..leafs.n_clusters()).try_for_each(|cluster| writeln!(out, "{}", leafs.leafs_of(cluster).len()))?;
    }
    let hints = prt.hints();
    if hints.is_some() {
        writeln!(out, "{}", prt.solid_faces().len())?;
    }
    for (k, portal) in prt.portals().enumerate() {
        write!(out, "{} {} {} ", portal.points.len(), portal.clusters[0], portal.clusters[1])?;
        if let Some(hints) = hints {
            write!(out, "{} ", hints[k])?;
        }
        points(portal.points, out)?;
    }
    for face in prt.solid_faces() {
        write!(out, "{} {} ", face.points.len(), face.cluster)?;
        points(&face.points, out)?;
    }
    match &prt.leafs {
        None | Some((LeafList::Counts, _)) => {}
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

/// The corners of a polygon, and the end of the line.
fn points(points: &[Point3], out: &mut String) -> std::fmt::Result {
    for [x, y, z] in points {
        write!(out, "({x} {y} {z}) ")?;
    }
    out.push('\n');
    Ok(())
}
