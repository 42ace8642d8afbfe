"""Exact visibility for floor plans and buildings.

* :class:`Plan`: walls in the plane, from GeoJSON, DXF, numpy, shapely or geopandas: isovists, sight between points, visibility graphs.
* :func:`bake`: the table of a scene in space, from a file, bytes or trimesh.
* :class:`Table`: which cells and objects are seen from where, and why; :func:`load` reads one.
* :func:`strip`: what of a scene nobody can ever see.
* :class:`Reaches`: when bodies that move could see each other.
* :mod:`sightlines.scenes`: generated plans and buildings to try things on.

Nothing that can be seen is ever reported hidden. The same input gives the same answer, with any number of threads.
"""

from ._bake import bake
from ._native import Error, __version__
from ._isovist import Isovist, Isovists
from ._plan import Plan
from ._relevance import Reaches
from ._strip import Stripped, StrippedObject, strip
from ._table import Explanation, Table, load
from ._vga import VisibilityGraph
from . import scenes

__all__ = ["Error", "Explanation", "Isovist", "Isovists", "Plan", "Reaches", "Stripped", "StrippedObject", "Table", "VisibilityGraph", "__version__", "bake", "load", "scenes", "strip"]
