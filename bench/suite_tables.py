"""Tables of bench/real_suite."""

import collections

from suite_figures import CONSISTENCY, ERRORS, FIGURES, statistics
from suite_recordings import PRIORS


def text(value):
    return "-" if value is None else f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def is_prior(variant):
    return any(variant.endswith(prior) for prior in PRIORS)


def summary_of(runs):
    """{figure: Statistics} over {variant: figures}."""
    summary = {}
    for name, figure in FIGURES.items():
        values = {variant: figures[name] for variant, figures in runs.items()
                  if name in CONSISTENCY or not is_prior(variant)}
        summary[name] = statistics(figure, values)
    return summary


def print_block(title, summary, names_worst):
    print(f"\n{title}\n{'':28}{'median':>10}{'90 %':>10}{'worst':>10}{'missing':>9}")
    for name, row in summary.items():
        if row.median is None:
            continue
        cells = "".join(f"{text(value):>10}" for value in (row.median, row.percentile_90, row.worst))
        print(f"{FIGURES[name].label:28}{cells}{row.missing:>9}{'  ' + row.worst_of if names_worst else ''}")
    absent = [FIGURES[name].label for name, row in summary.items() if row.median is None]
    if absent:
        print(f"{'-':>38}  {len(absent)} figures: {', '.join(absent)}")


def verdicts_of(runs):
    """Shares of the frames of all variants."""
    counts = collections.Counter()
    for figures in runs.values():
        counts.update(figures["verdicts"])
    total = sum(counts.values())
    return ", ".join(f"{verdict} {100 * n / total:.1f} %" for verdict, n in counts.most_common() if n)


def print_each(runs):
    columns = list(ERRORS)
    print(f"{'':28}" + "".join(f"{name:>14}" for name in columns))
    for variant, figures in runs.items():
        print(f"{variant:28}" + "".join(f"{text(figures[name]):>14}" for name in columns))


def as_json(summary):
    return {name: vars(row) for name, row in summary.items()}


def print_development(tree, each):
    figures = {}
    for recording, policies in sorted(tree.items()):
        for policy, runs in policies.items():
            summary = summary_of(runs)
            print_block(f"development, {recording}, {policy}, {len(runs)} variants", summary, True)
            print(f"verdicts: {verdicts_of(runs)}")
            if each:
                print_each(runs)
            figures.setdefault(recording, {})[policy] = as_json(summary)
    return figures


def print_judging(tree):
    """Aggregate per policy over all variants of all recordings, and of all simulated flights."""
    pooled = {}
    for recording, policies in tree.items():
        origin = "simulated" if recording.startswith("simulated") else "recorded"
        for policy, runs in policies.items():
            pooled.setdefault((origin, policy), {}).update({f"{recording} {v}": f for v, f in runs.items()})
    figures = {}
    for (origin, policy), runs in sorted(pooled.items()):
        summary = summary_of(runs)
        print_block(f"judging, {origin}, {policy}, {len(runs)} variants", summary, False)
        figures.setdefault(origin, {})[policy] = as_json(summary)
        for row in figures[origin][policy].values():
            del row["worst_of"]
    return figures
