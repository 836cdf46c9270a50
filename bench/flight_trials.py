#!/usr/bin/env python3
"""Navigation errors on the flow paper's flight, simulated over several grounds and seeds.

One row per trial: median over seeds and grounds, worst in brackets. Results that already exist in the
output folder are reused.

  clean        true initial state
  tilt         same images, initial roll error of 1 deg
  paper        same images, paper mode (configs/paper.yaml)
  relief       terrain relief of 5 m
  disturbed    exposure ramp of 30 %, flicker, a vehicle on 4 % of the image

Ablations:

  last-frame   clean, aligned to the previous frame instead of a keyframe
  unlevelled   tilt, without correction of roll and pitch by the plane normal
  first-order  clean, tiles shifted without warp
  plain        disturbed, uniform tile weights
"""

import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import threading

ROOT = pathlib.Path(__file__).resolve().parent.parent

# trial -> (configuration of the simulation, folder of the flight's images, keys set for the run)
TRIALS = {
    "clean": ("simulate_paper", "flat", []),
    "tilt": ("simulate_paper", "flat", []),
    "paper": ("simulate_paper", "flat", []),
    "relief": ("simulate_relief", "relief", []),
    "disturbed": ("simulate_disturbed", "disturbed", []),
    "last-frame": ("simulate_paper", "flat", ["navigator.keyframes.enabled=false"]),
    "unlevelled": ("simulate_paper", "flat", ["navigator.levelling.enabled=false"]),
    "first-order": ("simulate_paper", "flat", ["navigator.alignment.exact_warp=false"]),
    "plain": ("simulate_disturbed", "disturbed", ["navigator.alignment.solver.robust=false"]),
}
INITIAL_ROLL_ERROR = ("tilt", "unlevelled")

# printed columns: heading, unit, value of a trial's results
COLUMNS = [
    ("position RMS", "m", lambda r: r["evaluation"]["position_rmse_m"]),
    ("end error", "% of path", lambda r: r["evaluation"]["drift_percent"]),
    ("end error", "% of height", lambda r: 100 * r["end_error_m"] / r["initial_height_m"]),
    ("tilt RMSE", "deg", lambda r: math.degrees(r["evaluation"]["tilt_rmse_rad"])),
    ("end tilt error", "deg", lambda r: math.degrees(r["end_tilt_rad"])),
    ("velocity RMSE", "m/s, worst axis", lambda r: max(r["evaluation"]["velocity_rmse_m_s"])),
    ("frames rejected", "", lambda r: r["frames"]["rejected"]),
]

printing = threading.Lock()


def stillkite(command, *arguments):
    """Standard output of the command; RuntimeError if it fails."""
    done = subprocess.run([str(command), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"stillkite {arguments[0]} failed: {done.stderr.strip()}")
    return done.stdout


def tum_ends(path):
    """First and last pose of a TUM file: (position, quaternion x y z w)."""
    rows = [row.split() for row in path.read_text().splitlines() if row and row[0] != "#"]
    return [([float(v) for v in row[1:4]], [float(v) for v in row[4:8]]) for row in (rows[0], rows[-1])]


def up_in_body(quaternion):
    """World z axis in the body frame (roll and pitch)."""
    x, y, z, w = quaternion
    return (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))


def angle_between(a, b):
    cross = math.hypot(
        a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return math.atan2(cross, sum(p * q for p, q in zip(a, b)))


def initial_pose_with_roll_error(truth, error_deg):
    """First true pose with a roll error, as --set arguments."""
    position, (x, y, z, w) = truth[0]
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = math.asin(2 * (w * y - z * x))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    keys = {"from_truth": "false", "height_m": position[2], "yaw_deg": math.degrees(yaw),
            "pitch_deg": math.degrees(pitch), "roll_deg": math.degrees(roll) + error_deg}
    return [word for key, value in keys.items() for word in ("--set", f"initial.{key}={value}")]


def simulate(options, config, folder, seed, ground):
    if (folder / "run.yaml").exists():
        return
    folder.parent.mkdir(parents=True, exist_ok=True)
    photograph = [] if ground is None else ["--set", f"ground.photograph={ground}"]
    stillkite(options.command, "simulate", ROOT / "configs" / f"{config}.yaml", "--out", folder,
              "--set", f"seed={seed}", "--set", f"flight.duration_s={options.duration}", *photograph)


def navigate(options, trial, flight, results):
    truth = tum_ends(flight / "truth.tum")
    if not (results / "summary.json").exists():
        if trial == "paper":
            arguments = [ROOT / "configs" / "paper.yaml"]
            for key, name in (("source", "flight.mp4"), ("truth", "truth.tum")):
                arguments += ["--set", f"{key}.path={flight / name}"]
        else:
            arguments = [flight / "run.yaml"]
        if trial in INITIAL_ROLL_ERROR:
            arguments += initial_pose_with_roll_error(truth, 1)
        arguments += [word for key in TRIALS[trial][2] for word in ("--set", key)]
        stillkite(options.command, "run", *arguments, "--out", results)
    result = json.loads((results / "summary.json").read_text())
    end = tum_ends(results / "trajectory.tum")[1]
    result["end_error_m"] = math.dist(end[0], truth[1][0])
    result["end_tilt_rad"] = angle_between(up_in_body(end[1]), up_in_body(truth[1][1]))
    result["initial_height_m"] = truth[0][0][2]
    return result


def fly(options, images, seed, ground):
    """Simulates one flight and runs all trials on it."""
    name = "own" if ground is None else ground.stem
    flight = options.out / "flights" / f"{images}-{name}-{seed}"
    trials = [t for t in options.trials if TRIALS[t][1] == images]
    simulate(options, TRIALS[trials[0]][0], flight, seed, ground)
    all_results = []
    for trial in trials:
        result = navigate(options, trial, flight, options.out / options.label / f"{trial}-{name}-{seed}")
        values = "  ".join(f"{column[2](result):.4g}" for column in COLUMNS)
        with printing:
            print(f"  {trial:12} {name:18} seed {seed:<4} {values}", file=sys.stderr, flush=True)
        all_results.append((trial, name, result))
    return all_results


def print_table(all_results):
    print("| trial | ground | flights | " + " | ".join(f"{h}, {u}".strip(", ") for h, u, _ in COLUMNS) + " |")
    print("|---" * (3 + len(COLUMNS)) + "|")
    for trial in TRIALS:
        grounds = sorted({ground for t, ground, _ in all_results if t == trial}, key=lambda g: (g != "own", g))
        for chosen in ([[g] for g in grounds] + ([grounds] if len(grounds) > 1 else [])):
            rows = [result for t, ground, result in all_results if t == trial and ground in chosen]
            cells = []
            for _, _, value in COLUMNS:
                values = [value(row) for row in rows]
                cells.append(f"{statistics.median(values):.3g} ({max(values):.3g})")
            print(f"| {trial} | {chosen[0] if len(chosen) == 1 else 'all'} | {len(rows)} | " + " | ".join(cells) + " |")


def parse(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", type=pathlib.Path, default=ROOT / "build/release/app/stillkite",
                        help="stillkite executable (default: build/release/app/stillkite)")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/trials",
                        help="folder of flights and results (default: out/trials); 0.2 GB per flight")
    parser.add_argument("--label", default="results", help="subfolder of the results, one per executable")
    parser.add_argument("--seeds", type=int, nargs="+", default=[11, 12, 13, 14, 15],
                        help="seeds; 1 to 10 were used for tuning (default: 11 to 15)")
    parser.add_argument("--photographs", type=pathlib.Path, nargs="*", default=[],
                        help="additional ground textures: aerial images")
    parser.add_argument("--trials", nargs="+", choices=TRIALS, default=list(TRIALS), metavar="TRIAL",
                        help=f"{', '.join(TRIALS)} (default: all)")
    parser.add_argument("--duration", type=float, default=150, help="duration of a flight, s (default: 150)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel flights")
    return parser.parse_args(arguments)


def main():
    options = parse(sys.argv[1:])
    image_sets = list(dict.fromkeys(TRIALS[trial][1] for trial in options.trials))
    tasks = [(images, seed, ground) for images in image_sets for seed in options.seeds
             for ground in [None, *options.photographs]]
    all_results = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done in concurrent.futures.as_completed([pool.submit(fly, options, *t) for t in tasks]):
            all_results += done.result()
    print_table(all_results)


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, KeyboardInterrupt, OSError) as error:
        sys.exit(f"flight_trials: {error}")
