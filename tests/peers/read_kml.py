"""Reads a KML file with fastkml, after the schema of OGC KML 2.2 has accepted it.

Prints its folders, its placemarks (name, geometry, number of coordinates), how many
geometries there are of each kind, and the coordinates of its lines, as JSON.
"""

import collections
import json
import sys

import fastkml
import lxml.etree
from fastkml import validator
from fastkml.enums import AltitudeMode
from fastkml.utils import find_all
from pygeoif.geometry import LineString, Point, Polygon

path = sys.argv[1]
schema = validator.get_schema_parser()
schema.assertValid(lxml.etree.parse(path))
document = fastkml.KML.parse(path)
styles = {style.id for style in find_all(document, of_type=fastkml.Style)}
placemarks = []
kinds = collections.Counter()
lines = []
for placemark in find_all(document, of_type=fastkml.Placemark):
    url = placemark.style_url
    assert url is None or url.url.lstrip("#") in styles, url.url
    shape = placemark.geometry
    ring = shape.exterior if isinstance(shape, Polygon) else shape
    places = list(ring.coords)
    assert isinstance(shape, (Polygon, LineString, Point)), shape
    assert all(len(place) == 3 for place in places), places
    if isinstance(shape, Polygon):
        assert places[0] == places[-1] and len(places) > 3, places
    mode = placemark.kml_geometry.altitude_mode
    assert mode in (AltitudeMode.absolute, AltitudeMode.clamp_to_ground), mode
    if isinstance(shape, LineString):
        raised = mode == AltitudeMode.absolute
        assert bool(placemark.kml_geometry.extrude) == raised, placemark.name
        lines.append([raised, places])
    kinds[shape.geom_type] += 1
    placemarks.append([placemark.name, shape.geom_type, len(places)])
folders = [folder.name for folder in find_all(document, of_type=fastkml.Folder)]
print(
    json.dumps(
        {"folders": folders, "placemarks": placemarks, "geometries": kinds, "lines": lines}
    )
)
