"""What nobody can ever see: against the truth by construction."""

import numpy as np
import pytest
from test_bake import HALLS, box_mesh

import sightlines as sl

#: A closed box with a thing in it, and one beside it.
BOXES = {"hull": box_mesh((0, 0, 0), (4, 4, 4)), "inside": box_mesh((1, 1, 1), (2, 2, 2)), "beside": box_mesh((6, 1, 1), (7, 2, 2))}


def stripped(source, **how):
    return sl.strip(source, progress=False, **how)


def test_what_is_in_a_closed_box_is_hidden():
    found = stripped(BOXES)
    assert found.hidden == ["inside"] and found.n_closed_surfaces == 3
    hull, inside, _ = found.objects
    assert (hull.fate, hull.reason, hull.witness.shape) == ("seen", None, (2, 3))
    assert (inside.fate, inside.reason, inside.witness) == ("hidden", "enclosed", None)
    assert inside.hidden_triangles.all() and not hull.hidden_triangles.any()
    # The twins: glass, a wish, and a box without a side.
    assert stripped(BOXES, see_through=["hull"]).hidden == []
    assert stripped(BOXES, keep=["inside"]).objects[1].fate == "kept"
    corners, triangles = BOXES["hull"]
    assert stripped({**BOXES, "hull": (corners, triangles[2:])}).objects[1].fate == "seen"


def test_eyes_in_boxes_and_eyes_that_walk():
    assert stripped(BOXES, eyes=[((1, 1, 2.5), (3, 3, 3.5))]).hidden == ["beside"]
    assert "table" in stripped(HALLS, walk=(5, 5, 2)).hidden
    assert "table" not in stripped(HALLS, walk=[(5, 5, 2), (18, 2, 2)]).hidden
    open_wall = {**HALLS, "wall": box_mesh((9.75, 0, 0), (10.25, 7, 4))}
    assert "table" not in stripped(open_wall, walk=(5, 5, 2)).hidden


def test_triangles_files_and_threads(tmp_path, tower_bytes):
    whole = stripped(tower_bytes)
    path = tmp_path / "tower.glb"
    path.write_bytes(tower_bytes)
    one_by_one = stripped(path, triangles=True, threads=1, effort=0)
    assert [of.name for of in one_by_one.objects] == [of.name for of in whole.objects]
    n_hidden = [sum(int(of.hidden_triangles.sum()) for of in found.objects) for found in (whole, one_by_one)]
    assert n_hidden[0] <= n_hidden[1]
    assert np.array_equal(stripped(BOXES, threads=1).objects[0].witness, stripped(BOXES, threads=2).objects[0].witness)


def test_what_cannot_be_done_is_refused(tmp_path):
    for how, why in [
        ({"eyes": "inside"}, "is not 'outside'"),
        ({"eyes": [(0, 0, 0)]}, "boxes"),
        ({"eyes": np.zeros((1, 2, 3)), "walk": (0, 0, 0)}, "either walk"),
        ({"eyes": np.zeros((0, 2, 3))}, "no box is given"),
        ({"gap": -1}, "is no width"),
        ({"gap": 1e-9}, "too narrow"),
        ({"keep": ["door"]}, "no object named 'door'"),
        ({"see_through": ["door"]}, "no mesh named 'door'"),
        ({"gap": float("nan")}, "gap is nan"),
    ]:
        with pytest.raises(ValueError, match=why):
            stripped(BOXES, **how)
    for how in [{"keep": "hull"}, {"gap": "0.1"}, {"effort": 1.5}]:
        with pytest.raises(TypeError):
            stripped(BOXES, **how)
    with pytest.raises(ValueError, match="a file says itself"):
        stripped(b"", name="a.glb", see_through=["hull"])
    with pytest.raises(FileNotFoundError):
        stripped(tmp_path / "none.glb")
    with pytest.raises(sl.Error):
        stripped(b"\x00\x01", name="a.glb")
