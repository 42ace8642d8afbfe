"""To GeoJSON from whatever has ``__geo_interface__``."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

#: Properties of features that mean something to a plan.
PROPERTIES = ("sight", "opaque", "mirror", "left_group", "right_group", "name", "id", "object")


def interface_of(x: Any) -> Mapping[str, Any] | None:
    """The GeoJSON-like mapping of an object, or of a list of them; None if it is neither."""
    if isinstance(x, Mapping):
        return x
    if hasattr(x, "__geo_interface__"):
        found: Mapping[str, Any] = x.__geo_interface__
        return found
    if isinstance(x, (list, tuple)) and x and (isinstance(x[0], Mapping) or hasattr(x[0], "__geo_interface__")):
        parts = [interface_of(part) for part in x]
        if any(part is None for part in parts):
            raise ValueError("a list of geometries holds something else too")
        return {"type": "FeatureCollection", "features": [f for part in parts for f in _features(part)]}
    return None


def _features(mapping: Mapping[str, Any] | None) -> Iterator[dict[str, Any]]:
    kind = mapping.get("type") if isinstance(mapping, Mapping) else None
    if not isinstance(mapping, Mapping) or not isinstance(kind, str):
        raise ValueError("a geometry has no type")
    if kind == "FeatureCollection":
        features = mapping.get("features")
        if not isinstance(features, Iterable):
            raise ValueError("a FeatureCollection has no features")
        for feature in features:
            yield from _features(feature)
    elif kind == "Feature":
        geometry = _geometry(mapping.get("geometry"))
        if geometry is not None:
            yield {"type": "Feature", "properties": _properties(mapping), "geometry": geometry}
    else:
        geometry = _geometry(mapping)
        if geometry is not None:
            yield {"type": "Feature", "properties": {}, "geometry": geometry}


def _properties(feature: Mapping[str, Any]) -> dict[str, Any]:
    """Only what means something here: a table may have columns of any kind."""
    given = feature.get("properties") or {}
    if not isinstance(given, Mapping):
        raise ValueError("the properties of a feature are no mapping")
    kept = {key: given[key] for key in PROPERTIES if isinstance(given.get(key), (str, bool, int))}
    if isinstance(given.get("id"), float) and given["id"].is_integer():
        kept["id"] = int(given["id"])
    return kept


def _geometry(geometry: Any) -> dict[str, Any] | None:
    """A geometry that the reader takes; None for an empty one."""
    if geometry is None:
        return None
    if not isinstance(geometry, Mapping) or not isinstance(geometry.get("type"), str):
        raise ValueError("a geometry has no type")
    kind = geometry["type"]
    if kind == "GeometryCollection":
        parts = [part for part in map(_geometry, geometry.get("geometries") or ()) if part is not None]
        return {"type": kind, "geometries": parts} if parts else None
    coordinates = geometry.get("coordinates")
    if not isinstance(coordinates, Iterable):
        raise ValueError(f"a {kind} has no coordinates")
    coordinates = [part for part in coordinates if not (isinstance(part, (list, tuple)) and len(part) == 0)]
    if not coordinates:
        return None
    return {"type": "LineString" if kind == "LinearRing" else kind, "coordinates": coordinates}


def geojson_of(mapping: Mapping[str, Any]) -> str:
    """The text of a mapping, without what is empty."""
    collection = {"type": "FeatureCollection", "features": list(_features(mapping))}
    try:
        return json.dumps(collection, allow_nan=False, default=_plain)
    except ValueError as error:
        if "JSON compliant" in str(error):
            raise ValueError("a coordinate is not finite") from None
        raise


def _plain(x: Any) -> Any:
    """Arrays and numbers of numpy, as their lists and numbers."""
    if hasattr(x, "tolist"):
        return x.tolist()
    raise ValueError(f"a coordinate is of {type(x).__name__}")


def crs_of(x: Any) -> Any:
    """The coordinate reference system of a GeoSeries or GeoDataFrame; warns of degrees."""
    crs = getattr(x, "crs", None)
    if getattr(crs, "is_geographic", False):
        warnings.warn(
            "the coordinates are degrees, and are taken as numbers in a plane: use to_crs with a projected system",
            stacklevel=3,
        )
    return crs


def crs_of_json(text: str) -> Any:
    """What a member ``crs`` of a GeoJSON file names, else the member itself."""
    crs = json.loads(text)
    try:
        return crs["properties"]["name"]
    except (KeyError, TypeError):
        return crs
