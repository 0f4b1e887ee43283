"""`runner diff A B`: two stored runs side by side, config, provenance, caveats and metrics."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.commands.arguments import Parser
from runner.commands.columns import aligned, number
from runner.config.compose import quiet_environment

if TYPE_CHECKING:
    from runner.store import Run

# What a result may follow from beside its config; date, machine and command tell nothing about the physics.
_PROVENANCE = ("commit", "versions", "plant_step")


def main(arguments: Sequence[str]) -> int:
    """Print what two runs differ in."""
    parser = Parser("diff", __doc__)
    parser.add_argument("a", type=Path, metavar="A", help="folder of a run")
    parser.add_argument("b", type=Path, metavar="B", help="folder of another run")
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner import store

    a, b = store.open_run(options.a), store.open_run(options.b)
    print(f"A  {_headline(a)}\nB  {_headline(b)}\n")
    print(_compare("config", store.simulated_part(a.config), store.simulated_part(b.config)))
    if a.urdf != b.urdf:
        print("  the text of robot.urdf differs")
    print(_compare("provenance", _provenance(a), _provenance(b)))
    print(_caveats(a, b), end="\n\n")
    print(aligned([["metric", "unit", "A", "B", "B - A", "B / A"], *_metric_rows(a, b)], indent=""))
    print(f"\n{_paired(a, b)}")
    return 0


def _headline(run: "Run") -> str:
    return f"{run.folder}  {run.failure_text or run.status}{'' if run.sealed else '  unsealed: no digests'}"


def _compare(name: str, a: Mapping[str, Any], b: Mapping[str, Any]) -> str:
    """Return a table of the dotted keys in which two mappings differ, or that they are the same."""
    flat_a, flat_b = dict(_flatten(a)), dict(_flatten(b))
    rows = [
        [key, flat_a.get(key, "(absent)"), flat_b.get(key, "(absent)")]
        for key in dict.fromkeys([*flat_a, *flat_b])
        if flat_a.get(key) != flat_b.get(key)
    ]
    return f"{name} differs:\n{aligned([['key', 'A', 'B'], *rows])}" if rows else f"same {name}"


def _flatten(value: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for key, item in value.items():
        if isinstance(item, Mapping):
            yield from _flatten(item, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", item if isinstance(item, str) else json.dumps(item)


def _provenance(run: "Run") -> dict[str, Any]:
    return {key: run.provenance[key] for key in _PROVENANCE if key in run.provenance}


def _caveats(a: "Run", b: "Run") -> str:
    """Return why either result may not be what it seems, or that no rule found anything."""
    found = {"A": a.caveats, "B": b.caveats}
    rows = [[name, str(caveat["rule"]), str(caveat["text"])] for name, caveats in found.items() for caveat in caveats]
    return f"caveats:\n{aligned(rows)}" if rows else "no caveats"


def _metric_rows(a: "Run", b: "Run") -> Iterator[list[str]]:
    for name in dict.fromkeys([*a.metrics, *b.metrics]):
        metric_a, metric_b = a.metrics.get(name, {}), b.metrics.get(name, {})
        found_a, found_b = metric_a.get("median"), metric_b.get("median")
        difference, ratio = None, None
        if found_a is not None and found_b is not None:
            difference = found_b - found_a
            ratio = found_b / found_a if found_a else None
        unit = metric_a.get("unit") or metric_b.get("unit", "")
        yield [name, unit, *map(number, (found_a, found_b, difference, ratio))]


def _paired(a: "Run", b: "Run") -> str:
    """Return the comparison of two runs on the same seeds, repetition by repetition, or why there is none."""
    seeds, counts = (a.config["seed"], b.config["seed"]), (a.record["repetitions"], b.record["repetitions"])
    if seeds[0] != seeds[1]:
        return f"not compared in pairs: seed {seeds[0]} and seed {seeds[1]} share no noise"
    from runner.statistics import SMALLEST_SAMPLE

    if min(counts) < SMALLEST_SAMPLE:
        return f"not compared in pairs: {min(counts)} repetitions in common, and {SMALLEST_SAMPLE} are needed"
    rows = [_paired_row(name, a.metrics[name], b.metrics[name]) for name in a.metrics if name in b.metrics]
    header = ["metric", "unit", "B - A", "95 % interval", "effect", "p", "B is"]
    head = (
        f"medians of the differences in {min(counts)} pairs on the same seeds (effect 1: B is larger in all of them):"
    )
    return f"{head}\n{aligned([header, *rows])}"


def _paired_row(name: str, a: Mapping[str, Any], b: Mapping[str, Any]) -> list[str]:
    import numpy as np

    from runner.statistics import compare_paired

    pairs = list(zip(a["values"], b["values"], strict=False))
    of_a, of_b = (np.array([np.inf if value is None else value for value in side]) for side in zip(*pairs, strict=True))
    comparison = compare_paired(of_a, of_b)
    difference, p_value = comparison.difference, comparison.p_value
    interval = f"{number(difference.low)} to {number(difference.high)}"
    numbers = [
        number(difference.median),
        interval,
        f"{comparison.effect:.2f}",
        "-" if p_value is None else f"{p_value:.2g}",
    ]
    return [name, a["unit"], *numbers, comparison.verdict]
