#!/usr/bin/env python3
"""Policy fused with the sliding window under one sensor fault per flight; neither height nor attitude given.

  bench/inertial_faults.py OUT [--seeds N] [--only FAULT,...] [--set KEY=VALUE,...]

Flights by hand in a room, 15 s, in motion from the first image. Used are the metric positions with verdict ok or
still. Columns; two values: median and worst run:

  used       runs with such a position
  diverged   of these, runs with a position error above 10 % of the path, with more than 10 % of the positions beyond
             5 sigma, or, if the fault must be refused, with such positions in more than 10 % of the frames
  ATE        after alignment of position and yaw, mm
  5 sigma    share of positions beyond 5 sigma, %; displacement from the first frame
  metric     time until the estimate is metric, s
  ok         share of frames with verdict ok or still since then, %
  error      of the parameter of the fault; of the clock after 10 s
  named      runs with a message that names the fault; without a fault with any message about IMU or mount

--only selects faults by the beginnings of their names; --set: keys of `stillkite simulate` for all flights, such as
flight.rest_s=2 or scene=coast. Simulated flights in OUT are used again.
"""

import argparse
import bisect
import csv
import json
import math
import os
import pathlib
import re
import statistics
import subprocess
import sys
from dataclasses import dataclass
from typing import Callable

from sliding_window import DATA, ROOT, STILLKITE, absolute_trajectory_error_m, stillkite

CHI_SQUARE_5_SIGMA = 31.8  # three degrees of freedom
MAX_ERROR_RATIO = 0.1  # of the path
MAX_RATIO = 0.1  # of the frames
LEVER_ARM_M = (0.08, 0.0, 0.06)  # length of 0.1 m
CLOCK_OFFSET_S = 0.06
NUMBER = r"([-+]?[\d.]+)"
FLIGHT = ["flight.duration_s=15", "flight.rest_s=0", f"camera.lever_arm_m={list(LEVER_ARM_M)}"]
AXES = ("source.end_s=8",)  # slow: an initialization is attempted with every frame
SENSORS_ONLY = ["camera.width_px=16", "camera.height_px=16"]


@dataclass
class Run:
    messages: str
    rows: list  # of estimates.csv
    truth: dict
    summary: dict

    def used(self):
        """Metric frames with verdict ok or still."""
        return [row for row in self.rows
                if row["x [m]"] and row["scale"] != "none" and row["verdict"] in ("ok", "still")]

    def pose_of(self, row):
        return self.truth[stamp_s(row)]


def stamp_s(row):
    return round(int(row["#timestamp [ns]"]) * 1e-9, 6)


def up_in_body(q):
    w, x, y, z = q
    return (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))


def yaw_of(q):
    w, x, y, z = q
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def attitude_of(row):
    return [float(row[f"q{axis} []"]) for axis in "wxyz"]


def numbers_in(pattern, run):
    found = re.search(pattern, run.messages)
    return [float(value) for value in found.groups()] if found else None


def clock_error(run):
    value = numbers_in(rf"set imu\.time_offset_s to {NUMBER}", run)
    return 1e3 * abs(value[0]) if value else None


def lever_arm_error(run):
    value = numbers_in(rf"the camera is at \({NUMBER}, {NUMBER}, {NUMBER}\) m", run)
    return 1e3 * math.dist(value, LEVER_ARM_M) if value else None


def rate_error(run):
    return math.degrees(math.hypot(*run.summary["evaluation"]["angular_rate_median_abs_error_rad_s"]))


def tilt_error(run):
    errors = [math.dist(up_in_body(attitude_of(row)), up_in_body(run.pose_of(row)[1])) for row in run.used()]
    return math.degrees(math.sqrt(statistics.fmean(e * e for e in errors))) if errors else None


@dataclass
class Fault:
    images: tuple = ()  # settings of the simulated images and sensors
    sensors: tuple = ()  # of the IMU alone
    run: tuple = ()
    columns: tuple = tuple(range(7))  # of the IMU's log
    message: str | None = None  # names the fault
    parameter: tuple[str, Callable] | None = None  # unit, error
    is_refused: bool = False


FAULTS = {
    "none": Fault(message=r"imu\.path|imu:|mount:"),
    "IMU gap 0.45 s": Fault(sensors=("imu.gap_s=0.45", "imu.gap_every_s=5"), message="gap"),
    "IMU at 10 Hz": Fault(sensors=("imu.rate_hz=10",), message="readings per second"),
    "clock 60 ms": Fault(run=(f"imu.time_offset_s={CLOCK_OFFSET_S}", "source.end_s=10"), message="its clock is",
                         parameter=("ms", clock_error)),
    "gyro bias 5 deg/s": Fault(sensors=("imu.gyro_bias_rad_s=0.0873",),
                               parameter=("deg/s", rate_error)),
    "lever arm 10 cm": Fault(run=("mount.down_deg=10",), message="the camera is at",
                             parameter=("mm", lever_arm_error)),
    "bank 15 deg": Fault(images=("flight.roll_deg=15",), parameter=("deg", tilt_error)),
    "no gravity": Fault(sensors=("imu.removes_gravity=true",), message="gravity is missing", is_refused=True),
    "axes rotated about z": Fault(run=(*AXES, "imu.rotation_wxyz=[0.70710678, 0, 0, 0.70710678]"), message="axes",
                                  is_refused=True),
    "axes rotated about x": Fault(run=(*AXES, "imu.rotation_wxyz=[0.70710678, 0.70710678, 0, 0]"), message="axes",
                                  is_refused=True),
    "axes x, y swapped": Fault(run=AXES, columns=(0, 2, 1, 3, 5, 4, 6), message="axes", is_refused=True),
}


def simulated(options, settings, seed):
    keys = [*FLIGHT, *options.set, f"seed={seed}", *settings]
    folder = options.out / "flights" / file_name(" ".join(keys))
    if not (folder / "run.yaml").exists():
        stillkite("simulate", ROOT / "configs/simulate_room.yaml", *sets(keys), "--out", folder)
    return folder


def file_name(text):
    return re.sub(r"[^\w.=]+", "_", text)


def sets(keys):
    return [part for key in keys for part in ("--set", key)]


def write_log(log, columns, out):
    out.parent.mkdir(parents=True, exist_ok=True)
    header, *rows = log.read_text().splitlines()
    swapped = [",".join(row.split(",")[column] for column in columns) for row in rows]
    out.write_text("\n".join([header, *swapped, ""]))


def poses_of(truth):
    """{stamp, s: (position, quaternion wxyz)} of a TUM file."""
    rows = [list(map(float, line.split())) for line in truth.read_text().splitlines() if line[:1] not in ("", "#")]
    return {round(row[0], 6): (row[1:4], [row[7], *row[4:7]]) for row in rows}


def fly(options, name, seed):
    fault, out = FAULTS[name], options.out
    flight = simulated(options, fault.images, seed)
    imu = simulated(options, (*fault.images, *SENSORS_ONLY, *fault.sensors), seed) if fault.sensors else flight
    folder = out / "runs" / file_name(f"{name} {seed}")
    log = out / "logs" / file_name(f"{name} {seed}.csv")
    write_log(imu / "imu0/data.csv", fault.columns, log)
    keys = ["fusion.solver=window", "initial.from_truth=false", f"imu.path={log}", *fault.run]
    run = subprocess.run([STILLKITE, "run", flight / "run.yaml", *sets(keys), "--out", folder], capture_output=True,
                         text=True, env={**os.environ, "STILLKITE_DATA": str(DATA)})
    truth = poses_of(flight / "truth.tum")
    if run.returncode:
        return Run(run.stderr, [], truth, {})
    with open(folder / "estimates.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return Run(run.stderr, rows, truth, json.loads((folder / "summary.json").read_text()))


def errors_from_start(run):
    """(position error, squared normalized error) per used frame. The world's origin is 1 m below the first frame;
    its yaw is the first frame's, taken from the first used one."""
    used = run.used()
    first = run.truth[min(run.truth)][0]
    yaw = yaw_of(attitude_of(used[0])) - yaw_of(run.pose_of(used[0])[1])
    c, s = math.cos(yaw), math.sin(yaw)
    for row in used:
        x, y, z = (a - b for a, b in zip(run.pose_of(row)[0], first))
        error = [float(row[f"{axis} [m]"]) - t for axis, t in zip("xyz", (c * x - s * y, s * x + c * y, z + 1))]
        yield math.hypot(*error), sum((e / float(row[f"sd_{axis} [m]"]))**2 for axis, e in zip("xyz", error))


@dataclass
class Figures:
    named: bool
    used: bool = False
    diverged: bool = False
    ate_mm: float | None = None
    beyond: float | None = None
    metric_s: float | None = None
    ok: float | None = None
    error: float | None = None


def figures_of(run, fault):
    named = bool(fault.message and re.search(fault.message, run.messages))
    used = run.used()
    if len(used) < 2:
        return Figures(named)
    errors = list(errors_from_start(run))
    beyond = statistics.fmean(e > CHI_SQUARE_5_SIGMA for _, e in errors)
    positions = [run.truth[stamp][0] for stamp in sorted(run.truth)]
    path_m = sum(map(math.dist, positions, positions[1:]))
    pairs = [([float(row[f"{axis} [m]"]) for axis in "xyz"], run.pose_of(row)[0]) for row in used]
    since = bisect.bisect_left([stamp_s(row) for row in run.rows], stamp_s(used[0]))
    is_wrong = max(e for e, _ in errors) > MAX_ERROR_RATIO * path_m or beyond > MAX_RATIO
    is_accepted = len(used) > MAX_RATIO * len(run.rows)
    return Figures(named, used=True, diverged=is_accepted if fault.is_refused else is_wrong,
                   ate_mm=1e3 * absolute_trajectory_error_m(pairs), beyond=100 * beyond,
                   metric_s=stamp_s(used[0]) - stamp_s(run.rows[0]), ok=100 * len(used) / (len(run.rows) - since),
                   error=fault.parameter[1](run) if fault.parameter else None)


def median_and_worst(figures, key, form, worst=max):
    values = [getattr(f, key) for f in figures if getattr(f, key) is not None]
    return f"{statistics.median(values):{form}}, {worst(values):{form}}" if values else "-"


HEADER = ("fault", "runs", "used", "diverged", "ATE mm", "5 sigma %", "metric s", "ok %", "error", "named")
LINE = "{:<20}  {:>4}  {:>4}  {:>8}  {:>10}  {:>9}  {:>10}  {:>8}  {:>16}  {:>5}"


def row_of(name, figures):
    fault = FAULTS[name]
    error = median_and_worst(figures, "error", ".1f" if fault.parameter and fault.parameter[0] == "mm" else ".2f")
    cells = [name, len(figures), sum(f.used for f in figures), sum(f.diverged for f in figures),
             median_and_worst(figures, "ate_mm", ".1f"), median_and_worst(figures, "beyond", ".1f"),
             median_and_worst(figures, "metric_s", ".2f"), median_and_worst(figures, "ok", ".0f", min),
             error + (f" {fault.parameter[0]}" if fault.parameter else ""),
             sum(f.named for f in figures) if fault.message else "-"]
    return LINE.format(*cells)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--only", type=lambda text: tuple(text.split(",")), default=tuple(FAULTS))
    parser.add_argument("--set", type=lambda text: text.split(","), default=[])
    options = parser.parse_args()
    print(LINE.format(*HEADER))
    for name in (name for name in FAULTS if name.startswith(options.only)):
        figures = []
        for seed in range(1, options.seeds + 1):
            figures.append(figures_of(fly(options, name, seed), FAULTS[name]))
            print(f"{name}, seed {seed} of {options.seeds}: {figures[-1]}", file=sys.stderr)
        print(row_of(name, figures), flush=True)


if __name__ == "__main__":
    main()
