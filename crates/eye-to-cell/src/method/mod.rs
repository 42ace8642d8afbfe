//! The methods: from what a cell may see to what a viewer in it sees.

mod clip;
mod exact;
mod missing;
mod query;
mod reach;
mod sweep;

pub(crate) use clip::Clipper;
pub(crate) use exact::Frame;
pub(crate) use missing::Missing;
pub(crate) use sweep::Pieces;

use crate::doors::Doors;
use crate::outlook::Outlook;
use crate::scratch::Scratch;
use crate::seen::Seen;
use crate::view::View;
use query::Query;
use std::fmt;
use std::str::FromStr;

/// A way to find what a viewer sees of the cells that his cell may see.
///
/// Every implementation errs towards visible: what can be seen through an open set of lines from the eye, within
/// the view, through open portals, is in the answer.
pub trait EyeToCell {
    /// What it is called.
    fn name(&self) -> &'static str;

    /// Adds to `seen` the cells and objects that a viewer sees who is in the root cell of `outlook`, and the
    /// mirrors.
    ///
    /// `seen` has room for the table's cells and objects ([`Seen::clear`]). A viewer on the border between cells is asked
    /// about with the outlook of each of them.
    fn look(&self, outlook: &Outlook, view: &View, doors: &Doors, scratch: &mut Scratch, seen: &mut Seen);
}

/// The methods of the literature, each no more than the one before.
///
/// Cells without any portal, such as boxes that were given instead of cut, are asked about by their boxes by all methods but the zeroth, and
/// what is seen from such a cell by the objects' boxes: no sequence of portals leads there, and none is needed.
///
/// Source: Teller and Séquin, "Visibility Preprocessing for Interactive Walkthroughs", SIGGRAPH 1991, section
/// "eye-to-cell visibility"; the names are from there. Portals are crossed only from the side that the eye is on,
/// which is ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Method {
    /// All that the table says the cell may see, in view or not. O(cells).
    CellToCell,
    /// The cells whose box the view meets. O(cells).
    DisjointCell,
    /// Those that are reached from the viewer's cell through cells whose box the view meets. O(cells + portals).
    ConnectedComponent,
    /// Those that are reached through portals that the view meets. O(cells + portals).
    IncidentPortals,
    /// Those to which a line leads from the eye, through portals, within the view; within rounding. The cost is that of
    /// the parts into which the cells' edges cut what is seen. Where that is out of all proportion, the answer is that
    /// of the incident portals; no scene that was measured came to that.
    Exact,
}

impl Method {
    /// All, each no more than the one before.
    pub const ALL: [Self; 5] =
        [Self::CellToCell, Self::DisjointCell, Self::ConnectedComponent, Self::IncidentPortals, Self::Exact];
}

impl EyeToCell for Method {
    fn name(&self) -> &'static str {
        match self {
            Self::CellToCell => "cell-to-cell",
            Self::DisjointCell => "disjoint-cell",
            Self::ConnectedComponent => "connected-component",
            Self::IncidentPortals => "incident-portals",
            Self::Exact => "exact",
        }
    }

    fn look(&self, outlook: &Outlook, view: &View, doors: &Doors, scratch: &mut Scratch, seen: &mut Seen) {
        if *self == Self::CellToCell {
            return query::all(outlook, view, seen);
        }
        for part in view.parts() {
            let mut query = Query::new(outlook, view, part, doors, scratch, seen);
            match self {
                Self::CellToCell | Self::DisjointCell => reach::disjoint(&mut query),
                Self::ConnectedComponent => reach::connected(&mut query),
                Self::IncidentPortals => reach::incident(&mut query),
                Self::Exact => exact::exact(&mut query),
            }
            query.keep_apart_cells();
            query.keep_loose_objects();
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Not the name of a [`Method`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is none of cell-to-cell, disjoint-cell, connected-component, incident-portals, exact")]
pub struct UnknownMethod(String);

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(text: &str) -> Result<Self, UnknownMethod> {
        Self::ALL.into_iter().find(|method| method.name() == text).ok_or_else(|| UnknownMethod(text.to_owned()))
    }
}

#[cfg(test)]
mod agreement;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for method in Method::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert!(Method::Exact > Method::IncidentPortals);
        assert!("best".parse::<Method>().unwrap_err().to_string().contains("'best' is none of cell-to-cell"));
    }
}
