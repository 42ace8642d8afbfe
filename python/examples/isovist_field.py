# %% [markdown]
# # The isovist field of a gallery
#
# An isovist is the polygon of everything that can be seen from a point. Computed for many points, its measures are fields over the floor: where
# does one see much, where is one hidden, where do views change?

# %%
import numpy as np

import sightlines as sl

# A gallery of 24 by 12 metres: an outline, partitions for pictures, and a pillar.
outline = [(0, 0), (24, 0), (24, 12), (0, 12)]
partitions = [[(6, 0), (6, 7)], [(12, 12), (12, 5)], [(18, 0), (18, 7)], [(3, 9), (5, 9)], [(20, 9), (22, 9)]]
pillar = [(14.5, 2.5), (15.5, 2.5), (15.5, 3.5), (14.5, 3.5)]
gallery = sl.Plan(
    {
        "type": "GeometryCollection",
        "geometries": [
            {"type": "Polygon", "coordinates": [[*outline, outline[0]], [*pillar, pillar[0]]]},
            {"type": "MultiLineString", "coordinates": partitions},
        ],
    },
    crs="EPSG:28992",
)

# %% [markdown]
# One point first. Edges of the polygon are parts of walls, or *occluding*: behind them, something is hidden.

# %%
entrance = gallery.isovist((1, 1))
print(entrance)
print({name: round(value, 2) for name, value in entrance.measures.items()})
assert entrance.area < 24 * 12
assert 0 < entrance.occlusivity < entrance.perimeter

# %% [markdown]
# Now a point every quarter of a metre. Those inside of the pillar see nothing but its inside.

# %%
field = gallery.isovists(gallery.grid(0.25))
print(field)
area = field["area"]
best = int(np.argmax(area))
print(f"most is seen from {field.points[best]}: {area[best]:.1f} square metres")
assert area.max() < 24 * 12 - 1
assert area.min() == 1.0

# %% [markdown]
# Where would a picture be seen from most places? Each isovist lists the walls that are seen in it.

# %%
n_seen = np.zeros(len(gallery.walls), dtype=int)
for isovist in field:
    n_seen[np.unique(isovist.walls[isovist.walls >= 0])] += 1
for wall in np.argsort(-n_seen)[:3]:
    (ax, ay), (bx, by) = gallery.walls[wall]
    print(f"wall from ({ax:g}, {ay:g}) to ({bx:g}, {by:g}): seen from {n_seen[wall]} of {len(field)} points")

# %%
from matplotlib import pyplot

figure, (left, right) = pyplot.subplots(1, 2, figsize=(12, 4))
field.plot("area", left)
gallery.plot(left)
entrance.plot(right)
gallery.plot(right)
pyplot.show()

# %% [markdown]
# The result goes on to geopandas, with the coordinate reference system of the plan.

# %%
frame = field.to_geodataframe(geometry="points")
print(frame.sort_values("occlusivity").tail(3)[["area", "occlusivity", "geometry"]])
assert frame.crs == "EPSG:28992"
