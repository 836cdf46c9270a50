#!/usr/bin/env python3
"""Writes OUT/tilted/*.yaml: the flat flights of bench/studies/flights.yaml with an initial roll error of 1 deg.

  bench/tilted_flights.py out/flights
"""

import math
import pathlib
import sys

ROLL_ERROR_DEG = 1


def first_pose(truth):
    """(height, yaw, pitch, roll in degrees) of the first row of a TUM file."""
    row = next(row for row in truth.read_text().splitlines() if row and row[0] != "#")
    z, qx, qy, qz, w = (float(v) for v in row.split()[3:8])
    yaw = math.atan2(2 * (w * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
    pitch = math.asin(2 * (w * qy - qz * qx))
    roll = math.atan2(2 * (w * qx + qy * qz), 1 - 2 * (qx * qx + qy * qy))
    return z, *map(math.degrees, (yaw, pitch, roll))


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    folder = pathlib.Path(sys.argv[1]).resolve()
    (folder / "tilted").mkdir(exist_ok=True)
    for flight in sorted((folder / "jobs").glob("flat-*/")):
        height_m, yaw, pitch, roll = first_pose(flight / "truth.tum")
        (folder / "tilted" / f"tilted-{flight.name}.yaml").write_text(
            f"source: {{path: {flight / 'flight.mp4'}}}\n"
            f"calibration: {{path: {flight / 'sensor.yaml'}}}\n"
            f"truth: {{path: {flight / 'truth.tum'}}}\n"
            f"initial: {{height_m: {height_m}, yaw_deg: {yaw}, pitch_deg: {pitch}, roll_deg: {roll + ROLL_ERROR_DEG}}}\n")


if __name__ == "__main__":
    main()
