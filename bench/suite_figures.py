"""Figures of a run of bench/real_suite and their statistics over the variants."""

import dataclasses
import math

DEGREES = 180 / math.pi


def number(entry, path):
    """Value of a dotted path; None if it or a value above it is missing."""
    for key in path.split("."):
        entry = entry.get(key) if isinstance(entry, dict) else None
    return entry


def norm(*values):
    return None if None in values else math.hypot(*values)


def scaled(path, factor=1.0):
    def read(entry):
        value = number(entry, path)
        return None if value is None else factor * value
    return read


def vector(path, factor=1.0):
    def read(entry):
        value = number(entry, path)
        return None if value is None else factor * norm(*value)
    return read


def attitude_deg(entry):
    parts = (number(entry, f"evaluation.{axis}_rmse_rad") for axis in ("tilt", "yaw"))
    angle = norm(*parts)
    return None if angle is None else DEGREES * angle


@dataclasses.dataclass(frozen=True)
class Figure:
    label: str
    read: object
    high_is_worse: bool = True
    floor: float = 0  # differences below it are no regression


ERRORS = {
    "position": Figure("position RMSE, % of path", scaled("evaluation.position_rmse_percent"), floor=0.05),
    "position_m": Figure("position RMSE, m", scaled("evaluation.position_rmse_m"), floor=0.005),
    "rpe": Figure("RPE over 1 m, %", scaled("evaluation.relative.per_metre.translation_rmse_m", 100), floor=0.1),
    "velocity": Figure("velocity RMSE, m/s", vector("evaluation.velocity_rmse_m_s"), floor=0.005),
    "rates": Figure("rate RMSE, deg/s", vector("evaluation.angular_rate_rmse_rad_s", DEGREES), floor=0.05),
    "attitude": Figure("attitude RMSE, deg", attitude_deg, floor=0.05),
    "availability": Figure("availability, %", scaled("availability_ratio", 100), False, floor=1),
}
GROUPS = {"position": "position", "attitude": "attitude", "velocity": "velocity", "rates": "angular_rate"}
CONSISTENCY = {}
for name, group in GROUPS.items():
    path = f"evaluation.consistency.{group}."
    CONSISTENCY[f"{name}_beyond_3"] = Figure(
        f"{name} beyond 99.73 %, %", scaled(path + "share_beyond_3_sigma", 100), floor=3)
    CONSISTENCY[f"{name}_beyond_5"] = Figure(
        f"{name} beyond 5 sigma, %", scaled(path + "share_beyond_5_sigma", 100), floor=3)
    CONSISTENCY[f"{name}_ratio"] = Figure(
        f"{name} sigma / RMS error", scaled(path + "sigma_over_rms"), False, floor=0.1)
FIGURES = {**ERRORS, **CONSISTENCY}


def figures_of(entry):
    """Figures of one estimator of comparison.json, and the verdicts' counts."""
    return {name: figure.read(entry) for name, figure in FIGURES.items()} | {"verdicts": entry["verdicts"]}


NO_FIGURES = dict.fromkeys(FIGURES) | {"verdicts": {}}  # of a job that failed


def quantile(ordered, share):
    at = share * (len(ordered) - 1)
    low = math.floor(at)
    return ordered[low] + (at - low) * (ordered[min(low + 1, len(ordered) - 1)] - ordered[low])


@dataclasses.dataclass(frozen=True)
class Statistics:
    """Over variants; None without a value. `worst_of` names one, if it differs from the median."""
    median: float
    percentile_90: float
    worst: float
    worst_of: str
    missing: int


def statistics(figure, values):
    """Statistics of {variant: value or None}; the percentile lies towards the worse values."""
    known = {variant: value for variant, value in values.items() if value is not None}
    missing = len(values) - len(known)
    if not known:
        return Statistics(None, None, None, "", missing)
    ordered = sorted(known.values(), reverse=not figure.high_is_worse)
    worst = max(known, key=known.get) if figure.high_is_worse else min(known, key=known.get)
    median = quantile(ordered, 0.5)
    return Statistics(median, quantile(ordered, 0.9), ordered[-1], worst if known[worst] != median else "", missing)
