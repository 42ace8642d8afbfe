"""Visibility graph analysis: the measures of space syntax."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import count, points as points_of, threads as threads_of
from ._progress import Progress, Reporter

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._plan import Plan

#: Name, title, unit and group of each measure.
MEASURES = {name.replace("-", "_"): (title, unit, group) for name, title, unit, group in _native.vga_measures()}


class VisibilityGraph:
    """Measures of the points of a grid, an array for each: ``graph["integration_hh"]``. NaN where a measure has no value.

    Definitions are those of depthmapX.
    """

    __slots__ = ("crs", "measures", "n_pairs", "points", "spacing")

    def __init__(
        self,
        points: NDArray[np.float64],
        spacing: float,
        measures: dict[str, NDArray[np.float64]],
        n_pairs: int,
        crs: Any,
    ) -> None:
        #: The points: shape (n, 2).
        self.points = points
        #: Their distance along the axes.
        self.spacing = spacing
        #: The values, by name.
        self.measures = measures
        #: How many pairs of points see each other.
        self.n_pairs = n_pairs
        #: The coordinate reference system of the plan.
        self.crs = crs

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        found = self.measures.get(name.replace("-", "_")) if isinstance(name, str) else None
        if found is None:
            raise KeyError(f"{name!r} was not computed: there are {', '.join(self.measures)}")
        return found

    def __repr__(self) -> str:
        return f"<sightlines.VisibilityGraph of {len(self)} points, {len(self.measures)} measures>"

    def title(self, name: str) -> str:
        """What depthmapX calls a measure, with its unit, in which u is the unit of the plan."""
        title, unit, _ = MEASURES[name.replace("-", "_")]
        return f"{title} ({unit})" if unit else title

    def to_array(self, name: str) -> tuple[NDArray[np.float64], tuple[float, float, float, float]]:
        """A measure as an image: rows from the bottom up, NaN where there is no point; and its left, right, bottom and top."""
        values = self[name]
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        columns, rows = (np.rint((high - low) / self.spacing).astype(int) + 1).tolist()
        places = np.rint((self.points - low) / self.spacing).astype(int)
        image = np.full((rows, columns), np.nan)
        image[places[:, 1], places[:, 0]] = values
        half = 0.5 * self.spacing
        (x0, y0), (x1, y1) = (low - half).tolist(), (high + half).tolist()
        return image, (x0, x1, y0, y1)

    def plot(self, name: str = "connectivity", ax: Axes | None = None, *, cmap: str = "viridis", **style: Any) -> Axes:
        """Draws a measure with matplotlib; ``style`` is for ``imshow``."""
        from ._plot import plot_image

        return plot_image(*self.to_array(name), self.title(name), ax, cmap, style)

    def to_geodataframe(self, *, geometry: str = "pixels") -> Any:
        """A ``geopandas.GeoDataFrame`` with the measures as columns.

        :param geometry: ``"pixels"`` for squares, or ``"points"``
        """
        import geopandas
        import shapely

        if geometry == "points":
            shapes = shapely.points(self.points)
        elif geometry == "pixels":
            half = 0.5 * self.spacing
            (x, y) = self.points.T
            shapes = shapely.box(x - half, y - half, x + half, y + half)
        else:
            raise ValueError(f"geometry is {geometry!r}, where 'pixels' or 'points' is expected")
        return geopandas.GeoDataFrame(self.measures, geometry=shapes, crs=self.crs)

    def _features(self) -> Iterator[dict[str, Any]]:
        columns = {name: [None if np.isnan(x) else x for x in v.tolist()] for name, v in self.measures.items()}
        for k, point in enumerate(self.points.tolist()):
            properties = {name: values[k] for name, values in columns.items()}
            geometry = {"type": "Point", "coordinates": tuple(point)}
            yield {"type": "Feature", "id": str(k), "properties": properties, "geometry": geometry}

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The points as a FeatureCollection with the measures."""
        return {"type": "FeatureCollection", "features": list(self._features())}


def analyse(
    plan: Plan,
    spacing: float,
    *,
    seeds: Any,
    measures: Sequence[str],
    radius: int | None,
    metric_radius: float | None,
    angular_radius: float | None,
    turns: str,
    touching: bool,
    threads: int | None,
    progress: Progress,
) -> VisibilityGraph:
    """What :meth:`Plan.vga` returns."""
    if turns not in ("near_walls", "anywhere"):
        raise ValueError(f"turns is {turns!r}, where 'near_walls' or 'anywhere' is expected")
    names = [measures] if isinstance(measures, str) else list(measures)
    if not all(isinstance(name, str) for name in names):
        raise TypeError("measures are names")
    options = {
        "measures": [name.replace("_", "-") for name in names],
        "radius": count(radius, "radius"),
        "metric_radius": metric_radius,
        "angular_radius": angular_radius,
        "turns_anywhere": turns == "anywhere",
        "touching": bool(touching),
        "threads": threads_of(threads),
    }
    places = None if seeds is None else points_of(seeds, 2, "seeds")[0]
    with Reporter(progress) as report:
        points, columns, n_pairs = _native.vga(plan._inner, float(spacing), places, options, report)
    values = {name.replace("-", "_"): column for name, column in columns}
    return VisibilityGraph(points, float(spacing), values, n_pairs, plan.crs)
