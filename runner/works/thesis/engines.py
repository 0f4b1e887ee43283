"""What another engine makes of a figure's runs, and where the two part."""

from collections.abc import Mapping

from runner.claims import judge, load_claims
from runner.quantities import above_rounding, number, quantity, ranged
from runner.reporting.plant_agreement import describe_agreement, disagreement, find_twin
from runner.reporting.run_values import apart, clock, median
from runner.reporting.words import PLANT
from runner.store import Run

_PARTED = 1e-3  # m, from which distance on two plants have parted
_METRICS = {"settling_time": "settles after", "steady_state_error": "rests within", "max_tracking_error": "strays by"}


def agreement_of_both(named: Mapping[str, Run]) -> str:
    """Return how far the other engine's tip is from a figure's, under both presets, in a sentence."""
    pairs = [(words, run, twin) for words, run in named.items() if (twin := find_twin(run)) is not None]
    if len(pairs) < len(named):
        return " ".join(f"{words[0].upper()}{words[1:]}: {describe_agreement(run)}" for words, run in named.items())
    told = []
    for words, run, twin in pairs:
        found = disagreement(run, twin)
        told.append(f"{above_rounding(found.tip, 'm', 2)} ({words}; at the end {above_rounding(found.final, 'm', 2)})")
    _, first, other = pairs[0]
    most = " and ".join(told)
    return f"{_plant(other)} in place of {_plant(first)} puts the tip at most {most} elsewhere at equal times."


def parting(named: Mapping[str, Run], claims: Mapping[str, int]) -> list[str]:
    """Return what became of the runs whose tips the engines put farther apart than the band of a settled arm.

    Args:
        named: The run under each preset, by the preset's words.
        claims: The claims on the figure, by metric.
    """
    told = []
    for words, run in named.items():
        twin = find_twin(run)
        if twin is not None and disagreement(run, twin).tip > float(run.config["robot"]["settling_band"]):
            told.append(_parted(words, run, twin, claims))
    plant = _plant(next(iter(named.values())))
    why = f"What makes such differences grow is said under {plant} against Runge-Kutta."
    return [*told, why] if told else []


def _parted(words: str, run: Run, twin: Run, claims: Mapping[str, int]) -> str:
    distance, t = apart(run, twin, "tip"), clock(run)
    saturated = median(run, "saturation_fraction")
    start = float(t[int((distance > _PARTED).argmax())])
    text = (
        f"{words[0].upper()}{words[1:]}: some torque is at its limit for {number(100.0 * (saturated or 0.0), 2)} % of "
        f"the ticks; the engines are {quantity(_PARTED, 'm')} apart from {quantity(start, 's')} on, "
        f"{above_rounding(float(distance.max()), 'm', 2)} at {quantity(float(t[int(distance.argmax())]), 's')}, and "
        f"{above_rounding(float(distance[-1]), 'm', 2)} at the end."
    )
    return " ".join([text, *(_of_metric(metric, claim, run, twin) for metric, claim in claims.items())]).strip()


def _of_metric(metric: str, claim: int, run: Run, twin: Run) -> str:
    """Return whether the other engine's value lies among the repetitions', and what it means for the verdict."""
    stored, other = run.metrics[metric], median(twin, metric)
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
        f"{ranged(low, high, unit)} of {_plant(run)}'s {len(stored['values'])} repetitions"
    )
    return f"{text}." if ours == theirs else f"{text}: claim {claim} would read {theirs} in place of {ours}."


def _plant(run: Run) -> str:
    kind = str(run.config["plant"]["kind"])
    return PLANT.get(kind, kind)
