//! Meshes whose nodes want different triangles.

use crate::scene::json::Document;
use crate::scene::primitive::FIRST_OF_TRIANGLES;
use crate::scene::source::GltfSource;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What becomes of a primitive.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Plan<'a> {
    Keep,
    Drop,
    /// As indices into its corners, wound as in the file.
    Triangles(Cow<'a, [[u32; 3]]>),
}

/// What becomes of the primitives of a mesh, and the nodes that want that.
#[derive(Debug)]
pub(super) struct Variant<'a> {
    pub(super) plans: Vec<Plan<'a>>,
    pub(super) nodes: Vec<usize>,
}

impl Variant<'_> {
    pub(super) fn is_empty(&self) -> bool {
        !self.plans.is_empty() && self.plans.iter().all(|plan| *plan == Plan::Drop)
    }

    fn is_as_before(&self) -> bool {
        self.plans.iter().all(|plan| *plan == Plan::Keep)
    }
}

/// By mesh, what its nodes want, in the order of the nodes; where a node that was not read has the mesh, the
/// mesh as it was comes first.
#[derive(Debug)]
pub(super) struct Variants<'a> {
    pub(super) by_mesh: BTreeMap<usize, Vec<Variant<'a>>>,
}

impl<'a> Variants<'a> {
    /// * `triangles`: for each object, checked.
    pub(super) fn new(source: &GltfSource, document: &Document, triangles: &'a [Option<Vec<[u32; 3]>>]) -> Self {
        let mut by_mesh: BTreeMap<usize, Vec<Variant<'a>>> = BTreeMap::new();
        let mut known: BTreeMap<(usize, Vec<Plan<'a>>), usize> = BTreeMap::new();
        let mut add = |mesh: usize, plans: Vec<Plan<'a>>, node: Option<usize>| {
            let variants = by_mesh.entry(mesh).or_default();
            let k = *known.entry((mesh, plans.clone())).or_insert(variants.len());
            if k == variants.len() {
                variants.push(Variant { plans, nodes: Vec::new() });
            }
            variants[k].nodes.extend(node);
        };
        let n_primitives = |mesh: usize| document.meshes[mesh].primitives.len();
        let mut was_read = vec![false; document.nodes.len()];
        for origin in &source.origins {
            was_read[origin.node] = true;
        }
        let not_read = document.nodes.iter().zip(&was_read).filter(|(_, was_read)| !**was_read);
        for mesh in not_read.filter_map(|(node, _)| node.mesh).filter(|&mesh| mesh < document.meshes.len()) {
            add(mesh, vec![Plan::Keep; n_primitives(mesh)], None);
        }
        for origin in &source.origins {
            let plan = |k: usize| {
                let is_area = document.meshes[origin.mesh].primitives[k].mode >= FIRST_OF_TRIANGLES;
                match &triangles[origin.first_object + k] {
                    None => Plan::Keep,
                    Some(list) if list.is_empty() && is_area => Plan::Drop,
                    Some(list) if list.is_empty() => Plan::Keep,
                    Some(list) if origin.mirrors => Plan::Triangles(list.iter().map(|&[a, b, c]| [a, c, b]).collect()),
                    Some(list) => Plan::Triangles(Cow::Borrowed(list)),
                }
            };
            add(origin.mesh, (0..n_primitives(origin.mesh)).map(plan).collect(), Some(origin.node));
        }
        Self { by_mesh }
    }

    pub(super) fn keep(&self, mesh: usize, primitive: usize) -> bool {
        let variants = self.by_mesh.get(&mesh);
        variants.is_none_or(|variants| variants.iter().any(|variant| variant.plans[primitive] == Plan::Keep))
    }

    pub(super) fn are_all_as_before(&self) -> bool {
        self.by_mesh.values().flatten().all(Variant::is_as_before)
    }
}
