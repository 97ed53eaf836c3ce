"""A ground station that is not ours: loads a mission into a vehicle and reads it back.

usage: vehicle_ground_station.py mavsdk|pymavlink PORT ITEMS

The vehicle listens on a UDP port of this machine. Prints one JSON line: the
seconds that the upload took, and what was read back.
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"


def rows(count):
    """Sequence number, x, y, z of waypoints."""
    return [(seq, 363000000 + 100 * seq, -842500000 - 70 * seq, 480.25) for seq in range(count)]


def with_mavsdk(port, count):
    from mavsdk import ComponentType, Configuration, Mavsdk
    from mavsdk.plugins.mission_raw import MissionItem, MissionRaw

    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(f"udpout://127.0.0.1:{port}")
    system = mavsdk.first_autopilot(10.0)
    mission = MissionRaw(system)
    items = [
        MissionItem(seq, 0, 16, int(seq == 0), 1, 0.0, 0.0, 0.0, 0.0, x, y, z, 0)
        for seq, x, y, z in rows(count)
    ]
    began = time.monotonic()
    mission.upload_mission(items)
    seconds = time.monotonic() - began
    return seconds, [(item.seq, item.x, item.y, item.z) for item in mission.download_mission()]


def with_pymavlink(port, count):
    from pymavlink import mavutil

    link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=254)
    link.mav.heartbeat_send(6, 8, 0, 0, 4)
    link.wait_heartbeat(timeout=10)
    target = (link.target_system, link.target_component)
    items = rows(count)
    began = time.monotonic()
    link.mav.mission_count_send(*target, count, 0)
    while True:
        message = link.recv_match(
            type=["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"], blocking=True, timeout=5
        )
        if message.get_type() == "MISSION_ACK":
            assert message.type == 0, message
            break
        seq, x, y, z = items[message.seq]
        current = int(seq == 0)
        link.mav.mission_item_int_send(*target, seq, 0, 16, current, 1, 0, 0, 0, 0, x, y, z, 0)
    seconds = time.monotonic() - began
    link.mav.mission_request_list_send(*target, 0)
    total = link.recv_match(type="MISSION_COUNT", blocking=True, timeout=5).count
    read = []
    for seq in range(total):
        link.mav.mission_request_int_send(*target, seq, 0)
        item = link.recv_match(type="MISSION_ITEM_INT", blocking=True, timeout=5)
        read.append((item.seq, item.x, item.y, item.z))
    link.mav.mission_ack_send(*target, 0, 0)
    return seconds, read


def main():
    tool, port, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    seconds, items = {"mavsdk": with_mavsdk, "pymavlink": with_pymavlink}[tool](port, count)
    print(json.dumps({"seconds": seconds, "items": items}), flush=True)


main()
