"""When bodies that move could see each other."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import count, floats


class Reaches:
    """For each pair of cells of a table the first of some reaches at which bodies in them may see each other; see :meth:`Table.reaches`.

    Answers err towards seen: bodies that move no farther do not see each other, as long as they stay in cells of the table.
    """

    __slots__ = ("_dimension", "_inner")

    _inner: _native.Reaches
    _dimension: int

    def __init__(self, *_: object, **__: object) -> None:
        raise TypeError("Reaches finds nothing: Table.reaches and Table.load_reaches make one")

    @classmethod
    def _of(cls, native: _native.Reaches, dimension: int) -> Reaches:
        reaches = object.__new__(cls)
        reaches._inner, reaches._dimension = native, dimension
        return reaches

    @property
    def ladder(self) -> NDArray[np.float64]:
        """The reaches, ascending from 0, in scene units."""
        return self._inner.ladder

    @property
    def one_moves(self) -> bool:
        """Whether only the first of two bodies moves."""
        return self._inner.one_moves

    @property
    def by_walking(self) -> bool:
        """Whether distances are along ways through portals; else they are straight."""
        return self._inner.by_walking

    @property
    def rungs(self) -> NDArray[np.uint8]:
        """For each pair of cells the index in the ladder of the first reach at which bodies in them may see each other; the ladder's length if at
        none of them. Shape (n_cells, n_cells), made anew each time."""
        return self._inner.rungs()

    @property
    def hidden_shares(self) -> NDArray[np.float64]:
        """For each reach the share of pairs of different cells that do not see each other within it."""
        return self._inner.hidden_shares()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a ``.rel`` file, as the program's ``relevance`` does.

        :raises OSError: if it cannot be written
        """
        self._inner.save(os.fspath(path))

    def shown(
        self,
        positions: ArrayLike,
        *,
        times: ArrayLike | None = None,
        eyes: ArrayLike = 0.0,
        seen: ArrayLike = 0.0,
        reach: ArrayLike = 0.0,
        arm: float = 0.0,
        hold: float = 0.0,
        looks: int | None = None,
    ) -> NDArray[np.bool_]:
        """Who is to be told of whom, of bodies that walk: which may come to see which before news of it arrives.

        :param positions: of each time and body, shape (times, bodies, dimension)
        :param times: in seconds, ascending; by default one after the other. They count for ``hold`` only
        :param eyes: where the eyes can be, as offsets from the position: lower and upper corner, shape (2, dimension), or a number for as much on all sides
        :param seen: what can be seen of the body, likewise
        :param reach: how far a body may get: speed times (round trip + interpolation + tick); a number, or one for each body
        :param arm: how far a camera that follows the body may be from the eyes
        :param hold: for how many seconds somebody stays shown who may no longer be seen
        :param looks: how many bodies are placed exactly at each time; by default all. The others are shown sooner
        :return: shape (times, bodies, bodies): who is told, of whom; nobody of themselves. Who is outside of all cells is shown to all, and all to them
        """
        at = floats(positions, "positions")
        d = self._dimension
        if at.ndim != 3 or at.shape[2] != d:
            raise ValueError(f"positions: an array of shape {at.shape}, where (times, bodies, {d}) is expected")
        when = np.arange(float(len(at))) if times is None else floats(times, "times")
        if when.shape != (len(at),) or (np.diff(when) < 0).any() or not np.isfinite(when).all():
            raise ValueError(f"times: {len(at)} ascending numbers are expected")
        far = np.ascontiguousarray(np.broadcast_to(floats(reach, "reach"), at.shape[1:2]))
        most = None if looks is None else (count(looks, "looks") if looks else 0)
        return self._inner.shown(at, when, self._box(eyes, "eyes"), self._box(seen, "seen"), far, float(arm), float(hold), most)

    def _box(self, box: ArrayLike, what: str) -> list[list[float]]:
        corners = floats(box, what)
        if corners.size == 1:
            corners = np.repeat([-corners.reshape(1), corners.reshape(1)], self._dimension, axis=1)
        if corners.shape != (2, self._dimension):
            raise ValueError(f"{what}: a number, or an array of shape (2, {self._dimension}) is expected, not {corners.shape}")
        filled = np.zeros((2, 3))
        filled[:, : self._dimension] = corners
        rows: list[list[float]] = filled.tolist()
        return rows

    def __repr__(self) -> str:
        who = "one of two moves" if self.one_moves else "both move"
        return f"<sightlines.Reaches: {len(self.ladder)} up to {self.ladder[-1]:g}, {who}>"
