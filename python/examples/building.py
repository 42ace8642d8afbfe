# %% [markdown]
# # Sight in a building
#
# A tower of two floors is generated; any `.glb`, `.gltf` or `.obj` file, or a `trimesh.Scene`, goes the same way. Its table tells
# which objects can be seen from where: never too few.

# %%
import numpy as np

import sightlines as sl

table = sl.bake(sl.scenes.tower(floors=2, rooms_x=3, rooms_y=2))
print(table)

# %% [markdown]
# From one point:

# %%
eye = table.cells[0].mean(axis=0)
seen = table.visible_objects(eye)
print(f"{len(seen)} of {table.n_objects} objects can be seen from {eye}")
print([table.objects[k] for k in seen[:5]], "...")
assert 0 < len(seen) < table.n_objects

# %% [markdown]
# From many points at once: along a walk through the building, how much is in sight? A point in a wall is in no cell; there everything
# counts as visible, unless one asks otherwise.

# %%
low, high = table.cells[:, 0].min(axis=0), table.cells[:, 1].max(axis=0)
walk = np.linspace(low, high, 200)
walk[:, 1] = 1.7
in_sight = table.visible_objects(walk, outside="none").sum(axis=1)
print(f"at most {in_sight.max()} objects in sight")
assert in_sight.max() < table.n_objects

# %% [markdown]
# Which objects are seen from the fewest places? Those can be drawn last, or not be loaded at first.

# %%
seen_from = np.zeros(table.n_objects, dtype=int)
for cell in range(table.n_cells):
    seen_from[table.objects_seen_by(cell)] += 1
for k in np.argsort(seen_from)[:5]:
    print(f"{table.objects[k]}: seen from {seen_from[k]} of {table.n_cells} cells")

# %% [markdown]
# Two cells that see each other have a line of sight, and two that do not have walls that stop all of them.

# %%
hidden = int(np.flatnonzero(~table.visibility[0])[-1])
why = table.explain(0, hidden)
print(why)
assert why.visible is False

# %%
from matplotlib import pyplot

ax = table.plot(eye=eye)
ax.set_title("What is seen at the height of the eye, from above")
pyplot.show()

# %% [markdown]
# A game or a tool keeps the table as a file.

# %%
import tempfile
from pathlib import Path

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "tower.pvz"
    table.save(path)
    print(f"{path.stat().st_size} bytes")
    assert sl.load(path) == table
