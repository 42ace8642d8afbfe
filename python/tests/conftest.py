"""Scenes that several tests share, and an oracle in whole numbers and fractions."""

from __future__ import annotations

import os
from fractions import Fraction

import numpy as np
import pytest

import sightlines as sl

os.environ.setdefault("MPLBACKEND", "Agg")

#: Two rooms of 4 by 3 with a door from y = 1 to y = 2 between them, and a third room without one.
ROOMS = [
    [[0, 0], [12, 0]],
    [[12, 0], [12, 3]],
    [[12, 3], [0, 3]],
    [[0, 3], [0, 0]],
    [[4, 0], [4, 1]],
    [[4, 2], [4, 3]],
    [[8, 0], [8, 3]],
]


@pytest.fixture(scope="session")
def rooms() -> sl.Plan:
    return sl.Plan(ROOMS)


@pytest.fixture(scope="session")
def rooms_table(rooms: sl.Plan) -> sl.Table:
    return rooms.bake(progress=False)


@pytest.fixture(scope="session")
def tower_bytes() -> bytes:
    return sl.scenes.tower(floors=2, rooms_x=2, rooms_y=2)


@pytest.fixture(scope="session")
def tower(tower_bytes: bytes) -> sl.Table:
    return sl.bake(tower_bytes, progress=False)


def side(a, b, c) -> int:
    """On which side of the line from a to b the point c lies; exact."""
    (ax, ay), (bx, by), (cx, cy) = ((Fraction(x), Fraction(y)) for x, y in (a, b, c))
    turn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (turn > 0) - (turn < 0)


def within(a, b, c) -> bool:
    """Whether c, on the line through a and b, lies between them."""
    return all(min(p, q) <= r <= max(p, q) for p, q, r in zip(a, b, c))


def meet(p, q, a, b) -> bool:
    """Whether two closed segments have a point in common; exact."""
    sides = side(p, q, a), side(p, q, b), side(a, b, p), side(a, b, q)
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    ends = ((sides[0], (p, q, a)), (sides[1], (p, q, b)), (sides[2], (a, b, p)), (sides[3], (a, b, q)))
    return any(s == 0 and within(*points) for s, points in ends)


def free(p, q, walls) -> bool:
    """Whether the segment from p to q touches no wall; exact."""
    return not any(meet(p, q, a, b) for a, b in np.asarray(walls).tolist())
