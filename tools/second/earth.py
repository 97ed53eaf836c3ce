"""The earth and the ground on it."""

import math
import struct
import zlib
from pathlib import Path

import numpy as np

A, F = 6378137.0, 1 / 298.257223563  # WGS84
E2 = F * (2 - F)


def functions(number):
    """Those of one number, which are much faster, or of arrays."""
    return math if isinstance(number, float) else np


def ecef(lat, lon):
    """Points of the ellipsoid, shape (..., 3)."""
    f = functions(lat)
    lat, lon = f.radians(lat), f.radians(lon)
    n = A / f.sqrt(1 - E2 * f.sin(lat) ** 2)
    across = n * f.cos(lat)
    xyz = [across * f.cos(lon), across * f.sin(lon), n * (1 - E2) * f.sin(lat)]
    return np.array(xyz) if f is math else np.stack(xyz, axis=-1)


def geodetic(xyz):
    """Latitude and longitude of points near the ellipsoid, degrees."""
    x, y, z = xyz.tolist() if xyz.ndim == 1 else np.moveaxis(xyz, -1, 0)
    f = functions(x)
    p = f.hypot(x, y)
    lat = f.atan2(z, p * (1 - E2))
    for _ in range(4):
        n = A / f.sqrt(1 - E2 * f.sin(lat) ** 2)
        height = p / f.cos(lat) - n
        lat = f.atan2(z, p * (1 - E2 * n / (n + height)))
    return f.degrees(lat), f.degrees(f.atan2(y, x))


def axes(lat, lon):
    """East and north at a place."""
    lat, lon = math.radians(lat), math.radians(lon)
    east = np.array([-math.sin(lon), math.cos(lon), 0])
    north = np.array([-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)])
    return east, north


def distance(a, b):
    return float(np.linalg.norm(ecef(*a) - ecef(*b)))


class Ground:
    """A GeoTIFF of whole metres, deflated in strips, pixel is point."""

    def __init__(self, path):
        data = Path(path).read_bytes()
        (at,) = struct.unpack_from("<I", data, 4)
        (count,) = struct.unpack_from("<H", data, at)
        sizes = {2: ("c", 1), 3: ("H", 2), 4: ("I", 4), 12: ("d", 8)}
        tag = {}
        for index in range(count):
            key, kind, number = struct.unpack_from("<HHI", data, at + 2 + 12 * index)
            letter, size = sizes[kind]
            where = at + 10 + 12 * index
            if number * size > 4:
                (where,) = struct.unpack_from("<I", data, where)
            tag[key] = struct.unpack_from(f"<{number}{letter}", data, where)
        columns, rows = tag[256][0], tag[257][0]
        assert tag[259] == (8,) and tag[258] == (16,) and tag[34735][8:12] == (1025, 0, 1, 2)
        strips = [zlib.decompress(data[o : o + n]) for o, n in zip(tag[273], tag[279])]
        heights = np.frombuffer(b"".join(strips), "<i2").reshape(rows, columns)
        if tag[317] == (2,):
            heights = np.cumsum(heights, axis=1, dtype=np.int16)
        self.heights = heights.astype(float)
        self.step = tag[33550][:2]
        self.west, self.north = tag[33922][3], tag[33922][4]
        # The greatest slope in any direction: that of a bilinear cell is at a corner.
        metres = math.radians(1) * A * (1 - 1.5 * E2)
        across = metres * self.step[0] * math.cos(math.radians(self.north))
        dx = np.abs(np.diff(self.heights, axis=1)) / across
        dy = np.abs(np.diff(self.heights, axis=0)) / (metres * self.step[1])
        self.at_home = {}
        self.steepest = float(np.hypot(np.maximum(dx[:-1], dx[1:]), np.maximum(dy[:, :-1], dy[:, 1:])).max())

    def posts_apart(self, lat, lon, spacing):
        """How far a surface, bilinear between posts so far apart, may be below and above the ground: the worst of
        16 ways in which the place may lie between the posts."""
        lat, lon, here = np.asarray(lat), np.asarray(lon), np.asarray(self.height(lat, lon))
        flat = 1 - E2 * np.sin(np.radians(lat)) ** 2
        north = np.degrees(flat**1.5 / (A * (1 - E2)))
        east = np.degrees(np.sqrt(flat) / (A * np.cos(np.radians(lat))))
        # The ground at quarters of a cell around each place: up along the last axis but one, right along the last.
        quarters = np.arange(-3, 5) * spacing / 4
        around = self.height(lat[..., None, None] + quarters[:, None] * north[..., None, None],
                             lon[..., None, None] + quarters * east[..., None, None])
        below, above = np.zeros(here.shape), np.zeros(here.shape)
        for x in range(4):
            for y in range(4):
                low, high = around[..., 3 - y, :], around[..., 7 - y, :]
                south, north_side = ((row[..., 3 - x] * (4 - x) + row[..., 7 - x] * x) / 4 for row in (low, high))
                posts = (south * (4 - y) + north_side * y) / 4
                below, above = np.maximum(below, here - posts), np.maximum(above, posts - here)
        return below, above

    def followed_apart(self, lat, lon, home, spacing, most=30.0):
        """The same of a surface that is moved so that it is on the ground at home, by no more than `most` (TERRAIN_OFS_MAX)."""
        below, above = self.posts_apart(lat, lon, spacing)
        if home not in self.at_home:
            self.at_home[home] = [min(float(off), most) for off in self.posts_apart(*home, spacing)]
        return below + self.at_home[home][1], above + self.at_home[home][0]

    def height(self, lat, lon):
        row = (self.north - np.asarray(lat)) / self.step[1]
        column = (np.asarray(lon) - self.west) / self.step[0]
        rows, columns = self.heights.shape
        assert (row >= 0).all() and (row <= rows - 1).all() and (column >= 0).all() and (column <= columns - 1).all()
        r = np.minimum(row.astype(int), rows - 2)
        c = np.minimum(column.astype(int), columns - 2)
        y, x = row - r, column - c
        h = self.heights
        return (h[r, c] * (1 - x) + h[r, c + 1] * x) * (1 - y) + (h[r + 1, c] * (1 - x) + h[r + 1, c + 1] * x) * y
