//! Why cells see each other, as a page carries it.

use crate::progress::Bar;
use sightlines::bake::lines::{LineOptions, lines};
use sightlines::pvs::Table;
use sightlines::viewer::Reasons;

/// Looks for at most `max_lines` lines, and for the reasons of half as many hidden pairs. None for a table without portals, and for none.
pub(crate) fn reasons(table: &Table, max_lines: usize, show_progress: bool) -> Option<Reasons> {
    if max_lines == 0 {
        return None;
    }
    let bar = Bar::new("lines", show_progress);
    // The bar cancels nothing.
    let found = lines(table, LineOptions { max_lines, max_hidden: max_lines.div_ceil(2) }, Some(&bar)).ok().flatten();
    bar.finish();
    found.map(Into::into)
}
