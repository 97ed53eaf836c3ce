"""A vehicle by MAVSDK: its MissionRawServer at the other end of a UDP port.

usage: vehicle_mavsdk.py PORT SYSID

Prints "ready", then one JSON line for every list of items that was uploaded to
it, and runs until its standard input is closed.
"""

import json
import math
import sys

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.mission_raw_server import MissionRawServer


def number(value):
    """JSON has no NaN."""
    return None if math.isnan(value) else value


def incoming(result, plan, _data=None):
    items = [
        {
            "mission_type": item.mission_type,
            "seq": item.seq,
            "command": item.command,
            "frame": item.frame,
            "current": item.current,
            "autocontinue": item.autocontinue,
            "params": [number(p) for p in (item.param1, item.param2, item.param3, item.param4)],
            "x": item.x,
            "y": item.y,
            "z": number(item.z),
        }
        for item in plan.mission_items
    ]
    print(json.dumps({"result": int(result), "items": items}), flush=True)


def main():
    port, sysid = sys.argv[1], int(sys.argv[2])
    configuration = Configuration.create_with_component_type(ComponentType.AUTOPILOT)
    configuration.system_id = sysid
    mavsdk = Mavsdk(configuration)
    mavsdk.add_any_connection(f"udpout://127.0.0.1:{port}")
    server = MissionRawServer(mavsdk.server_component_by_type(ComponentType.AUTOPILOT))
    server.subscribe_incoming_mission(incoming)
    print("ready", flush=True)
    sys.stdin.read()


main()
