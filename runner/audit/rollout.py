"""A wrong formula run beside the right one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from runner.audit.sources import rollout_of
from runner.audit.truth import FloatArray


@dataclass(frozen=True)
class Rollout:
    """What a robot does that believes a formula.

    Attributes:
        title: What is run.
        text: What happens, in a sentence or two, with numbers.
        x_label: What the abscissae are, with unit.
        y_label: What the curves show, with unit.
        x: Abscissae, shape (T,).
        curves: Ordinates of each run by its name, shape (T,); NaN where it ended before.
        logarithmic: Whether the ordinates need a logarithmic axis.
    """

    title: str
    text: str
    x_label: str
    y_label: str
    x: FloatArray
    curves: Mapping[str, FloatArray]
    logarithmic: bool = False


def run_rollout(source: str, name: str) -> Rollout:
    """Run the rollout of a work that "module.name" stands for."""
    run: Callable[[], Rollout] = rollout_of(source, name)
    return run()
