"""Bakes of scenes in space."""

import os
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import sightlines as sl


def box_mesh(low, high):
    """The corners and triangles of a box."""
    corners = np.array([[(high if k >> axis & 1 else low)[axis] for axis in range(3)] for k in range(8)], dtype=float)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


#: Two halls and a wall between them.
HALLS = {
    "floor": box_mesh((0, 0, -0.25), (20, 8, 0)),
    "ceiling": box_mesh((0, 0, 4), (20, 8, 4.25)),
    "west": box_mesh((-0.25, -0.25, -0.25), (0, 8.25, 4.25)),
    "east": box_mesh((20, -0.25, -0.25), (20.25, 8.25, 4.25)),
    "south": box_mesh((0, -0.25, -0.25), (20, 0, 4.25)),
    "north": box_mesh((0, 8, -0.25), (20, 8.25, 4.25)),
    "wall": box_mesh((9.75, 0, 0), (10.25, 8, 4)),
    "chair": box_mesh((2, 2, 0), (2.5, 2.5, 0.5)),
    "table": box_mesh((15, 4, 0), (16, 6, 0.75)),
}

EYE = (5.0, 5.0, 2.0)


def names(table, eye=EYE):
    return {table.objects[k] for k in table.visible_objects(eye)}


def test_paths_bytes_and_meshes(tmp_path, tower, tower_bytes):
    path = tmp_path / "tower.glb"
    path.write_bytes(tower_bytes)
    for source in (path, str(path), bytearray(tower_bytes), memoryview(tower_bytes)):
        assert sl.bake(source, progress=False).to_bytes() == tower.to_bytes()
    table = sl.bake(HALLS, progress=False)
    assert table.objects == list(HALLS)
    seen = names(table)
    assert "chair" in seen and "wall" in seen and "table" not in seen
    assert "table" in names(sl.bake(HALLS, see_through=["wall"], progress=False))
    with pytest.raises(ValueError, match="no mesh named 'window'"):
        sl.bake(HALLS, see_through=["window"])


def test_obj_as_bytes_needs_a_name():
    text = b"o floor\nv 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 2 0\nf 1 2 3 4\nf 1 2 5\n"
    assert sl.bake(text, name="floor.obj", progress=False).objects == ["floor"]
    with pytest.raises(sl.Error):
        sl.bake(b"\x00\x01\x02\x03", progress=False)


def test_trimesh(tower_bytes):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    for name, (corners, triangles) in HALLS.items():
        # Placed by their nodes.
        shift = np.array([7.0, 0.0, 0.0])
        mesh = trimesh.Trimesh(corners - shift, triangles, process=False)
        scene.add_geometry(mesh, node_name=name, geom_name=name, transform=trimesh.transformations.translation_matrix(shift))
    table = sl.bake(scene, progress=False)
    assert set(table.objects) == set(HALLS)
    assert names(table) == names(sl.bake(HALLS, progress=False))
    one = sl.bake(trimesh.creation.box((2, 2, 2)), progress=False)
    assert one.objects == ["mesh"] and one.object_bounds.tolist() == [[[-1, -1, -1], [1, 1, 1]]]
    assert sl.bake({"a": trimesh.creation.box((2, 2, 2))}, progress=False).objects == ["a"]


def test_cells_may_be_chosen():
    assert sl.bake(HALLS, cells="kd-tree", progress=False).kind == "scene, k-d tree"
    grid = sl.bake(HALLS, cells=(3, 2, 1), progress=False)
    assert grid.kind == "scene, boxes as cells" and grid.n_cells == 6
    places = sl.bake(HALLS, cells=8, progress=False)
    assert 0 < places.n_cells <= 16
    assert sl.bake(HALLS, cells="places", cell_size=4.0, progress=False).n_cells > places.n_cells
    eyes = sl.bake(HALLS, cells="eye-level", cell_size=4.0, eye_height=(0.5, 2.0), up="z", progress=False)
    sizes = eyes.cells[:, 1] - eyes.cells[:, 0]
    assert (sizes[:, :2] <= 4.0).all() and (sizes[:, 2] <= 2.25).all()
    assert sl.bake(HALLS, cell_size=4.0, eye_height=(0.5, 2.0), up="z", progress=False) == eyes
    for wrong in (
        {"cells": (3, 2, 1), "cell_size": 2.0},
        {"cells": 8, "eye_height": (0, 2)},
        {"cells": "eye-level", "up": "w"},
        {"cells": "eye-level", "eye_height": (0, 1, 2)},
    ):
        with pytest.raises(ValueError):
            sl.bake(HALLS, progress=False, **wrong)
    boxes = np.array([[[1, 1, 1], [3, 3, 2]], [[15, 1, 1], [18, 3, 2]]])
    given = sl.bake(HALLS, cells=boxes, method="both", progress=False)
    assert (given.cells == boxes).all() and not given.sees(0, 1)
    assert "no portals" in given.explain(0, 1).text and "scene=" in given.explain(0, 1).text and given.explain(0, 1).visible is None
    one = given.explain(1, 1)
    assert one.visible is True and one.text == "both are cell 1, and a cell sees itself"
    region = sl.bake(HALLS, view_region=[[1, 1, 1], [3, 3, 2]], progress=False)
    # The other hall cannot be reached from there.
    assert len(region.cells_at(EYE)) and not len(region.cells_at((15, 2, 2)))


def test_parts_of_meshes_are_ranges_of_triangles():
    table = sl.bake(HALLS, cells=(4, 1, 1), parts=4, progress=False)
    whole = sl.bake(HALLS, cells=(4, 1, 1), progress=False)
    for eye in (EYE, (18.0, 4.0, 2.0)):
        ranges = table.visible_ranges(eye)
        assert set(ranges[:, 0]) <= set(whole.visible_objects(eye))
        # Every mesh has twelve triangles.
        assert (ranges[:, 1] < ranges[:, 2]).all() and ranges[:, 2].max() == 12
        assert (ranges[:, 2] - ranges[:, 1]).sum() < 0.9 * 12 * len(whole.visible_objects(eye))
        cell = table.cells_at(eye)[0]
        assert (table.ranges_seen_by(cell) == ranges).all()
        untouched = whole.visible_ranges(eye)
        assert (untouched[:, 1:] == (0, -1)).all() and (untouched[:, 0] == whole.visible_objects(eye)).all()
    far = (99.0, 0.0, 0.0)
    assert (table.visible_ranges(far)[:, 0] == np.arange(len(HALLS))).all()
    assert table.visible_ranges(far, outside="none").shape == (0, 3)
    with pytest.raises(ValueError, match="is in no cell"):
        table.visible_ranges(far, outside="error")
    with pytest.raises(ValueError, match="parts"):
        sl.bake(HALLS, parts=0, progress=False)


def test_meshes_in_single_precision_are_as_precise_as_that():
    turn = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])
    # Halls that stand on their z axis, turned around y.
    exact = {name: (corners @ turn.T, triangles) for name, (corners, triangles) in HALLS.items()}
    single = {name: (corners.astype(np.float32), triangles) for name, (corners, triangles) in exact.items()}
    doubles = {name: (corners.astype(np.float64), triangles) for name, (corners, triangles) in single.items()}
    table = sl.bake(single, progress=False)
    assert table.frame is not None and sl.bake(exact, progress=False).frame is None
    # Whatever the array's type is, and unless the caller knows better.
    assert sl.bake(doubles, progress=False).to_bytes() == table.to_bytes()
    assert sl.bake(single, gap=0.0, progress=False).frame is None


def test_rays_explain_cells_without_portals(tmp_path):
    lines, n = [], 1
    for name, (corners, triangles) in HALLS.items():
        lines += [f"o {name}", *(f"v {x} {y} {z}" for x, y, z in corners)]
        lines += [f"f {a} {b} {c}" for a, b, c in triangles + n]
        n += len(corners)
    scene = tmp_path / "halls.obj"
    scene.write_text("\n".join(lines))
    boxes = np.array([[[1, 1, 1], [3, 3, 2]], [[6, 1, 1], [8, 3, 2]], [[15, 1, 1], [18, 3, 2]]])
    table = sl.bake(scene, cells=boxes, method="both", progress=False)
    seen = table.explain(0, 1, scene=scene)
    assert seen.visible is True and seen.cells == [0, 1] and seen.portals == []
    assert all((low < p).all() and (p < high).all() for p, (low, high) in zip(seen.line, boxes))
    hidden = table.explain(0, 2, scene=scene)
    assert hidden.visible is None and "which proves nothing; hidden by " in hidden.text
    with pytest.raises(FileNotFoundError):
        table.explain(0, 2, scene=tmp_path / "absent.obj")


#: Walls of the two halls that are not at right angles.
SLANTED = {name: (corners + 0.25 * corners[:, [1, 0, 2]], triangles) for name, (corners, triangles) in HALLS.items()}


def program() -> str:
    """The program, as the environment names it or the project's own tests build it."""
    built = Path(__file__).parents[2] / "target" / "debug" / "sightlines"
    found = os.environ.get("SIGHTLINES_PROGRAM", str(built))
    if not Path(found).is_file():
        pytest.skip(f"there is no program {found} to compare with")
    return found


@pytest.mark.parametrize(
    ("options", "arguments"),
    [
        ({}, []),
        ({"cells": 12}, ["--n-cells", "12"]),
        ({"cells": (3, 2, 1)}, ["--grid", "3,2,1"]),
        ({"cells": (3, 2, 1), "method": "line-space"}, ["--grid", "3,2,1", "--method", "line-space"]),
        ({"method": "sightlines"}, ["--method", "sightlines"]),
        ({"cells": 12, "gap": 0.001}, ["--n-cells", "12", "--gap", "0.001"]),
        ({"cells": 12, "view_region": [[1, 1, 1], [9, 3, 2]]}, ["--n-cells", "12", "--view-region", "1,1,1,9,3,2"]),
        ({"method": "sightlines", "detail_below": 0.5}, ["--method", "sightlines", "--detail-below", "0.5"]),
        ({"method": "sightlines", "keep_solid": True}, ["--method", "sightlines", "--keep-solid"]),
        ({"cells": 12, "max_cells": 40}, ["--n-cells", "12", "--max-cells", "40"]),
        ({"cells": 12, "method": "shafts", "split": np.int64(1)}, ["--n-cells", "12", "--method", "shafts", "--split", "1"]),
        (
            {"cells": 12, "method": "both", "planes": 1, "texels": 16, "sheets": 0, "carry": False, "occluders": 20},
            ["--n-cells", "12", "--method", "both", "--planes", "1", "--texels", "16"]
            + ["--sheets", "0", "--no-carry", "--occluders", "20"],
        ),
    ],
)
def test_files_are_baked_as_the_program_does(tmp_path, tower_bytes, options, arguments):
    lines = []
    first = 1
    for name, (corners, triangles) in SLANTED.items():
        lines += [f"o {name}"] + [f"v {x} {y} {z}" for x, y, z in corners.tolist()]
        lines += ["f " + " ".join(str(first + i) for i in triangle) for triangle in triangles.tolist()]
        first += len(corners)
    (tmp_path / "halls.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "tower.glb").write_bytes(tower_bytes)
    for name in ["halls.obj", "tower.glb"]:
        path, out = tmp_path / name, tmp_path / "out.pvs"
        subprocess.run([program(), "build", str(path), *arguments, "-o", str(out)], check=True, capture_output=True)
        assert sl.bake(path, progress=False, **options).to_bytes() == out.read_bytes()


def test_the_table_does_not_depend_on_threads(tower_bytes, tower):
    for threads in (1, 2, 4):
        assert sl.bake(tower_bytes, threads=threads, progress=False) == tower


@pytest.mark.parametrize(
    "options",
    [
        {"cells": "hexagons"},
        {"cells": 0},
        {"cells": (1, 2)},
        {"cells": (0, 1, 1)},
        {"cells": np.zeros((2, 3))},
        {"cells": np.empty((0, 2, 3))},
        {"cells": [[[1, 1, 1], [0, 0, 0]]]},
        {"cells": [[[np.nan, 1, 1], [2, 2, 2]]]},
        {"cells": [[[0, 0, 0], [1e300, 2, 2]]]},
        {"method": "magic"},
        {"view_region": [0, 1]},
        {"view_region": [[1, 1, 1], [0, 0, 0]]},
        {"gap": -1.0},
        {"gap": float("nan")},
        {"detail_below": float("inf")},
        {"time_limit": -1.0},
        {"threads": 0},
        {"threads": 2000},
        {"max_cells": 0},
        {"texel": 16},
        {"split": 13},
        {"cells": "kd-tree", "up": "y"},
        {"cells": 5, "n_cells": 9},
        {"tau": float("nan")},
        {"texels": 16},
    ],
)
def test_wrong_options_are_refused(options):
    with pytest.raises(ValueError):
        sl.bake(HALLS, progress=False, **options)


@pytest.mark.parametrize(
    "options", [{"cells": 2.5}, {"gap": "wide"}, {"threads": "two"}, {"method": 7}, {"map": 7}, {"progress": False, "cells": (1.5, 1, 1)}]
)
def test_options_of_wrong_types_are_refused(options):
    with pytest.raises(TypeError):
        sl.bake(HALLS, **{"progress": False, **options})


@pytest.mark.parametrize(
    "mesh",
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, -1]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0.0, 1.0, 2.0]]),
        ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, np.nan]], [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 1e300]], [[0, 1, 2]]),
        ([[0, 0, 0]],),
        7,
    ],
)
def test_wrong_meshes_are_refused(mesh):
    with pytest.raises(ValueError):
        sl.bake({"mesh": mesh}, progress=False)


def test_nothing_is_no_scene():
    for nothing in (42, None, object()):
        with pytest.raises(TypeError, match="not"):
            sl.bake(nothing)
    for empty in ({}, {"a": (np.empty((0, 3)), np.empty((0, 3), dtype=int))}):
        try:
            table = sl.bake(empty, progress=False)
        except sl.Error:
            continue
        assert table.n_cells <= 1


def test_missing_and_damaged_files(tmp_path, tower_bytes):
    with pytest.raises(FileNotFoundError) as raised:
        sl.bake(tmp_path / "absent.glb", progress=False)
    assert raised.value.filename == str(tmp_path / "absent.glb")
    path = tmp_path / "half.glb"
    path.write_bytes(tower_bytes[: len(tower_bytes) // 2])
    with pytest.raises(sl.Error, match="half.glb: "):
        sl.bake(path, progress=False)
    (tmp_path / "text.txt").write_text("no scene")
    with pytest.raises(sl.Error):
        sl.bake(tmp_path / "text.txt", progress=False)


def test_progress_is_told_and_may_stop():
    data = sl.scenes.tower(floors=4, rooms_x=6, rooms_y=4)
    calls = []
    sl.bake(data, progress=lambda *call: calls.append(call))
    assert calls and all(isinstance(p, str) and 0 <= done <= total for p, done, total in calls)

    class Enough(Exception):
        pass

    def stop(phase, done, total):
        raise Enough

    with pytest.raises(Enough):
        sl.bake(data, progress=stop)


def test_bars_of_tqdm(capsys):
    pytest.importorskip("tqdm")
    sl.bake(HALLS, progress=True)
    # It was over before a bar was worth it.
    assert capsys.readouterr().err == ""


def test_a_bar_shows_what_takes_long(capsys):
    pytest.importorskip("tqdm")
    from sightlines._progress import Reporter

    with Reporter(True) as report:
        report("cells", 1, 10)
        time.sleep(0.6)
        report("cells", 5, 10)
        report("objects", 1, 3)
    assert "cells: " in capsys.readouterr().err
    with Reporter(False) as report:
        assert report is None


def test_other_threads_run_meanwhile():
    n, done = [0], threading.Event()

    def count():
        while not done.is_set():
            n[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    sl.bake(sl.scenes.tower(floors=4, rooms_x=6, rooms_y=4), progress=False, threads=1)
    took = time.monotonic() - start
    done.set()
    thread.join()
    # A lock held throughout would have left it a handful.
    assert n[0] > 20 * took, (n[0], took)
