"""Reads one mission file with one independent reader and prints what it found as JSON.

usage: import_mission.py READER FILE, where READER is one of
  pymavlink           mavwp.MAVWPLoader (.waypoints)
  mavsdk-plan-A       MAVSDK import_qgroundcontrol_mission (.plan)
  mavsdk-waypoints-A  MAVSDK import_mission_planner_mission (.waypoints)
where A is the MAV_AUTOPILOT the connected vehicle claims to be (3 or 12).
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"
FIELDS = ["command", "frame", "autocontinue", "param1", "param2", "param3", "param4", "x", "y", "z"]


def listed(items):
    return [[getattr(item, field) for field in FIELDS] for item in items]


def pymavlink(path):
    from pymavlink import mavwp

    loader = mavwp.MAVWPLoader()
    loader.load(path)
    return {"mission": listed(loader.wp(index) for index in range(loader.count()))}


def mavsdk(kind, autopilot, path):
    from mavsdk import ComponentType, Configuration, Mavsdk
    from mavsdk.plugins.mission_raw import MissionRaw
    from pymavlink import mavutil

    station = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    station.add_any_connection("raw://")
    sender = mavutil.mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    heartbeat = sender.heartbeat_encode(2, autopilot, 0, 0, 3)
    deadline = time.monotonic() + 20

    # A system is there before its heartbeat says which autopilot it is: it would be read as none.
    def is_known():
        systems = station.get_systems()
        return systems and systems[0].autopilot_type().name != "UNKNOWN"

    while not is_known() and time.monotonic() < deadline:
        station.pass_received_raw_bytes(heartbeat.pack(sender))
        time.sleep(0.1)
    raw = MissionRaw(station.get_systems()[0])
    read = raw.import_qgroundcontrol_mission if kind == "plan" else raw.import_mission_planner_mission
    found = read(path)
    return {
        "mission": listed(found.mission_items),
        "fence": listed(found.geofence_items),
        "rally": listed(found.rally_items),
    }


def main():
    reader, path = sys.argv[1:]
    if reader == "pymavlink":
        found = pymavlink(path)
    else:
        _, kind, autopilot = reader.split("-")
        found = mavsdk(kind, int(autopilot), path)
    # NaN is not JSON: a string stands for it.
    text = json.dumps(found).replace("NaN", '"NaN"')
    print(text, flush=True)
    # Without the peers' slow farewells.
    os._exit(0)


main()
