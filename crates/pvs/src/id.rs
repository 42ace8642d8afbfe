//! Ids, dense from 0. Each kind has its own type, so that they cannot be confused.

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        pub struct $name(pub u32);

        impl $name {
            /// The id as an index.
            #[inline]
            pub const fn idx(self) -> usize {
                self.0 as usize
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    )*};
}

ids! {
    /// A convex cell of a scene.
    CellId
    /// An object: something that is visible or not, in the order of the scene.
    ObjectId
    /// A portal between two cells, in the order of the table.
    PortalId
    /// A mirror, of which there may be parts in several cells.
    MirrorId
    /// A door, in the order of the table.
    DoorId
}
