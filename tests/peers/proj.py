"""Prints places drawn by a seed with their ECEF and ENU coordinates by PROJ as JSON."""

import json
import pathlib
import random
import sys

import pyproj

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
from geodesy_truth import ecef, enu  # noqa: E402

draw = random.Random(int(sys.argv[1]))
rows = []
for _ in range(int(sys.argv[2])):
    origin_lat, origin_lon = draw.uniform(-90, 90), draw.uniform(-180, 180)
    away = draw.choice([100, 10_000, 300_000]) * draw.random()
    lon, lat, _ = pyproj.Geod(ellps="WGS84").fwd(origin_lon, origin_lat, draw.uniform(0, 360), away)
    height = draw.uniform(-500, 10_000)
    place = [origin_lat, origin_lon, lat, lon, height]
    rows.append([*place, *ecef(lat, lon, height), *enu(*place)])
print(json.dumps(rows))
