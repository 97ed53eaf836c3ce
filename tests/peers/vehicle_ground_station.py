"""A ground station that is not ours: loads a mission into a vehicle and reads it back.

usage: vehicle_ground_station.py mavsdk|pymavlink PORT ITEMS [clear]

The vehicle listens on a UDP port of this machine. Prints one JSON line: the
seconds that the upload took (null if it failed), what was read back (likewise),
and what went wrong. With `clear` the mission is cleared in the end.
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"

# How long pymavlink, which has no mission protocol of its own, is let try, seconds.
PATIENCE_S = 8
# Whether the mission is cleared in the end.
CLEAR = sys.argv[4:] == ["clear"]


def rows(count):
    """Sequence number, x, y, z of waypoints."""
    return [(seq, 363000000 + 100 * seq, -842500000 - 70 * seq, 480.25) for seq in range(count)]


def with_mavsdk(port, count, result):
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
    result["seconds"] = time.monotonic() - began
    result["items"] = [(item.seq, item.x, item.y, item.z) for item in mission.download_mission()]
    if CLEAR:
        mission.clear_mission()


def with_pymavlink(port, count, result):
    from pymavlink import mavutil

    link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=254)
    link.mav.heartbeat_send(6, 8, 0, 0, 4)
    link.wait_heartbeat(timeout=10)
    target = (link.target_system, link.target_component)
    items = rows(count)
    began = time.monotonic()
    answers = ["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"]

    def receive(kinds):
        """The next message of these kinds for us, or None after 1.5 s."""
        message = link.recv_match(type=kinds, blocking=True, timeout=1.5)
        if message is None:
            link.mav.heartbeat_send(6, 8, 0, 0, 4)
        return message

    message = None
    while message is None:
        link.mav.mission_count_send(*target, count, 0)
        message = receive(answers)
        assert time.monotonic() < began + PATIENCE_S, "no answer to MISSION_COUNT"
    while message is None or message.get_type() != "MISSION_ACK" or message.type == 13:
        assert time.monotonic() < began + PATIENCE_S, "the upload does not end"
        if message is not None and message.get_type() != "MISSION_ACK":
            seq, x, y, z = items[message.seq]
            current = int(seq == 0)
            link.mav.mission_item_int_send(*target, seq, 0, 16, current, 1, 0, 0, 0, 0, x, y, z, 0)
        message = receive(answers)
    assert message.type == 0, message
    result["seconds"] = time.monotonic() - began
    total = None
    while total is None:
        link.mav.mission_request_list_send(*target, 0)
        total = receive("MISSION_COUNT")
        assert time.monotonic() < began + 2 * PATIENCE_S, "no answer to MISSION_REQUEST_LIST"
    read = []
    while len(read) < total.count:
        link.mav.mission_request_int_send(*target, len(read), 0)
        item = receive("MISSION_ITEM_INT")
        if item is not None and item.seq == len(read):
            read.append((item.seq, item.x, item.y, item.z))
        assert time.monotonic() < began + 2 * PATIENCE_S, "the download does not end"
    link.mav.mission_ack_send(*target, 0, 0)
    result["items"] = read
    if CLEAR:
        link.mav.mission_clear_all_send(*target, 0)
        answer = receive("MISSION_ACK")
        assert answer is not None and answer.type == 0, answer


def main():
    tool, port, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    result = {"seconds": None, "items": None, "error": None}
    try:
        {"mavsdk": with_mavsdk, "pymavlink": with_pymavlink}[tool](port, count, result)
    except Exception as error:  # whatever it is, the test judges what it means
        result["error"] = repr(error)
    print(json.dumps(result), flush=True)


main()
