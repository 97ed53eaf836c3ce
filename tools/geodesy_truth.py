"""Writes what PROJ says to tests/data/geodesy_truth.csv and geoid_truth.csv, for tests/geodesy_truth.rs.

    pip install pyproj==3.7.2
    python tools/geodesy_truth.py > tests/data/geodesy_truth.csv
    python tools/geodesy_truth.py egm96_15.gtx > tests/data/geoid_truth.csv

The grid egm96_15.gtx is in the Debian package proj-data.
"""

import math
import random
import sys

import pyproj

ORIGINS = [
    (36.30, -84.25), (0.0, 0.0), (51.9, 4.1), (-33.9, 151.2), (45.0, 90.0),
    (69.9, 179.9), (-16.5, -179.95),  # beside the date line
    (89.5, 12.0), (-90.0, 0.0), (90.0, -45.0),  # around the poles
]
# Azimuth in degrees, distance in metres, height above the ellipsoid in metres.
RAYS = [
    (0, 0, 0), (37, 12.5, 0), (90, 1000, 120.5), (203.7, 30000, 1076),
    (311, 150000, -80), (142, 300000, 4808), (270, 299999, 9000),
]


def ecef(lat, lon, height):
    step = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    return step.transform(lon, lat, height)


def enu(origin_lat, origin_lon, lat, lon, height):
    step = pyproj.Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
        f"+step +proj=topocentric +ellps=WGS84 +lat_0={origin_lat!r} +lon_0={origin_lon!r} +h_0=0"
    )
    return step.transform(lon, lat, height)


def undulation(grid, lat, lon):
    step = pyproj.Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
        f"+step +proj=vgridshift +grids={grid} +multiplier=1 +step +proj=unitconvert +xy_in=rad +xy_out=deg"
    )
    return step.transform(lon, lat, 0.0)[2]


def frames():
    print("# WGS84 to ECEF, and to the ENU frame at an origin of height 0, for places up to 300 km away.")
    print(
        f"# From PROJ {pyproj.proj_version_str} (+proj=cart, +proj=topocentric; places by its geodesics)"
        f" through pyproj {pyproj.__version__}, by tools/geodesy_truth.py."
    )
    print("origin_lat_deg,origin_lon_deg,lat_deg,lon_deg,height_m,x_m,y_m,z_m,east_m,north_m,up_m")
    turn = 0
    for origin_lat, origin_lon in ORIGINS:
        for azimuth, distance, height in RAYS:
            along = pyproj.Geod(ellps="WGS84").fwd(origin_lon, origin_lat, (azimuth + 13 * turn) % 360, distance)
            lat, lon = round(along[1], 9), round(along[0], 9)
            turn += 1
            degrees = [f"{value:.9f}" for value in (origin_lat, origin_lon, lat, lon)]
            metres = [*ecef(lat, lon, height), *enu(origin_lat, origin_lon, lat, lon, height)]
            print(",".join([*degrees, f"{height:.3f}", *(f"{value:.6f}" for value in metres)]))


def geoid(grid):
    print("# How far mean sea level lies above the WGS84 ellipsoid, EGM96, all over the earth.")
    print(
        f"# From PROJ {pyproj.proj_version_str} (+proj=vgridshift) with its own egm96_15.gtx"
        f" through pyproj {pyproj.__version__}, by tools/geodesy_truth.py."
    )
    print("lat_deg,lon_deg,undulation_m")
    draw = random.Random(1996)
    even = [(math.degrees(math.asin(draw.uniform(-1, 1))), draw.uniform(-180, 180)) for _ in range(1000)]
    edges = [(lat, lon) for lat in (-90, -89.9, -0.1, 0, 0.25, 89.9, 90) for lon in (-180, -179.9, -0.1, 0, 0.125, 179.9)]
    for lat, lon in [*edges, *even]:
        lat, lon = round(lat, 7), round(lon, 7)
        print(f"{lat:.7f},{lon:.7f},{undulation(grid, lat, lon):.6f}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        geoid(sys.argv[1])
    else:
        frames()
