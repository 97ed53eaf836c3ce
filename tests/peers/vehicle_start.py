"""A ground station that is not ours: loads a short mission, arms, starts it, and watches.

usage: vehicle_start.py mavsdk|pymavlink ardupilot|px4 PORT

The vehicle listens on a UDP port of this machine. Prints one JSON line: whether it was
armed, the greatest height above home (metres) and greatest item that were seen, and what
went wrong.
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"

# How long the flight is watched, seconds of the clock on the wall.
WATCH_S = 25.0
HOME_X, HOME_Y = 363000000, -842500000


def rows(autopilot):
    """Command, latitude, longitude, altitude: up, away, and stay."""
    items = [(22, HOME_X, HOME_Y, 30.0), (16, HOME_X + 3000, HOME_Y, 30.0), (17, HOME_X + 9000, HOME_Y, 30.0)]
    if autopilot == "ardupilot":
        items.insert(0, (16, HOME_X, HOME_Y, 400.5))
    return items


def with_mavsdk(autopilot, port, result):
    from mavsdk import ComponentType, Configuration, Mavsdk
    from mavsdk.plugins.action import Action
    from mavsdk.plugins.mission_raw import MissionItem, MissionRaw
    from mavsdk.plugins.telemetry import Telemetry

    items = [
        MissionItem(seq, 3, command, int(seq == 0), 1, 0.0, 0.0, 0.0, 0.0, x, y, z, 0)
        for seq, (command, x, y, z) in enumerate(rows(autopilot))
    ]
    for attempts_left in reversed(range(6)):
        mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
        mavsdk.add_any_connection(f"udpout://127.0.0.1:{port}")
        system = mavsdk.first_autopilot(10.0)
        mission, action, telemetry = MissionRaw(system), Action(system), Telemetry(system)
        try:
            mission.upload_mission(items)
            break
        except Exception as error:
            # MAVSDK asks a vehicle that it meets for its version, once: when it misses the
            # answer, it takes the vehicle for too old until it meets it anew. Transfers
            # have tests of their own; here they are tried again.
            result["again"] = repr(error)
            if attempts_left == 0:
                raise
    action.arm()
    mission.start_mission()
    began = time.monotonic()
    while time.monotonic() < began + WATCH_S:
        result["armed"] = result["armed"] or telemetry.armed()
        result["height_m"] = max(result["height_m"], telemetry.position().relative_altitude_m)
        result["item"] = max(result["item"], mission.mission_progress().current)
        time.sleep(0.1)


def with_pymavlink(autopilot, port, result):
    from pymavlink import mavutil

    link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=254)
    link.mav.heartbeat_send(6, 8, 0, 0, 4)
    link.wait_heartbeat(timeout=10)
    target = (link.target_system, link.target_component)
    items = rows(autopilot)
    link.mav.mission_count_send(*target, len(items), 0)
    message = None
    while message is None or message.get_type() != "MISSION_ACK":
        if message is not None:
            command, x, y, z = items[message.seq]
            link.mav.mission_item_int_send(
                *target, message.seq, 3, command, int(message.seq == 0), 1, 0, 0, 0, 0, x, y, z, 0
            )
        message = link.recv_match(
            type=["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"], blocking=True, timeout=3
        )
        assert message is not None, "the upload does not end"
    assert message.type == 0, message

    def order(command, *params):
        params = list(params) + [0] * (7 - len(params))
        link.mav.command_long_send(*target, command, 0, *params)
        ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=3)
        assert ack is not None and ack.command == command and ack.result == 0, ack

    if autopilot == "ardupilot":
        order(176, 1, 4)
        order(400, 1)
        order(300)
    else:
        order(400, 1)
        order(176, 1, 4, 4)
    began = time.monotonic()
    while time.monotonic() < began + WATCH_S:
        message = link.recv_match(
            type=["HEARTBEAT", "GLOBAL_POSITION_INT", "MISSION_CURRENT"], blocking=True, timeout=1
        )
        if message is None:
            continue
        kind = message.get_type()
        if kind == "HEARTBEAT":
            result["armed"] = result["armed"] or bool(message.base_mode & 128)
        elif kind == "GLOBAL_POSITION_INT":
            result["height_m"] = max(result["height_m"], message.relative_alt / 1000)
        else:
            result["item"] = max(result["item"], message.seq)


def main():
    tool, autopilot, port = sys.argv[1], sys.argv[2], int(sys.argv[3])
    result = {"armed": False, "height_m": 0.0, "item": 0, "error": None}
    try:
        {"mavsdk": with_mavsdk, "pymavlink": with_pymavlink}[tool](autopilot, port, result)
    except Exception as error:  # whatever it is, the test judges what it means
        result["error"] = repr(error)
    print(json.dumps(result), flush=True)


main()
