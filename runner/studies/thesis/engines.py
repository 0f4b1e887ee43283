"""Integration error in the runs of a figure, and runs that differ from Runge-Kutta."""

from collections.abc import Mapping, Sequence
from typing import Any

from runner.base.quantities import above_rounding, format_range, number, quantity
from runner.reporting.claims import judge, load_claims
from runner.reporting.metric_titles import title
from runner.reporting.plant_step import describe_plant, percent
from runner.reporting.words import PLANT
from runner.store import Run
from runner.study.run_values import median

_METRICS = {"settling_time": "settles after", "steady_state_error": "rests within", "max_axis_error": "strays by"}


def step_of_both(named: Mapping[str, Run], metrics: Sequence[str]) -> str:
    """Return what the plant's step is worth in a figure's metrics, under both presets, in a sentence.

    Where none of the metrics has a value, it is how far the step moves the tip. Nothing is said here of runs whose
    motion parts from that on Runge-Kutta; see `parting`.
    """
    errors = {words: run.plant_error or {"reason": ""} for words, run in named.items()}
    if any("reason" in error for error in errors.values()):
        return " ".join(
            f"{words[0].upper()}{words[1:]}: {describe_plant(run, metrics)}" for words, run in named.items()
        )
    told = []
    for metric in metrics:
        shares = {words: error["metrics"].get(metric, {}).get("share") for words, error in errors.items()}
        known = [f"{percent(share)} ({words})" for words, share in shares.items() if share is not None]
        told += [f"{' and '.join(known)} of the {title(metric)}"] if known else []
    first = next(iter(named.values()))
    step = f"{_plant(first)}'s step of {quantity(first.provenance['plant_step'], 's')}"
    if told:
        return f"{step} is worth {'; '.join(told)}."
    moved = [
        f"{above_rounding(error['largest'], 'm', 2)} ({words})"
        for words, error in errors.items()
        if error["parted"] is None
    ]
    return f"{step} moves the tip by {' and '.join(moved)} at most." if moved else ""


def parting(named: Mapping[str, Run], claims: Mapping[str, int]) -> list[str]:
    """Return what became of the runs whose motion parts from that on Runge-Kutta.

    Args:
        named: The run under each preset, by the preset's words.
        claims: The claims on the figure, by metric.
    """
    told = []
    for words, run in named.items():
        error = run.plant_error or {}
        if error.get("parted") is not None:
            told.append(_parted(words, run, error, claims))
    plant = _plant(next(iter(named.values())))
    why = f"What makes such differences grow is said under {plant} against Runge-Kutta."
    return [*told, why] if told else []


def _parted(words: str, run: Run, error: Mapping[str, Any], claims: Mapping[str, int]) -> str:
    saturated = median(run, "saturation_fraction")
    text = (
        f"{words[0].upper()}{words[1:]}: some torque is at its limit for {number(100.0 * (saturated or 0.0), 2)} % of "
        f"the ticks; Runge-Kutta, with the same noise, goes another way from {quantity(error['parted'], 's')} on, "
        f"{above_rounding(error['largest'], 'm', 2)} away at {quantity(error['at'], 's')}, and "
        f"{above_rounding(error['end'], 'm', 2)} at the end."
    )
    return " ".join([text, *(_of_metric(metric, claim, run, error) for metric, claim in claims.items())]).strip()


def _of_metric(metric: str, claim: int, run: Run, error: Mapping[str, Any]) -> str:
    """Return whether Runge-Kutta's value lies among the repetitions', and what it means for the verdict."""
    stored, other = run.metrics[metric], error["metrics"].get(metric, {}).get("value")
    low, high, unit = stored["min"], stored["max"], str(stored["unit"])
    if other is None or low is None or high is None:
        return ""
    inside = low <= other <= high
    printed = next(each.value for each in load_claims("thesis") if each.number == claim)
    ours, theirs = (judge(printed or 0.0, value) for value in (stored["median"], other))
    if ours == theirs and metric != "settling_time":
        return ""
    text = (
        f"There the tip {_METRICS[metric]} {quantity(other, unit)}, {'within' if inside else 'outside'} the "
        f"{format_range(low, high, unit)} of {_plant(run)}'s {run.record['repetitions']} repetitions"
    )
    return f"{text}." if ours == theirs else f"{text}: claim {claim} would read {theirs} in place of {ours}."


def _plant(run: Run) -> str:
    kind = str(run.config["plant"]["kind"])
    return PLANT.get(kind, kind)
