//! Why one cell of a table sees another, or why it does not: one answer for every kind of cells.
//!
//! [`explain`] answers for a stored table, an [`Explainer`] for many pairs of one graph, or for a graph without a table. Cells that portals join
//! get a line through them, or a proof that there is none. Cells without portals get a line that nothing in their scene touches,
//! or the methods that may have hidden them.

mod answer;
mod boxes;
mod ends;
mod explainer;
#[cfg(feature = "serde")]
pub mod json;

pub use answer::{Answer, BlockedWay, Blocks, Corner, ExactLine, Explanation, Reason, SightLine, Way};
pub use explainer::Explainer;

use crate::graph::GraphKind;
use sightlines_cells::Scene;
use sightlines_pvs::{CellId, Table};
use sightlines_stabtree::MOST_EXPLAINED;
use sightlines_verify::VerifyError;

/// How much is looked for. Lower limits can only change an answer to [`Answer::GivenUp`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExplainOptions {
    /// Plans: cells entered.
    pub max_visits: u64,
    /// Boxes of a k-d tree: linear programs.
    pub max_programs: u32,
    /// Clusters: sequences of portals that are tested.
    pub max_questions: u64,
    /// Cells without portals: about how many rays are aimed from each at the other.
    pub n_rays: u32,
    /// Plans and clusters: blocked ways that are kept; all are counted.
    pub max_blocked: usize,
    /// Clusters: whether an independent checker looks at the answer, which may take longer than finding it.
    pub check: bool,
}

impl Default for ExplainOptions {
    /// Enough for one pair that someone asks for: mostly milliseconds, at worst minutes.
    fn default() -> Self {
        Self {
            max_visits: 20_000_000,
            max_programs: 20_000,
            max_questions: MOST_EXPLAINED,
            n_rays: 4096,
            max_blocked: 8,
            check: false,
        }
    }
}

/// Why a pair cannot be explained.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExplainError {
    /// A cell that the table does not have.
    #[error("there is no cell {cell}: the table has {n_cells} cells")]
    NoSuchCell {
        /// The cell.
        cell: CellId,
        /// Cells of the table.
        n_cells: usize,
    },
    /// A table whose cells and portals were stripped, or do not fit together.
    #[error("the table has no polygons and portals to look for lines in")]
    NoShapes,
    /// The scene of another table.
    #[error(transparent)]
    OtherScene(#[from] VerifyError),
}

/// Why one cell of a table sees another, or not.
///
/// The answer is about the cells and portals that the table stores, or about `scene`, whatever the table lists for the pair. `scene` is used for
/// cells without portals only: it is the one that the table was made of, along the axes of its file. Points of the answer are along the axes of
/// the table.
///
/// A line is exact. So is a reason, but for [`Blocking::Behind`](sightlines_stabtree::Blocking::Behind) between clusters, which allows for corners
/// off their planes. What is neither is [`Answer::GivenUp`], [`Answer::Undecided`] or [`Answer::Unknown`]. A line through portals passes walls that
/// are borders of cells; it may meet others, by which a from-region method hides the pair, and walls that hide from one side only: then the table is
/// right too ([`stated_methods`](crate::stated_methods) says what took part). The same arguments give the same answer.
///
/// Cost: the graph is made anew, O(size of the table), and the search ends within the options. With a scene, O(n log n) of triangles and the rays;
/// for a pair that both kinds of methods may have hidden, a bake of the two cells by sightlines too.
///
/// # Errors
/// [`ExplainError`]
pub fn explain(
    table: &Table,
    scene: Option<&Scene>,
    pair: [CellId; 2],
    options: &ExplainOptions,
) -> Result<Explanation, ExplainError> {
    let n_cells = table.n_cells();
    if let Some(&cell) = pair.iter().find(|cell| cell.idx() >= n_cells) {
        return Err(ExplainError::NoSuchCell { cell, n_cells });
    }
    let cells = GraphKind::of(table);
    if cells == GraphKind::Boxes {
        let answer = boxes::answer(table, scene, pair, options.n_rays)?;
        return Ok(Explanation { cells, answer, checked: None });
    }
    let graph = crate::from_table::graph(table).ok_or(ExplainError::NoShapes)?;
    let explainer = Explainer::new(&graph).ok_or(ExplainError::NoShapes)?;
    Ok(explainer.explain(pair, options))
}
