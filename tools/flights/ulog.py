"""PX4's log, as much of it as the truth of a simulator needs."""

import struct

import numpy as np

TYPES = {"int8_t": "b", "uint8_t": "B", "int16_t": "h", "uint16_t": "H", "int32_t": "i", "uint32_t": "I", "int64_t": "q",
         "uint64_t": "Q", "float": "f", "double": "d", "bool": "?", "char": "c"}
ARMED, AUTO_MISSION = 2, 3


def layout(text):
    """The structure of a format such as `uint64_t timestamp;float[3] x;`: names of its single fields."""
    letters, names = "<", []
    for part in filter(None, text.split(";")):
        kind, _, name = part.partition(" ")
        kind, _, count = kind.partition("[")
        if kind not in TYPES:
            return None
        count = int(count.rstrip("]") or 1) if count else 1
        # Padding at the end is not written.
        if not name.startswith("_padding"):
            letters += f"{count}{TYPES[kind]}" if count > 1 else TYPES[kind]
            names += [name] if count == 1 else [f"{name}[{n}]" for n in range(count)]
        else:
            letters += f"{count}x"
    return letters, names


def read(data, names):
    """The first instance of these topics as dictionaries of lists by field, the lines, the release."""
    formats, topics, found, lines, release = {}, {}, {name: {} for name in names}, [], None
    at = 16
    while at + 3 <= len(data):
        size, kind = struct.unpack_from("<HB", data, at)
        body = data[at + 3 : at + 3 + size]
        at += 3 + size
        if len(body) < size:
            break
        if kind == ord("F"):
            name, _, fields = body.decode().partition(":")
            formats[name] = layout(fields)
        elif kind == ord("A") and body[0] == 0:
            name = body[3:].decode()
            if name in found and formats.get(name):
                letters, fields = formats[name]
                topics[struct.unpack_from("<H", body, 1)[0]] = (struct.Struct(letters.rstrip("x0123456789")), fields, found[name])
        elif kind == ord("D"):
            topic = topics.get(struct.unpack_from("<H", body)[0])
            if topic and len(body) >= 2 + topic[0].size:
                for field, value in zip(topic[1], topic[0].unpack_from(body, 2)):
                    topic[2].setdefault(field, []).append(value)
        elif kind == ord("L"):
            lines.append(body[9:].decode(errors="replace"))
        elif kind == ord("I") and body[1:].startswith(b"uint32_t ver_sw_release"):
            release = struct.unpack("<I", body[-4:])[0]
    return found, lines, release


class Truth:
    """Where the simulator had the vehicle: times since boot in seconds, degrees, metres."""

    def __init__(self, path):
        place, status, mission = names = ("vehicle_global_position_groundtruth", "vehicle_status", "mission_result")
        found, self.texts, release = read(path.read_bytes(), names)
        place, status, mission = (found[name] for name in (place, status, mission))
        self.t = np.array(place["timestamp"]) * 1e-6
        self.lat, self.lon, self.amsl = (np.array(place[name], float) for name in ("lat", "lon", "alt"))
        flies = (np.array(status["arming_state"]) == ARMED) & (np.array(status["nav_state"]) == AUTO_MISSION)
        if not flies.any():
            raise ValueError("it never flew its mission")
        self.t0_s = float(np.array(status["timestamp"])[flies][0]) * 1e-6
        # Items are counted from 0, rows from the home at 0.
        times = np.array([self.t0_s] + [t * 1e-6 for t in mission["timestamp"]])
        rows = np.array([0, 1] + [seq + 1 for seq in mission["seq_current"]])
        order = np.argsort(np.maximum(times, self.t0_s), kind="stable")
        times = np.maximum(times, self.t0_s)[order]
        self.row = np.concatenate([rows[:1], rows[1:][order]])[np.searchsorted(times, self.t, side="right")]
        if release is not None:
            self.texts.insert(0, f"PX4 {release >> 24}.{release >> 16 & 255}.{release >> 8 & 255}")
