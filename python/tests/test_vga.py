"""Visibility graph analysis against matrices in numpy."""

import numpy as np
import pytest

import sightlines as sl

from conftest import ROOMS


def brute_force(sees: np.ndarray, points: np.ndarray, radius: float = np.inf) -> dict[str, np.ndarray]:
    """Local and global measures from the matrix of who sees whom, straight from their definitions."""
    n = len(sees)
    sees = sees & ~np.eye(n, dtype=bool)
    degree = sees.sum(axis=1)
    distance = np.hypot(*(points[:, None] - points[None, :]).transpose(2, 0, 1))
    # Depths by powers of the matrix.
    depth = np.where(np.eye(n, dtype=bool), 0.0, np.inf)
    reached, step = np.eye(n, dtype=bool), 0
    while step < radius:
        step += 1
        further = ((reached.astype(int) @ sees.astype(int)) > 0) & np.isinf(depth)
        if not further.any():
            break
        depth[further] = step
        reached |= further
    found = np.isfinite(depth)
    count = found.sum(axis=1).astype(float)
    total = np.where(found, depth, 0.0).sum(axis=1)
    result = {name: np.full(n, np.nan) for name in ("clustering", "control", "controllability", "mean_depth", "integration_hh", "entropy")}
    result["connectivity"] = degree.astype(float)
    result["first_moment"] = (distance * sees).sum(axis=1)
    result["second_moment"] = (distance**2 * sees).sum(axis=1)
    result["node_count"] = count
    for i in range(n):
        if degree[i] >= 2:
            around = sees[i]
            result["clustering"][i] = sees[np.ix_(around, around)].sum() / (degree[i] * (degree[i] - 1))
            result["control"][i] = (1 / degree[around]).sum()
            result["controllability"][i] = degree[i] / sees[around].any(axis=0).sum()
        if count[i] > 1:
            mean = result["mean_depth"][i] = total[i] / (count[i] - 1)
            steps = depth[i][found[i] & (depth[i] > 0)]
            shares = np.unique(steps, return_counts=True)[1] / len(steps)
            result["entropy"][i] = -(shares * np.log2(shares)).sum()
            k = count[i]
            if k >= 3 and mean != 1:
                asymmetry = 2 * (mean - 1) / (k - 2)
                diamond = 2 * (k * (np.log2((k + 2) / 3) - 1) + 1) / ((k - 1) * (k - 2))
                result["integration_hh"][i] = diamond / asymmetry
    return result


PLANS = {
    "rooms": lambda: (sl.Plan(ROOMS), 0.5, None),
    "office": lambda: (sl.scenes.office(2, 2), 0.9, None),
    "slanted": lambda: (sl.Plan([[0, 0, 7, 1], [7, 1, 6, 6], [6, 6, -1, 5], [-1, 5, 0, 0], [2, 2, 4, 3], [4, 5.4, 4, 4]]), 0.5, [(1.0, 1.0)]),
    "national grid": lambda: (sl.Plan(np.array(ROOMS) + (412345.5, 653210.25)), 0.5, None),
}


@pytest.mark.parametrize("name", PLANS)
@pytest.mark.parametrize("radius", [None, 2])
def test_measures_are_those_of_the_definitions(name, radius):
    plan, spacing, seeds = PLANS[name]()
    graph = plan.vga(spacing, seeds=seeds, radius=radius, progress=False)
    sees = plan.visibility(graph.points)
    assert 20 < len(graph) < 800 and graph.n_pairs == (sees.sum() - len(graph)) // 2
    expected = brute_force(sees, graph.points, np.inf if radius is None else radius)
    assert len(expected) >= 10
    for measure, values in expected.items():
        np.testing.assert_allclose(graph[measure], values, rtol=1e-9, atol=1e-9, err_msg=measure)
    assert np.isfinite(graph["mean_depth"]).any() and len(np.unique(graph["connectivity"])) > 3


def test_impostor_a_pair_less_is_found_out():
    plan, spacing, _ = PLANS["rooms"]()
    graph = plan.vga(spacing, measures="global", progress=False)
    sees = plan.visibility(graph.points)
    a, b = np.argwhere(sees & ~np.eye(len(sees), dtype=bool))[0]
    sees[a, b] = sees[b, a] = False
    fewer = brute_force(sees, graph.points)
    assert (fewer["mean_depth"] != graph["mean_depth"]).sum() >= 2


def test_groups_names_and_titles():
    plan, spacing, _ = PLANS["rooms"]()
    every = plan.vga(spacing, measures=("local", "global", "metric", "angular"), progress=False)
    assert {"metric_length", "angular_depth", "clustering", "integration_hh"} <= set(every.measures)
    assert all(len(values) == len(every) for values in every.measures.values())
    one = plan.vga(spacing, measures="integration-hh", progress=False)
    assert list(one.measures) == ["integration_hh"] and np.array_equal(
        one["integration-hh"], every["integration_hh"], equal_nan=True
    )
    assert one.title("integration_hh") == "Visual Integration [HH]" and every.title("metric_length").endswith("(u)")
    with pytest.raises(KeyError, match="was not computed"):
        one["connectivity"]
    anywhere = plan.vga(spacing, measures="metric", turns="anywhere", progress=False)
    assert (anywhere["metric_length"] <= every["metric_length"] + 1e-9).all()
    assert (anywhere["metric_length"] >= anywhere["straight_distance"] - 1e-9).all()


def test_seeds_choose_what_is_filled():
    plan = sl.Plan(ROOMS)
    west, every = plan.vga(0.5, seeds=(1, 1), progress=False), plan.vga(0.5, progress=False)
    assert (west.points[:, 0] < 8).all() and (every.points[:, 0] > 8).any()
    assert len(west) < len(every)


@pytest.mark.parametrize(
    "options",
    [
        {"spacing": 0},
        {"spacing": -1.0},
        {"spacing": float("nan")},
        {"spacing": 1e-9},
        {"seeds": (99, 99)},
        {"seeds": [1, 2, 3]},
        {"seeds": (np.nan, 1)},
        {"measures": "beauty"},
        {"measures": ["local", "beauty"]},
        {"radius": 0},
        {"metric_radius": -1.0},
        {"angular_radius": float("inf")},
        {"turns": "never"},
        {"threads": 0},
    ],
)
def test_wrong_options_are_refused(rooms, options):
    with pytest.raises(ValueError):
        rooms.vga(**{"spacing": 0.5, "progress": False, **options})


def test_what_has_no_inside():
    with pytest.raises(ValueError):
        sl.Plan([]).vga(1.0)
    with pytest.raises(ValueError):
        sl.Plan([[0, 0, 5, 5]]).vga(1.0)


def test_results_go_on(rooms):
    geopandas = pytest.importorskip("geopandas")
    plan = sl.Plan(ROOMS, crs="EPSG:28992")
    graph = plan.vga(0.5, progress=False)
    frame = graph.to_geodataframe()
    assert frame.crs == "EPSG:28992" and len(frame) == len(graph) and np.allclose(frame.area, 0.25)
    points = graph.to_geodataframe(geometry="points")
    assert frame.geometry.contains(points.geometry).all() and "integration_hh" in points
    assert len(geopandas.GeoDataFrame.from_features(graph.__geo_interface__)) == len(graph)
    image, (left, right, bottom, top) = graph.to_array("connectivity")
    assert np.isfinite(image).sum() == len(graph) and right - left == image.shape[1] * 0.5 and top - bottom == image.shape[0] * 0.5
    x, y = graph.points[5]
    assert image[int((y - bottom) / 0.5), int((x - left) / 0.5)] == graph["connectivity"][5]
    with pytest.raises(ValueError, match="geometry"):
        graph.to_geodataframe(geometry="hexagons")
    pyplot = pytest.importorskip("matplotlib.pyplot")
    ax = graph.plot("mean_depth")
    assert len(ax.images) == 1 and "VisibilityGraph of" in repr(graph)
    pyplot.close("all")


def test_the_result_does_not_depend_on_threads():
    plan = sl.scenes.office(3, 3)
    one = plan.vga(0.75, threads=1, progress=False)
    for threads in (None, 2, 3):
        other = plan.vga(0.75, threads=threads, progress=False)
        assert all(np.array_equal(one[name], other[name], equal_nan=True) for name in one.measures)
