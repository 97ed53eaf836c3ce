"""A vehicle that flies to a stop and back over the same line, some centimetres beside it, exactly as planned: prints
what `tools/campaign` says of it as JSON."""

import json
import pathlib
import sys
from types import SimpleNamespace

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

from flights.tube import Tube, compare  # noqa: E402

M_PER_DEG, SPEED_MPS, FAR_M, UP_M = 110_574.0, 5.0, 200.0, 50.0
# When it is up, at its stop, off again, back, and down.
UP_S, THERE_S = 10.0, 10.0 + FAR_M / SPEED_MPS
AWAY_S = THERE_S + float(sys.argv[1])
BACK_S = AWAY_S + FAR_M / SPEED_MPS
DOWN_S = BACK_S + 20


def place(t, north_m, up_m, row):
    return {"lat_deg": north_m / M_PER_DEG, "lon_deg": 0.0, "amsl_m": up_m, "t_s": t, "item": row}


def segment(row, *ends):
    a, b = (place(*end, row) for end in ends)
    return {"from": a, "to": b, "flown": True, "error_m": 0.0}


segments = [
    segment(1, (0.0, 0.0, 0.0), (UP_S, 0.0, UP_M)),
    segment(2, (UP_S, 0.0, UP_M), (THERE_S, FAR_M, UP_M)),
    segment(2, (THERE_S, FAR_M, UP_M), (AWAY_S, FAR_M, UP_M)),
    segment(3, (AWAY_S, FAR_M, UP_M), (BACK_S, 0.0, UP_M)),
    segment(4, (BACK_S, 0.0, UP_M), (DOWN_S, 0.0, 0.0)),
]
times = [0, UP_S, THERE_S, AWAY_S, BACK_S, DOWN_S]
t = np.arange(0, DOWN_S, 0.1)
late_s = float(sys.argv[2])
north = np.interp(t - late_s, times, [0, 0, FAR_M, FAR_M, 0, 0])
up = np.interp(t - late_s, times, [0, UP_M, UP_M, UP_M, UP_M, 0])
row = np.searchsorted([0, UP_S + late_s, AWAY_S + late_s, BACK_S + late_s], t, side="right")
wobble = 1e-6 * np.sin(t)
truth = SimpleNamespace(t=t, t0_s=0.0, lat=north / M_PER_DEG, lon=wobble, amsl=up + 0.1 * np.cos(3 * t), row=np.maximum(row, 1), texts=[])
tube = Tube({"segments": segments, "takeoff_early_s": 0.0, "takeoff_late_s": 1.0})
figures, escapes = compare(tube, truth, 10.0)
print(json.dumps({"escapes": escapes, "late_s": figures["late_s"]}))
