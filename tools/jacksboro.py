"""Writes missions/terrain/jacksboro.tif from the elevation sample of the matplotlib wheel.

    pip install matplotlib==3.11.2
    python tools/jacksboro.py missions/terrain/jacksboro.tif

The sample's own latitude labels are wrong (ymin and ymax are swapped and moved).
Row 0 is the north; the edges of the true grid are below. They put the highest
cell, 1076 m, on Cross Mountain, Tennessee, and five towns of the valley at their
heights, and every node on a whole 3 arc-seconds, as in SRTM; under the labels
all of those lie outside of the grid.
"""

import struct
import sys
import zlib
from pathlib import Path

import matplotlib
import numpy as np

WEST, NORTH = -84.41375, 36.44625  # edges of the north-west cell, degrees
STEP = 1 / 1200  # 3 arc-seconds
ROWS_PER_STRIP = 43
SUMMIT = (36.1986, -84.2308)  # Cross Mountain

# TIFF 6.0 field types.
ASCII, SHORT, LONG, DOUBLE = 2, 3, 4, 12
FORMATS = {ASCII: "c", SHORT: "H", LONG: "I", DOUBLE: "d"}


def elevation():
    sample = Path(matplotlib.get_data_path()) / "sample_data" / "jacksboro_fault_dem.npz"
    heights = np.load(sample)["elevation"]
    assert heights.shape == (344, 403) and heights.dtype == np.int16
    row, column = np.unravel_index(heights.argmax(), heights.shape)
    lat, lon = NORTH - (row + 0.5) * STEP, WEST + (column + 0.5) * STEP
    assert abs(lat - SUMMIT[0]) < STEP and abs(lon - SUMMIT[1]) < STEP, (lat, lon)
    return heights


def strips(heights):
    """Deflated strips, each row as differences (predictor 2)."""
    for first in range(0, len(heights), ROWS_PER_STRIP):
        rows = heights[first:first + ROWS_PER_STRIP]
        difference = np.diff(rows, axis=1, prepend=np.int16(0))
        yield zlib.compress(difference.astype("<i2").tobytes(), 9)


def geo_keys():
    keys = [
        (1024, 2),     # GTModelType: geographic
        (1025, 2),     # GTRasterType: pixel is point
        (2048, 4326),  # GeodeticCRS: WGS84
        (2054, 9102),  # GeogAngularUnits: degree
        (4099, 9001),  # VerticalUnits: metre
    ]
    return [1, 1, 0, len(keys), *(number for key, value in keys for number in (key, 0, 1, value))]


def tiff(heights):
    rows, columns = heights.shape
    data = list(strips(heights))
    offsets, at = [], 8
    for strip in data:
        offsets.append(at)
        at += len(strip) + len(strip) % 2
    fields = [
        (256, LONG, [columns]),
        (257, LONG, [rows]),
        (258, SHORT, [16]),               # bits per sample
        (259, SHORT, [8]),                # compression: deflate
        (262, SHORT, [1]),                # black is zero
        (273, LONG, offsets),
        (277, SHORT, [1]),                # one band
        (278, LONG, [ROWS_PER_STRIP]),
        (279, LONG, [len(strip) for strip in data]),
        (317, SHORT, [2]),                # predictor: difference to the left
        (339, SHORT, [2]),                # sample format: signed
        (33550, DOUBLE, [STEP, STEP, 0]),
        # With pixel is point, the tie is the centre of the cell, not its edge.
        (33922, DOUBLE, [0, 0, 0, WEST + STEP / 2, NORTH - STEP / 2, 0]),
        (34735, SHORT, geo_keys()),
        (42113, ASCII, [bytes([letter]) for letter in b"-32768\0"]),
    ]
    directory = at
    overflow = directory + 2 + 12 * len(fields) + 4
    entries, extra = b"", b""
    for tag, kind, values in fields:
        packed = struct.pack(f"<{len(values)}{FORMATS[kind]}", *values)
        if len(packed) > 4:
            place = struct.pack("<I", overflow + len(extra))
            extra += packed + b"\0" * (len(packed) % 2)
        else:
            place = packed.ljust(4, b"\0")
        entries += struct.pack("<HHI", tag, kind, len(values)) + place
    body = b"".join(strip + b"\0" * (len(strip) % 2) for strip in data)
    header = struct.pack("<2sHI", b"II", 42, directory)
    return header + body + struct.pack("<H", len(fields)) + entries + struct.pack("<I", 0) + extra


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(tiff(elevation()))
