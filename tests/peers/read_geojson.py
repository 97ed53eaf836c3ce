"""Reads a GeoJSON file with shapely (GEOS), and holds it against RFC 7946.

Rings are closed, valid and counter-clockwise outside, positions are longitude and
latitude on the earth, with a height or without. Prints how many geometries there are
of each kind, and of each line whether it has heights and its coordinates, as JSON.
"""

import collections
import json
import sys

import shapely

text = open(sys.argv[1], encoding="utf-8").read()
collection = json.loads(text)
assert collection["type"] == "FeatureCollection" and "crs" not in collection
shapes = shapely.get_parts(shapely.from_geojson(text))
kinds = collections.Counter()
lines = []
for shape in shapes:
    west, south, east, north = shape.bounds
    assert -180 <= west <= east <= 180 and -90 <= south <= north <= 90, shape
    if shape.geom_type == "Polygon":
        assert shape.exterior.is_ring and shape.exterior.is_ccw and shape.is_valid, shape
        assert not shape.has_z, shape
    if shape.geom_type == "LineString":
        coordinates = shapely.get_coordinates(shape, include_z=shape.has_z)
        lines.append([bool(shape.has_z), coordinates.tolist()])
    kinds[shape.geom_type] += 1
assert sum(kinds.values()) == len(collection["features"])
print(json.dumps({"geometries": kinds, "lines": lines}))
