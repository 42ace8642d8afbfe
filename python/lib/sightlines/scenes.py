"""Generated plans and buildings, to try things on: the same numbers give the same scene, on every machine."""

from __future__ import annotations

from . import _native
from ._arrays import index
from ._plan import Plan

__all__ = ["city", "office", "tower"]


def _natural(n: int, what: str, most: int = 2**32 - 1) -> int:
    n = index(n, what)
    if not 0 <= n <= most:
        raise ValueError(f"{what} is {n}, where a number from 0 to {most} is expected")
    return n


def office(
    rooms_x: int = 18, rooms_y: int = 6, *, wall_thickness: float = 0.0, furniture: bool = True, seed: int = 1
) -> Plan:
    """An office floor in metres: corridors, rooms, an outer wall, desks as objects.

    :param rooms_x: room places in a row, from 1 to 128
    :param rooms_y: rows of rooms, from 1 to 128
    :param wall_thickness: 0 (a wall is a line), 0.25 or 0.5
    """
    n = (_natural(rooms_x, "rooms_x"), _natural(rooms_y, "rooms_y"))
    return Plan._of(_native.office(*n, float(wall_thickness), bool(furniture), _natural(seed, "seed", 2**64 - 1)))


def tower(floors: int = 2, rooms_x: int = 6, rooms_y: int = 4, *, furniture: int = 1, seed: int = 1) -> bytes:
    """An office tower in metres, y up, as the bytes of a GLB file.

    :param floors: from 1 to 256
    :param rooms_x: room places in a row, from 1 to 128
    :param rooms_y: rows of rooms, from 1 to 128
    :param furniture: its level of detail, from 0 (none) to 3
    """
    n = (_natural(floors, "floors"), _natural(rooms_x, "rooms_x"), _natural(rooms_y, "rooms_y"))
    return _native.tower(*n, _natural(furniture, "furniture"), _natural(seed, "seed", 2**64 - 1))


def city(blocks_x: int = 2, blocks_z: int = 2, *, seed: int = 1) -> bytes:
    """Streets and houses in metres, y up, as the bytes of a GLB file.

    :param blocks_x: from 1 to 64
    :param blocks_z: from 1 to 64
    """
    n = (_natural(blocks_x, "blocks_x"), _natural(blocks_z, "blocks_z"))
    return _native.city(*n, _natural(seed, "seed", 2**64 - 1))
