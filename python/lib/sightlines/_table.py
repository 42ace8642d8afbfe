"""Tables: what is seen from where."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import floats, index, indices, points, threads as threads_of
from ._relevance import Reaches

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Outside = Literal["all", "none", "error"]


@dataclass(frozen=True, eq=False)
class Explanation:
    """Why one cell of a table sees another, or why it does not."""

    #: Whether they see each other; None if it was not decided.
    visible: bool | None
    #: A sentence.
    text: str
    #: Two points of a line of sight, shape (2, dimension).
    line: NDArray[np.float64] | None = None
    #: The cells that it passes, in order.
    cells: list[int] = field(default_factory=list)
    #: The portals between them.
    portals: list[int] = field(default_factory=list)
    #: Of a plan: some sequences of portals that no line passes.
    blocked: list[list[int]] = field(default_factory=list)
    #: In space: walls as boxes (n, 2, 3), of which every line meets one.
    walls: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2, 3)))

    def __str__(self) -> str:
        return self.text


class Table:
    """Which cells of a scene, and which objects, can be seen from which cells. It never changes.

    Answers err towards visible: what is reported hidden cannot be seen. Cells and objects are numbers from 0.
    """

    __slots__ = ("__weakref__", "_inner", "_said", "crs")

    _inner: _native.Table
    _said: tuple[int, int, int] | None
    #: The coordinate reference system of the plan that it was made of; not written to files.
    crs: Any

    def __init__(self, *_: Any, **__: Any) -> None:
        raise TypeError("Table makes no tables: sightlines.load reads one from a file, sightlines.bake and Plan.bake make one")

    @classmethod
    def _of(cls, native: _native.Table, said: tuple[int, int, int] | None = None, crs: Any = None) -> Table:
        table = object.__new__(cls)
        table._inner, table._said, table.crs = native, said, crs
        return table

    # Files.

    @staticmethod
    def from_bytes(data: bytes) -> Table:
        """The table of the content of a ``.pvs`` or ``.pvz`` file.

        :raises Error: for anything else, and for damaged bytes
        """
        return Table._of(_native.Table.from_bytes(bytes(data)))

    def to_bytes(self, *, packed: bool = False) -> bytes:
        """The content of a file, the same on every machine; packed, it takes a fraction of the size."""
        return self._inner.to_bytes(packed)

    def save(self, path: str | os.PathLike[str], *, packed: bool | None = None) -> None:
        """Writes a file: beside the old one, which it then replaces, so that no half of it is ever there.

        :param packed: by default, if the name ends in ``.pvz``
        :raises OSError: if it cannot be written; the old one is still there
        """
        name = os.fspath(path)
        self._inner.save(name, name.endswith(".pvz") if packed is None else packed)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_unpickle, (self.to_bytes(packed=True), self.crs))

    def __eq__(self, other: object) -> bool:
        return self.to_bytes() == other.to_bytes() if isinstance(other, Table) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        objects = f", {self._inner.n_objects} objects" if self._inner.n_objects else ""
        return f"<sightlines.Table: {self.kind}, {self.n_cells} cells{objects}>"

    # What it holds.

    @property
    def dimension(self) -> int:
        """2 for a plan, 3 for a scene in space."""
        return self._inner.dimension

    @property
    def kind(self) -> str:
        """What was cut into cells, and how."""
        return self._inner.kind

    @property
    def up(self) -> str | None:
        """The axis that points up, "x", "y" or "z"; None if it is not known."""
        return self._inner.up

    @property
    def info(self) -> dict[str, str]:
        """What the table says about how it was made."""
        return dict(self._inner.info)

    @property
    def undecided_pairs(self) -> int | None:
        """Of a table that was just baked: the pairs that count as visible because they took too long; None for others."""
        return None if self._said is None else self._said[1] + self._said[2]

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return self._inner.n_cells

    @property
    def n_objects(self) -> int:
        """Number of objects."""
        return self._inner.n_objects

    @property
    def objects(self) -> list[str]:
        """The names of the objects; names may repeat."""
        return self._inner.object_names()

    @property
    def object_bounds(self) -> NDArray[np.float64]:
        """Boxes around the objects: shape (n, 2, dimension), lower and upper corner, along the axes of the table."""
        return self._inner.object_bounds()

    @property
    def cells(self) -> NDArray[np.float64]:
        """Boxes around the cells: shape (n, 2, dimension), lower and upper corner, along the axes of the table."""
        return self._inner.cell_bounds()

    @property
    def cell_names(self) -> list[str] | None:
        """The names of the cells, if they have any."""
        return self._inner.cell_names()

    @property
    def cell_groups(self) -> NDArray[np.int64]:
        """The group of each cell, such as the sector of a Doom map; -1 for none."""
        return self._inner.cell_groups()

    @property
    def polygons(self) -> list[NDArray[np.float64]]:
        """The corners of the cells of a plan, counter-clockwise, an array (k, 2) for each; empty arrays in space."""
        return _split(*self._inner.polygons())

    @property
    def portals(self) -> list[NDArray[np.float64]]:
        """The corners of the openings between cells, an array (k, dimension) for each."""
        return _split(*self._inner.portal_points())

    @property
    def portal_cells(self) -> NDArray[np.int64]:
        """The two cells of each opening: shape (n, 2)."""
        return self._inner.portal_cells()

    @property
    def frame(self) -> NDArray[np.float64] | None:
        """The axes along which the coordinates of cells and objects are, as unit vectors of the scene, one in each row; None: those of the
        scene. Queries take points of the scene, with a frame or without."""
        return self._inner.frame()

    def to_scene(self, coordinates: ArrayLike) -> NDArray[np.float64]:
        """Points along the axes of the table, shape (..., dimension), along those of the scene."""
        along = np.asarray(coordinates, dtype=np.float64)
        frame = self.frame
        return along if frame is None else along @ frame

    # Questions.

    def sees(self, a: ArrayLike, b: ArrayLike) -> Any:
        """Whether something in cell ``a`` may be seen from somewhere in cell ``b``; symmetric.

        :param a: a cell, or an array of cells, which is paired with ``b`` as numpy does
        :returns: a bool, or an array of them
        :raises IndexError: for cells that there are not
        """
        if np.ndim(a) == 0 and np.ndim(b) == 0:
            return self._inner.sees(index(a, "a"), index(b, "b"))
        left, right = np.broadcast_arrays(indices(a, "a"), indices(b, "b"))
        flat = [np.ascontiguousarray(side).reshape(-1) for side in (left, right)]
        return self._inner.sees_many(flat[0], flat[1]).reshape(left.shape)

    def may_see(self, a: Any, b: Any) -> Any:
        """Whether the cells at point ``a`` may see those at point ``b``; True where one is outside of all cells.

        :param a: a point, or an array of points (n, dimension), paired with ``b``
        """
        (p, one), (q, other) = points(a, self.dimension, "a"), points(b, self.dimension, "b")
        if len(p) != len(q):
            if 1 not in (len(p), len(q)):
                raise ValueError(f"{len(p)} points and {len(q)} points are no pairs")
            p, q = (np.ascontiguousarray(x) for x in np.broadcast_arrays(p, q))
        seen = self._inner.sees_points(p, q)
        return bool(seen[0]) if one and other else seen

    def cells_at(self, eye: Any) -> NDArray[np.int64]:
        """The cells that contain a point: several on borders, none outside."""
        return self._inner.cells_at(self._eye(eye))

    def visible_cells(self, eye: Any, *, outside: Outside = "all") -> Any:
        """The cells that may be seen from a point.

        :param eye: a point, or an array of points (n, dimension)
        :param outside: what holds for points in no cell, of which nothing is known: all may be seen, none, or a ValueError
        :returns: numbers of cells, ascending; for an array a matrix of bools (n, n_cells)
        """
        one, many = self._inner.cells_from, self._inner.cells_from_many
        return self._seen(eye, outside, self.n_cells, one, many)

    def visible_objects(self, eye: Any, *, outside: Outside = "all") -> Any:
        """The objects that may be seen from a point: as :meth:`visible_cells`.

        :returns: numbers of objects, ascending; for an array a matrix of bools (n, n_objects)
        """
        one, many = self._inner.objects_from, self._inner.objects_from_many
        return self._seen(eye, outside, self.n_objects, one, many)

    def visible_ranges(self, eye: Any, *, outside: Outside = "all") -> NDArray[np.int64]:
        """What may be seen from a point, by triangles: of objects that were cut into parts (``bake(parts=)``) only the parts that may be seen.

        :param eye: a point
        :param outside: as for :meth:`visible_cells`
        :returns: an array (n, 3), by ascending object: the object, its first triangle in the order of its file, and the one behind the last;
            0 and -1 for all triangles of an object
        """
        at = self._eye(eye)
        found = self._inner.ranges_from(at)
        if found is not None:
            return found.reshape(-1, 3)
        self._seen(at, outside, self.n_objects, self._inner.objects_from, None)
        whole = range(self.n_objects if outside == "all" else 0)
        return np.array([(item, 0, -1) for item in whole], np.int64).reshape(-1, 3)

    def ranges_seen_by(self, cell: int) -> NDArray[np.int64]:
        """What a cell may see, by triangles: as :meth:`visible_ranges`."""
        return self._inner.ranges_seen_by_cell(index(cell, "cell")).reshape(-1, 3)

    def _eye(self, eye: Any) -> list[float]:
        found, single = points(eye, self.dimension, "eye")
        if not single:
            raise ValueError("eye: one point is expected")
        row: list[float] = found[0].tolist()
        return row

    def _seen(self, eye: Any, outside: Outside, n: int, one: Any, many: Any) -> Any:
        if outside not in ("all", "none", "error"):
            raise ValueError(f"outside is {outside!r}, where 'all', 'none' or 'error' is expected")
        eyes, single = points(eye, self.dimension, "eye")
        if single:
            found = one(eyes[0].tolist())
            if found is not None:
                return found
            self._refuse_outside(outside, eyes[0])
            return np.arange(n if outside == "all" else 0)
        seen, inside = many(eyes)
        if not inside.all():
            self._refuse_outside(outside, eyes[~inside][0])
            seen[~inside] = outside == "all"
        return seen

    @staticmethod
    def _refuse_outside(outside: Outside, eye: NDArray[np.float64]) -> None:
        if outside == "error":
            raise ValueError(f"the point {tuple(eye.tolist())} is in no cell")

    def seen_by(self, cell: int) -> NDArray[np.int64]:
        """The cells that a cell may see, itself included, ascending."""
        return self._inner.seen_by_cell(index(cell, "cell"))

    def objects_seen_by(self, cell: int) -> NDArray[np.int64]:
        """The objects that a cell may see, ascending."""
        return self._inner.objects_seen_by_cell(index(cell, "cell"))

    def objects_in(self, cell: int) -> NDArray[np.int64]:
        """The objects that touch a cell, ascending."""
        return self._inner.objects_of_cell(index(cell, "cell"))

    @property
    def visibility(self) -> NDArray[np.bool_]:
        """Which cells may see which: a matrix (n_cells, n_cells), made anew each time."""
        return self._inner.visibility()

    @property
    def visible_share(self) -> float:
        """Of all pairs of different cells, the share that may see each other, from 0 to 1; 0 for fewer than two cells.

        The program's ``info`` and the page of ``view`` print the same number. ``visibility.mean()`` is larger: each cell sees itself.
        """
        return self._inner.visible_share

    @property
    def counts(self) -> NDArray[np.int64]:
        """How many cells each cell may see, itself included."""
        return self._inner.counts()

    def reaches(
        self,
        ladder: ArrayLike = (),
        *,
        one_moves: bool = False,
        by_walking: bool = False,
        threads: int | None = None,
    ) -> Reaches:
        """For each pair of cells the first of some reaches at which bodies in them may see each other: for servers that hide players.

        :param ladder: at most 14 reaches in scene units, ascending; by default 0.25, 0.5, 1, 2, 4, 8 and 16 m
        :param one_moves: only the first of two bodies moves
        :param by_walking: distances are along ways through portals; holds where nobody passes what hides
        :raises ValueError: for other ladders, and for a table without places of its cells
        """
        steps = floats(ladder, "ladder").reshape(-1).tolist()
        return Reaches._of(self._inner.reaches(steps, one_moves, by_walking, threads_of(threads)), self.dimension)

    def load_reaches(self, path: str | os.PathLike[str]) -> Reaches:
        """The reaches of a ``.rel`` file that :meth:`Reaches.save` or the program's ``relevance`` made of this table.

        :raises OSError: if it cannot be opened
        :raises Error: if it is of another table, or damaged
        """
        return Reaches._of(self._inner.load_reaches(os.fspath(path)), self.dimension)

    def explain(self, a: Any, b: Any, *, scene: str | os.PathLike[str] | None = None) -> Explanation:
        """Why two cells see each other, or why they do not.

        :param a: a cell, or a point; of points on borders a pair of cells is taken that see each other, if there is one
        :param scene: of cells without portals: the file that the table was made of, to look for a line between them with rays
        :raises OSError: if the scene cannot be read
        :raises Error: if it is not the scene of such a table
        """
        pair = self._choose(self._cells(a, "a"), self._cells(b, "b"))
        found = self._inner.explain(*pair, None if scene is None else os.fspath(scene))
        return Explanation(
            found.visible, found.text, found.line(), found.cells, found.portals, found.blocked, found.walls()
        )

    def _cells(self, place: Any, what: str) -> list[int]:
        if np.ndim(place) == 0 and not hasattr(place, "geom_type"):
            return [index(place, what)]
        cells: list[int] = self.cells_at(place).tolist()
        if not cells:
            raise ValueError(f"{what}: the point is in no cell")
        return cells

    def _choose(self, left: list[int], right: list[int]) -> tuple[int, int]:
        pairs = [(a, b) for a in left for b in right]
        same = next(((a, b) for a, b in pairs if a == b), None)
        return same or next((pair for pair in pairs if self._inner.sees(*pair)), pairs[0])

    # Pictures.

    def plot(
        self,
        eye: Any = None,
        *,
        cell: int | None = None,
        height: float | None = None,
        ax: Axes | None = None,
        cmap: str = "viridis",
        line: Explanation | None = None,
    ) -> Axes:
        """Draws the cells with matplotlib, a scene in space from above: in the colour of how many cells they see, or with an eye, or a cell,
        those that it may see.

        :param eye: a point
        :param cell: a cell in its place
        :param height: in space, only cells at this height are drawn; by default those at the height of the eye, else all
        :param line: draws the line of an explanation too
        """
        from ._plot import plot_table

        return plot_table(self, eye, cell, height, ax, cmap, line)

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The cells of a plan as a FeatureCollection, with number, count and group; for geopandas."""
        return {"type": "FeatureCollection", "features": list(self._features())}

    def _features(self) -> Iterator[Mapping[str, Any]]:
        if self.dimension != 2:
            raise TypeError("only the cells of a plan are polygons")
        rows = zip(self.polygons, self.cells, self.counts.tolist(), self.cell_groups.tolist())
        for number, (polygon, box, n, group) in enumerate(rows):
            ring = polygon if len(polygon) else _ring(box)
            corners = [*map(tuple, ring.tolist()), tuple(ring[0].tolist())]
            yield {
                "type": "Feature",
                "id": str(number),
                "properties": {"cell": number, "sees": n, "group": None if group < 0 else group},
                "geometry": {"type": "Polygon", "coordinates": (tuple(corners),)},
            }

    def to_geodataframe(self) -> Any:
        """The cells of a plan as a ``geopandas.GeoDataFrame`` with the columns cell, sees and group."""
        import geopandas

        return geopandas.GeoDataFrame.from_features(self.__geo_interface__, crs=self.crs)


def _ring(box: NDArray[np.float64]) -> NDArray[np.float64]:
    (x0, y0), (x1, y1) = box
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def _split(corners: NDArray[np.float64], starts: NDArray[np.int64]) -> list[NDArray[np.float64]]:
    return [corners[a:b] for a, b in zip(starts[:-1], starts[1:])]


def _unpickle(data: bytes, crs: Any) -> Table:
    table = Table.from_bytes(data)
    table.crs = crs
    return table


def load(path: str | os.PathLike[str]) -> Table:
    """Reads a table from a ``.pvs`` or ``.pvz`` file.

    :raises OSError: if it cannot be opened
    :raises Error: if it is no table, or damaged
    """
    return Table._of(_native.Table.load(os.fspath(path)))
