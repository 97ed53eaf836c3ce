"""Reads an ArduPilot terrain database as the vehicle does, and prints heights as JSON.

    read_dat.py FOLDER SPACING '[[lat, lon], ...]'

Written from AP_Terrain: struct grid_block in AP_Terrain.h, calculate_grid_info and grid_bitnum in
TerrainUtil.cpp, height_amsl in AP_Terrain.cpp, east_blocks, seek_offset and read_block in TerrainIO.cpp,
and offset_latlng, get_distance_NE and longitude_scale in Location.cpp.
"""

import json
import math
import os
import struct
import sys

BLOCK = struct.Struct("<QiiHHH896hHHhbB")


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


METRES = single(0.011131884502145034)
PER_METRE = single(89.83204953368922)


def scale(lat_e7):
    return max(single(math.cos(single(math.radians(lat_e7 * 1e-7)))), 0.01)


def distance(lat1, lon1, lat2, lon2):
    return (lat2 - lat1) * METRES, (lon2 - lon1) * METRES * scale((lat1 + lat2) / 2)


def offset(lat, lon, north, east):
    up = int(north * PER_METRE)
    return lat + up, lon + int(east * PER_METRE / scale(lat + up / 2))


def crc(data):
    table = [0] * 256
    for byte in range(256):
        value = byte << 8
        for _ in range(8):
            value = (value << 1) ^ (0x1021 if value & 0x8000 else 0)
        table[byte] = value & 0xFFFF
    found = 0
    for byte in data:
        found = ((found << 8) & 0xFFFF) ^ table[(found >> 8) ^ byte]
    return found


def height(folder, spacing, lat_deg, lon_deg):
    lat, lon = round(lat_deg * 1e7), round(lon_deg * 1e7)
    square_lat, square_lon = lat // 10**7, lon // 10**7
    corner = square_lat * 10**7, square_lon * 10**7
    north, east = distance(*corner, lat, lon)
    row, column = int(north / spacing), int(east / spacing)
    block_row, block_column = row // 24, column // 28
    place = offset(*corner, block_row * 24 * spacing, block_column * 28 * spacing)
    _, width = distance(*corner, *offset(corner[0], corner[1] + 10**7, 0, 2 * spacing * 32))
    number = int(width / (spacing * 28)) * block_row + block_column
    letters = "S" if square_lat < 0 else "N", "W" if square_lon < 0 else "E"
    name = f"{letters[0]}{abs(square_lat):02}{letters[1]}{abs(square_lon):03}.DAT"
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return None
    with open(path, "rb") as file:
        file.seek(2048 * number)
        raw = file.read(2048)
    if len(raw) < 2048:
        return None
    bitmap, block_lat, block_lon, found_crc, version, found_spacing, *rest = BLOCK.unpack(raw[: BLOCK.size])
    if bitmap == 0:
        return None
    heights, (grid_x, grid_y, lon_int, lat_int, minor) = rest[:896], rest[896:]
    # What read_block refuses, and what keeps the vehicle from arming.
    assert abs(block_lat - place[0]) <= 5 and abs(block_lon - place[1]) <= 5, (name, number, place)
    assert (version, minor, found_spacing) == (1, 1, spacing), (version, minor, found_spacing)
    assert found_crc == crc(raw[:16] + b"\0\0" + raw[18:1821])
    assert (grid_x, grid_y, lon_int, lat_int) == (block_row, block_column, square_lon, square_lat)
    x, y = row % 24, column % 28
    for i, j in ((x, y), (x, y + 1), (x + 1, y), (x + 1, y + 1)):
        if not bitmap >> (j // 4 + 8 * (i // 4)) & 1:
            return None
    fx, fy = north / spacing - row, east / spacing - column
    post = lambda i, j: heights[32 * i + j]
    west = post(x, y) * (1 - fx) + post(x + 1, y) * fx
    east = post(x, y + 1) * (1 - fx) + post(x + 1, y + 1) * fx
    return west * (1 - fy) + east * fy


if __name__ == "__main__":
    folder, spacing, places = sys.argv[1], int(sys.argv[2]), json.loads(sys.argv[3])
    print(json.dumps([height(folder, spacing, *place) for place in places]))
