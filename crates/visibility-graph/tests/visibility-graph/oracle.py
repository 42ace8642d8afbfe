"""Measures of a visibility graph, straight from their definitions, in plain Python.

usage: oracle.py WALLS.csv POINTS.csv

WALLS.csv has lines ax,ay,bx,by and POINTS.csv lines x,y,near with whole numbers; near is 1 where paths may turn.
Prints a line for each point with the columns named in COLUMNS.
"""

import math
import sys

COLUMNS = [
    "connectivity", "first-moment", "second-moment", "clustering", "control", "controllability",
    "node-count", "mean-depth", "integration-hh", "integration-tekl", "integration-p", "entropy", "relativised-entropy",
    "metric-node-count", "metric-length", "straight-distance", "any-length",
]


def read(path):
    with open(path, encoding="ascii") as file:
        return [tuple(int(cell) for cell in line.split(",")) for line in file if line.strip()]


def within(low, x, high):
    return min(low, high) <= x <= max(low, high)


def blocks(wall, p, q):
    """Whether a closed wall and the closed segment pq share a point, by Cramer's rule in whole numbers."""
    ax, ay, bx, by = wall
    ux, uy = bx - ax, by - ay
    vx, vy = q[0] - p[0], q[1] - p[1]
    wx, wy = p[0] - ax, p[1] - ay
    det = ux * vy - uy * vx
    if det != 0:
        # a + s u = p + t v, with s and t over det.
        s, t = wx * vy - wy * vx, wx * uy - wy * ux
        if det < 0:
            det, s, t = -det, -s, -t
        return 0 <= s <= det and 0 <= t <= det
    if wx * uy - wy * ux != 0:
        return False
    k = 0 if ux != 0 else 1
    a, b, c, d = (ax, bx, p[0], q[0]) if k == 0 else (ay, by, p[1], q[1])
    return within(a, c, b) or within(a, d, b) or within(c, a, d)


def distance(p, q):
    return math.hypot(p[0] - q[0], p[1] - q[1])


def shortest(start, points, sees, turns_at):
    """Dijkstra's algorithm without a queue."""
    cost, settled = {start: 0.0}, {}
    while cost:
        here = min(cost, key=lambda j: cost[j])
        settled[here] = cost.pop(here)
        if here == start or turns_at(here):
            for j in sees[here]:
                if j not in settled:
                    length = settled[here] + distance(points[here], points[j])
                    cost[j] = min(length, cost.get(j, math.inf))
    return settled


def global_row(start, sees):
    depth, layer, levels = {start: 0}, [start], []
    while layer:
        levels.append(len(layer))
        found = sorted({j for i in layer for j in sees[i] if j not in depth})
        depth.update((j, len(levels)) for j in found)
        layer = found
    n, total = len(depth), sum(depth.values())
    if n == 1:
        return [n] + [-1] * 6
    mean = total / (n - 1)
    hh = tekl = p_value = -1
    if n > 2 and mean > 1:
        asymmetry = 2 * (mean - 1) / (n - 2)
        diamond = 2 * (n * (math.log((n + 2) / 3, 2) - 1) + 1) / ((n - 1) * (n - 2))
        hh = diamond / asymmetry
        p_value = 2 * (n - math.log(n, 2) - 1) / ((n - 1) * (n - 2)) / asymmetry
        if total - n + 1 > 1:
            tekl = math.log((n - 2) / 2) / math.log(total - n + 1)
    entropy = relative = 0.0
    for k, count in enumerate(levels[1:], start=1):
        p = count / (n - 1)
        entropy -= p * math.log(p, 2)
        relative += p * (math.log(p) - (k * math.log(mean) - math.lgamma(k + 2) - mean)) / math.log(2)
    return [n, mean, hh, tekl, p_value, entropy, relative]


def main():
    walls, rows = read(sys.argv[1]), read(sys.argv[2])
    points, near = [row[:2] for row in rows], [row[2] == 1 for row in rows]
    n = len(points)
    sees = [set() for _ in range(n)]
    for i in range(n):
        for j in range(i):
            if not any(blocks(wall, points[i], points[j]) for wall in walls):
                sees[i].add(j)
                sees[j].add(i)
    print(",".join(COLUMNS))
    for i in range(n):
        own = sees[i]
        k = len(own)
        row = [k, sum(distance(points[i], points[j]) for j in own)]
        row.append(sum((points[i][0] - points[j][0]) ** 2 + (points[i][1] - points[j][1]) ** 2 for j in own))
        if k > 1:
            union = set().union(*(sees[j] for j in own))
            row += [sum(len(own & sees[j]) for j in own) / (k * (k - 1)), sum(1 / len(sees[j]) for j in own), k / len(union)]
        else:
            row += [-1] * 3
        row += global_row(i, sees)
        lengths = shortest(i, points, sees, lambda j: near[j])
        anywhere = shortest(i, points, sees, lambda j: True)
        row += [len(lengths), sum(lengths.values()) / len(lengths)]
        row.append(sum(distance(points[i], points[j]) for j in lengths) / len(lengths))
        row.append(sum(anywhere.values()) / len(anywhere))
        print(",".join(repr(x) for x in row))


main()
