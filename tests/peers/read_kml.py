"""Prints folders, placemarks, their geometry and number of coordinates of a KML file as JSON."""

import json
import sys
import xml.etree.ElementTree as tree

KML = "{http://www.opengis.net/kml/2.2}"
root = tree.parse(sys.argv[1]).getroot()
assert root.tag == KML + "kml", root.tag
styles = {style.get("id") for style in root.iter(KML + "Style")}
placemarks = []
for placemark in root.iter(KML + "Placemark"):
    link = placemark.find(KML + "styleUrl")
    assert link is None or link.text.lstrip("#") in styles, link.text
    shape = next(c for c in placemark if c.tag[len(KML) :] in ("Polygon", "LineString", "Point"))
    places = next(shape.iter(KML + "coordinates")).text.split()
    assert all(len([float(number) for number in place.split(",")]) == 3 for place in places)
    placemarks.append([placemark.find(KML + "name").text, shape.tag[len(KML) :], len(places)])
folders = [folder.find(KML + "name").text for folder in root.iter(KML + "Folder")]
print(json.dumps({"folders": folders, "placemarks": placemarks}))
