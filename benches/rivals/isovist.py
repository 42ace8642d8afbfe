"""Isovists by pysovist and visible vertices by pyvisgraph, for the bench `isovist`.

Reads lines `wall ax ay bx by` and `eye x y` from standard input; prints a line for each rival that is installed, with the mean seconds of one
isovist. Preparations of the whole plan are not counted, as the mesh is not counted in ours.
"""

import sys
import time

walls, eyes = [], []
for line in sys.stdin:
    kind, *numbers = line.split()
    numbers = list(map(float, numbers))
    if kind == "wall":
        walls.append(numbers)
    else:
        eyes.append(numbers)

try:
    import numpy as np
    import pysovist

    plan = pysovist.Plan(np.array(walls).reshape(-1, 2, 2))
    radius = float(np.abs(np.array(walls)).max()) * 4
    pysovist.isovist(plan, eyes[0], max_distance=radius)
    start = time.process_time()
    for eye in eyes:
        pysovist.isovist(plan, eye, max_distance=radius)
    print("pysovist", (time.process_time() - start) / len(eyes))
except ImportError as error:
    print("pysovist is not installed:", error)
except Exception as error:  # a rival that fails is not measured
    print("pysovist failed:", error)

try:
    from pyvisgraph.graph import Graph, Point
    from pyvisgraph.visible_vertices import visible_vertices

    # It takes polygons; a wall is one with two vertices.
    graph = Graph([[Point(ax, ay), Point(bx, by)] for ax, ay, bx, by in walls])
    some = eyes[:5]
    start = time.process_time()
    for x, y in some:
        visible_vertices(Point(x, y), graph)
    print("pyvisgraph (visible vertices only)", (time.process_time() - start) / len(some))
except ImportError as error:
    print("pyvisgraph is not installed:", error)
except Exception as error:
    print("pyvisgraph failed:", error)
