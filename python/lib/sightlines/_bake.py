"""Tables of scenes in space, and of files of any kind."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import count, floats, index, threads as threads_of
from ._progress import Progress, Reporter
from ._table import Table

_Mesh = tuple[str, NDArray[np.float64], NDArray[np.int64], bool]


def bake(
    source: Any,
    *,
    cells: str | int | tuple[int, int, int] | ArrayLike | None = None,
    cell_size: float | None = None,
    eye_height: tuple[float, float] | None = None,
    up: str | None = None,
    method: str | None = None,
    view_region: ArrayLike | None = None,
    gap: float | None = None,
    detail_below: float | None = None,
    keep_solid: bool = False,
    parts: int | None = None,
    see_through: Sequence[str] = (),
    max_cells: int | None = None,
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Progress = True,
    name: str = "scene",
    map: str | None = None,
    **options: Any,
) -> Table:
    """Makes the table of a scene: which cells and objects can be seen from which cells.

    The interpreter is free for other threads meanwhile, and Ctrl-C ends the call, as soon as what is under way is finished.

    :param source: a file (``.glb``, ``.gltf``, ``.obj``, ``.bsp``, ``.prt``, ``.wad``, ``.geojson``) as a path, its content as
        bytes, a ``trimesh.Scene`` or ``Trimesh``, or meshes by name: ``{"wall": (corners, triangles)}`` with arrays of shapes (n, 3)
        and (m, 3)
    :param cells: where viewers can be. None: chosen by the scene, such as above floors at the height of eyes. ``"kd-tree"``: boxes along
        the walls, with portals. ``"eye-level"``: above floors at the height of eyes; viewers elsewhere see everything. ``"places"`` or a
        number: so many boxes, cut where views differ. Three numbers: a grid. An array (n, 2, 3): these boxes
    :param cell_size: width of cells above floors, or of boxes that are cut where views differ, at most, in scene units
    :param eye_height: of ``"eye-level"``, which it implies: from how far to how far above floors eyes are, in scene units. None: 0 to 2.5 m
    :param up: of ``"eye-level"``, which it implies: the axis that points upwards, ``"x"``, ``"y"`` or ``"z"``. None: as the file says, else z
    :param method: what decides. None: chosen by the scene, as ``"auto"`` does. Otherwise ``"sightlines"``, ``"auto"``,
        ``"both"``, ``"multifocal"``, ``"line-space"``, ``"shafts"``
    :param view_region: a box (2, 3) in which viewers are; rooms that cannot be reached from it are no cells. None: the box around the view
        volumes of the file, if it states any, else everywhere
    :param gap: how precise coordinates are, in scene units: openings that are narrower may count as closed. None: as precise as
        the file's format; meshes whose coordinates single precision holds are as precise as that, others are taken exactly
    :param detail_below: objects smaller than this in every direction hide nothing; None for what suits the scene
    :param keep_solid: whether the insides of solid things are cells too
    :param parts: objects of more triangles than this are split into parts of at most that many, and the table lists which cells may see
        each part (:meth:`Table.visible_ranges`); None to split none
    :param see_through: names of meshes that are seen and hide nothing; only for trimesh and meshes by name
    :param max_cells: the most cells
    :param time_limit: of scenes, seconds, after which what is not decided counts as visible; the table then depends on the machine
    :param threads: None for one for each core. The table does not depend on it
    :param progress: a bar, if tqdm is installed, or a function that gets what is done, the units done, and all of them
    :param name: the name that bytes would have as a file, if it is needed to tell what they are: ``"scene.obj"``
    :param map: which map of a WAD
    :param options: further options of ``sightlines build``, by their names with ``_`` for ``-``: ``tau``, ``subdivide``, ``split``, ``planes``,
        ``texels``, ``occluders``, ``carry``, ``sheets``, ``backend``, ``fast``
    :raises ValueError: for arguments that cannot be used
    :raises OSError: for a file that cannot be read
    :raises Error: for a damaged file, or a scene that cannot be baked
    """
    where = _cells(cells)
    for option in where.keys() & options.keys():
        raise ValueError(f"{option} is given twice, as cells too")
    request = {**options, **where}
    for option, value in {
        "cell_size": number(cell_size, "cell_size"),
        "eye_height": None if eye_height is None else _numbers(eye_height, "eye_height", 2),
        "up": _name(up, "up"),
        "method": _name(method, "method"),
        "view_region": None if view_region is None else _numbers(view_region, "view_region", 6),
        "gap": number(gap, "gap"),
        "detail_below": number(detail_below, "detail_below"),
        "keep_solid": bool(keep_solid),
        "parts": count(parts, "parts"),
        "max_cells": count(max_cells, "max_cells"),
    }.items():
        if value is not None:
            request[option] = value
    limit = number(time_limit, "time_limit")
    if limit is not None and limit < 0:
        raise ValueError(f"time_limit is {limit}, where a number from 0 on is expected")
    how = {"request": json.dumps(request, allow_nan=False, default=_plain), "is_single": False, "time_limit": limit, "threads": threads_of(threads)}
    if map is not None and not isinstance(map, str):
        raise TypeError("map is the name of a map")
    refuse_see_through(source, see_through)
    with Reporter(progress) as report:
        if isinstance(source, (str, os.PathLike)):
            made = _native.bake_file(os.fspath(source), map, how, report)
        elif isinstance(source, (bytes, bytearray, memoryview)):
            made = _native.bake_bytes(bytes(source), name, map, how, report)
        else:
            meshes, is_single = meshes_of(source, frozenset(see_through))
            made = _native.bake_meshes(meshes, {**how, "is_single": is_single}, report)
    return Table._of(*made)


def refuse_see_through(source: Any, see_through: Sequence[str]) -> None:
    """Refuses names for what says itself what is seen through."""
    if see_through and isinstance(source, (str, os.PathLike, bytes, bytearray, memoryview)):
        raise ValueError("see_through is for meshes: a file says itself what is seen through")


def number(x: float | None, what: str) -> float | None:
    """A finite number, or none."""
    if x is None:
        return None
    if isinstance(x, (bool, str)) or not isinstance(x, SupportsFloat):
        raise TypeError(f"{what}: a number is expected, not {type(x).__name__}")
    if not math.isfinite(x):
        raise ValueError(f"{what} is {x}, where a finite number is expected")
    return float(x)


def _numbers(x: ArrayLike, what: str, n: int) -> list[float]:
    """So many finite numbers."""
    array = floats(x, what)
    if array.size != n or array.shape not in ((n,), (2, n // 2)):
        raise ValueError(f"{what}: an array of shape {array.shape}, where {n} numbers are expected")
    if not np.isfinite(array).all():
        raise ValueError(f"{what}: a number that is not finite")
    return [float(y) for y in array.reshape(-1)]


def _name(x: str | None, what: str) -> str | None:
    if x is not None and not isinstance(x, str):
        raise TypeError(f"{what}: a name is expected, not {type(x).__name__}")
    return x


def _plain(x: Any) -> Any:
    """A number of numpy as JSON takes it."""
    if isinstance(x, np.generic):
        return x.item()
    raise TypeError(f"an option is a number, a name or a list, not {type(x).__name__}")


def _cells(cells: Any) -> dict[str, Any]:
    """Cells as a request has them."""
    if cells is None:
        return {}
    if isinstance(cells, str):
        return {"cells": cells}
    if np.ndim(cells) == 0:
        return {"n_cells": count(index(cells, "cells"), "cells")}
    if np.ndim(cells) == 1:
        if len(cells) != 3:
            raise ValueError(f"cells: {len(cells)} numbers, where three are a grid")
        return {"grid": [count(index(n, "cells"), "cells") for n in cells]}
    boxes = floats(cells, "cells")
    if boxes.ndim != 3 or boxes.shape[1:] != (2, 3):
        raise ValueError(f"cells: an array of shape {boxes.shape}, where boxes (n, 2, 3) are expected")
    if not np.isfinite(boxes).all():
        raise ValueError("cells: a number that is not finite")
    return {"cells": {"cells": [{"id": str(i), "min": low, "max": high} for i, (low, high) in enumerate(boxes.tolist())]}}


def meshes_of(source: Any, see_through: frozenset[str]) -> tuple[list[_Mesh], bool]:
    """The meshes, and whether their coordinates are as precise as single precision is."""
    if isinstance(source, Mapping):
        found = [_mesh(str(name), *_pair(name, mesh)) for name, mesh in source.items()]
    elif hasattr(source, "graph") and hasattr(source, "geometry"):
        found = _of_scene(source)
    elif hasattr(source, "vertices") and hasattr(source, "faces"):
        name = (getattr(source, "metadata", None) or {}).get("name") or "mesh"
        found = [_mesh(str(name), source.vertices, source.faces)]
    else:
        raise TypeError(f"the source is a path, bytes, trimesh or meshes by name, not {type(source).__name__}")
    unknown = see_through - {name for name, _, _ in found}
    if unknown:
        raise ValueError(f"see_through: there is no mesh named {sorted(unknown)[0]!r}")
    is_single = all(_is_single(corners) for corners in _corners(source))
    return [(name, corners, triangles, name in see_through) for name, corners, triangles in found], is_single


def _corners(source: Any) -> Iterator[Any]:
    """The corners as they were given, before nodes of a scene place them."""
    if isinstance(source, Mapping):
        yield from (_pair(name, mesh)[0] for name, mesh in source.items())
    elif hasattr(source, "geometry"):
        yield from (geometry.vertices for geometry in source.geometry.values() if hasattr(geometry, "vertices"))
    else:
        yield source.vertices


def _is_single(corners: Any) -> bool:
    values = np.asarray(corners, dtype=np.float64)
    with np.errstate(over="ignore"):
        return bool(np.array_equal(values.astype(np.float32), values))


def _pair(name: Any, mesh: Any) -> tuple[Any, Any]:
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    try:
        corners, triangles = mesh
    except (TypeError, ValueError):
        raise ValueError(f"{name}: a mesh is a pair of corners and triangles") from None
    return corners, triangles


def _mesh(name: str, corners: Any, triangles: Any) -> tuple[str, NDArray[np.float64], NDArray[np.int64]]:
    vertices = floats(corners, f"{name}: corners")
    vertices = vertices.reshape(0, 3) if vertices.size == 0 else vertices
    faces = np.asarray(triangles)
    faces = faces.reshape(0, 3) if faces.size == 0 else faces
    if vertices.ndim != 2 or faces.ndim != 2:
        raise ValueError(f"{name}: arrays of shapes {vertices.shape} and {faces.shape}, where (n, 3) and (m, 3) are expected")
    if faces.size and faces.dtype.kind not in "iu":
        raise ValueError(f"{name}: triangles are whole numbers, not {faces.dtype}")
    return name, vertices, np.ascontiguousarray(faces, dtype=np.int64)


def _of_scene(scene: Any) -> list[tuple[str, NDArray[np.float64], NDArray[np.int64]]]:
    """Each mesh where its node places it, in the order of the nodes."""
    found = []
    for node in scene.graph.nodes_geometry:
        transform, geometry_name = scene.graph[node]
        geometry = scene.geometry[geometry_name]
        if not (hasattr(geometry, "vertices") and hasattr(geometry, "faces")):
            continue
        matrix = np.asarray(transform, dtype=np.float64)
        corners = floats(geometry.vertices, f"{node}: corners")
        if not np.array_equal(matrix, np.eye(4)):
            corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
        found.append(_mesh(str(node), corners, geometry.faces))
    return found
