"""Recorded figures of bench/real_suite and the comparison with them."""

import json

from suite_figures import FIGURES

# On one machine the figures are reproducible to the last digit. Another compiler or processor changes the order of
# floating-point sums, which flips single decisions (inlier, keyframe, gate). Two priors changed by 1e-4 relative
# change the medians of the short form by at most 0.8 %, the worst variants by at most 1.5 % or one frame.
TOLERANCES = {"median": 0.1, "worst": 0.25}


def record(file, summary):
    file.write_text(json.dumps(figures_of(summary), indent=1) + "\n")


def figures_of(summary):
    """{"PART RECORDING POLICY FIGURE STATISTIC": value}"""
    return {f"{part} {recording} {policy} {name} {statistic}": round_value(row[statistic])
            for part, recordings in summary.items()
            for recording, policies in recordings.items()
            for policy, figures in policies.items()
            for name, row in figures.items() if not name.endswith("_ratio")
            for statistic in (*TOLERANCES, "missing")}


def round_value(value):
    return None if value is None else float(f"{value:.4g}")


def limit_of(key, was):
    *_, name, statistic = key.split()
    if statistic == "missing":
        return was
    figure = FIGURES[name]
    margin = max(figure.floor, TOLERANCES[statistic] * abs(was))
    return was + margin if figure.high_is_worse else was - margin


def regressions(file, summary):
    """Messages; figures of recordings that did not run are not compared."""
    now = figures_of(summary)
    ran = {tuple(key.split()[:2]) for key in now}
    found = []
    for key, was in json.loads(file.read_text()).items():
        if was is None or tuple(key.split()[:2]) not in ran:
            continue
        limit, value = limit_of(key, was), now.get(key)
        figure = FIGURES[key.split()[-2]]
        if value is None:
            found.append(f"{key}: was {was}, is missing")
        elif (value > limit) if figure.high_is_worse or key.endswith("missing") else (value < limit):
            found.append(f"{key}: was {was}, is {value}, limit {limit:.4g}")
    return found
