//! Where objects are in the file that a table was made of.

use crate::{ObjectId, ObjectSource};

/// The objects of each node of a file, for finding them again.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NodeIndex {
    /// Ascending by node, then by object.
    objects: Vec<(u32, ObjectId)>,
}

impl NodeIndex {
    /// Gathers the sources of objects, in the order of their ids; no more than 2^32 of them. O(n log n).
    pub fn new(sources: &[Option<ObjectSource>]) -> Self {
        let known = (0u32..).map(ObjectId).zip(sources);
        let mut objects: Vec<_> = known.filter_map(|(id, source)| source.map(|source| (source.node, id))).collect();
        objects.sort_unstable();
        Self { objects }
    }

    /// Whether no object has a source.
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// The objects of a node, ascending. O(log n).
    pub fn objects_of(&self, node: u32) -> impl Iterator<Item = ObjectId> + '_ {
        let begin = self.objects.partition_point(|&(at, _)| at < node);
        self.objects[begin..].iter().take_while(move |&&(at, _)| at == node).map(|&(_, object)| object)
    }
}
