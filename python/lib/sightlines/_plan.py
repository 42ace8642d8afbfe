"""Plans: walls in the plane."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import floats, points as points_of, threads as threads_of
from ._geo import crs_of, crs_of_json, geojson_of, interface_of
from ._isovist import Isovist, Isovists
from ._progress import Progress, Reporter
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._vga import VisibilityGraph


_Limit = tuple[Union[float, None], Union[tuple[list[float], float], None], Union[float, None]]


class Plan:
    """A floor plan, a street map, a section: walls that hide what is behind them, from both sides.

    Walls may cross, overlap, touch and repeat, and polygons may cross themselves: their outlines are walls. Coordinates are taken as they are, and
    decisions are exact for them; where ends of walls miss others only by rounding, they are joined to them. It never changes.

    :param source: a path of a file with a plan (GeoJSON, DXF, or a WAD with a map of Doom); an array of walls (n, 2, 2) or (n, 4), both ends of
        each; a geometry of shapely, a list of them, a GeoSeries, a GeoDataFrame, or anything with ``__geo_interface__``. Points are objects,
        which hide nothing
    :param crs: the coordinate reference system of results; by default that of the source
    :param map: which map of a WAD
    :param layers: which layers of a DXF file are read; by default all that are neither frozen nor off
    :param deviation: how far the straight pieces of a curve of a DXF file may be from it
    :param gap: how precise coordinates are, in units of the plan: ends of walls that miss others by no more are joined to them, so openings up to
        this width may count as closed. None: what the digits of coordinates explain; 0: exactly as they are
    :raises ValueError: for coordinates and shapes that cannot be used
    :raises OSError: for a file that cannot be read
    :raises Error: for a damaged file
    """

    __slots__ = ("__weakref__", "_inner", "crs", "layers")

    _inner: _native.Plan
    #: The coordinate reference system, which results have as well; None if it is not known.
    crs: Any
    #: Of a plan from a DXF file: the names of all layers in it.
    layers: list[str]

    def __init__(
        self,
        source: Any,
        *,
        crs: Any = None,
        map: str | None = None,
        layers: Sequence[str] | None = None,
        deviation: float | None = None,
        gap: float | None = None,
    ) -> None:
        self.crs = crs_of(source) if crs is None else crs
        self.layers = []
        if isinstance(source, Plan):
            self._inner = source._inner
        elif isinstance(source, (str, os.PathLike)):
            self._inner, stated = _native.Plan.from_file(
                os.fspath(source), map, None if layers is None else list(layers), deviation
            )
            stated_crs, self.layers, messages = stated
            if crs is None and stated_crs is not None:
                self.crs = crs_of_json(stated_crs)
            for message in messages:
                warnings.warn(f"{os.fspath(source)}: {message}", stacklevel=2)
        elif (mapping := interface_of(source)) is not None:
            self._inner = _native.Plan.from_geojson(geojson_of(mapping))
        else:
            self._inner = _native.Plan.from_walls(_walls(source))
        self._inner = self._inner.joined(gap)

    @classmethod
    def _of(cls, native: _native.Plan, crs: Any = None) -> Plan:
        plan = object.__new__(cls)
        plan._inner, plan.crs, plan.layers = native, crs, []
        return plan

    @property
    def walls(self) -> NDArray[np.float64]:
        """The walls: shape (n, 2, 2), both ends of each. Lines that do not block sight are left out."""
        return self._inner.walls()

    @property
    def gap(self) -> float:
        """Openings up to this width are closed, as ends of walls are joined to others within it; 0 if there is nothing to join."""
        return self._inner.gap()

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
        return (_unpickle, (self.to_geojson(), self.crs, self.gap))

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

    def isovist(
        self,
        point: Any,
        *,
        radius: float | None = None,
        direction: ArrayLike | None = None,
        angle: float | None = None,
        deviation: float | None = None,
    ) -> Isovist:
        """What is seen from a point: a polygon, exact but for the last rounding of its corners.

        Where no wall ends a view, a frame does that leaves a quarter of the plan's larger side free around it.

        :param point: x and y, or a shapely Point
        :param radius: nothing farther is seen
        :param direction: of the middle of a sector of view, as x and y; with ``angle``
        :param angle: the whole angle of the sector in degrees, above 0 and below 360
        :param deviation: how far the straight pieces that stand for a circle may be inside of it; a thousandth of the radius by default
        :raises ValueError: for points that are not inside the frame, plans without walls, and limits that are none
        """
        eye, single = points_of(point, 2, "point")
        if not single:
            raise ValueError("point: one point is expected; isovists takes many")
        limit = _limit(radius, direction, angle, deviation)
        found: Isovist = Isovists(eye, _native.isovist_of(self._inner, eye, limit), self.crs)[0]
        return found

    def isovists(
        self,
        points: Any,
        *,
        radius: float | None = None,
        direction: ArrayLike | None = None,
        angle: float | None = None,
        deviation: float | None = None,
        outlines: bool = True,
        threads: int | None = None,
        progress: Progress = True,
    ) -> Isovists:
        """What is seen from many points, with the measures as arrays.

        :param points: an array (n, 2), shapely Points, or a GeoSeries of them; for the other arguments see :meth:`isovist`
        :param outlines: whether the polygons are kept; measures of a million points fit into memory without them
        :param threads: None for one for each core. The result does not depend on it
        """
        eyes, _ = points_of(points, 2, "points")
        limit = _limit(radius, direction, angle, deviation)
        with Reporter(progress) as report:
            native = _native.isovists_of(self._inner, eyes, limit, outlines, threads_of(threads), report)
        return Isovists(eyes, native, self.crs)

    def sees(
        self, a: Any, b: Any, *, touching: bool = False, threads: int | None = None, progress: Progress = True
    ) -> Any:
        """Whether points see each other: no wall is in the way of the straight line between them. Exact and symmetric.

        Walls at the points themselves never block: a point on a wall looks to both of its sides. A point sees itself.

        :param a: a point, or points (n, 2), paired with ``b``; anywhere in the plane
        :param touching: False: a line that touches a wall on its way is blocked. True: lines may pass the ends of walls and run along
            them, as visibility graphs for shortest paths have it
        :returns: a bool, or an array (n,) of them
        """
        (p, one), (q, other) = points_of(a, 2, "a"), points_of(b, 2, "b")
        if len(p) != len(q):
            if 1 not in (len(p), len(q)):
                raise ValueError(f"{len(p)} points and {len(q)} points are no pairs")
            p, q = (np.ascontiguousarray(x) for x in np.broadcast_arrays(p, q))
        with Reporter(progress) as report:
            seen = _native.sees(self._inner, p, q, touching, threads_of(threads), report)
        return bool(seen[0]) if one and other else seen

    def visibility(
        self, points: Any, *, touching: bool = False, threads: int | None = None, progress: Progress = True
    ) -> NDArray[np.bool_]:
        """Which of some points see which: a matrix (n, n). The same as :meth:`sees` for all pairs, and much faster."""
        at, _ = points_of(points, 2, "points")
        with Reporter(progress) as report:
            return _native.sees_each(self._inner, at, touching, threads_of(threads), report)

    def vga(
        self,
        spacing: float,
        *,
        seeds: Any = None,
        measures: Sequence[str] = ("local", "global"),
        radius: int | None = None,
        metric_radius: float | None = None,
        angular_radius: float | None = None,
        turns: str = "near_walls",
        touching: bool = False,
        threads: int | None = None,
        progress: Progress = True,
    ) -> VisibilityGraph:
        """Visibility graph analysis: a grid of points, who sees whom (exact), and the measures of space syntax, as depthmapX defines them.

        :param spacing: of the points, which lie at its multiples
        :param seeds: points from which the grid is filled, up to the walls. By default all areas that walls enclose are filled, also the
            insides of pillars; if an outer door is open, so that the largest area is not enclosed, only that area
        :param measures: names of measures, or of groups: ``"local"`` (connectivity, first_moment, second_moment, clustering, control,
            controllability), ``"global"`` (node_count, mean_depth, integration_hh, integration_tekl, integration_p, entropy,
            relativised_entropy), ``"metric"`` and ``"angular"`` (lengths and turns of paths; slower)
        :param radius: the most steps that count in global measures
        :param metric_radius: the longest paths that count in metric measures
        :param angular_radius: the largest depth that counts in angular measures, in right angles
        :param turns: where paths of metric and angular measures may turn: ``"near_walls"``, as in depthmapX, or ``"anywhere"``
        :param touching: as for :meth:`sees`
        :param threads: None for one for each core. The result does not depend on it
        :raises ValueError: for a spacing that is none, plans that enclose nothing, seeds in walls or outside, and unknown measures
        """
        from ._vga import analyse

        return analyse(
            self,
            spacing,
            seeds=seeds,
            measures=measures,
            radius=radius,
            metric_radius=metric_radius,
            angular_radius=angular_radius,
            turns=turns,
            touching=touching,
            threads=threads,
            progress=progress,
        )

    def grid(self, spacing: float) -> NDArray[np.float64]:
        """Points (n, 2) at multiples of the spacing, within the bounds of the walls; for fields of isovists.

        :raises ValueError: for a spacing that is none, and for more than ten million points
        """
        if not (np.isfinite(spacing) and spacing > 0):
            raise ValueError(f"spacing is {spacing}, where a number above 0 is expected")
        x0, y0, x1, y1 = self.bounds
        if np.isnan(x0):
            return np.empty((0, 2))
        lows, highs = np.floor(np.array([x0, y0]) / spacing), np.ceil(np.array([x1, y1]) / spacing)
        if np.prod(highs - lows + 1.0) > 1e7:
            raise ValueError(f"spacing is {spacing}, which makes more than ten million points")
        across, up = (np.arange(low, high + 1.0) * spacing for low, high in zip(lows, highs))
        across, up = (side[(side > a) & (side < b)] for side, a, b in ((across, x0, x1), (up, y0, y1)))
        return np.stack(np.meshgrid(across, up), axis=-1).reshape(-1, 2)

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the walls with matplotlib; ``style`` is for ``LineCollection``."""
        from ._plot import plot_plan

        return plot_plan(self, ax, style)


def _limit(radius: float | None, direction: ArrayLike | None, angle: float | None, deviation: float | None) -> _Limit | None:
    if (direction is None) != (angle is None):
        raise ValueError("a sector has both a direction and an angle")
    sector = None
    if direction is not None and angle is not None:
        way, single = points_of(direction, 2, "direction")
        if not single:
            raise ValueError("direction: x and y are expected")
        sector = (way[0].tolist(), float(angle))
    if radius is None and sector is None and deviation is None:
        return None
    return (None if radius is None else float(radius), sector, None if deviation is None else float(deviation))


def _walls(source: Any) -> NDArray[np.float64]:
    walls = floats(source, "walls")
    if walls.size == 0:
        return walls.reshape(0, 4)
    if walls.ndim == 3 and walls.shape[1:] == (2, 2):
        return walls.reshape(-1, 4)
    if walls.ndim == 2 and walls.shape[1] == 4:
        return walls
    raise ValueError(f"walls: an array of shape {walls.shape}, where (n, 2, 2) or (n, 4) is expected")


def _unpickle(text: str, crs: Any, gap: float = 0.0) -> Plan:
    return Plan._of(_native.Plan.from_geojson(text).joined(gap), crs)
