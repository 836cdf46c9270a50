#!/usr/bin/env python3
"""Consistency of the fused pose covariance in closed loop.

Flies short trials of hover_conditions.py's conditions, one flight per axis and seed. Prints the NEES
of the pose's six degrees of freedom at ten stamps, averaged over the seeds; 6 if consistent. Marks
values outside the 99 % chi-square band: - below (pessimistic), + above (optimistic). Results that
already exist in the output folder are reused.
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
SHORT = ["plant.station.level_reach_m=0.5", "plant.station.vertical_reach_m=0.4"]


def band(count):
    """99 % band of the mean of `count` chi-square variables (Wilson and Hilferty 1931)."""
    k = DEGREES_OF_FREEDOM * count
    z = 2.576
    spread = 2 / (9 * k)
    return [k * (1 - spread + sign * z * math.sqrt(spread)) ** 3 / count for sign in (-1, 1)]


def nees_at_stamps(file):
    """(trial, stamp) -> first NEES at or after the stamp."""
    nees = {}
    with file.open() as rows:
        for row in csv.DictReader(line.lstrip("#") for line in rows):
            for stamp in STAMPS_S:
                key = (int(row["trial"]), stamp)
                if row["nees"] and float(row["t [s]"]) >= stamp and key not in nees:
                    nees[key] = float(row["nees"])
    return nees


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
    print(f"  band {low:.2f} to {high:.2f}: {inside} of {cells} values inside")


def parse(arguments):
    root = hover_conditions.ROOT
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", type=pathlib.Path, default=root / "build/release/app/stillkite",
                        help="stillkite executable (default: build/release/app/stillkite)")
    parser.add_argument("--out", type=pathlib.Path, default=root / "out/consistency",
                        help="output folder (default: out/consistency); one per executable")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(1001, 1051)),
                        help="seeds (default: 1001 to 1050)")
    parser.add_argument("--conditions", nargs="+", choices=hover_conditions.CONDITIONS,
                        default=["room"], metavar="CONDITION",
                        help=f"{', '.join(hover_conditions.CONDITIONS)} (default: room)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="configuration key for all flights; use a separate output folder")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel runs")
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
