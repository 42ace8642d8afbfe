//! Edges of triangles, three in a row for each, and how to go round them.

/// No triangle, no wall.
pub(crate) const NONE: u32 = u32::MAX;

/// One edge of a triangle, running counter-clockwise: the triangle is on its left. Edges `3 t` to `3 t + 2` are those of
/// triangle `t`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge {
    /// The corner where it starts.
    pub(crate) from: u32,
    /// The edge of the neighbouring triangle that runs the other way; [`NONE`] on the frame.
    pub(crate) twin: u32,
    /// The line of the plan that it is a piece of; [`NONE`] if sight passes.
    pub(crate) wall: u32,
}

/// The next edge of the same triangle.
#[inline(always)]
pub(crate) fn next(edge: u32) -> u32 {
    if edge % 3 == 2 { edge - 2 } else { edge + 1 }
}

/// The edge before it in the same triangle.
#[inline(always)]
pub(crate) fn previous(edge: u32) -> u32 {
    if edge.is_multiple_of(3) { edge + 2 } else { edge - 1 }
}

/// The edges that leave a corner, one for each triangle around it, given one of them.
pub(crate) fn around(edges: &[Edge], first: u32) -> impl Iterator<Item = u32> + '_ {
    // Counter-clockwise until the first again or the frame, then clockwise from the first.
    let forward = |e: u32| edges[previous(e) as usize].twin;
    let backward = |e: u32| match edges[e as usize].twin {
        NONE => NONE,
        twin => next(twin),
    };
    let mut state = Some((first, true));
    std::iter::from_fn(move || {
        let (current, ccw) = state?;
        let step = if ccw { forward(current) } else { backward(current) };
        state = match (step, ccw) {
            (NONE, true) => Some(backward(first)).filter(|&e| e != NONE).map(|e| (e, false)),
            (NONE, false) => None,
            (e, true) if e == first => None,
            (e, ccw) => Some((e, ccw)),
        };
        Some(current)
    })
}
