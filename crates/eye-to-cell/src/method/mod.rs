//! The methods: from what a cell may see to what a viewer in it sees.

mod budget;
mod clip;
mod exact;
mod missing;
mod query;
mod reach;
mod sweep;

use crate::doors::Doors;
use crate::epoch_set::{Decided, EpochSet};
use crate::side::Side;
use crate::subgraph::VisibleSubgraph;
use crate::view::View;
use crate::visible_set::VisibleSet;
pub use budget::StepBudget;
use budget::Work;
use clip::Clipper;
use exact::Frame;
use missing::Missing;
use query::Query;
use std::fmt;
use std::str::FromStr;
use sweep::Pieces;

/// Room to work in, kept from frame to frame: once warm, a query allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    /// The sides of the view.
    pub(crate) view: Vec<Side>,
    /// Cells of the subgraph: whether the view meets them.
    pub(crate) cell_in_view: Decided,
    /// Objects of the subgraph: whether the view meets them.
    pub(crate) object_in_view: Decided,
    /// Ways of the subgraph: whether the view meets them.
    pub(crate) way_in_view: Decided,
    /// Cells of the subgraph that were kept with all that is in them.
    pub(crate) kept: EpochSet,
    /// Cells of the subgraph that were reached.
    pub(crate) reached: EpochSet,
    /// Nodes of stab trees that were reached.
    pub(crate) reached_nodes: EpochSet,
    /// What is to be followed.
    pub(crate) pending: Vec<u32>,
    /// Nodes of stab trees that are to be followed.
    pub(crate) nodes: Vec<u32>,
    /// For each cell of the subgraph, whether it is on the way from the eye.
    pub(crate) on_way: Vec<bool>,
    /// The cones of sight on the way from the eye, one behind the other.
    pub(crate) sides: Vec<Side>,
    /// Cells that the exact method may find.
    pub(crate) wanted: EpochSet,
    /// Boxes of what it has not found yet.
    pub(crate) missing: Vec<Missing>,
    pub(crate) clipper: Clipper,
    /// What the exact method puts together.
    pub(crate) pieces: Pieces,
    /// The cone that is being made.
    pub(crate) cone: Vec<Side>,
    pub(crate) frames: Vec<Frame>,
    /// Steps of the exact method since this was made.
    pub(crate) n_steps: u64,
    /// What is left to the queries.
    pub(crate) work: Work,
}

impl Scratch {
    /// Not warm yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Portals that the exact method has looked at, of all queries together.
    pub fn n_steps(&self) -> u64 {
        self.n_steps
    }

    /// What all queries from here on may do together, until the next call; [`StepBudget::UNLIMITED`] at first. Once a frame, as a
    /// rule. A query that finds nothing left takes the answer of the incident portals; one that comes to the end of it takes
    /// that for what it has not looked at yet.
    pub fn allow(&mut self, budget: StepBudget) {
        self.work = Work::of(budget);
    }

    /// What is left of that.
    pub fn left(&self) -> StepBudget {
        StepBudget::steps(self.work.left())
    }
}

/// The methods of the literature, each no more than the one before.
///
/// Every method errs towards visible: what can be seen through an open set of lines from the eye, within the view, through open
/// portals, is in the answer. Cells without any portal, such as given boxes, are tested by their boxes by all methods but the
/// zeroth, and what is visible from such a cell by the boxes of the objects: no sequence of portals leads there.
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
    /// the parts into which the cells' edges cut what is seen. Where that is out of all proportion, the answer is exact
    /// near the eye, and that of the incident portals farther away; no scene that was measured came to that without a [`StepBudget`].
    Exact,
}

impl Method {
    /// All, each no more than the one before.
    pub const ALL: [Self; 5] =
        [Self::CellToCell, Self::DisjointCell, Self::ConnectedComponent, Self::IncidentPortals, Self::Exact];

    /// The name by which [`Method::from_str`] finds it, such as `incident-portals`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CellToCell => "cell-to-cell",
            Self::DisjointCell => "disjoint-cell",
            Self::ConnectedComponent => "connected-component",
            Self::IncidentPortals => "incident-portals",
            Self::Exact => "exact",
        }
    }

    /// Adds to `seen` the cells, objects and mirrors that a viewer in the root cell of `subgraph` sees.
    ///
    /// The view is that of the scene; for a table with a frame it is taken along its axes here.
    ///
    /// `seen` has room for the table's cells and objects ([`VisibleSet::clear`]). On the border between cells, look once with
    /// the subgraph of each of them. Allocates nothing once `scratch` and `seen` are warm, but for mirrors.
    ///
    /// Returns the method whose answer was added: this one, or the incident portals where the exact method had more to do than
    /// [`Scratch::allow`] lets it, or more than is in any proportion to its gain ([`Method::Exact`]). Then the answer contains the
    /// exact one and is within that of the incident portals, and often less: what is near the eye is exact.
    pub fn look(
        self,
        subgraph: &VisibleSubgraph,
        view: &View,
        doors: &Doors,
        scratch: &mut Scratch,
        seen: &mut VisibleSet,
    ) -> Self {
        let turned = subgraph.frame.map(|frame| view.in_frame(&frame));
        let view = turned.as_ref().unwrap_or(view);
        if self == Self::CellToCell {
            query::all(subgraph, view, seen);
            return self;
        }
        let mut answered = self;
        for part in view.parts() {
            let mut query = Query::new(subgraph, view, part, doors, scratch, seen);
            match self {
                Self::CellToCell | Self::DisjointCell => reach::disjoint(&mut query),
                Self::ConnectedComponent => reach::connected(&mut query),
                Self::IncidentPortals => reach::incident(&mut query),
                Self::Exact => {
                    if !exact::exact(&mut query) {
                        answered = Self::IncidentPortals;
                    }
                }
            }
            query.keep_apart_cells();
            query.keep_loose_objects();
        }
        answered
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Not the name of a [`Method`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is none of {names}", names = Method::ALL.map(Method::name).join(", "))]
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
mod bounded;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for method in Method::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert!(Method::Exact > Method::IncidentPortals);
        let names = "cell-to-cell, disjoint-cell, connected-component, incident-portals, exact";
        assert_eq!("best".parse::<Method>().unwrap_err().to_string(), format!("'best' is none of {names}"));
    }
}
