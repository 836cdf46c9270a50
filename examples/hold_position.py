#!/usr/bin/env python3
"""Position hold on the estimates of a live flight: prints velocity commands in the world, m/s.

  stillkite fly flight.yaml --set live.json=- | examples/hold_position.py
"""

import json
import sys

GAIN_1_S = 0.5  # commanded velocity per metre of displacement
MAX_M_S = 0.5
MEASURED = {"ok", "first_frame", "still"}


def command_m_s(position_m, reference_m):
    command = [GAIN_1_S * (r - p) for p, r in zip(position_m, reference_m)]
    norm = sum(c * c for c in command) ** 0.5
    return [c * min(1, MAX_M_S / norm) if norm > 0 else 0.0 for c in command]


reference_m = None
for line in sys.stdin:
    estimate = json.loads(line)
    position_m = [estimate[axis] for axis in ("x", "y", "z")]
    # without a scale there is no position in metres; a predicted one is not held
    if estimate["verdict"] not in MEASURED or None in position_m:
        print("hold: no measured position,", estimate["verdict"], flush=True)
        continue
    reference_m = reference_m or position_m
    print(["%.3f" % c for c in command_m_s(position_m, reference_m)], flush=True)
