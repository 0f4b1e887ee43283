"""Comparison of runs for `runner compare`: config, provenance, caveats and metrics."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from runner.base.sanitize import one_line
from runner.cli.columns import COMPARED, align_columns, answer_cells, number
from runner.reporting.comparison.operand import letter

if TYPE_CHECKING:
    from runner.reporting.comparison.operand import Side
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
    from runner.sweeps.measurements import check_metrics

    check_metrics(metrics, dict.fromkeys(name for run in runs for name in run.metrics))
    first = runs[0]
    for place, run in enumerate(runs[1:], 1):
        _print_two(first, run, letter(place), metrics, end="\n\n" if place < len(runs) - 1 else "\n")


def _print_two(a: "Run", b: "Run", name: str, metrics: Sequence[str], end: str) -> None:
    from runner import store
    from runner.reporting.comparison.cells import one_cell
    from runner.reporting.comparison.differences import find_differences
    from runner.reporting.comparison.operand import side_of_run
    from runner.sweeps.finer_step import work_out

    for run in (a, b):
        work_out(run.folder.parent.parent, [run])
    sides = side_of_run("A", a), side_of_run(name, b)
    print(one_line(f"A  {_headline(a)}"), one_line(f"{name}  {_headline(b)}"), "", sep="\n")
    found = find_differences(*sides, one_cell())
    print(one_line(found.in_words("A", name)))
    print(_differing("config", store.simulated_part(a.config), store.simulated_part(b.config), name))
    if a.urdf != b.urdf:
        print("  the text of robot.urdf differs")
    print(_differing("provenance", _provenance(a), _provenance(b), name))
    print(_caveats(a, b, name), end="\n\n")
    header = ["metric", "unit", "A", name, f"{name} - A", f"{name} / A"]
    print(align_columns([header, *_metric_rows(a, b, metrics)], indent=""))
    print(f"\n{_paired(*sides, metrics)}", end=end)


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
    return f"{what} differs:\n{align_columns([['key', 'A', name], *rows])}" if rows else f"same {what}"


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
    return f"caveats:\n{align_columns(rows)}" if rows else "no caveats"


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


def _paired(a: "Side", b: "Side", metrics: Sequence[str]) -> str:
    """Return the comparison of two runs on the same seeds, repetition by repetition, or why there is none."""
    from runner.reporting.answers import EXPLAINED, Asked, judge
    from runner.reporting.comparison.cells import one_cell
    from runner.reporting.comparison.messages import NOISE_ALONE
    from runner.reporting.comparison.pairs import compare, share_seeds
    from runner.reporting.comparison.sweeps import noise_alone
    from runner.reporting.sweep.subject import first_screen, whole_metrics
    from runner.statistics import SMALLEST_SAMPLE

    one, other = a.measurements, b.measurements
    pairs = one_cell().pairs
    if not share_seeds(one, other, pairs).all():
        return f"not compared in pairs: seed {one.seeds[0]} and seed {other.seeds[0]} share no noise"
    count = min(one.repetitions, other.repetitions)
    if count < SMALLEST_SAMPLE:
        return f"not compared in pairs: {count} repetitions in common, and {SMALLEST_SAMPLE} are needed"
    both = [name for name in metrics or one.values if name in one.values and name in other.values]
    if not both:
        return "not compared in pairs: no metric is in both"
    asked = [Asked(name, one.units[name], found) for name in both if (found := compare(one, other, name, pairs))]
    first = first_screen(metrics or whole_metrics(both))
    answers = judge(asked, first)
    rows = [[answer.metric, answer.unit, *answer_cells(answer)] for answer in answers]
    alone = noise_alone([config for side in (one, other) for config, _ in side.configs])
    return "\n".join(
        [
            *(answer.sentence(a.name, b.name) for answer in answers if answer.metric in first),
            align_columns([["metric", "unit", f"{b.name} - {a.name}", *COMPARED, f"{b.name} is"], *rows]),
            EXPLAINED,
            *([NOISE_ALONE] if alone else []),
        ]
    )
