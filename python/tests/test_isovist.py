"""Isovists and sight between points, against brute force in fractions."""

from fractions import Fraction

import numpy as np
import pytest

import sightlines as sl

from conftest import ROOMS, meet, side, within
from test_oracle import random_plan


def blocked(p, q, walls) -> bool:
    """Whether a closed wall has a point in common with the segment from p to q, its ends apart; exact.

    A wall at p or q does not block by what it has in common with that point alone; one that runs along the line does.
    """
    if p == q:
        return False
    for a, b in walls:
        if not meet(p, q, a, b):
            continue
        sides = side(p, q, a), side(p, q, b)
        if sides == (0, 0):
            # Along the line: blocked if they share more than the ends p and q.
            inner = [c for c in (a, b) if within(p, q, c) and c != p and c != q]
            covers = within(a, b, p) and within(a, b, q)
            if inner or covers:
                return True
            continue
        at_ends = [c for c in (p, q) if side(a, b, c) == 0 and within(a, b, c)]
        if not at_ends:
            return True
    return False


@pytest.mark.parametrize("seed", range(8))
def test_sees_is_what_brute_force_sees(seed):
    plan = random_plan(seed)
    walls = [tuple(map(tuple, wall)) for wall in plan.walls.tolist()]
    # On corners and walls too: half steps of the grid, and outside of everything.
    points = [(x / 2, y / 2) for x in range(-2, 15, 2) for y in range(-1, 14, 3)]
    pairs = [(p, q) for k, p in enumerate(points) for q in points[: k : 3]]
    a, b = (np.array([pair[k] for pair in pairs]) for k in (0, 1))
    seen = plan.sees(a, b)
    expected = np.array([not blocked(p, q, walls) for p, q in pairs])
    assert seen.dtype == bool and seen.shape == (len(pairs),)
    wrong = np.flatnonzero(seen != expected)
    assert not len(wrong), [(pairs[k], seen[k]) for k in wrong[:5]]
    assert 0.1 < seen.mean() < 0.9
    assert (plan.sees(b, a) == seen).all()
    # One by one, and all at once.
    for k in range(0, len(pairs), 40):
        assert plan.sees(*pairs[k]) is bool(seen[k])
    matrix = plan.visibility(points)
    number = {p: k for k, p in enumerate(points)}
    assert all(matrix[number[p], number[q]] == s for (p, q), s in zip(pairs, seen))
    # Who passes ends of walls sees no less.
    passing = plan.sees(a, b, touching=True)
    assert (passing | ~seen).all() and (passing != seen).any()


def test_impostor_one_wall_less_is_found_out():
    plan = random_plan(1)
    fewer = sl.Plan(plan.walls[1:])
    points = np.random.default_rng(1).uniform(0, 6, (60, 2))
    assert (plan.visibility(points) != fewer.visibility(points)).any()


def shoelace(vertices) -> Fraction:
    """Twice the area, exactly."""
    v = [(Fraction(x), Fraction(y)) for x, y in vertices]
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(v, v[1:] + v[:1]))


@pytest.mark.parametrize("seed", range(6))
def test_isovists_hold_what_is_seen(seed):
    shapely = pytest.importorskip("shapely")
    plan = random_plan(seed)
    rng = np.random.default_rng(seed)
    eyes = rng.uniform(0.01, 5.99, (12, 2))
    others = rng.uniform(0.01, 5.99, (300, 2))
    all_eyes = plan.isovists(eyes, progress=False)
    assert len(all_eyes) == 12 and all_eyes.points is not None
    n_inside = n_outside = 0
    for eye, isovist in zip(eyes, all_eyes):
        assert float(shoelace(isovist.vertices.tolist())) / 2 == pytest.approx(isovist.area, rel=1e-12)
        inside = shapely.contains_xy(isovist.polygon, others)
        seen = plan.sees(eye, others)
        # Corners are rounded, so a point within a hair of the outline may be on either side.
        near = shapely.distance(isovist.polygon.exterior, shapely.points(others)) < 1e-9
        assert (inside == seen)[~near].all()
        n_inside += inside.sum()
        n_outside += (~inside).sum()
        one = plan.isovist(eye)
        assert (one.vertices == isovist.vertices).all() and one.measures == isovist.measures
        assert isovist.perimeter == pytest.approx(isovist.polygon.length, rel=1e-12)
    assert n_inside > 100 and n_outside > 100


def test_a_room(rooms):
    isovist = rooms.isovist((1, 1.5))
    assert isovist.kinds.dtype == np.uint8 and set(isovist.kinds.tolist()) == {0, 1}
    assert len(isovist.walls) == len(isovist.vertices) == len(isovist.kinds)
    assert ((isovist.walls >= 0) == (isovist.kinds == 0)).all()
    assert isovist.minimal_radial == 1.0 and isovist.measures["minimal_radial"] == 1.0
    assert "area" in repr(isovist)
    with pytest.raises(AttributeError):
        isovist.volume
    far = rooms.isovist((10, 1.5))
    assert far.area == 12.0 and far.occlusivity == 0.0
    assert rooms.isovist((10, 1.5), radius=0.5).area == pytest.approx(np.pi / 4, rel=3e-3)
    quarter = rooms.isovist((10, 1.5), radius=0.5, direction=(1, 0), angle=90)
    assert quarter.area == pytest.approx(np.pi / 16, rel=3e-3) and 3 in quarter.kinds
    # Outside of the walls the frame ends the view.
    assert 2 in rooms.isovist((-1, -1)).kinds


def test_walls_are_numbered_without_lines_that_do_not_block():
    glass = {"type": "Feature", "properties": {"sight": "transparent"}, "geometry": {"type": "LineString", "coordinates": [(1, 0), (1, 3)]}}
    room = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[(0, 0), (4, 0), (4, 3), (0, 3), (0, 0)]]}}
    plan = sl.Plan({"type": "FeatureCollection", "features": [glass, room]})
    isovist = plan.isovist((2, 1))
    assert sorted(isovist.walls.tolist()) == [0, 1, 2, 3] and len(plan.walls) == 4
    for corner, wall in zip(isovist.vertices, isovist.walls):
        assert corner.tolist() in plan.walls[wall].tolist()


@pytest.mark.parametrize(
    "options",
    [
        {"radius": 0.0},
        {"radius": float("nan")},
        {"direction": (1, 0)},
        {"angle": 90},
        {"direction": (0, 0), "angle": 90},
        {"direction": (1, 0), "angle": 360},
        {"direction": [(1, 0), (0, 1)], "angle": 90},
        {"radius": 1, "deviation": -1},
    ],
)
def test_wrong_limits_are_refused(rooms, options):
    for call in (rooms.isovist, rooms.isovists):
        with pytest.raises(ValueError):
            call((1, 1), **options)


@pytest.mark.parametrize("point", [(1,), (1, 2, 3), None, (np.nan, 1), (np.inf, 1), (1e300, 1), "ab"])
def test_wrong_points_are_refused(rooms, point):
    for call in (rooms.isovist, rooms.isovists, rooms.visibility, lambda p: rooms.sees(p, (1, 1))):
        with pytest.raises(ValueError):
            call(point)


def test_which_point_is_wrong_is_told(rooms):
    eyes = np.full((1000, 2), 1.0)
    eyes[777] = (1000, 1000)
    with pytest.raises(ValueError, match=r"row 777: the point \(1000, 1000\) is not inside the frame"):
        rooms.isovists(eyes, progress=False)
    with pytest.raises(ValueError, match="one point is expected"):
        rooms.isovist(eyes)
    with pytest.raises(ValueError, match="no pairs"):
        rooms.sees(eyes, eyes[:5])


def test_far_away_and_without_walls():
    rooms = sl.Plan(ROOMS)
    # Sight has no frame.
    assert rooms.sees((-1e6, 1e6), (1e6, 1e6)) and not rooms.sees((-1e6, 1.5), (1e6, 1.5))
    assert rooms.visibility([(-1e5, 9), (1e5, 9), (6, 1)]).sum() == 5
    empty = sl.Plan([])
    assert empty.sees((0, 0), (5, 5)) and empty.visibility([(0, 0), (1, 1)]).all()
    with pytest.raises(ValueError, match="no line of the plan blocks sight"):
        empty.isovist((0, 0))
    assert rooms.visibility([]).shape == (0, 0) and rooms.sees([], []).shape == (0,) and len(rooms.isovists([])) == 0


def test_isovists_as_arrays_and_frames(rooms):
    geopandas = pytest.importorskip("geopandas")
    import shapely

    plan = sl.Plan(ROOMS, crs="EPSG:28992")
    points = plan.grid(0.5)
    assert ((points > 0) & (points < (12, 3))).all() and len(points) == 23 * 5
    isovists = plan.isovists(points, progress=False)
    assert isovists["area"].shape == (len(points),) == isovists.measures["skewness"].shape
    assert [len(p) for p in isovists.polygons] == [len(i.vertices) for i in isovists]
    frame = isovists.to_geodataframe()
    assert frame.crs == "EPSG:28992" and len(frame) == len(points)
    assert np.allclose(frame.area, isovists["area"]) and frame["drift"].tolist() == isovists["drift"].tolist()
    assert (isovists.to_geodataframe(geometry="points").geometry == shapely.points(points)).all()
    again = geopandas.GeoDataFrame.from_features(isovists.__geo_interface__)
    assert np.allclose(again.area, frame.area)
    assert shapely.geometry.shape(isovists[3].__geo_interface__["geometry"]).area == pytest.approx(isovists[3].area)
    series = geopandas.GeoSeries(shapely.points(points), crs="EPSG:28992")
    assert (plan.isovists(series)["area"] == isovists["area"]).all()
    assert [i.area for i in isovists[2:4]] == isovists["area"][2:4].tolist() and isovists[-1].area == isovists["area"][-1]
    with pytest.raises(IndexError):
        isovists[len(points)]
    with pytest.raises(KeyError, match="no measure"):
        isovists["volume"]
    with pytest.raises(ValueError, match="geometry"):
        isovists.to_geodataframe(geometry="circles")
    bare = plan.isovists(points, outlines=False, progress=False)
    assert (bare["area"] == isovists["area"]).all() and all(len(p) == 0 for p in bare.polygons)


def test_the_result_does_not_depend_on_threads():
    plan = sl.scenes.office(6, 4)
    points = plan.grid(0.25)
    one = plan.isovists(points, threads=1, progress=False)
    for threads in (None, 2, 3):
        other = plan.isovists(points, threads=threads, progress=False)
        assert all((one[name] == other[name]).all() for name in one.measures)
        assert (np.concatenate(one.polygons) == np.concatenate(other.polygons)).all()


@pytest.mark.parametrize("spacing", [0, -1, float("nan"), float("inf"), 1e-9])
def test_wrong_spacings_are_refused(rooms, spacing):
    with pytest.raises(ValueError, match="spacing"):
        rooms.grid(spacing)


def test_pictures_of_isovists(rooms):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    ax = rooms.isovist((1, 1)).plot()
    assert len(ax.patches) == 1
    ax = rooms.isovists(rooms.grid(0.5)).plot("compactness")
    assert len(ax.collections[0].get_offsets()) == 115
    pyplot.close("all")


# What other libraries stumble over.


@pytest.mark.parametrize("shift", [(0.0, 0.0), (412345.67, 653210.98)])
def test_corners_collinear_walls_and_touching_polygons(shift):
    def at(*points):
        return [tuple(np.add(p, shift)) for p in points]

    def ring(*points):
        corners = at(*points)
        return [[a, b] for a, b in zip(corners, corners[1:] + corners[:1])]

    # Two boxes that touch in a corner, one beside them that shares a side, and walls in one line with a gap.
    boxes = ring((0, 0), (2, 0), (2, 2), (0, 2)) + ring((2, 2), (4, 2), (4, 4), (2, 4)) + ring((4, 2), (6, 2), (6, 4), (4, 4))
    gap = [at((0, -2), (2, -2)), at((4, -2), (6, -2))]
    plan = sl.Plan(boxes + gap)

    def sees(p, q, **options):
        return plan.sees(*at(p, q), **options)

    # Through the point where two boxes touch.
    assert not sees((1, 3), (3, 1)) and not sees((1, 3), (3, 1), touching=True)
    # From a corner: along its own wall, and past the other end of it only if walls may be touched.
    assert not sees((0, 0), (2, 0)) and sees((0, 0), (2, 0), touching=True)
    assert sees((0, 0), (0, -1)) and sees((-1, -1), (0, 0))
    # Along walls in one line.
    assert not sees((-1, -2), (7, -2)) and sees((-1, -2), (7, -2), touching=True)
    assert sees((3, -2), (3.5, -2)) and sees((3, -1), (3, -3))
    # Past a corner without touching it, and touching it.
    assert sees((-1, 2.5), (3, 5)) and not sees((-1, 2), (1, 2))
    assert sees((-1, 1), (1, 3), touching=True) and not sees((-1, 1), (1, 3))
    # From outside of all polygons, and from inside.
    assert sees((-5, -5), (20, -4)) and not sees((1, 1), (-1, 1)) and sees((0.5, 0.5), (1.5, 1.5))
    # An eye on a corner and one in the middle of a wall look to all sides.
    assert plan.isovist(at((2, 2))[0]).area > 0 and plan.isovist(at((1, 0))[0]).area > plan.isovist(at((1, 1))[0]).area
    assert plan.isovist(at((1, 1))[0]).area == pytest.approx(4, rel=1e-6)


def test_walls_that_repeat_and_cross_change_nothing(rooms):
    repeated = sl.Plan(np.concatenate([rooms.walls, rooms.walls, rooms.walls[:, ::-1]]))
    # Cut at a third, which no double is.
    third = rooms.walls[:, :1] + (rooms.walls[:, 1:] - rooms.walls[:, :1]) / 2
    cut = sl.Plan(np.concatenate([np.concatenate([rooms.walls[:, :1], third], 1), np.concatenate([third, rooms.walls[:, 1:]], 1)]))
    points = rooms.grid(0.5)
    for same in (repeated, cut):
        assert (same.visibility(points) == rooms.visibility(points)).all()
        assert np.allclose(same.isovists(points)["area"], rooms.isovists(points)["area"], rtol=1e-12)
