#!/usr/bin/env python3
"""Consistency of the fused pose covariance in closed loop.

Reads the folder of a study of bench/studies/hover_conditions.yaml with short flights, one flight per
axis and seed. Prints the NEES of the pose's six degrees of freedom at ten stamps, averaged over the
seeds; 6 if consistent. Marks values outside the 99 % chi-square band: - below (pessimistic), + above
(optimistic).

  stillkite batch bench/studies/hover_conditions.yaml --only room --out out/consistency \\
    --set 'seeds={first: 1001, count: 50}' --set settings.plant.station.level_reach_m=0.5 \\
    --set settings.plant.station.vertical_reach_m=0.4
  bench/hover_consistency.py out/consistency
"""

import csv
import itertools
import math
import sys

from study_jobs import finished_jobs

DEGREES_OF_FREEDOM = 6
STAMPS_S = range(1, 11)
AXES = ("x", "y", "z")


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
    for trial, axis in enumerate(AXES):
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


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    jobs = finished_jobs(sys.argv[1])
    for condition, flown in itertools.groupby(jobs, key=lambda pair: pair[0]["configuration"]):
        print_table(condition, [nees_at_stamps(results / "estimates.csv") for _, results in flown])


if __name__ == "__main__":
    main()
