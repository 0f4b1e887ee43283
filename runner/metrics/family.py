"""Context of the metrics of a run, and evaluation of metric families from plug-ins."""

import copy
from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import ModuleType

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.trace import Trace
from runner.plugins import metric_units
from runner.plugins.guard import describe_fault, find_fault, is_write, place, read_only
from runner.trajectories.shaped import Shifted
from runner.trajectories.trajectory import Trajectory


@dataclass(frozen=True)
class MetricContext:
    """Context of the metrics of a run.

    Attributes:
        trajectory: The desired motion.
        settling_band: Largest error on each axis of an arm that has settled, in m.
        period: Time between two rows of the trace, in s.
        reach: Largest distance from a mounted stage's base at which the stage follows the target, in m; None if no
            controller has such a limit.
    """

    trajectory: Trajectory
    settling_band: float
    period: float
    reach: float | None = None

    def at_stage(self, offset: FloatArray) -> "MetricContext":
        """Return the context of a stage whose end point keeps an offset to the tip, shape (3,), in m."""
        return replace(self, trajectory=Shifted(self.trajectory, offset))


def evaluate_added(trace: Trace, context: MetricContext, notices: list[str]) -> dict[str, float | None]:
    """Return the metrics of one run from user-supplied families; if a family fails, its metrics have no value.

    Args:
        trace: The trace of the run.
        context: The context of the metrics.
        notices: List that receives a message for each fault.

    Raises:
        SimulationError: if a family tries to change the trace or the context; the message contains the line.
    """
    values: dict[str, float | None] = {}
    for family in metric_units.added_families():
        try:
            values |= dict(_evaluate_family(family, trace, context, notices))
        except Exception as error:
            fault = f"metrics of {family.__name__}: {describe_fault(error)}"
            if is_write(error):
                raise SimulationError(fault) from error
            notices.append(fault)
            values |= dict.fromkeys(family.UNITS)
    return values


def _evaluate_family(
    family: ModuleType, trace: Trace, context: MetricContext, notices: list[str]
) -> Iterator[tuple[str, float | None]]:
    """Yield names and values of the metrics of a family that have a unit; a value with a fault is None."""
    for name, value in dict(family.evaluate(read_only(trace), copy.deepcopy(context))).items():
        if not any(f"_{known}_" in f"_{name}_" for known in family.UNITS):
            notices.append(f"metric {name}: {family.__name__}.UNITS names no unit for it; it is left out")
            continue
        owner = metric_units.owner_of(name)
        if owner is not family and owner is not None:
            notices.append(f"metric {name}: {family.__name__} gave a metric of {owner.__name__}; it is left out")
            continue
        fault = None if value is None else find_fault(value, ())
        if fault:
            notices.append(f"metric {name}: {place(family.evaluate)} gave {fault}")
        yield name, None if fault or value is None else float(value)
