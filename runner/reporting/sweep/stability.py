"""Remedies of failures in a sweep: the largest value of each axis that finishes, and the bound of the law."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.quantities import number
from runner.reporting.metric_titles import capital
from runner.reporting.sweep.subject import Subject
from runner.store.axes import Axis, group_cells

UNSTABLE = "unstable_gains"
"""Caveat whose value is the ratio of a velocity gain to its bound."""

_SCALED = ("controller.natural_frequency", "controller.period", "controller.damping_ratio")
"""Keys that the velocity gain times the period is proportional to."""
_ALIKE = 1.02  # ratio of bounds up to which they are one bound
_NAMED = 3


def remedies(subject: Subject) -> list[str]:
    """Return for each numeric axis up to which value runs finish and from which on they fail, as sentences."""
    failed = np.array([status != "ok" for status in subject.measurements.statuses])
    return [text for axis in subject.axes if axis.numbers is not None and (text := _remedy(subject, axis, failed))]


def _remedy(subject: Subject, axis: Axis, failed: NDArray[np.bool_]) -> str:
    others = [other for other in subject.axes if other is not axis and other.name != "seed"]
    found: dict[str, list[str]] = {}
    for levels, cells in group_cells(others, np.arange(len(failed))):
        phrase = _boundary(axis, failed, cells)
        if phrase:
            at = ", ".join(f"{other.name}={other.text(level)}" for other, level in zip(others, levels, strict=True))
            bound = _bound(subject, axis, cells)
            found.setdefault(f"{phrase}{bound}", []).append(at)
    if not found:
        return ""
    if len(found) == 1:
        (phrase,) = found
        return f"{axis.name}: {phrase}."
    texts = [f"{phrase} at {'; '.join(places[:_NAMED])}" for phrase, places in list(found.items())[:_NAMED]]
    more = f"; {len(found) - _NAMED} more bounds" if len(found) > _NAMED else ""
    return f"{axis.name}: {'; '.join(texts)}{more}."


def _boundary(axis: Axis, failed: NDArray[np.bool_], cells: NDArray[np.intp]) -> str:
    """Return the neighbouring values between which cells begin or cease to fail; "" without one such place."""
    levels = np.unique(axis.level[cells])
    lost = [bool(failed[cells[axis.level[cells] == level]].any()) for level in levels.tolist()]
    changes = [place for place in range(1, len(lost)) if lost[place] != lost[place - 1]]
    if len(changes) != 1:
        return ""
    below, above = (axis.text(int(levels[place])) for place in (changes[0] - 1, changes[0]))
    return f"stable up to {below}, fails at {above}" if lost[-1] else f"fails at {below}, stable from {above} on"


def _bound(subject: Subject, axis: Axis, cells: NDArray[np.intp]) -> str:
    """Return the bound of the velocity loop on an axis, to follow a phrase; "" if no cell knows it."""
    if axis.name not in _SCALED or axis.numbers is None:
        return ""
    numbers, caveats = axis.numbers, subject.measurements.caveats
    found = [
        float(numbers[axis.level[cell]]) / float(one["value"])
        for cell in cells.tolist()
        for one in (caveats[cell] if caveats else ())
        if one["rule"] == UNSTABLE and float(one["value"]) > 0.0
    ]
    if not found or max(found) > _ALIKE * min(found):
        return ""
    return f" (the velocity loop is stable below {number(min(found), 3)}, if no torque is at its limit)"


def causes_of_failure(subject: Subject) -> str:
    """Return the caveats that all failed cells have and no other cell has: one that has a range with it, or nothing."""
    measurements = subject.measurements
    failed = [status != "ok" for status in measurements.statuses]
    rules = [{str(one["rule"]) for one in found} for found in measurements.caveats]
    lost = [found for found, is_failed in zip(rules, failed, strict=False) if is_failed]
    good = [found for found, is_failed in zip(rules, failed, strict=False) if not is_failed]
    common = set.intersection(*lost) - set().union(*good) if lost else set()
    texts = [
        _unstable(measurements.caveats) if rule == UNSTABLE else f"{capital(text)}."
        for rule, *_, text in measurements.caveats_by_rule()
        if rule in common
    ]
    return " ".join(texts)


def _unstable(caveats: Sequence[Sequence[Mapping[str, Any]]]) -> str:
    ratios = [float(one["value"]) for some in caveats for one in some if one["rule"] == UNSTABLE]
    low, high = (number(end, 2) for end in (min(ratios), max(ratios)))
    return (
        "The velocity loop is unstable: controller.natural_frequency or controller.period is "
        f"{low if low == high else f'{low} to {high}'} times too large."
    )
