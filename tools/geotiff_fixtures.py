"""Writes tests/data/geotiff/*.tif with GDAL, an independent writer.

    pip install rasterio==1.4.4
    python tools/geotiff_fixtures.py tests/data/geotiff

Six rows and eight columns; the centre of the north-west pixel is 47.05 N 8.10 E,
pixels are 0.01 degrees; the height at row r and column c is 400 + 10 r + c.
"""

import sys
from pathlib import Path

import numpy as np
import rasterio
from rasterio.transform import Affine

STEP = 0.01
HEIGHTS = 400 + 10 * np.arange(6)[:, None] + np.arange(8)[None, :]
# GDAL's transform is of pixel edges, whatever the file says its pixels are.
EDGES = Affine(STEP, 0, 8.10 - STEP / 2, 0, -STEP, 47.05 + STEP / 2)
FOLDER = Path(sys.argv[1])


def write(name, heights=HEIGHTS, dtype="int16", crs="EPSG:4326", transform=EDGES, point=False, **options):
    bands = heights if heights.ndim == 3 else heights[None]
    size = {"count": len(bands), "height": bands.shape[1], "width": bands.shape[2]}
    with rasterio.open(
        FOLDER / name, "w", driver="GTiff", dtype=dtype, crs=crs, transform=transform, **size, **options
    ) as file:
        file.update_tags(AREA_OR_POINT="Point" if point else "Area")
        file.write(bands.astype(dtype))


holes = HEIGHTS.astype(float)
holes[2, 3], holes[4, 5], holes[0, 0] = -9999, np.nan, 20000

write("area.tif", compress="deflate")
write("east.tif", HEIGHTS + 8, transform=EDGES * Affine.translation(8, 0))
write("point.tif", point=True)
write("float.tif", holes, "float32", nodata=-9999, compress="lzw")
write("double.tif", HEIGHTS, "float64", compress="deflate", predictor=3)
write("byte.tif", HEIGHTS - 400, "uint8", nodata=255)
write("word.tif", HEIGHTS, "uint16", compress="packbits")
write("long.tif", HEIGHTS, "int32", compress="zstd")
write("tiled.tif", HEIGHTS, "int16", tiled=True, blockxsize=16, blockysize=16, compress="deflate", predictor=2)
write("big.tif", BIGTIFF="YES", ENDIANNESS="BIG")
write("egm96.tif", crs="EPSG:4326+5773")
write("ellipsoid.tif", crs="EPSG:4979")
write("utm.tif", crs="EPSG:32632", transform=Affine(90, 0, 450000, 0, -90, 5200000))
write("nad27.tif", crs="EPSG:4267")
write("no_crs.tif", crs=None)
write("rotated.tif", transform=EDGES * Affine.rotation(10))
write("south_up.tif", transform=Affine(STEP, 0, 8.10 - STEP / 2, 0, STEP, 47.00 - STEP / 2))
write("two_bands.tif", np.stack([HEIGHTS, HEIGHTS]))
write("complex.tif", HEIGHTS, "complex64")
with rasterio.open(FOLDER / "no_place.tif", "w", driver="GTiff", dtype="int16", crs="EPSG:4326", count=1, height=6, width=8) as file:
    file.write(HEIGHTS.astype("int16")[None])
with rasterio.open(FOLDER / "scaled.tif", "w", driver="GTiff", dtype="int16", crs="EPSG:4326", transform=EDGES, nodata=-32768, count=1, height=6, width=8) as file:
    file.write(((HEIGHTS - 300) * 10).astype("int16")[None])
    file.scales, file.offsets, file.units = [0.1], [300.0], ["m"]
    file.set_band_description(1, "height")
    file.update_tags(STATISTICS_MEAN="1")
with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True), rasterio.open(FOLDER / "masked.tif", "w", driver="GTiff", dtype="int16", crs="EPSG:4326", transform=EDGES, count=1, height=6, width=8) as file:
    file.write(HEIGHTS.astype("int16")[None])
    mask = np.full((6, 8), 255, "uint8")
    mask[2, 3] = 0
    file.write_mask(mask)
