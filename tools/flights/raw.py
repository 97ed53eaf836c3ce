"""A launcher of its own, for missions that the verdict rejects: uploaded and flown as they are."""

import os
import time

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402

MAV = mavutil.mavlink


def connect(address):
    link = mavutil.mavlink_connection(address, source_system=255, source_component=190)
    link.wait_heartbeat(timeout=60)
    return link


def upload(link, rows):
    """The rows of a `.waypoints` file, home first."""
    fields = [row.split("\t") for row in rows]
    link.mav.mission_count_send(link.target_system, 1, len(fields), 0)
    until = time.monotonic() + 60
    while time.monotonic() < until:
        message = link.recv_match(type=["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"], blocking=True, timeout=2)
        if message is None:
            continue
        if message.get_type() == "MISSION_ACK":
            if message.type == 0:
                return
            raise OSError(f"the mission is refused: {message.type}")
        f = fields[message.seq]
        values = [float(x) for x in f[4:8]]
        link.mav.mission_item_int_send(link.target_system, 1, message.seq, int(f[2]), int(f[3]), 0, 1, *values,
                                       round(float(f[8]) * 1e7), round(float(f[9]) * 1e7), float(f[10]), 0)
    raise OSError("no answer to the mission")


def command(link, number, *values):
    values = [*values, *[0] * (7 - len(values))]
    for _ in range(40):
        link.mav.command_long_send(link.target_system, 1, number, 0, *values)
        answer = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=1)
        if answer is not None and answer.command == number and answer.result == 0:
            return
        time.sleep(0.3)
    raise OSError(f"command {number} is refused")


def set_parameter(link, name, value):
    for _ in range(20):
        link.mav.param_set_send(link.target_system, 1, name.encode(), value, MAV.MAV_PARAM_TYPE_REAL32)
        answer = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=1)
        if answer is not None and answer.param_id == name:
            return
    raise OSError(f"parameter {name} is not set")


def fly_copter(address, rows, parameters, most_s):
    fly("copter", address, rows, parameters, most_s)


# The numbers of the modes to arm in and to fly the mission in.
MODES = {"copter": (4, 3), "plane": (5, 10)}


def fly(kind, address, rows, parameters, most_s):
    """Flies until it has landed or so many seconds of its own time have passed since its start."""
    link = connect(address)
    for name, value in parameters.items():
        set_parameter(link, name, value)
    ready = MAV.MAV_SYS_STATUS_PREARM_CHECK
    while True:
        link.mav.request_data_stream_send(link.target_system, 1, MAV.MAV_DATA_STREAM_ALL, 4, 1)
        status = link.recv_match(type="SYS_STATUS", blocking=True, timeout=2)
        if status and status.onboard_control_sensors_health & ready and status.onboard_control_sensors_present & ready:
            break
    upload(link, rows)
    armed_in, auto = MODES[kind]
    command(link, MAV.MAV_CMD_DO_SET_MODE, 1, armed_in)
    command(link, MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    command(link, MAV.MAV_CMD_DO_SET_MODE, 1, auto)
    if kind == "copter":
        command(link, MAV.MAV_CMD_MISSION_START)
    began = None
    while True:
        message = link.recv_match(type=["GLOBAL_POSITION_INT", "HEARTBEAT"], blocking=True, timeout=10)
        if message is None:
            raise OSError("the vehicle is silent")
        if message.get_type() == "HEARTBEAT":
            is_armed = message.base_mode & MAV.MAV_MODE_FLAG_SAFETY_ARMED
            if began and message.get_srcComponent() == 1 and not is_armed:
                break
            continue
        began = began or message.time_boot_ms
        if message.time_boot_ms - began > 1000 * most_s:
            break
    link.close()
