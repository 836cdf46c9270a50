#!/usr/bin/env python3
"""Error budget on flight_mat: truth, shutter, calibration and first climb.

Reads the folder of the study bench/studies/flight_mat.yaml, one change of configs/flight_mat.yaml at
a time, and prints median absolute errors and correlations. Then estimates the height of the mat from
optical flow and true velocities. STILLKITE_DATA names the folder with flight_mat.

  stillkite batch bench/studies/flight_mat.yaml && bench/flight_mat_residual.py out/flight_mat
"""

import csv
import math
import os
import pathlib
import statistics
import sys

from study_jobs import finished_jobs

AXES = ("vx", "vy", "vz", "wx", "wy", "wz")
FIRST_CLIMB = 200  # frames
TRUTH_WINDOW = 5  # frames: 80 ms, fitting window of the motion capture


def read_rows(path):
    with open(path) as file:
        return [row for row in csv.reader(file) if row and not row[0].startswith("#")]


def estimates(results):
    """Rows of estimates.csv as dictionaries, one per frame."""
    with open(results / "estimates.csv") as file:
        return list(csv.DictReader(file))


def column(rows, axis):
    unit = "m/s" if axis[0] == "v" else "rad/s"
    return [float(row[f"{axis}_camera [{unit}]"] or "nan") for row in rows]


def averaged(rows, window):
    """Centred moving average of the twists over `window` frames (equals a centred line fit)."""
    rows = [dict(row) for row in rows]
    for axis in AXES:
        values = column(rows, axis)
        unit = "m/s" if axis[0] == "v" else "rad/s"
        for i, row in enumerate(rows):
            neighbours = values[max(0, i - window // 2):i + window // 2 + 1]
            row[f"{axis}_camera [{unit}]"] = statistics.fmean(neighbours)
    return rows


def pairs_of(rows, truth, axis, first_frame):
    """(estimate, truth) of the frames with both."""
    stamps = [int(row["#timestamp [ns]"]) for row in rows]
    pairs = [(e, truth[t][AXES.index(axis)]) for e, t in zip(column(rows, axis), stamps) if t in truth]
    return [(e, t) for e, t in pairs[first_frame:] if math.isfinite(e)]


def print_row(name, rows, truth, first_frame=0):
    errors, correlations = [], []
    for axis in AXES:
        pairs = pairs_of(rows, truth, axis, first_frame)
        errors.append(statistics.median(abs(e - t) for e, t in pairs))
        correlations.append(statistics.correlation(*zip(*pairs)))
    values = ["/".join(f"{v:.3f}" for v in part)
              for part in (errors[:3], errors[3:], correlations[:3])]
    print(f"{name:48}" + "".join(f"{v:21}" for v in values), flush=True)


def mat_height(rows, truth, poses, axis):
    """c and gain of true velocity = gain * (z - c) * rate, rate in heights/s from optical flow.

    Linear in gain and gain * c; iteratively reweighted least squares against outliers."""
    samples = []
    for row, speed in zip(rows, column(rows, axis)):
        stamp = int(row["#timestamp [ns]"])
        if stamp in truth and stamp in poses and math.isfinite(speed):
            rate = speed / float(row["z [m]"])
            samples.append((poses[stamp] * rate, -rate, truth[stamp][AXES.index(axis)]))
    weights = [1.0] * len(samples)
    for _ in range(10):
        aa = sum(w * a * a for w, (a, b, y) in zip(weights, samples))
        ab = sum(w * a * b for w, (a, b, y) in zip(weights, samples))
        bb = sum(w * b * b for w, (a, b, y) in zip(weights, samples))
        ay = sum(w * a * y for w, (a, b, y) in zip(weights, samples))
        by = sum(w * b * y for w, (a, b, y) in zip(weights, samples))
        determinant = aa * bb - ab * ab
        gain, offset = (ay * bb - by * ab) / determinant, (aa * by - ab * ay) / determinant
        residuals = [y - gain * a - offset * b for a, b, y in samples]
        scale = 1.4826 * statistics.median(abs(r) for r in residuals)
        weights = [1 / (1 + (r / (2 * scale)) ** 2) for r in residuals]
    return offset / gain, gain


def initial_mat_height(rows, poses, frames=range(20, 101)):
    """c below the first frame, from the climb z - z_0 and the height ratio measured by optical flow.

    The height ratio over a plane is the determinant of the homography, independent of the normal."""
    stamps = [int(row["#timestamp [ns]"]) for row in rows]
    heights = [float(row["z [m]"]) for row in rows]
    z_0 = poses[stamps[0]]
    return statistics.median(z_0 - (poses[stamps[i]] - z_0) / (heights[i] / heights[0] - 1)
                             for i in frames if stamps[i] in poses)


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    if "STILLKITE_DATA" not in os.environ:
        sys.exit("flight_mat_residual: STILLKITE_DATA is not set; set it to the folder with flight_mat")
    data = pathlib.Path(os.environ["STILLKITE_DATA"]) / "flight_mat"
    truth = {int(r[0]): [float(v) for v in r[1:7]] for r in read_rows(data / "velocity.csv")}
    poses = {int(r[0]): float(r[3])
             for r in read_rows(data / "mav0/state_groundtruth_estimate0/data.csv")}
    print(f"{'':48}{'m/s':21}{'rad/s':21}{'correlation (v)':21}")
    runs = {job["configuration"]: estimates(results) for job, results in finished_jobs(sys.argv[1])}
    configured = runs.pop("configured")
    print_row("configured", configured, truth)
    print_row("  from frame 200, after the first climb", configured, truth, FIRST_CLIMB)
    print_row("  estimates averaged over 80 ms, as the truth", averaged(configured, TRUTH_WINDOW), truth)
    for name, rows in runs.items():
        print_row(name, rows, truth)
    print("\nheight c of the mat over the truth's z = 0, from true velocity = gain (z - c) x rate")
    for axis in AXES[:3]:
        height, gain = mat_height(configured, truth, poses, axis)
        print(f"  {axis}: c = {1000 * height:.0f} mm, gain {gain:.3f}")
    print(f"  at the initial position, from the first climb: {1000 * initial_mat_height(configured, poses):.0f} mm")


if __name__ == "__main__":
    main()
