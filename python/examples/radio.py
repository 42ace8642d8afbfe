# %% [markdown]
# # Radio with a line of sight across a floor
#
# Signals of 60 GHz hardly pass walls: a receiver needs a line of sight to an access point. Which places have one, and how few access points are
# enough? The floor is generated; a GeoJSON file or a GeoDataFrame goes the same way.

# %%
import numpy as np

import sightlines as sl

floor = sl.scenes.office(rooms_x=6, rooms_y=4, wall_thickness=0.25)
print(floor, floor.bounds)

# Receivers stand every metre, but not inside of walls, where nothing is seen of the floor.
places = floor.grid(1.0) + 0.0625
places = places[floor.isovists(places, outlines=False)["area"] > 4]
print(f"{len(places)} places")

# %% [markdown]
# One access point at one place: who has a line of sight to it?

# %%
reached = floor.sees(places[len(places) // 2], places)
print(f"{reached.sum()} of {len(places)} places")
assert 0 < reached.sum() < len(places)

# %% [markdown]
# Which places see which, all at once, as a matrix.

# %%
sees = floor.visibility(places)
print(f"{sees.mean():.1%} of all pairs see each other")
assert (sees == sees.T).all()
assert (sees[len(places) // 2] == reached).all()

# %% [markdown]
# Signals do not reach farther than 15 metres. Access points are chosen one by one, each where it reaches most places that have none yet.

# %%
distance = np.hypot(*(places[:, None] - places[None, :]).transpose(2, 0, 1))
reaches = sees & (distance <= 15)
chosen, covered = [], np.zeros(len(places), dtype=bool)
while not covered.all():
    gain = (reaches & ~covered).sum(axis=1)
    chosen.append(int(np.argmax(gain)))
    covered |= reaches[chosen[-1]]
print(f"{len(chosen)} access points reach every place; the first five reach {reaches[chosen[:5]].any(axis=0).mean():.0%}")
assert 1 < len(chosen) < len(places) / 4

# %% [markdown]
# What the first one covers is its isovist, up to that distance.

# %%
from matplotlib import pyplot

first = floor.isovist(places[chosen[0]], radius=15)
print(f"it covers {first.area:.0f} square metres")
ax = first.plot()
floor.plot(ax, linewidths=0.5)
ax.plot(*places[chosen].T, "r.")
ax.set_title("Access points, and what the first one covers")
pyplot.show()
