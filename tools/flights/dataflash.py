"""ArduPilot's dataflash log, as much of it as the truth of a simulator needs."""

import re
import struct

import numpy as np

HEAD = b"\xa3\x95"
FORMATS = {"a": "64s", "b": "b", "B": "B", "h": "h", "H": "H", "i": "i", "I": "I", "f": "f", "d": "d", "n": "4s",
           "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "M": "B", "q": "q", "Q": "Q",
           "g": "2s"}
SCALES = {"c": 0.01, "C": 0.01, "e": 0.01, "E": 0.01, "L": 1e-7}


def read(data, names):
    """The messages of these names: for each a dictionary of lists by field."""
    kinds, found = {128: ("FMT", 89, None, None)}, {name: None for name in names}
    at, end = 0, len(data)
    while at + 3 <= end:
        kind = kinds.get(data[at + 2])
        if data[at : at + 2] != HEAD or kind is None:
            at = data.find(HEAD, at + 1)
            if at < 0:
                break
            continue
        name, length, layout, fields = kind
        if at + length > end:
            break
        if name == "FMT":
            number, size, own, letters, columns = struct.unpack_from("<BB4s16s64s", data, at + 3)
            own, letters, columns = (text.rstrip(b"\0").decode() for text in (own, letters, columns))
            if all(letter in FORMATS for letter in letters):
                kinds[number] = (own, size, struct.Struct("<" + "".join(FORMATS[c] for c in letters)),
                                 list(zip(columns.split(","), letters)))
                if own in found and found[own] is None:
                    found[own] = {field: [] for field, _ in kinds[number][3]}
        elif found.get(name) is not None:
            for (field, letter), value in zip(fields, layout.unpack_from(data, at + 3)):
                if isinstance(value, bytes):
                    value = value.rstrip(b"\0").decode(errors="replace")
                found[name][field].append(value * SCALES[letter] if letter in SCALES else value)
        at += length
    return {name: columns or {} for name, columns in found.items()}


class Truth:
    """Where the simulator had the vehicle: times since boot in seconds, degrees, metres."""

    def __init__(self, path):
        found = read(path.read_bytes(), ["SIM", "MISE", "MSG", "EV"])
        sim, item = found["SIM"], found["MISE"]
        self.t = np.array(sim["TimeUS"]) * 1e-6
        self.lat, self.lon, self.amsl = (np.array(sim[name], float) for name in ("Lat", "Lng", "Alt"))
        # The navigation item that was begun last. A busy machine loses messages of a log, but none of its texts.
        started = [(t * 1e-6, row) for t, row, command in zip(item["TimeUS"], item["CNum"], item["CId"]) if command < 95]
        texts = zip(found["MSG"].get("TimeUS", []), found["MSG"].get("Message", []))
        said = [(t * 1e-6, int(begun.group(1))) for t, text in texts if (begun := re.match(r"Mission: (\d+) ", text))]
        started = sorted(started + [(t, row) for t, row in said if row not in item["CNum"]])
        # It leaves the ground when its first item is begun: how long the order took is no matter of the vehicle.
        self.t0_s = started[0][0]
        times, rows = np.array([t for t, _ in started]), np.array([0] + [row for _, row in started])
        self.row = rows[np.searchsorted(times, self.t, side="right")]
        self.texts = found["MSG"].get("Message", [])
