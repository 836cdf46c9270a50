#!/usr/bin/env python3
"""Flies one fault a flight along each axis and prints what the hold made of it.

Asked for: while the fault lasts the drone goes no further than its station has gone since it
began and 0.3 m; 5 s after its end it is within 10 cm of its place, to stay; every command is a
number. Columns, each for x, y and z:

  beyond   the drone's way since the fault began less the station's, at its largest (0: never)
  back     from the fault's end until it is within 10 cm to stay; - where the flight ends before
  off      from its place 5 s after the fault's end, in m

What is already in the folder of results is not flown again.
"""

import argparse
import csv
import math
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
START_S, DURATION_S = 6.0, 3.0
HOME_M, SETTLED_S, MOST_BEYOND_M = 0.10, 5.0, 0.3
AXES = 3  # an interrupted run has fewer flights
AMOUNTS = {"height_step": ["plant.fault.floor_rise_m=1"]}
KINDS = ["every_third_frame_lost", "stamps_off", "height_step", "gyro_bias", "frozen_video",
         "tether_slack", "picture_dark", "reference_blind", "flow_blind"]


def fly(options, kind, seed):
    folder = options.out / f"{kind}-{seed}"
    if not (folder / "samples.csv").exists() or len(flights(folder)) < AXES:
        keys = ["plant.station.level_reach_m=0.8", f"plant.fault.start_s={START_S}",
                f"plant.fault.duration_s={DURATION_S}", f"plant.fault.kind={kind}", f"seed={seed}",
                *AMOUNTS.get(kind, []), *options.set]
        words = [word for key in keys for word in ("--set", key)]
        done = subprocess.run([options.command, "hover", ROOT / "configs" / "trials_faults.yaml",
                               "--out", folder, *words], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(done.stderr.strip())
    return folder


def flights(folder):
    """Samples of each flight: (time, displacement, station, verdict, commands)."""
    made = {}
    with open(folder / "samples.csv", encoding="utf-8") as file:
        for row in csv.reader(line for line in file if not line.startswith("#")):
            numbers = [float(v) for v in row[1:8]]
            made.setdefault(row[0], []).append(
                (numbers[0], numbers[1:4], numbers[4:7], row[9], [float(v) for v in row[12:16]]))
    return list(made.values())


def judge(samples):
    """(beyond, seconds until back or None, off after 5 s, verdicts of the fault)."""
    end_s = START_S + DURATION_S
    during = [s for s in samples if START_S <= s[0] < end_s]
    after = [s for s in samples if s[0] >= end_s]
    first = during[0]
    beyond = max(math.dist(s[1], first[1]) - math.dist(s[2], first[2]) for s in during)
    away = [s[0] for s in after if math.hypot(*s[1]) > HOME_M]
    back = 0.0 if not away else None if away[-1] == after[-1][0] else away[-1] - end_s
    off = next(math.hypot(*s[1]) for s in after if s[0] >= end_s + SETTLED_S)
    told = sorted({s[3] for s in samples if START_S <= s[0] < end_s + 1} - {"ok", "first_frame"})
    if not all(math.isfinite(v) for s in samples for v in s[4]):
        raise SystemExit("a command is not a number")
    return max(0.0, beyond), back, off, told


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", default=ROOT / "build/release/app/stillkite", type=pathlib.Path)
    parser.add_argument("--out", default=pathlib.Path("out/faults"), type=pathlib.Path)
    parser.add_argument("--kinds", nargs="+", default=KINDS)
    parser.add_argument("--seeds", nargs="+", type=int, default=[1])
    parser.add_argument("--set", action="append", default=[], help="key=value, as for stillkite")
    options = parser.parse_args()
    print("| kind | seed | beyond, m | back, s | off after 5 s, m | told by | met |\n"
          "|---|---|---|---|---|---|---|")
    for kind in options.kinds:
        for seed in options.seeds:
            results = [judge(samples) for samples in flights(fly(options, kind, seed))]
            met = all(beyond <= MOST_BEYOND_M and back is not None and back <= SETTLED_S
                      for beyond, back, _, _ in results)
            cells = [", ".join(f"{r[0]:.2f}" for r in results),
                     ", ".join("-" if r[1] is None else f"{r[1]:.1f}" for r in results),
                     ", ".join(f"{r[2]:.2f}" for r in results),
                     ", ".join(sorted({t for r in results for t in r[3]})) or "nothing"]
            print(f"| {kind} | {seed} | {' | '.join(cells)} | {'yes' if met else 'no'} |", flush=True)


if __name__ == "__main__":
    main()
