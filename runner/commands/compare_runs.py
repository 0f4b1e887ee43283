"""Runs side by side for `runner compare`: config, provenance, caveats and metrics."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from runner.commands.columns import COMPARED, aligned, comparison_cells, letter, number
from runner.texts import one_line

if TYPE_CHECKING:
    from runner.store import Run

# What a result may follow from beside its config; date, machine and command tell nothing about the physics.
_PROVENANCE = ("commit", "versions", "plant_step")


def print_runs(runs: "Sequence[Run]", metrics: Sequence[str]) -> None:
    """Print what each run but the first differs from the first in.

    Args:
        runs: The runs, two or more.
        metrics: Names of metrics; empty for all.

    Raises:
        RunnerError: If no run has one of these metrics.
    """
    from runner.sweeps.metric_names import check_metrics

    check_metrics(metrics, dict.fromkeys(name for run in runs for name in run.metrics))
    first = runs[0]
    for place, run in enumerate(runs[1:], 1):
        _print_two(first, run, letter(place), metrics, end="\n\n" if place < len(runs) - 1 else "\n")


def _print_two(a: "Run", b: "Run", name: str, metrics: Sequence[str], end: str) -> None:
    from runner import store
    from runner.comparison.beyond import beyond
    from runner.comparison.cells import one_cell
    from runner.comparison.side import side_of_run

    print(one_line(f"A  {_headline(a)}"), one_line(f"{name}  {_headline(b)}"), "", sep="\n")
    found = beyond(side_of_run("A", a), side_of_run(name, b), one_cell())
    print(one_line(found.in_words("A", name)))
    print(_differing("config", store.simulated_part(a.config), store.simulated_part(b.config), name))
    if a.urdf != b.urdf:
        print("  the text of robot.urdf differs")
    print(_differing("provenance", _provenance(a), _provenance(b), name))
    print(_caveats(a, b, name), end="\n\n")
    header = ["metric", "unit", "A", name, f"{name} - A", f"{name} / A"]
    print(aligned([header, *_metric_rows(a, b, metrics)], indent=""))
    print(f"\n{_paired(a, b, name, metrics)}", end=end)


def _headline(run: "Run") -> str:
    return f"{run.folder}  {run.failure_text or run.status}"


def _differing(what: str, a: Mapping[str, Any], b: Mapping[str, Any], name: str) -> str:
    """Return a table of the dotted keys in which two mappings differ, or that they are the same."""
    flat_a, flat_b = dict(_flatten(a)), dict(_flatten(b))
    rows = [
        [key, flat_a.get(key, "(absent)"), flat_b.get(key, "(absent)")]
        for key in dict.fromkeys([*flat_a, *flat_b])
        if flat_a.get(key) != flat_b.get(key)
    ]
    return f"{what} differs:\n{aligned([['key', 'A', name], *rows])}" if rows else f"same {what}"


def _flatten(value: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for key, item in value.items():
        if isinstance(item, Mapping):
            yield from _flatten(item, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", item if isinstance(item, str) else json.dumps(item)


def _provenance(run: "Run") -> dict[str, Any]:
    return {key: run.provenance[key] for key in _PROVENANCE if key in run.provenance}


def _caveats(a: "Run", b: "Run", name: str) -> str:
    """Return why either result may not be what it seems, or that no rule found anything."""
    found = {"A": a.caveats, name: b.caveats}
    rows = [[side, str(caveat["rule"]), str(caveat["text"])] for side, caveats in found.items() for caveat in caveats]
    return f"caveats:\n{aligned(rows)}" if rows else "no caveats"


def _metric_rows(a: "Run", b: "Run", metrics: Sequence[str]) -> Iterator[list[str]]:
    for name in dict.fromkeys(metrics or [*a.metrics, *b.metrics]):
        metric_a, metric_b = a.metrics.get(name, {}), b.metrics.get(name, {})
        found_a, found_b = metric_a.get("median"), metric_b.get("median")
        difference, ratio = None, None
        if found_a is not None and found_b is not None:
            difference = found_b - found_a
            ratio = found_b / found_a if found_a else None
        unit = metric_a.get("unit") or metric_b.get("unit", "")
        yield [name, unit, *map(number, (found_a, found_b, difference, ratio))]


def _paired(a: "Run", b: "Run", name: str, metrics: Sequence[str]) -> str:
    """Return the comparison of two runs on the same seeds, repetition by repetition, or why there is none."""
    seeds, counts = (a.config["seed"], b.config["seed"]), (a.record["repetitions"], b.record["repetitions"])
    if seeds[0] != seeds[1]:
        return f"not compared in pairs: seed {seeds[0]} and seed {seeds[1]} share no noise"
    from runner.comparison.words import NOISE_ALONE, at_once, noise_alone
    from runner.statistics import SMALLEST_SAMPLE

    if min(counts) < SMALLEST_SAMPLE:
        return f"not compared in pairs: {min(counts)} repetitions in common, and {SMALLEST_SAMPLE} are needed"
    both = [metric for metric in metrics or a.metrics if metric in a.metrics and metric in b.metrics]
    if not both:
        return "not compared in pairs: no metric is in both"
    rows = [_paired_row(metric, a, b, min(counts)) for metric in both]
    header = ["metric", "unit", f"{name} - A", *COMPARED, f"{name} is"]
    head = (
        f"medians of the differences in {min(counts)} pairs on the same seeds (effect 1: {name} is larger in all of "
        "them):"
    )
    alone = noise_alone([a.config, b.config])
    return "\n".join([head, aligned([header, *rows]), at_once(len(rows)), *([NOISE_ALONE] if alone else [])])


def _paired_row(name: str, a: "Run", b: "Run", pairs: int) -> list[str]:
    import numpy as np

    from runner.statistics import compare_paired

    of_a, of_b = (run.values(name)[:pairs] for run in (a, b))
    of_a, of_b = (np.where(np.isnan(side), np.inf, side) for side in (of_a, of_b))
    return [name, a.metrics[name]["unit"], *comparison_cells(compare_paired(of_a, of_b))]
