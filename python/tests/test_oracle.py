"""Tables of random plans against brute force in fractions."""

import numpy as np
import pytest

import sightlines as sl

from conftest import free, meet


def random_plan(seed: int, n: int = 9, size: int = 6) -> sl.Plan:
    """A closed room with walls on a small grid, where they touch, cross and coincide."""
    rng = np.random.default_rng(seed)
    ends = rng.integers(0, size + 1, (4 * n, 2, 2))
    ends = ends[(ends[:, 0] != ends[:, 1]).any(axis=1)][:n]
    border = [[[0, 0], [size, 0]], [[size, 0], [size, size]], [[size, size], [0, size]], [[0, size], [0, 0]]]
    return sl.Plan(np.concatenate([ends, border]))


def false_rejections(table: sl.Table, walls, points) -> tuple[int, int]:
    """Of all pairs of points that see each other: how many, and how many of them the table hides."""
    n = n_wrong = 0
    for i, p in enumerate(points):
        for q in points[:i]:
            if free(p, q, walls):
                n += 1
                n_wrong += not table.may_see(p, q)
    return n, n_wrong


@pytest.mark.parametrize("seed", range(12))
def test_what_sees_each_other_is_never_hidden(seed):
    plan = random_plan(seed)
    table = plan.bake(progress=False)
    # Points that lie on no wall and on no border of a cell, as dyadic fractions.
    points = (np.random.default_rng(seed + 100).integers(1, 6 * 64, (24, 2)) + 0.5) / 64
    n, n_wrong = false_rejections(table, plan.walls, points.tolist())
    assert n > 10 and n_wrong == 0


@pytest.mark.parametrize("seed", range(12))
def test_what_is_reported_visible_has_a_line(seed):
    plan = random_plan(seed)
    table = plan.bake(progress=False)
    n = n_hidden = 0
    for a in range(table.n_cells):
        for b in range(a):
            why = table.explain(a, b)
            assert why.visible is table.sees(a, b)
            n_hidden += not why.visible
            if why.line is not None:
                start, end = why.line.tolist()
                # Ends are rounded, and so is a line that passes between two corners by a hair.
                n += free(start, end, plan.walls)
    n_visible = int(table.visibility.sum() - table.n_cells) // 2
    assert n_visible > 0 and n >= 0.95 * n_visible
    assert n_hidden > 0


def test_impostor_the_table_of_another_plan_is_found_out():
    plan = random_plan(3)
    # One more wall across.
    more = sl.Plan(np.concatenate([plan.walls, [[[0, 3], [6, 3]]]])).bake(progress=False)
    points = (np.random.default_rng(103).integers(1, 6 * 64, (40, 2)) + 0.5) / 64
    n, n_wrong = false_rejections(more, plan.walls, points.tolist())
    assert n > 10 and n_wrong > 0


def test_the_oracle_knows_what_meets():
    assert meet((0, 0), (2, 2), (0, 2), (2, 0))
    assert meet((0, 0), (2, 0), (1, 0), (3, 0)) and meet((0, 0), (2, 0), (2, 0), (3, 5))
    assert not meet((0, 0), (1, 0), (2, 0), (3, 0)) and not meet((0, 0), (2, 0), (0, 1), (2, 1))
    # Nearly on the line, and not on it.
    assert meet((0.1, 0.1), (0.3, 0.3), (0.2, 0.2), (0.5, 0.0))
    assert not meet((0.1, 0.1), (0.3, 0.3), (0.2, np.nextafter(0.2, 0)), (0.5, 0.0))
