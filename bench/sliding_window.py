#!/usr/bin/env python3
"""Policy fused on flights with an IMU: sliding window without the initial height, with it, and with known height,
mount and clock, as the filter assumes them; filter.

  bench/sliding_window.py OUT                     EuRoC MH_01 from 0 to 6 s on, simulated room and coast, 3 seeds
  bench/sliding_window.py OUT SIMULATION.yaml...  and flights of these configurations of `stillkite simulate`

Printed per flight: time until the estimate is metric, ATE after alignment of position and yaw, velocity RMSE (3-D),
share of positions beyond 5 sigma, time per frame. Simulated flights in OUT are used again.
"""

import bisect
import csv
import json
import math
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
STILLKITE = ROOT / "build/release/app/stillkite"
DATA = pathlib.Path(os.environ.get("STILLKITE_DATA", ROOT / "../shared/data")).resolve()
SEEDS = (1, 2, 3)
SOLVERS = {"window, no height": ["fusion.solver=window", "navigator.sensors.start_height_sigma_ratio=1"],
           "window": ["fusion.solver=window"],
           "window, calibrated": ["fusion.solver=window", *(f"navigator.sensors.{key}" for key in (
               "start_height_sigma_ratio=0.001", "lever_arm_sigma_m=0.002",
               "camera_rotation_sigma_rad=0.0017", "time_offset_sigma_s=0.001"))],
           "filter": ["fusion.solver=filter"]}


def stillkite(*arguments):
    run = subprocess.run([STILLKITE, *map(str, arguments)], capture_output=True, text=True,
                         env={**os.environ, "STILLKITE_DATA": str(DATA)})
    if run.returncode:
        sys.exit(f"sliding_window: {run.stderr.strip()}")


def positions_of(truth):
    """{stamp, s: (x, y, z)} of a TUM or EuRoC file."""
    rows = [line.replace(",", " ").split() for line in truth.read_text().splitlines() if line[:1] not in ("", "#")]
    scale = 1e-9 if truth.suffix == ".csv" else 1
    return {float(row[0]) * scale: tuple(map(float, row[1:4])) for row in rows}


def nearest(stamps, t):
    i = bisect.bisect(stamps, t)
    return min(stamps[max(0, i - 1):i + 1], key=lambda stamp: abs(stamp - t))


def absolute_trajectory_error_m(pairs):
    """RMSE after the alignment of position and yaw by least squares (Umeyama 1991, about the vertical)."""
    means = [[sum(pair[k][axis] for pair in pairs) / len(pairs) for axis in range(3)] for k in (0, 1)]
    centred = [[[p - m for p, m in zip(pair[k], means[k])] for k in (0, 1)] for pair in pairs]
    yaw = math.atan2(sum(e[0] * t[1] - e[1] * t[0] for e, t in centred),
                     sum(e[0] * t[0] + e[1] * t[1] for e, t in centred))
    c, s = math.cos(yaw), math.sin(yaw)
    squared = sum((c * e[0] - s * e[1] - t[0])**2 + (s * e[0] + c * e[1] - t[1])**2 + (e[2] - t[2])**2
                  for e, t in centred)
    return math.sqrt(squared / len(pairs))


def figures_of(folder, truth):
    """Cells of one run; '-' for figures that it does not have."""
    with open(folder / "estimates.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    metric = [row for row in rows if row["x [m]"] and row["scale"] != "none" and row["verdict"] == "ok"]
    summary = json.loads((folder / "summary.json").read_text())
    if len(metric) < 2:
        return ["-"] * 4 + frame_times(summary)
    true = positions_of(truth)
    stamps = sorted(true)
    stamp_s = lambda row: int(row["#timestamp [ns]"]) * 1e-9
    pairs = [([float(row[f"{axis} [m]"]) for axis in "xyz"], true[nearest(stamps, stamp_s(row))]) for row in metric]
    evaluation = summary["evaluation"]
    velocity = evaluation["velocity_rmse_m_s"]
    position = (evaluation["consistency"] or {}).get("position")
    return [f"{stamp_s(metric[0]) - stamp_s(rows[0]):.2f}",
            f"{1e3 * absolute_trajectory_error_m(pairs):.1f}",
            f"{math.hypot(*velocity):.4f}" if velocity else "-",
            f"{100 * position['share_beyond_5_sigma']:.1f}" if position else "-"] + frame_times(summary)


def frame_times(summary):
    times = summary["timing"]["frame_ms"]
    return [f"{times['median']:.1f}", f"{times['p99']:.1f}"]


def flights(out, simulations):
    """(name, configuration, settings, truth)."""
    recording = ROOT / "bench/recordings/euroc_mh01.yaml"
    truth = DATA / "euroc_mh01/mav0/state_groundtruth_estimate0/data.csv"
    for start_s in range(7):
        yield f"MH_01 from {start_s} s", recording, [f"source.start_s={start_s}"], truth
    jobs = [(f"{scene} {seed}", ROOT / "configs/simulate_room.yaml",
             [f"scene={scene}", f"seed={seed}"] + (["flight.height_m=3"] if scene == "coast" else []))
            for scene in ("room", "coast") for seed in SEEDS]
    jobs += [(path.stem, path, []) for path in simulations]
    for name, config, settings in jobs:
        folder = out / name.replace(" ", "_")
        if not (folder / "run.yaml").exists():
            stillkite("simulate", config, *(part for key in settings for part in ("--set", key)), "--out", folder)
        yield name, folder / "run.yaml", [f"imu.path={folder / 'imu0/data.csv'}"], folder / "truth.tum"


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    out = pathlib.Path(sys.argv[1]).resolve()
    header = ("flight", "solver", "metric after s", "ATE mm", "velocity m/s", "beyond 5 sigma %", "ms median", "ms 99 %")
    line = "{:<18}  {:<17}  {:>14}  {:>7}  {:>12}  {:>16}  {:>9}  {:>7}"
    print(line.format(*header))
    for name, config, settings, truth in flights(out, [pathlib.Path(path).resolve() for path in sys.argv[2:]]):
        for solver, solver_keys in SOLVERS.items():
            folder = out / "runs" / f"{name}-{solver}".replace(" ", "_").replace(",", "")
            keys = ["estimator.policy=fused", *solver_keys, *settings]
            stillkite("run", config, *(part for key in keys for part in ("--set", key)), "--out", folder)
            print(line.format(name, solver, *figures_of(folder, truth)), flush=True)


if __name__ == "__main__":
    main()
