# %% [markdown]
# # The integration map of a plan
#
# Visibility graph analysis (Turner, Doxa, O'Sullivan and Penn 2001) asks of each point of a grid how it is placed among all others: how many it sees, and
# over how many turns all of them are reached. Definitions are those of depthmapX.

# %%
import numpy as np

import sightlines as sl

plan = sl.scenes.office(rooms_x=4, rooms_y=3)
graph = plan.vga(0.5)
print(graph)

# %% [markdown]
# Integration is high where few turns lead to everywhere: in corridors, and not in rooms.

# %%
integration = graph["integration_hh"]
best, worst = (int(f(integration)) for f in (np.nanargmax, np.nanargmin))
print(f"highest at {graph.points[best]}: {integration[best]:.2f}, lowest at {graph.points[worst]}: {integration[worst]:.2f}")
assert integration[best] > 2 * integration[worst]
assert graph["mean_depth"][best] < graph["mean_depth"][worst]

# %% [markdown]
# Local and global measures tell different things: intelligibility is how well the first foretell the second.

# %%
known = np.isfinite(integration)
r = np.corrcoef(graph["connectivity"][known], integration[known])[0, 1]
print(f"intelligibility: r² = {r * r:.2f}")
assert 0 < r < 1

# %%
from matplotlib import pyplot

figure, (left, right) = pyplot.subplots(1, 2, figsize=(12, 4))
for ax, measure in ((left, "integration_hh"), (right, "clustering")):
    graph.plot(measure, ax, cmap="turbo")
    plan.plot(ax)
pyplot.show()

# %% [markdown]
# As a GeoDataFrame the map goes to any GIS.

# %%
frame = graph.to_geodataframe()
print(frame[["connectivity", "integration_hh"]].describe().round(2))
assert len(frame) == len(graph)
