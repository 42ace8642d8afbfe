"""Plans: walls in the plane."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import floats, threads as threads_of
from ._geo import crs_of, geojson_of, interface_of
from ._progress import Progress, Reporter
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Plan:
    """A floor plan, a street map, a section: walls that hide what is behind them, from both sides.

    Walls may cross, overlap, touch and repeat, and polygons may cross themselves: their outlines are walls. Coordinates are taken as they are, and
    decisions are exact for them. It never changes.

    :param source: a path of a file with a plan (GeoJSON, or a WAD with a map of Doom); an array of walls (n, 2, 2) or (n, 4), both ends of
        each; a geometry of shapely, a list of them, a GeoSeries, a GeoDataFrame, or anything with ``__geo_interface__``. Points are objects,
        which hide nothing
    :param crs: the coordinate reference system of results; by default that of the source
    :param map: which map of a WAD
    :raises ValueError: for coordinates and shapes that cannot be used
    :raises OSError: for a file that cannot be read
    :raises Error: for a damaged file
    """

    __slots__ = ("__weakref__", "_inner", "crs")

    _inner: _native.Plan
    crs: Any

    def __init__(self, source: Any, *, crs: Any = None, map: str | None = None) -> None:
        self.crs = crs_of(source) if crs is None else crs
        if isinstance(source, Plan):
            self._inner = source._inner
        elif isinstance(source, (str, os.PathLike)):
            self._inner = _native.Plan.from_file(os.fspath(source), map)
        elif (mapping := interface_of(source)) is not None:
            self._inner = _native.Plan.from_geojson(geojson_of(mapping))
        else:
            self._inner = _native.Plan.from_walls(_walls(source))

    @classmethod
    def _of(cls, native: _native.Plan, crs: Any = None) -> Plan:
        plan = object.__new__(cls)
        plan._inner, plan.crs = native, crs
        return plan

    @property
    def walls(self) -> NDArray[np.float64]:
        """The walls: shape (n, 2, 2), both ends of each. Lines that do not block sight are left out."""
        return self._inner.walls()

    @property
    def objects(self) -> list[str]:
        """The names of the objects."""
        return self._inner.object_names()

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest x and y, and the largest, of all walls; NaN without any."""
        ends = self.walls.reshape(-1, 2)
        if not len(ends):
            return (float("nan"),) * 4
        return (*ends.min(axis=0).tolist(), *ends.max(axis=0).tolist())

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The plan as a FeatureCollection."""
        found: dict[str, Any] = json.loads(self._inner.to_geojson())
        return found

    def to_geojson(self) -> str:
        """The plan as the text of a GeoJSON file, without its coordinate reference system."""
        return self._inner.to_geojson()

    def __reduce__(self) -> tuple[Any, ...]:
        return (_unpickle, (self.to_geojson(), self.crs))

    def __repr__(self) -> str:
        return f"<sightlines.Plan: {self._inner.n_lines()} lines>"

    def bake(
        self, *, subdivide: str = "auto", threads: int | None = None, progress: Progress = True
    ) -> Table:
        """Cuts the plan into convex cells, and decides exactly which of them see which.

        :param subdivide: ``"kd"`` along walls that are parallel to the axes, ``"triangulation"`` for any, or ``"auto"``
        :param threads: None for one for each core. The table does not depend on it
        :param progress: a bar, if tqdm is installed, or a function that gets what is done, the units done, and all of them
        :raises Error: if there is no room between walls
        """
        with Reporter(progress) as report:
            table, said = self._inner.bake(subdivide, threads_of(threads), report)
        return Table._of(table, said, self.crs)

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the walls with matplotlib; ``style`` is for ``LineCollection``."""
        from ._plot import plot_plan

        return plot_plan(self, ax, style)


def _walls(source: Any) -> NDArray[np.float64]:
    walls = floats(source, "walls")
    if walls.size == 0:
        return walls.reshape(0, 4)
    if walls.ndim == 3 and walls.shape[1:] == (2, 2):
        return walls.reshape(-1, 4)
    if walls.ndim == 2 and walls.shape[1] == 4:
        return walls
    raise ValueError(f"walls: an array of shape {walls.shape}, where (n, 2, 2) or (n, 4) is expected")


def _unpickle(text: str, crs: Any) -> Plan:
    return Plan._of(_native.Plan.from_geojson(text), crs)
