"""Pictures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._isovist import Isovist
    from ._plan import Plan
    from ._table import Explanation, Table

#: The colours of what an eye sees, of where it is, and of the rest.
SEEN, HERE, HIDDEN = "#7fb2e5", "#f2a13c", "#ececec"


def axes(ax: Axes | None) -> Axes:
    """The axes to draw in, with equal units."""
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.figure().add_subplot()
    ax.set_aspect("equal")
    return ax


def plot_plan(plan: Plan, ax: Axes | None, style: dict[str, Any]) -> Axes:
    from matplotlib.collections import LineCollection

    ax = axes(ax)
    ax.add_collection(LineCollection(list(plan.walls), **{"colors": "black", "linewidths": 1.0, **style}))
    ax.autoscale_view()
    return ax


def _across(up: str | None) -> tuple[int, list[int]]:
    """The axis that points up, and the two of a picture from above."""
    axis = "xyz".index(up or "z")
    return axis, [k for k in range(3) if k != axis]


def _outlines(table: Table) -> list[NDArray[np.float64]]:
    """What is drawn for each cell, in the plane of the picture."""
    boxes = table.cells
    if table.dimension == 2:
        rings = [[(x0, y0), (x1, y0), (x1, y1), (x0, y1)] for (x0, y0), (x1, y1) in boxes.tolist()]
        return [p if len(p) else np.array(ring) for p, ring in zip(table.polygons, rings)]
    axis, [u, v] = _across(table.up)
    corners = np.repeat(boxes[:, :1, :], 4, axis=1)
    for corner, (at_u, at_v) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
        corners[:, corner, u], corners[:, corner, v] = boxes[:, at_u, u], boxes[:, at_v, v]
    return list(table.to_scene(corners)[:, :, [u, v]])


def plot_table(
    table: Table,
    eye: Any,
    cell: int | None,
    height: float | None,
    ax: Axes | None,
    cmap: str,
    line: Explanation | None,
) -> Axes:
    from matplotlib.collections import PolyCollection

    if eye is not None and cell is not None:
        raise ValueError("an eye or a cell can be drawn, not both")
    flat = table.dimension == 2
    axis, across = (2, [0, 1]) if flat else _across(table.up)
    chosen = np.arange(table.n_cells)
    if not flat:
        boxes = table.cells
        if height is None and eye is not None:
            height = float(np.asarray(eye, dtype=np.float64)[axis])
        if height is not None:
            chosen = chosen[(boxes[:, 0, axis] <= height) & (height <= boxes[:, 1, axis])]
        # The highest are drawn last.
        chosen = chosen[np.argsort(boxes[chosen, 1, axis], kind="stable")]
    outlines = _outlines(table)
    ax = axes(ax)
    drawn = PolyCollection([outlines[k] for k in chosen], edgecolors="white", linewidths=0.3)
    if eye is None and cell is None:
        drawn.set_array(table.counts[chosen])
        drawn.set_cmap(cmap)
    else:
        seen = table.visible_cells(eye) if cell is None else table.seen_by(cell)
        here = table.cells_at(eye) if cell is None else np.array([cell])
        colours = np.full(table.n_cells, HIDDEN, dtype=object)
        colours[seen] = SEEN
        colours[here] = HERE
        drawn.set_facecolor(colours[chosen].tolist())
    ax.add_collection(drawn)
    if eye is None and cell is None and ax.figure is not None:
        ax.figure.colorbar(drawn, ax=ax, label="cells seen")
    if eye is not None:
        x, y = np.asarray(eye, dtype=np.float64)[across]
        ax.plot([x], [y], "k.")
    if line is not None and line.line is not None:
        ax.plot(*line.line[:, across].T, "k-", linewidth=1.0)
    ax.autoscale_view()
    # From above, x to the right and z down are as they stand; with z up the picture would be a mirror image.
    if axis == 1 and not ax.yaxis_inverted():
        ax.invert_yaxis()
    return ax


def plot_isovist(isovist: Isovist, ax: Axes | None, style: dict[str, Any]) -> Axes:
    from matplotlib.patches import Polygon

    ax = axes(ax)
    ax.add_patch(Polygon(isovist.vertices, **{"facecolor": SEEN, "alpha": 0.6, **style}))
    ax.plot(*isovist.eye[:, None], "k.")
    ax.autoscale_view()
    return ax


def plot_values(
    points: NDArray[np.float64],
    values: NDArray[np.float64],
    label: str,
    ax: Axes | None,
    cmap: str,
    style: dict[str, Any],
) -> Axes:
    ax = axes(ax)
    drawn = ax.scatter(points[:, 0], points[:, 1], c=values, **{"s": 9.0, "cmap": cmap, **style})
    if ax.figure is not None:
        ax.figure.colorbar(drawn, ax=ax, label=label)
    return ax


def plot_image(
    image: NDArray[np.float64],
    extent: tuple[float, float, float, float],
    label: str,
    ax: Axes | None,
    cmap: str,
    style: dict[str, Any],
) -> Axes:
    ax = axes(ax)
    drawn = ax.imshow(image, extent=extent, origin="lower", **{"cmap": cmap, "interpolation": "nearest", **style})
    if ax.figure is not None:
        ax.figure.colorbar(drawn, ax=ax, label=label)
    return ax
