# %% [markdown]
# # Which rooms of an office see each other
#
# A floor plan is cut into convex cells, and the table tells exactly which of them see which. Cells that belong to one room are
# put together, and the result is a table from room to room.

# %%
import numpy as np

import sightlines as sl

# Nine rooms of 4 by 4 metres in three rows, with doors of 1 metre. The last room has none.
walls = []
for x in range(0, 13, 4):
    for y in range(0, 12, 4):
        is_outer = x in (0, 12)
        is_shut = (x, y) == (8, 8)
        if is_outer or is_shut:
            walls.append([[x, y], [x, y + 4]])
        else:
            walls += [[[x, y], [x, y + 1.5]], [[x, y + 2.5], [x, y + 4]]]
for y in range(0, 13, 4):
    for x in range(0, 12, 4):
        is_outer = y in (0, 12)
        is_shut = (x, y) == (8, 8)
        if is_outer or is_shut:
            walls.append([[x, y], [x + 4, y]])
        else:
            walls += [[[x, y], [x + 1.5, y]], [[x + 2.5, y], [x + 4, y]]]
plan = sl.Plan(walls)
table = plan.bake()
print(table)

# %% [markdown]
# The room of a cell is that of its middle.

# %%
middles = table.cells.mean(axis=1)
room = (middles // 4).astype(int)
room = room[:, 1] * 3 + room[:, 0]
n_rooms = 9

# A room sees another if one of its cells sees one of the other's.
belongs = np.arange(n_rooms)[:, None] == room
sees = belongs.astype(int) @ table.visibility.astype(int) @ belongs.T.astype(int) > 0
print(sees.astype(int))

assert (sees == sees.T).all()
# Doors are in line: the first room sees along its row and its column, and past the doors to others.
assert sees[0, 2] and sees[0, 6]
# Nothing leads into the last one.
assert sees[8].sum() == 1

# %% [markdown]
# Why does the first room see the third? `explain` gives a line of sight, with the doors that it passes.

# %%
why = table.explain((2, 2), (10, 2))
print(why)
assert why.visible and len(why.portals) >= 2

# %%
from matplotlib import pyplot

ax = table.plot(eye=(2, 2), line=why)
plan.plot(ax)
ax.set_title("What is seen from the first room, and a line to the third")
pyplot.show()
