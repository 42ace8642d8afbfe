"""Isovists: what is seen from points of a plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: What an edge of an isovist is, by its number.
KINDS = ("wall", "occluding", "frame", "limit")

NAMES: tuple[str, ...] = tuple(_native.Isovists.names())


class Isovist:
    """The polygon of everything that can be seen from a point. Its measures are attributes:

    ``area``, ``perimeter``, ``occlusivity`` (length of the outline that is no wall), ``compactness``, ``drift`` and ``drift_angle`` (from the
    eye to the centroid; degrees), ``minimal_radial``, ``maximal_radial``, ``mean_radial``, ``variance`` and ``skewness`` of the radials.
    """

    __slots__ = ("crs", "eye", "kinds", "measures", "vertices", "walls")

    def __init__(
        self,
        eye: NDArray[np.float64],
        vertices: NDArray[np.float64],
        kinds: NDArray[np.uint8],
        walls: NDArray[np.int64],
        measures: Mapping[str, float],
        crs: Any,
    ) -> None:
        #: The point.
        self.eye = eye
        #: The corners, counter-clockwise: shape (n, 2). Edge k leads from corner k to the next one, the last one to the first.
        self.vertices = vertices
        #: What each edge is: 0 a part of a wall, 1 occluding (a ray past the end of a wall), 2 the frame around the plan, 3 a limit.
        self.kinds = kinds
        #: The wall that each edge lies on, as an index of the plan's walls; -1 for none.
        self.walls = walls
        #: The measures, by name.
        self.measures = dict(measures)
        #: The coordinate reference system of the plan.
        self.crs = crs

    def __getattr__(self, name: str) -> float:
        if name in NAMES:
            return self.measures[name]
        raise AttributeError(name)

    def __repr__(self) -> str:
        x, y = self.eye.tolist()
        return f"<sightlines.Isovist of ({x:g}, {y:g}): {len(self.vertices)} corners, area {self.area:g}>"

    @property
    def polygon(self) -> Any:
        """The polygon of shapely."""
        import shapely

        return shapely.Polygon(self.vertices)

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        return _feature(None, self.vertices, self.eye, self.measures)

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the polygon and the eye with matplotlib; ``style`` is for the polygon."""
        from ._plot import plot_isovist

        return plot_isovist(self, ax, style)


class Isovists:
    """What is seen from many points: a sequence of :class:`Isovist`, with an array for each measure, ``isovists["area"]``."""

    __slots__ = ("_corners", "_kinds", "_starts", "_table", "_walls", "crs", "points")

    def __init__(self, points: NDArray[np.float64], native: _native.Isovists, crs: Any) -> None:
        #: The points: shape (n, 2).
        self.points = points
        #: The coordinate reference system of the plan.
        self.crs = crs
        self._table = native.measures()
        self._corners, self._starts = native.corners(), native.starts()
        self._kinds, self._walls = native.kinds(), native.walls()

    @property
    def measures(self) -> dict[str, NDArray[np.float64]]:
        """An array (n,) for each measure, by name."""
        return {name: self._table[:, k] for k, name in enumerate(NAMES)}

    @property
    def polygons(self) -> list[NDArray[np.float64]]:
        """The corners of each isovist, an array (k, 2) for each; empty if outlines were not kept."""
        return [self._corners[a:b] for a, b in zip(self._starts[:-1], self._starts[1:])]

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, key: Any) -> Any:
        """The array of a measure by its name, or an isovist by its number."""
        if isinstance(key, str):
            if key not in NAMES:
                raise KeyError(f"{key!r} is no measure: there are {', '.join(NAMES)}")
            return self._table[:, NAMES.index(key)]
        k = range(len(self))[key]
        if not isinstance(k, int):
            return [self[i] for i in k]
        part = slice(int(self._starts[k]), int(self._starts[k + 1]))
        measures = dict(zip(NAMES, self._table[k].tolist()))
        return Isovist(self.points[k], self._corners[part], self._kinds[part], self._walls[part], measures, self.crs)

    def __iter__(self) -> Iterator[Isovist]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<sightlines.Isovists of {len(self)} points>"

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The isovists as a FeatureCollection, with x and y of the eyes and the measures."""
        rows = zip(self.polygons, self.points, self._table.tolist())
        features = [_feature(str(k), *row[:2], dict(zip(NAMES, row[2]))) for k, row in enumerate(rows)]
        return {"type": "FeatureCollection", "features": features}

    def to_geodataframe(self, *, geometry: str = "polygons") -> Any:
        """A ``geopandas.GeoDataFrame`` with the measures as columns.

        :param geometry: ``"polygons"``, or ``"points"`` for the eyes
        """
        import geopandas
        import shapely

        if geometry == "points":
            shapes = shapely.points(self.points)
        elif geometry == "polygons":
            shapes = np.array([shapely.Polygon(p) for p in self.polygons], dtype=object)
        else:
            raise ValueError(f"geometry is {geometry!r}, where 'polygons' or 'points' is expected")
        return geopandas.GeoDataFrame(self.measures, geometry=shapes, crs=self.crs)

    def plot(self, measure: str = "area", ax: Axes | None = None, *, cmap: str = "viridis", **style: Any) -> Axes:
        """Draws the points in the colour of a measure; ``style`` is for ``scatter``."""
        from ._plot import plot_values

        return plot_values(self.points, self[measure], measure, ax, cmap, style)


def _feature(
    number: str | None, vertices: NDArray[np.float64], eye: NDArray[np.float64], measures: Mapping[str, float]
) -> dict[str, Any]:
    corners = [*map(tuple, vertices.tolist()), *map(tuple, vertices[:1].tolist())]
    x, y = eye.tolist()
    return {
        "type": "Feature",
        **({} if number is None else {"id": number}),
        "properties": {"x": x, "y": y, **measures},
        "geometry": {"type": "Polygon", "coordinates": (tuple(corners),)},
    }
