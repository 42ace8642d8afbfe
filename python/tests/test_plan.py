"""Plans: from all that has walls, and what is refused."""

import json
import pickle

import numpy as np
import pytest

import sightlines as sl

from conftest import ROOMS


def test_arrays_of_either_shape(rooms):
    walls = np.array(ROOMS, dtype=float)
    assert (sl.Plan(walls).walls == walls).all()
    assert (sl.Plan(walls.reshape(-1, 4)).walls == walls).all()
    assert (sl.Plan(walls.astype("i4")).walls == walls).all()
    assert (sl.Plan(np.asfortranarray(walls)).walls == walls).all()
    assert (sl.Plan(rooms).walls == rooms.walls).all()
    assert rooms.bounds == (0.0, 0.0, 12.0, 3.0)
    assert repr(rooms) == "<sightlines.Plan: 7 lines>"
    assert (pickle.loads(pickle.dumps(rooms)).walls == rooms.walls).all()


@pytest.mark.parametrize(
    "walls",
    [
        [[0, 0, 1]],
        [0, 0, 1, 1],
        np.zeros((2, 2, 3)),
        np.zeros((1, 2, 2, 2)),
        [[0, 0, np.nan, 1]],
        [[0, 0, np.inf, 1]],
        [[0, 0, 1e300, 1]],
        [[1, 2, 1, 2]],
        [["a", "b", "c", "d"]],
        [[0, 0, 1, 1], [0, 0]],
        None,
        42,
        [[0, 0, 1j, 1]],
    ],
)
def test_wrong_walls_are_refused(walls):
    with pytest.raises(ValueError) as raised:
        sl.Plan(walls)
    assert str(raised.value)


def test_what_is_wrong_is_named():
    with pytest.raises(ValueError, match="row 1 has a coordinate that is not finite"):
        sl.Plan([[0, 0, 1, 1], [0, 0, np.nan, 1]])
    with pytest.raises(ValueError, match=r"line 1 has length zero at \(3, 3\)"):
        sl.Plan([[0, 0, 1, 1], [3, 3, 3, 3]])


def test_no_walls_are_a_plan_without_rooms():
    for empty in ([], np.empty((0, 4)), np.empty((0, 2, 2)), {"type": "FeatureCollection", "features": []}):
        plan = sl.Plan(empty)
        assert plan.walls.shape == (0, 2, 2) and np.isnan(plan.bounds).all()
        with pytest.raises(sl.Error):
            plan.bake(progress=False)


def test_national_grids_keep_every_digit():
    # Coordinates with six digits before the point, and centimetres.
    offset = np.array([412345.67, 653210.98])
    walls = np.array(ROOMS, dtype=float) + offset
    plan = sl.Plan(walls)
    assert (plan.walls == walls).all()
    table = plan.bake(progress=False)
    assert table.may_see(offset + (1, 1.5), offset + (7, 1.5))
    assert not table.may_see(offset + (1, 1.5), offset + (9, 1.5))
    near = sl.Plan(ROOMS).bake(progress=False)
    assert table.n_cells == near.n_cells and (table.visibility == near.visibility).all()


def test_files_and_mappings(tmp_path, rooms):
    path = tmp_path / "rooms.geojson"
    path.write_text(rooms.to_geojson())
    for same in (path, str(path), json.loads(path.read_text()), rooms):
        assert (sl.Plan(same).walls == rooms.walls).all()
    assert (sl.Plan(rooms.__geo_interface__).walls == rooms.walls).all()
    with pytest.raises(FileNotFoundError):
        sl.Plan(tmp_path / "absent.geojson")
    path.write_text('{"type": "Polygon", "coordinates": 7}')
    with pytest.raises(sl.Error, match="rooms.geojson: "):
        sl.Plan(path)
    path.write_bytes(sl.scenes.tower(floors=1, rooms_x=1, rooms_y=1))
    with pytest.raises(sl.Error, match="use sightlines.bake"):
        sl.Plan(path)
    with pytest.raises(OSError):
        sl.Plan(tmp_path)


def test_lines_without_length_are_dropped_from_drawings():
    for nothing in ({"type": "LineString", "coordinates": [(0, 0), (0, 0)]}, {"type": "LineString", "coordinates": []}):
        assert len(sl.Plan(nothing).walls) == 0


def test_files_name_their_reference_system(tmp_path, rooms):
    path = tmp_path / "rooms.geojson"
    member = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::28992"}}
    path.write_text(json.dumps({"type": "FeatureCollection", "crs": member, "features": rooms.__geo_interface__["features"]}))
    plan = sl.Plan(path)
    assert plan.crs == "urn:ogc:def:crs:EPSG::28992" and len(plan.walls) == 7
    assert sl.Plan(path, crs="EPSG:3857").crs == "EPSG:3857"
    geopandas = pytest.importorskip("geopandas")
    assert plan.bake(progress=False).to_geodataframe().crs == geopandas.GeoSeries(crs="EPSG:28992").crs


def test_dxf(tmp_path):
    def lines(layer, *ends):
        pairs = [(0, "LINE"), (8, layer)]
        for (ax, ay), (bx, by) in ends:
            yield from [*pairs, (10, ax), (20, ay), (11, bx), (21, by)]

    room = [((0, 0), (4, 0)), ((4, 0), (4, 3)), ((4, 3), (0, 3)), ((0, 3), (0, 0))]
    entities = [*lines("walls", *room), *lines("wires", ((1, 1), (2, 2)))]
    pairs = [(0, "SECTION"), (2, "ENTITIES"), *entities, (0, "ENDSEC"), (0, "EOF")]
    path = tmp_path / "room.dxf"
    path.write_text("".join(f"{code}\n{value}\n" for code, value in pairs))
    assert len(sl.Plan(path).walls) == 5
    plan = sl.Plan(path, layers=["walls"])
    assert len(plan.walls) == 4 and plan.isovist((1, 1)).area == 12.0
    assert {"walls", "wires"} <= set(plan.layers)
    for wrong in (0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="deviation"):
            sl.Plan(path, deviation=wrong)
    path.write_text("0\nSECTION\n2\nENTITIES\n0\nLINE\n10\nabc\n")
    with pytest.raises(sl.Error, match="room.dxf: "):
        sl.Plan(path)


def test_properties_mean_what_they_do_in_files():
    wall = {"type": "LineString", "coordinates": [(0, 0), (4, 0)]}
    glass = {"type": "Feature", "properties": {"sight": "transparent", "price": float("nan")}, "geometry": wall}
    desk = {"type": "Feature", "properties": {"name": "desk"}, "geometry": {"type": "Point", "coordinates": (1, 1)}}
    plan = sl.Plan({"type": "FeatureCollection", "features": [glass, desk]})
    assert plan.walls.shape == (0, 2, 2) and plan.objects == ["desk"]


@pytest.mark.parametrize(
    "mapping",
    [
        {},
        {"type": "Polygon"},
        {"type": "Circle", "coordinates": [(0, 0)]},
        {"type": "Feature", "geometry": {"coordinates": []}},
        {"type": "FeatureCollection", "features": 7},
        {"type": "FeatureCollection", "features": [7]},
        {"type": "LineString", "coordinates": [(0, float("nan")), (1, 1)]},
        {"type": "LineString", "coordinates": [(0, 0), object()]},
        {"type": "LineString", "coordinates": "abc"},
        {"type": "LineString", "coordinates": [(0, 0), (1e300, 0)]},
    ],
)
def test_wrong_mappings_are_refused(mapping):
    with pytest.raises(ValueError):
        sl.Plan(mapping)


def test_shapely():
    shapely = pytest.importorskip("shapely")
    room = shapely.Polygon([(0, 0), (4, 0), (4, 3), (0, 3)], [[(1, 1), (2, 1), (2, 2)]])
    assert len(sl.Plan(room).walls) == 4 + 3
    assert len(sl.Plan(shapely.MultiPolygon([room])).walls) == 7
    assert len(sl.Plan([room, shapely.LineString([(0, 0), (4, 3), (5, 5)])]).walls) == 9
    assert len(sl.Plan(shapely.LinearRing([(0, 0), (1, 0), (0, 1)])).walls) == 3
    assert len(sl.Plan(shapely.GeometryCollection([room, shapely.Point(1, 1), shapely.LineString()])).walls) == 7
    assert sl.Plan(shapely.Polygon()).walls.shape == (0, 2, 2)
    # With heights, which are ignored.
    assert (sl.Plan(shapely.LineString([(0, 0, 9), (1, 0, 7)])).walls == [[[0, 0], [1, 0]]]).all()


def test_polygons_that_cross_themselves_or_touch():
    shapely = pytest.importorskip("shapely")
    bow = shapely.Polygon([(0, 0), (4, 3), (4, 0), (0, 3)])
    assert not bow.is_valid
    table = sl.Plan(bow).bake(progress=False)
    # Both halves are rooms, which meet in one point only.
    assert not table.may_see((0.5, 1.5), (3.5, 1.5)) and table.may_see((0.5, 1.5), (0.5, 1.0))
    twins = shapely.MultiPolygon([shapely.box(0, 0, 4, 3), shapely.box(4, 0, 8, 3)])
    table = sl.Plan(twins).bake(progress=False)
    assert not table.may_see((1, 1), (7, 1)) and table.may_see((1, 1), (3, 2))


def test_geopandas_keeps_the_reference_system():
    geopandas = pytest.importorskip("geopandas")
    from shapely import box

    frame = geopandas.GeoDataFrame(
        {"name": ["a", None], "when": ["2020-01-01", "x"], "size": [1.5, np.nan]},
        geometry=[box(0, 0, 4, 3), None],
        crs="EPSG:28992",
    )
    for source in (frame, frame.geometry):
        plan = sl.Plan(source)
        assert plan.crs == frame.crs and len(plan.walls) == 4
        table = plan.bake(progress=False)
        assert table.crs == frame.crs and table.to_geodataframe().crs == frame.crs
        assert pickle.loads(pickle.dumps(table)).crs == frame.crs
    assert sl.Plan(frame, crs="EPSG:3857").crs == "EPSG:3857"
    with pytest.warns(UserWarning, match="degrees"):
        sl.Plan(frame.set_crs("EPSG:4326", allow_override=True))
    with pytest.raises(TypeError, match="only the cells of a plan"):
        sl.bake(sl.scenes.tower(floors=1, rooms_x=1, rooms_y=1), progress=False).to_geodataframe()


def test_the_table_does_not_depend_on_threads():
    plan = sl.scenes.office(6, 3)
    tables = [plan.bake(threads=n, progress=False).to_bytes() for n in (None, 1, 2, 5)]
    assert len(set(tables)) == 1
    for wrong in (0, -1, 10**9):
        with pytest.raises(ValueError, match="threads"):
            plan.bake(threads=wrong)
    with pytest.raises(ValueError, match="no subdivision"):
        plan.bake(subdivide="squares")


def test_pictures_of_plans(rooms):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    ax = rooms.plot(colors="red")
    assert rooms.plot(ax) is ax and len(ax.collections) == 2
    assert len(ax.collections[0].get_segments()) == 7
    pyplot.close("all")


def test_generated_scenes_are_always_the_same():
    assert sl.scenes.tower(1, 1, 1) == sl.scenes.tower(1, 1, 1) != sl.scenes.tower(1, 1, 1, seed=2)
    assert (sl.scenes.office(3, 2).walls == sl.scenes.office(3, 2).walls).all()
    assert len(sl.scenes.office(3, 2, wall_thickness=0.25).walls) > len(sl.scenes.office(3, 2).walls)
    for wrong in (lambda: sl.scenes.office(0, 1), lambda: sl.scenes.tower(-1), lambda: sl.scenes.city(65, 1), lambda: sl.scenes.office(2, 2, wall_thickness=float("nan"))):
        with pytest.raises(ValueError):
            wrong()
