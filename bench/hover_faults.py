#!/usr/bin/env python3
"""Position error of the hold controller under sensor and video faults, one fault per flight and axis.

Reads the folder of a study of bench/studies/hover_faults.yaml. Requirements: during the fault the
displacement of the drone exceeds that of its station by at most 0.3 m; within 5 s after the fault the
position error is permanently below 10 cm; all commands are finite. Columns, each for x, y and z:

  excess   maximum displacement of the drone since the fault began, less the station's, m
  settled  time from the end of the fault until the error stays below 10 cm, s; -: never
  error    position error 5 s after the end of the fault, m

  stillkite batch bench/studies/hover_faults.yaml && bench/hover_faults.py out/hover_faults
"""

import csv
import math
import sys

from study_jobs import finished_jobs

START_S, DURATION_S = 6.0, 3.0
MAX_ERROR_M, MAX_SETTLING_S, MAX_EXCESS_M = 0.10, 5.0, 0.3


def flights(folder):
    """Samples of each flight: (time, displacement, station, verdict, commands)."""
    made = {}
    with open(folder / "samples.csv", encoding="utf-8") as file:
        for row in csv.reader(line for line in file if not line.startswith("#")):
            numbers = [float(v) for v in row[1:8]]
            made.setdefault(row[0], []).append(
                (numbers[0], numbers[1:4], numbers[4:7], row[9], [float(v) for v in row[12:16]]))
    return list(made.values())


def evaluate(samples):
    """(excess, settling time or None, error after 5 s, verdicts during the fault)."""
    end_s = START_S + DURATION_S
    during = [s for s in samples if START_S <= s[0] < end_s]
    after = [s for s in samples if s[0] >= end_s]
    first = during[0]
    excess = max(math.dist(s[1], first[1]) - math.dist(s[2], first[2]) for s in during)
    unsettled = [s[0] for s in after if math.hypot(*s[1]) > MAX_ERROR_M]
    settled = 0.0 if not unsettled else None if unsettled[-1] == after[-1][0] else unsettled[-1] - end_s
    error = next(math.hypot(*s[1]) for s in after if s[0] >= end_s + MAX_SETTLING_S)
    verdicts = sorted({s[3] for s in samples if START_S <= s[0] < end_s + 1} - {"ok", "first_frame"})
    if not all(math.isfinite(v) for s in samples for v in s[4]):
        raise SystemExit("hover_faults: samples.csv contains a non-finite command")
    return max(0.0, excess), settled, error, verdicts


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    print("| kind | seed | excess, m | settled, s | error after 5 s, m | verdicts | passed |\n"
          "|---|---|---|---|---|---|---|")
    for job, folder in finished_jobs(sys.argv[1]):
        results = [evaluate(samples) for samples in flights(folder)]
        passed = all(excess <= MAX_EXCESS_M and settled is not None and settled <= MAX_SETTLING_S
                     for excess, settled, _, _ in results)
        cells = [", ".join(f"{r[0]:.2f}" for r in results),
                 ", ".join("-" if r[1] is None else f"{r[1]:.1f}" for r in results),
                 ", ".join(f"{r[2]:.2f}" for r in results),
                 ", ".join(sorted({t for r in results for t in r[3]})) or "none"]
        print(f"| {job['configuration']} | {job['seed']} | {' | '.join(cells)} | {'yes' if passed else 'no'} |")


if __name__ == "__main__":
    main()
