"""Tables: what they hold, files, questions, pictures."""

import pickle
import stat
import threading

import numpy as np
import pytest

import sightlines as sl


def test_a_table_says_what_it_is(rooms_table, tower):
    assert (rooms_table.dimension, tower.dimension) == (2, 3)
    assert rooms_table.kind == "plan, k-d tree" and tower.kind == "scene, k-d tree"
    assert tower.up == "y" and rooms_table.up is None
    assert "cells" in repr(tower) and "objects" in repr(tower)
    assert rooms_table.info["subdivide"] == "kd"
    assert rooms_table.undecided_pairs == 0


def test_shapes(rooms_table, tower):
    for table in (rooms_table, tower):
        n, d = table.n_cells, table.dimension
        assert table.cells.shape == (n, 2, d) and table.cells.dtype == np.float64
        assert (table.cells[:, 0] <= table.cells[:, 1]).all()
        assert table.visibility.shape == (n, n) and table.visibility.dtype == bool
        assert table.counts.shape == (n,) and table.cell_groups.shape == (n,)
        assert table.object_bounds.shape == (table.n_objects, 2, d) == (len(table.objects), 2, d)
        assert table.portal_cells.shape == (len(table.portals), 2)
        assert all(p.shape[1] == d for p in table.portals)
    assert all(p.shape[1] == 2 and len(p) >= 3 for p in rooms_table.polygons)


def test_the_matrix_the_rows_and_the_pairs_agree(tower):
    matrix = tower.visibility
    assert (matrix == matrix.T).all() and matrix.diagonal().all()
    assert 0 < (~matrix).sum()
    assert (matrix.sum(axis=1) == tower.counts).all()
    n = len(matrix)
    assert tower.visible_share == pytest.approx((matrix.sum() - n) / (n * (n - 1)))
    every = np.arange(tower.n_cells)
    assert (tower.sees(every[:, None], every[None, :]) == matrix).all()
    for cell in range(0, tower.n_cells, 7):
        assert tower.seen_by(cell).tolist() == np.flatnonzero(matrix[cell]).tolist()
        assert tower.sees(cell, 0) is bool(matrix[cell, 0])


def test_one_eye_and_many_agree(tower):
    rng = np.random.default_rng(1)
    low, high = tower.cells[:, 0].min(axis=0), tower.cells[:, 1].max(axis=0)
    # Some are outside.
    eyes = rng.uniform(low - 2, high + 2, (200, 3))
    n_outside = 0
    for outside in ("all", "none"):
        cells, objects = (f(eyes, outside=outside) for f in (tower.visible_cells, tower.visible_objects))
        assert cells.shape == (200, tower.n_cells) and objects.shape == (200, tower.n_objects)
        for eye, row, seen in zip(eyes, cells, objects):
            assert np.flatnonzero(row).tolist() == tower.visible_cells(eye, outside=outside).tolist()
            assert np.flatnonzero(seen).tolist() == tower.visible_objects(eye, outside=outside).tolist()
            at = tower.cells_at(eye)
            n_outside += len(at) == 0
            if len(at):
                assert row[at].all()
            else:
                assert row.all() == (outside == "all") and row.any() == (outside == "all")
    assert 0 < n_outside < 400


def test_what_an_eye_sees_is_what_its_cells_see(rooms_table):
    eye = (1, 1.5)
    [cell] = rooms_table.cells_at(eye)
    assert rooms_table.visible_cells(eye).tolist() == rooms_table.seen_by(cell).tolist()
    assert rooms_table.may_see(eye, (7, 1.5)) is True
    assert rooms_table.may_see(eye, (9, 1.5)) is False
    assert rooms_table.may_see(eye, (99, 1.5)) is True
    assert rooms_table.may_see([eye, eye], [(7, 1.5), (9, 1.5)]).tolist() == [True, False]
    assert rooms_table.may_see(eye, [(7, 1.5), (9, 1.5)]).tolist() == [True, False]


def test_outside_may_be_an_error(rooms_table):
    with pytest.raises(ValueError, match=r"the point \(99.0, 1.0\) is in no cell"):
        rooms_table.visible_cells((99, 1), outside="error")
    with pytest.raises(ValueError, match="is in no cell"):
        rooms_table.visible_cells([(1, 1), (99, 1)], outside="error")
    with pytest.raises(ValueError, match="'all', 'none' or 'error'"):
        rooms_table.visible_cells((1, 1), outside="some")


def test_objects_have_names(tower):
    assert len(set(tower.objects)) > 10
    seen = tower.visible_objects(tower.cells[0].mean(axis=0))
    assert 0 < len(seen) < tower.n_objects
    assert set(tower.objects_in(0)) <= set(tower.objects_seen_by(0))


def test_files_come_back(tower, rooms_table, tmp_path):
    for table in (tower, rooms_table):
        for name in ("a.pvs", "a.pvz"):
            path = tmp_path / name
            table.save(path)
            assert sl.load(path) == table
            assert path.read_bytes() == table.to_bytes(packed=name.endswith("z"))
        assert (tmp_path / "a.pvz").stat().st_size < (tmp_path / "a.pvs").stat().st_size
        assert sl.Table.from_bytes(table.to_bytes()) == table == pickle.loads(pickle.dumps(table))
    assert tower != rooms_table and tower != 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.pvs", "a.pvz"]


def test_a_file_is_replaced_whole_or_not_at_all(rooms_table, tmp_path):
    path = tmp_path / "table.pvs"
    path.write_bytes(b"old")
    path.chmod(0o640)
    rooms_table.save(path)
    assert sl.load(path) == rooms_table
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    with pytest.raises(FileNotFoundError) as raised:
        rooms_table.save(tmp_path / "absent" / "table.pvs")
    assert raised.value.filename.endswith("table.pvs") and raised.value.errno == 2
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError):
        rooms_table.save(tmp_path / "taken")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["table.pvs", "taken"]


def test_damaged_files_are_refused(rooms_table, tmp_path):
    for packed in (False, True):
        data = rooms_table.to_bytes(packed=packed)
        for n in range(0, len(data), 37):
            with pytest.raises(sl.Error):
                sl.Table.from_bytes(data[:n])
            damaged = bytearray(data)
            damaged[n] ^= 0x20
            with pytest.raises(sl.Error):
                sl.Table.from_bytes(damaged)
    path = tmp_path / "damaged.pvs"
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(sl.Error, match="damaged.pvs: "):
        sl.load(path)
    with pytest.raises(FileNotFoundError, match="No such file"):
        sl.load(tmp_path / "absent.pvs")


def test_explanations_in_a_plan(rooms_table):
    seen = rooms_table.explain((1, 1.5), (7, 1.5))
    assert seen.visible is True and len(seen.portals) == len(seen.cells) - 1 >= 1
    assert seen.line.shape == (2, 2) and "sees cell" in str(seen)
    first, last = seen.cells[0], seen.cells[-1]
    assert first in rooms_table.cells_at(seen.line[0]) and last in rooms_table.cells_at(seen.line[1])
    hidden = rooms_table.explain((1, 1.5), (9, 1.5))
    assert hidden.visible is False and hidden.line is None and "does not see" in hidden.text
    assert rooms_table.explain(0, 0).visible is True
    with pytest.raises(ValueError, match="b: the point is in no cell"):
        rooms_table.explain(0, (99, 99))


def test_explanations_in_space_agree_with_the_table(tower):
    n = 0
    for a in range(0, tower.n_cells, 5):
        for b in range(a + 1, tower.n_cells, 11):
            why = tower.explain(a, b)
            assert why.visible in (tower.sees(a, b), None)
            if why.visible:
                assert why.line.shape == (2, 3) and np.isfinite(why.line).all()
                assert why.cells[0] == a and why.cells[-1] == b
            elif why.visible is False:
                assert why.walls.shape[1:] == (2, 3) or "no way" in why.text
            n += 1
    assert n > 50


def test_ids_are_checked(rooms_table):
    for call in (lambda: rooms_table.sees(0, 10**6), lambda: rooms_table.sees(-1, 0), lambda: rooms_table.seen_by(10**12)):
        with pytest.raises((IndexError, OverflowError)):
            call()
    with pytest.raises(IndexError, match="cell 99 of"):
        rooms_table.sees([0, 99], [0, 0])
    for wrong in (0.5, "0", None):
        with pytest.raises(TypeError):
            rooms_table.sees(wrong, 0)
    with pytest.raises(TypeError, match="whole numbers"):
        rooms_table.sees([0.5], [0])
    assert rooms_table.sees([], []).shape == (0,)
    with pytest.raises(TypeError, match="sightlines.load reads one"):
        sl.Table()
    with pytest.raises(TypeError, match="sightlines.load reads one"):
        sl.Table("tower.pvs")


@pytest.mark.parametrize("eye", [(1,), (1, 2, 3), [[1, 2, 3]], "ab", None, (np.nan, 0), (np.inf, 0), [[0, 0], [0, np.nan]], [[[0, 0]]]])
def test_wrong_eyes_are_refused(rooms_table, eye):
    for call in (rooms_table.visible_cells, rooms_table.visible_objects, rooms_table.cells_at):
        with pytest.raises(ValueError, match="eye"):
            call(eye)


def test_no_eyes_see_nothing(rooms_table):
    assert rooms_table.visible_cells(np.empty((0, 2))).shape == (0, rooms_table.n_cells)
    assert rooms_table.visible_cells([]).shape == (0, rooms_table.n_cells)


def test_any_array_of_numbers_will_do(rooms_table):
    eyes = np.array([[1, 1], [9, 1]])
    expected = rooms_table.visible_cells(eyes.astype(float))
    for same in (eyes, eyes.astype("f4"), eyes.astype(">f8"), np.asfortranarray(eyes), eyes.tolist(), np.repeat(eyes, 2, axis=0)[::2]):
        assert (rooms_table.visible_cells(same) == expected).all()
    pytest.importorskip("shapely")
    from shapely import Point

    assert rooms_table.visible_cells(Point(1, 1)).tolist() == np.flatnonzero(expected[0]).tolist()
    assert (rooms_table.visible_cells([Point(1, 1), Point(9, 1)]) == expected).all()


def test_threads_may_ask_at_once(tower):
    eyes = np.random.default_rng(2).uniform(0, 9, (500, 3))
    expected, results = tower.visible_cells(eyes), []
    threads = [threading.Thread(target=lambda: results.append(tower.visible_cells(eyes))) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len(results) == 4 and all((result == expected).all() for result in results)


def test_pictures(rooms_table, tower):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    middle = tower.cells[0].mean(axis=0)
    for table, eye in ((rooms_table, (1, 1.5)), (tower, middle)):
        for options in ({}, {"eye": eye}, {"cell": 0}, {"eye": eye, "line": table.explain(0, table.seen_by(0)[-1])}):
            ax = table.plot(**options)
            assert ax.collections and len(ax.collections[0].get_paths()) > 0
            pyplot.close(ax.figure)
        with pytest.raises(ValueError, match="not both"):
            table.plot(eye, cell=0)
    drawn = rooms_table.plot(eye=(1, 1.5)).collections[0]
    colours = [tuple(colour) for colour in drawn.get_facecolors()]
    assert len(set(colours)) == 3 and len(colours) == rooms_table.n_cells
    floor = tower.plot(height=1.0).collections[0]
    assert 0 < len(floor.get_paths()) < tower.n_cells
    pyplot.close("all")


def test_cells_go_to_geopandas(rooms_table):
    geopandas = pytest.importorskip("geopandas")
    frame = rooms_table.to_geodataframe()
    assert isinstance(frame, geopandas.GeoDataFrame) and len(frame) == rooms_table.n_cells
    assert frame["sees"].tolist() == rooms_table.counts.tolist()
    assert frame.area.sum() == 36.0
    assert rooms_table.__geo_interface__["type"] == "FeatureCollection"


def test_pictures_are_no_mirror_images(tower):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    assert tower.up == "y"
    ax = tower.plot(height=1.0)
    # Seen from above, x to the right is z downwards: a turn, and no mirror.
    assert not ax.xaxis_inverted() and ax.yaxis_inverted()
    assert tower.plot(height=1.0, ax=ax).yaxis_inverted()
    pyplot.close("all")
