#!/usr/bin/env python3
"""Is the fused pose's covariance honest in closed loop?

Flies short trials of hover_conditions.py's conditions, a flight an axis and seed, and prints the
NEES of the pose's six degrees of freedom, averaged over the seeds at ten stamps: 6 when honest. A
cell inside the 99 % band of so many chi-square variables is plain, one below it is marked - (too
careful), one above + (too sure). What is already in the folder of results is not flown again.
"""

import argparse
import concurrent.futures
import csv
import math
import os
import pathlib
import sys

import hover_conditions

DEGREES_OF_FREEDOM = 6
STAMPS_S = range(1, 11)
SHORT = ["plant.station.level_reach_m=0.5", "plant.station.upright_reach_m=0.4"]


def band(count):
    """99 % of the mean of that many chi-square variables (Wilson, Hilferty 1931)."""
    k = DEGREES_OF_FREEDOM * count
    z = 2.576
    spread = 2 / (9 * k)
    return [k * (1 - spread + sign * z * math.sqrt(spread)) ** 3 / count for sign in (-1, 1)]


def nees_at_stamps(file):
    """(trial, stamp) -> NEES of the first image from that stamp on that has one."""
    found = {}
    with file.open() as rows:
        for row in csv.DictReader(line.lstrip("#") for line in rows):
            for stamp in STAMPS_S:
                key = (int(row["trial"]), stamp)
                if row["nees"] and float(row["t [s]"]) >= stamp and key not in found:
                    found[key] = float(row["nees"])
    return found


def print_table(condition, flights):
    print(f"{condition}, {len(flights)} seeds")
    print("  axis " + "".join(f"{stamp:>7} s" for stamp in STAMPS_S))
    inside = cells = 0
    for trial, axis in enumerate(hover_conditions.AXES):
        line = f"  {axis:5}"
        for stamp in STAMPS_S:
            values = [f[trial, stamp] for f in flights if (trial, stamp) in f]
            cells += 1
            if not values:
                line += f"{'none':>9}"
                continue
            low, high = band(len(values))
            mean = sum(values) / len(values)
            inside += low <= mean <= high
            line += f"{mean:8.2f}" + ("-" if mean < low else "+" if mean > high else " ")
        print(line)
    low, high = band(max(1, len(flights)))
    print(f"  band {low:.2f} to {high:.2f}: {inside} of {cells} cells inside")


def parse(arguments):
    root = hover_conditions.ROOT
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", type=pathlib.Path, default=root / "build/release/app/stillkite",
                        help="the program (default: build/release/app/stillkite)")
    parser.add_argument("--out", type=pathlib.Path, default=root / "out/consistency",
                        help="folder of results (default: out/consistency); one program's alone")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(1001, 1051)),
                        help="(default: 1001 to 1050)")
    parser.add_argument("--conditions", nargs="+", choices=hover_conditions.CONDITIONS,
                        default=["room"], metavar="CONDITION",
                        help=f"of {', '.join(hover_conditions.CONDITIONS)} (default: room)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="a key for all flights; needs a folder of its own")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time")
    options = parser.parse_args(arguments)
    options.set = SHORT + options.set
    return options


def main():
    options = parse(sys.argv[1:])
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for condition in options.conditions:
            list(pool.map(lambda seed: hover_conditions.fly(options, condition, "fused", seed),
                          options.seeds))
            print_table(condition, [nees_at_stamps(options.out / condition / f"fused-{seed}" / "estimates.csv")
                                    for seed in options.seeds])


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, KeyboardInterrupt, OSError) as error:
        sys.exit(f"hover_consistency: {error}")
