//! Moving all that is at one place of a mesh to a neighbour.

use super::{Mesh, State};
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{dot, normal};

/// What happens if place `from` is moved to `to`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Change {
    pub(crate) from: u32,
    pub(crate) to: u32,
    /// Faces at both places: they lose their area.
    pub(crate) lost: Vec<u32>,
    /// The other faces at `from`, with the vertex of their object that their corner becomes.
    pub(crate) moved: Vec<(u32, u32)>,
}

impl Change {
    /// The change, if it preserves the topology: no edge gets more than two faces, no border and no seam is torn, no
    /// face turns over. `None` otherwise, and where more than two faces share an edge; such edges are left alone.
    pub(crate) fn new(mesh: &Mesh, from: u32, to: u32) -> Option<Self> {
        let around = mesh.around(from);
        if around.iter().any(|(_, n)| *n > 2) {
            return None;
        }
        let of_edge = around.iter().find(|(place, _)| *place == to)?.1;
        let border = around.iter().filter(|(_, n)| *n == 1).count();
        // A border is collapsed only along itself, and not where several borders touch.
        if border > 0 && (of_edge != 1 || border != 2) {
            return None;
        }
        let (lost, rest): (Vec<u32>, Vec<u32>) =
            mesh.at(from).iter().partition(|&&face| mesh.face(face).corners.contains(&to));
        // The surface of a lost face collapses onto its third edge, which some other face must have.
        let keeps_edge = |&face: &u32| {
            let corners = mesh.face(face).corners;
            let third = corners.into_iter().find(|&c| c != from && c != to);
            third.is_some_and(|third| {
                let has_both = |f: &&u32| mesh.face(**f).corners.contains(&third) && !lost.contains(f);
                mesh.at(to).iter().any(|f| has_both(&f)) || mesh.at(from).iter().any(|f| has_both(&f))
            })
        };
        if !lost.iter().all(keeps_edge) {
            return None;
        }
        // A common neighbour must belong to a lost face; otherwise two sheets would be glued together.
        let others = mesh.around(to);
        let next_to_both = around.iter().filter(|(p, _)| others.binary_search_by_key(p, |o| o.0).is_ok()).count();
        if next_to_both != lost.len() {
            return None;
        }
        let mut moved = Vec::with_capacity(rest.len());
        for face in rest {
            let wedge = partner(mesh, &lost, face, from, to)?;
            if turns_over(mesh, face, from, to) {
                return None;
            }
            moved.push((face, wedge));
        }
        Some(Self { from, to, lost, moved })
    }

    /// The corners of a moved face after the change.
    pub(crate) fn corners(&self, mesh: &Mesh, face: u32) -> [Point3; 3] {
        mesh.face(face).corners.map(|c| mesh.place(if c == self.from { self.to } else { c }))
    }

    pub(crate) fn apply(&self, mesh: &mut Mesh) {
        self.lost.iter().for_each(|&face| mesh.remove(face));
        for &(id, wedge) in &self.moved {
            let face = &mut mesh.faces[id as usize];
            face.state = State::New;
            for k in 0..3 {
                if face.corners[k] == self.from {
                    (face.corners[k], face.wedges[k]) = (self.to, wedge);
                }
            }
            mesh.at[self.to as usize].push(id);
        }
        mesh.at[self.from as usize].clear();
    }
}

/// The vertex at `to` that corresponds to a face's vertex at `from`: the one in a face of the same object that has
/// both.
fn partner(mesh: &Mesh, lost: &[u32], face: u32, from: u32, to: u32) -> Option<u32> {
    let wedge_at = |id: u32, place: u32| {
        let face = mesh.face(id);
        face.corners.iter().position(|&c| c == place).map(|k| face.wedges[k])
    };
    let own = wedge_at(face, from)?;
    let goes_with =
        |&&other: &&u32| mesh.face(other).object == mesh.face(face).object && wedge_at(other, from) == Some(own);
    lost.iter().find(goes_with).and_then(|&other| wedge_at(other, to))
}

/// Whether a face would turn over or lose its area. In doubles: this keeps meshes tidy, and guarantees nothing.
fn turns_over(mesh: &Mesh, face: u32, from: u32, to: u32) -> bool {
    let before = mesh.corners(face);
    let after = mesh.face(face).corners.map(|c| mesh.place(if c == from { to } else { c }));
    let (n, m) = (normal(before), normal(after));
    let dot = dot(n, m);
    dot.is_nan() || dot <= 0.0
}
