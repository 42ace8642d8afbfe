"""What of a scene nobody can ever see."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import floats, index, points, threads as threads_of
from ._bake import meshes_of, number, refuse_see_through
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class StrippedObject:
    """What becomes of an object."""

    #: Its name.
    name: str
    #: ``"seen"``, ``"hidden"``, ``"undecided"`` or ``"kept"``. Only what is hidden can go.
    fate: str
    #: Why it is hidden: ``"enclosed"``, ``"line-space"`` or ``"gap"``.
    reason: str | None
    #: If it is seen, a free segment (2, 3): from an eye through a point of it, and a little farther.
    witness: NDArray[np.float64] | None
    #: For each of its triangles whether it is hidden.
    hidden_triangles: NDArray[np.bool_]


@dataclass(frozen=True)
class Stripped:
    """What becomes of a scene."""

    #: All objects, in the order of the scene.
    objects: list[StrippedObject]
    #: How many closed surfaces were found.
    n_closed_surfaces: int

    @property
    def hidden(self) -> list[str]:
        """The names of objects that no eye sees."""
        return [of.name for of in self.objects if of.fate == "hidden"]


def strip(
    source: Any,
    *,
    eyes: str | ArrayLike = "outside",
    walk: ArrayLike | None = None,
    triangles: bool = False,
    gap: float = 0.0,
    keep: Sequence[str] = (),
    effort: int | None = None,
    ignore_mirrors: bool = False,
    see_through: Sequence[str] = (),
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = True,
    name: str = "scene",
) -> Stripped:
    """Decides for each object whether any of the eyes can see it. What is hidden can go, all of it at once, and no picture from there changes.

    The interpreter is free for other threads meanwhile, and Ctrl-C ends the call, as soon as what is under way is finished.

    :param source: a file (``.glb``, ``.gltf``, ``.obj``) as a path, its content as bytes, a ``trimesh.Scene`` or ``Trimesh``, or meshes by name:
        ``{"wall": (corners, triangles)}`` with arrays of shapes (n, 3) and (m, 3)
    :param eyes: where eyes are: ``"outside"``, everywhere outside of the box around the scene, or boxes, an array (n, 2, 3)
    :param walk: a point (3,) or points (n, 3): eyes are wherever a way leads from there that no surface bars
    :param triangles: whether triangles count one by one
    :param gap: openings through which no ball of this diameter fits count as closed, in scene units
    :param keep: names of objects that stay
    :param effort: cells of line space that all parts share that are not decided quickly; more decide more, but for eyes that walk
    :param ignore_mirrors: scenes with mirrors are refused otherwise, because mirrors show hidden things
    :param see_through: names of meshes that are seen and hide nothing; only for trimesh and meshes by name
    :param seed: of the rays that look for what is seen
    :param threads: None for one for each core. The answer does not depend on it
    :param progress: a bar, if tqdm is installed, or a function that gets what is done, the units done, and all of them
    :param name: the name that bytes would have as a file, if it is needed to tell what they are: ``"scene.obj"``
    :raises ValueError: for arguments that cannot be used
    :raises OSError: for a file that cannot be read
    :raises Error: for a damaged file, or a scene with mirrors
    """
    boxes: NDArray[np.float64] | None = None
    if walk is not None:
        if not (isinstance(eyes, str) and eyes == "outside"):
            raise ValueError("eyes and walk: eyes either walk from points or stay in boxes")
        starts, _ = points(walk, 3, "walk")
        boxes = np.ascontiguousarray(np.hstack([starts, starts]))
    elif isinstance(eyes, str):
        if eyes != "outside":
            raise ValueError(f"eyes: {eyes!r} is not 'outside', nor boxes")
    else:
        boxes = floats(eyes, "eyes")
        if boxes.ndim != 3 or boxes.shape[1:] != (2, 3):
            raise ValueError(f"eyes: an array of shape {boxes.shape}, where boxes (n, 2, 3) are expected")
        boxes = boxes.reshape(-1, 6)
    options = {
        "boxes": boxes,
        "walk": walk is not None,
        "triangles": bool(triangles),
        "gap": number(gap, "gap"),
        "keep": list(keep),
        "effort": None if effort is None else index(effort, "effort"),
        "ignore_mirrors": bool(ignore_mirrors),
        "seed": index(seed, "seed"),
        "threads": threads_of(threads),
    }
    if isinstance(keep, str):
        raise TypeError("keep: names are expected, not one name")
    refuse_see_through(source, see_through)
    with Reporter(progress) as report:
        if isinstance(source, (str, os.PathLike)):
            found, n_closed = _native.strip_file(os.fspath(source), options, report)
        elif isinstance(source, (bytes, bytearray, memoryview)):
            found, n_closed = _native.strip_bytes(bytes(source), name, options, report)
        else:
            meshes, _ = meshes_of(source, frozenset(see_through))
            found, n_closed = _native.strip_meshes(meshes, options, report)
    objects = [
        StrippedObject(of, fate, reason, None if free is None else np.array(free).reshape(2, 3), hidden)
        for of, fate, reason, free, hidden in found
    ]
    return Stripped(objects, n_closed)
