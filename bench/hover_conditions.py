#!/usr/bin/env python3
"""Position and estimation errors of the hold trials under named conditions.

One row per condition and policy, mean over the seeds, worst seed in brackets; each seed has one
flight along each of the paper's axes. Columns: mean |d| over all flights and along the worst axis,
cm; velocity RMSE, cm/s; position RMSE, cm; NEES of the pose's six degrees of freedom (6 if
consistent); ratio of measured frames, %. Results that already exist in the output folder are reused.

  room          configs/trials_fused.yaml
  calm          the same flights at the coast
  wind_3 ...    mean wind of 3, 6, 9 m/s with Dryden gusts
  sea           configs/trials_sea.yaml: waves, drift and wind
  yaw_kicks     yaw steps of 10 to 20 deg every 8 s
  weak_texture  scene contrast 10 %, unchanged noise
  sun           exposure ramp of 30 % over a flight, flicker of 5 %
  moving_objects  two people walking 2.7 m ahead, in the room
  excursion     no hold control: the drone follows its station over 20 m along x and z, at 1 m/s
"""

import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

HELD = ["trials.on=1", "trials.off=0"]
COAST = [*HELD, "scene=coast"]
WIND = "plant.wind.towards_deg=0"

# condition -> (configuration, keys)
CONDITIONS = {
    "room": ("trials_fused", HELD),
    "calm": ("trials_fused", COAST),
    "wind_3": ("trials_fused", [*COAST, "plant.wind.mean_m_s=3", WIND]),
    "wind_6": ("trials_fused", [*COAST, "plant.wind.mean_m_s=6", WIND]),
    "wind_9": ("trials_fused", [*COAST, "plant.wind.mean_m_s=9", WIND]),
    "sea": ("trials_sea", HELD),
    "yaw_kicks": ("trials_fused", [*COAST, "plant.yaw_kicks.every_s=8", "plant.yaw_kicks.smallest_deg=10"]),
    "weak_texture": ("trials_fused", [*COAST, "plant.contrast_ratio=0.1"]),
    "sun": ("trials_fused", [*COAST, "plant.camera.gain_ramp_ratio=0.3", "plant.camera.flicker_ratio=0.05"]),
    "moving_objects": ("trials_fused", [*HELD, "plant.moving_objects.count=2"]),
    "excursion": ("trials_fused", ["trials.on=0", "trials.off=1", "trials.estimate_off=true",
                                   "scene=coast", "plant.station.level_reach_m=20",
                                   "plant.station.speed_m_s=1"]),
}

AXES = ("x", "y", "z")


def displacement_cm(summary, axes):
    """Maximum of the mean |d| over these columns, cm; None for flights without hold control."""
    values = [summary["table"]["on"][axis]["mean_m"] for axis in axes]
    return max((100 * v for v in values if v is not None), default=None)


def estimate(key, factor):
    def value(summary):
        result = summary["estimate"][key]
        return None if result is None else factor * result
    return value


# heading, digits, value of a summary, worse of two values
COLUMNS = [
    ("mean abs(d), cm", 2, lambda s: displacement_cm(s, ["all"]), max),
    ("worst axis, cm", 2, lambda s: displacement_cm(s, AXES), max),
    ("velocity RMSE, cm/s", 2, estimate("velocity_rmse_m_s", 100), max),
    ("position RMSE, cm", 2, estimate("position_rmse_m", 100), max),
    ("NEES (6)", 1, estimate("nees_mean", 1), max),
    ("available, %", 1, estimate("available_ratio", 100), min),
]


def fly(options, condition, policy, seed):
    config, keys = CONDITIONS[condition]
    folder = options.out / condition / f"{policy}-{seed}"
    if not folder.exists():
        # an interrupted run writes a partial summary: rename only when finished
        unfinished = folder.with_name(folder.name + ".part")
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.parent.mkdir(parents=True, exist_ok=True)
        arguments = [options.command, "hover", ROOT / "configs" / f"{config}.yaml", "--out",
                     unfinished, "--jobs", "1"]
        for key in [*keys, f"estimator.policy={policy}", f"seed={seed}", *options.set]:
            arguments += ["--set", key]
        done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{condition}, {policy}, seed {seed}: {done.stderr.strip()}")
        unfinished.rename(folder)
    summary = json.loads((folder / "summary.json").read_text())
    values = "  ".join(cell([value(summary)], digits, worse) for _, digits, value, worse in COLUMNS)
    print(f"  {condition:12} {policy:10} seed {seed:<4} {values}", file=sys.stderr, flush=True)
    return summary


def cell(values, digits, worse):
    available = [v for v in values if v is not None]
    if not available:
        return "-"
    mean = sum(available) / len(available)
    return f"{mean:.{digits}f}" + (f" ({worse(available):.{digits}f})" if len(available) > 1 else "")


def print_table(options, flown):
    print("| condition | policy | seeds | " + " | ".join(heading for heading, *_ in COLUMNS) + " |")
    print("|---" * (3 + len(COLUMNS)) + "|")
    for condition in options.conditions:
        for policy in options.policies:
            rows = [flown[condition, policy, seed] for seed in options.seeds]
            cells = [cell([value(s) for s in rows], digits, worse) for _, digits, value, worse in COLUMNS]
            print(f"| {condition} | {policy} | {len(rows)} | " + " | ".join(cells) + " |")


def bound_95(values):
    """Upper 95 % confidence bound of the mean: Student's t (Abramowitz and Stegun, eq. 26.7.5)."""
    z, freedom = statistics.NormalDist().inv_cdf(0.95), len(values) - 1
    t = z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)
    return statistics.mean(values) + t * statistics.stdev(values) / math.sqrt(len(values))


def print_ratios(options, flown):
    first, *others = options.policies
    mean_m = {(c, p, s): displacement_cm(summary, ["all"]) for (c, p, s), summary in flown.items()}
    for condition in options.conditions:
        for policy in others:
            ratios = [mean_m[condition, policy, seed] / mean_m[condition, first, seed]
                      for seed in options.seeds if mean_m[condition, first, seed] and mean_m[condition, policy, seed]]
            if len(ratios) > 1:
                print(f"{condition}: {policy} / {first}, {len(ratios)} pairs: "
                      f"mean {statistics.mean(ratios):.3f}, 95 % bound {bound_95(ratios):.3f}")


def parse(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", type=pathlib.Path, default=ROOT / "build/release/app/stillkite",
                        help="stillkite executable (default: build/release/app/stillkite)")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/conditions",
                        help="output folder (default: out/conditions); one per executable")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="seeds (default: 1 2 3)")
    parser.add_argument("--conditions", nargs="+", choices=CONDITIONS, default=list(CONDITIONS),
                        metavar="CONDITION", help=f"{', '.join(CONDITIONS)} (default: all)")
    parser.add_argument("--policies", nargs="+", choices=["flow", "reference", "best", "fused"],
                        default=["fused"], metavar="POLICY",
                        help="flow, reference, best, fused (default: fused)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="configuration key for all flights; use a separate output folder")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel runs")
    return parser.parse_args(arguments)


def main():
    options = parse(sys.argv[1:])
    tasks = [(c, p, s) for c in options.conditions for p in options.policies for s in options.seeds]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        flown = dict(zip(tasks, pool.map(lambda task: fly(options, *task), tasks)))
    print_table(options, flown)
    print_ratios(options, flown)


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, KeyboardInterrupt, OSError) as error:
        sys.exit(f"hover_conditions: {error}")
