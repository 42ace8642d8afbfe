"""When bodies that move could see each other."""

import numpy as np
import pytest

import sightlines as sl


def walks(table, rng, n_times, n):
    low, high = table.cells[:, 0].min(axis=0), table.cells[:, 1].max(axis=0)
    start = rng.uniform(low, high, (1, n, table.dimension))
    steps = rng.uniform(-0.2, 0.2, (n_times, n, table.dimension))
    return start + np.cumsum(steps, axis=0)


def test_rungs_are_those_of_the_definition(rooms_table):
    reaches = rooms_table.reaches([0.5, 1, 3])
    assert reaches.ladder.tolist() == [0, 0.5, 1, 3] and not reaches.one_moves and not reaches.by_walking
    boxes, sees = rooms_table.cells, rooms_table.visibility
    gap = np.maximum(boxes[:, None, 0] - boxes[None, :, 1], boxes[None, :, 0] - boxes[:, None, 1]).clip(0)
    far = np.hypot(gap[..., 0], gap[..., 1])
    expected = np.full(sees.shape, 4)
    for k, reach in reversed(list(enumerate(reaches.ladder))):
        near = far <= reach if reach else np.eye(len(sees), dtype=bool)
        expected[near.astype(int) @ sees.astype(int) @ near.T.astype(int) > 0] = k
    # Cells that touch are 0 apart, so that no reach tells them apart from what they touch.
    assert (reaches.rungs <= expected).all() and (reaches.rungs[expected == 4] == 4).all()
    assert (reaches.rungs == expected).mean() > 0.9
    assert (np.diff(reaches.hidden_shares) <= 0).all()


def test_walkers_are_told_before_they_see(tower):
    rng = np.random.default_rng(3)
    at = walks(tower, rng, 60, 9)
    speed = np.linalg.norm(np.diff(at, axis=0), axis=2).max()
    reaches = tower.reaches()
    # One step ahead, each body moves by no more than the reach.
    told = reaches.shown(at, reach=speed)
    assert told.shape == (60, 9, 9) and not told[:, range(9), range(9)].any()
    now = reaches.shown(at)
    n_sights = 0
    for t in range(1, 60):
        n_sights += now[t].sum()
        # Who is outside may have come there from a place of which nothing was known.
        inside = np.array([len(tower.cells_at(p)) > 0 for p in at[t - 1]])
        both = inside[:, None] & inside[None, :]
        ahead = np.array([len(tower.cells_at(p)) > 0 for p in at[t]])
        both &= ahead[:, None] & ahead[None, :]
        assert (told[t - 1] | ~now[t] | ~both).all()
    assert n_sights > 100 and told.mean() < 0.95
    # A reach that is too short is noticed.
    late = [(now[t] & ~now[t - 1]).sum() for t in range(1, 60)]
    assert sum(late) > 0


def test_holds_and_looks_only_add(tower):
    at = walks(tower, np.random.default_rng(5), 40, 6)
    reaches = tower.reaches()
    plain = reaches.shown(at, eyes=0.1, seen=0.3, reach=0.5)
    for more in (dict(hold=3.0), dict(looks=0), dict(arm=2.0), dict(seen=0.6)):
        given = dict(eyes=0.1, seen=0.3, reach=0.5) | more
        assert (reaches.shown(at, **given) >= plain).all()
    each = reaches.shown(at, eyes=0.1, seen=0.3, reach=np.full(6, 0.5))
    assert (each == plain).all()


def test_files(tmp_path, tower, rooms_table):
    reaches = tower.reaches([1.0, 2.0], one_moves=True)
    path = tmp_path / "tower.rel"
    reaches.save(path)
    again = tower.load_reaches(path)
    assert (again.rungs == reaches.rungs).all() and again.one_moves and "one of two" in repr(again)
    with pytest.raises(sl.Error, match="another table"):
        rooms_table.load_reaches(path)
    with pytest.raises(FileNotFoundError):
        tower.load_reaches(tmp_path / "none.rel")


def test_what_means_nothing_is_refused(rooms_table):
    with pytest.raises(TypeError):
        sl.Reaches()
    for ladder in ([2, 1], [-1], [float("nan")], range(1, 20)):
        with pytest.raises(ValueError):
            rooms_table.reaches(ladder)
    reaches = rooms_table.reaches()
    for positions in ([1, 2], np.zeros((2, 3, 3)), [[["a", "b"]]]):
        with pytest.raises(ValueError, match="positions"):
            reaches.shown(positions)
    at = np.zeros((2, 3, 2))
    for bad in (dict(times=[1, 0]), dict(times=[0]), dict(eyes=[1, 2]), dict(reach=[1, 2])):
        with pytest.raises(ValueError):
            reaches.shown(at, **bad)
    # Of somebody without a place nothing is known.
    at[1, 0] = np.nan
    assert reaches.shown(at)[1, 0].tolist() == [False, True, True]
    assert reaches.shown(np.zeros((0, 3, 2))).shape == (0, 3, 3)
