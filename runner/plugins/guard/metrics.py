"""Runtime checks of metric plug-ins."""

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING

from runner.base.errors import SimulationError
from runner.plugins.guard.faults import find_fault, is_write, place, told_of_part
from runner.plugins.guard.read_only import read_only

if TYPE_CHECKING:
    from runner.base.trace import Trace
    from runner.metrics.family import MetricContext, MetricFamily


def watch_metrics(
    family: "MetricFamily", trace: "Trace", context: "MetricContext", notices: list[str]
) -> Mapping[str, float | None]:
    """Return the values that a metric family of the user's gives; where it fails, none of its metrics has a value.

    Args:
        family: The family's module.
        trace: The run's trace.
        context: Its setting.
        notices: Takes what went wrong, in words.

    Raises:
        SimulationError: where the family tries to change the trace or its setting; names the place.
    """
    try:
        values = dict(family.evaluate(read_only(trace), copy.deepcopy(context)))
        wrong = [name for name in values if not any(f"_{known}_" in f"_{name}_" for known in family.UNITS)]
        if wrong:
            notices.append(f"metric {wrong[0]}: {family.__name__}.UNITS names no unit for it; it is left out")
        kept = {name: value for name, value in values.items() if name not in wrong}
        for name, value in kept.items():
            fault = None if value is None else find_fault(value, ())
            if fault:
                notices.append(f"metric {name}: {place(family.evaluate)} gave {fault}")
                kept[name] = None
        return {name: None if value is None else float(value) for name, value in kept.items()}
    except Exception as error:
        if is_write(error):
            raise SimulationError(f"metrics of {family.__name__}: {told_of_part(error)}", float(trace.t[-1])) from error
        notices.append(f"metrics of {family.__name__}: {told_of_part(error)}")
        return dict.fromkeys(family.UNITS)
