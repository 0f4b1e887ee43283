"""Summary sentences of a compared figure, from stored numbers."""

from collections.abc import Mapping, Sequence

from runner.base.quantities import number, spread
from runner.store import Run
from runner.study.run_values import median

_ALIKE = 1.1  # ratio up to which two values are called the same
_WORDS = {
    "settling_time": ("the tip settles", "sooner", "as soon", "later", "after"),
    "steady_state_error": ("the tip rests", "closer to the goal", "as close to the goal", "farther from it", "within"),
    "max_axis_error": ("the tip strays", "less from its path", "as far from its path", "farther from it", "by"),
}


def takeaway(metrics: Sequence[str], named: Mapping[str, Run]) -> str:
    """Return how metrics differ between two presets, in a sentence, such as "... the tip rests 22 times closer ...".

    Args:
        metrics: Some of settling_time, steady_state_error and max_axis_error; the first one is told first.
        named: The run under each of the two presets, by the preset's words.
    """
    first, second = named.values()
    told = [_compared(metric, first, second) for metric in metrics]
    words = list(named)[1]
    return f"{words[0].upper()}{words[1:]} {', and '.join(told)}."


def _compared(metric: str, first: Run, second: Run) -> str:
    what, less, alike, more, by = _WORDS[metric]
    before, after = first.metrics.get(metric), second.metrics.get(metric)
    a, b = median(first, metric), median(second, metric)
    values = [
        "no value" if stored is None or stored["median"] is None else spread(stored) for stored in (after, before)
    ]
    if a is None or b is None or min(a, b) <= 0.0:
        return f"{what} {by} {values[0]} in place of {values[1]}"
    ratio = max(a, b) / min(a, b)
    if ratio < _ALIKE:
        return f"{what} {alike}, {by} {values[0]} beside {values[1]}"
    return f"{what} {number(ratio, 2)} times {less if b < a else more}, {by} {values[0]} in place of {values[1]}"
