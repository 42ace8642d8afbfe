"""What users give, as arrays that the compiled part takes."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import NDArray


def floats(x: Any, what: str) -> NDArray[np.float64]:
    """A contiguous array of doubles; the one that was given if it is one."""
    try:
        array = np.asarray(x)
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None
    if array.dtype.kind == "c":
        raise ValueError(f"{what}: complex numbers are no coordinates")
    if array.dtype.kind not in "fiub":
        # An empty list has a type of its own choice, and objects may be numbers.
        try:
            array = array.astype(np.float64)
        except (TypeError, ValueError):
            raise ValueError(f"{what}: an array of numbers is expected, not of {array.dtype}") from None
    return np.ascontiguousarray(array, dtype=np.float64)


def points(x: Any, dimension: int, what: str) -> tuple[NDArray[np.float64], bool]:
    """Points as rows, and whether it was a single one. Takes what shapely and geopandas have for points, too."""
    array = floats(_bare(x), what)
    single = array.ndim == 1 and array.shape[0] == dimension
    if single:
        array = array.reshape(1, dimension)
    elif array.size == 0 and array.ndim < 3:
        array = array.reshape(0, dimension)
    if array.ndim != 2 or array.shape[1] != dimension:
        raise ValueError(
            f"{what}: an array of shape {array.shape}, where ({dimension},) or (n, {dimension}) is expected"
        )
    if not np.isfinite(array).all():
        raise ValueError(f"{what}: a coordinate is not finite")
    return array, single


def _bare(x: Any) -> Any:
    if isinstance(x, np.ndarray):
        return x
    kind = getattr(x, "geom_type", None)
    if isinstance(kind, str):
        return _of_point(x)
    geometry = getattr(x, "geometry", None)
    if geometry is not None and hasattr(geometry, "geom_type"):
        return [_of_point(p) for p in geometry]
    if isinstance(x, (list, tuple)) and x and getattr(x[0], "geom_type", None) == "Point":
        return [_of_point(p) for p in x]
    return x


def _of_point(p: Any) -> tuple[float, float]:
    if getattr(p, "geom_type", None) != "Point" or p.is_empty:
        raise ValueError(f"a point is expected, not {getattr(p, 'geom_type', type(p).__name__)}")
    return (p.x, p.y)


def index(x: Any, what: str) -> int:
    """A whole number, of numpy or of Python."""
    try:
        return operator.index(x)
    except TypeError:
        raise TypeError(f"{what}: a whole number is expected, not {type(x).__name__}") from None


def indices(x: Any, what: str) -> NDArray[np.int64]:
    """An array of whole numbers of any shape."""
    array = np.asarray(x)
    if array.size == 0:
        return array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{what}: whole numbers are expected, not {array.dtype}")
    return np.ascontiguousarray(array, dtype=np.int64)


def count(x: int | None, what: str, most: int = 2**32 - 1) -> int | None:
    """A number from 1 on, or none."""
    if x is None:
        return None
    n = index(x, what)
    if not 1 <= n <= most:
        raise ValueError(f"{what} is {n}, where a number from 1 to {most} is expected")
    return n


def threads(n: int | None) -> int:
    """The number of threads as the compiled part takes it: 0 for one for each core."""
    return count(n, "threads", 1024) or 0
