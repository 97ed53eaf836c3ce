"""Prints a spec of many simulated vehicles in lanes beside each other, for measurements.

usage: fleet_spec.py VEHICLES PORT [AUTOPILOT] > fleet.yaml

Without AUTOPILOT every second one is a PX4.
Their links are UDP ports of this machine from PORT on, as `sortie vehicles
fleet.yaml --port PORT` opens them.
"""

import sys

COUNT, PORT = int(sys.argv[1]), int(sys.argv[2])
AUTOPILOTS = sys.argv[3:4] * 2 or ["ardupilot", "px4"]
SOUTH, LANE = 36.0, 0.002

print(f"""sortie: 1
name: fleet
area:
  south_west: {{lat: {SOUTH - 0.01:.4f}, lon: -84.30}}
  north_east: {{lat: {SOUTH + LANE * COUNT + 0.01:.4f}, lon: -84.20}}
  min_agl_m: 60
  max_amsl_m: 800
terrain: {{flat: {{amsl_m: 300}}}}
planner: {{seed: 1, evaluations: 200}}
mission: {{max_items: 800, fence: false}}
vehicles:""")
for n in range(COUNT):
    lat = SOUTH + LANE * n
    print(f"""  - id: v{n + 1:03}
    sysid: {n + 1}
    autopilot: {AUTOPILOTS[n % 2]}
    link: udpout:127.0.0.1:{PORT + n}
    start: {{lat: {lat:.4f}, lon: -84.29, agl_m: 80}}
    goal:  {{lat: {lat:.4f}, lon: -84.21, agl_m: 80}}
    finish: land
    speed_mps: 12
    max_climb_deg: 15
    max_descent_deg: 10""")
