"""Question of a sweep: the axis whose values are compared; the other axes are conditions of the answer.

A designer chooses the law, then its gains, then other values such as the trajectory or the period. Robot, noise, model
error, payload, environment, engine and seed are conditions, unless a user asks for one of them with `--by`.
"""

import contextlib
from collections.abc import Sequence

from runner.base.atomic import write_atomically
from runner.base.errors import StoreError
from runner.store.axes import Axis, axes_of
from runner.store.seal import sealed_json
from runner.store.sweep import QUESTION, Sweep

SEED = "seed"
"""The axis whose levels are draws of one thing, like repetitions."""

_CONDITIONS = frozenset({
    "robot", "noise", "mismatch", "gravity", "environment", "plant", "plant_error", "calibration", "repetitions", SEED,
})  # fmt: skip
_LAW = "controller"
_PERIOD = "controller.period"


def is_condition(key: str) -> bool:
    """Return True if a key is a condition, not a choice of a designer."""
    return key.partition(".")[0].partition("{")[0] in _CONDITIONS


def find_question(axes: Sequence[Axis], asked: str = "") -> Axis | None:
    """Return the axis that a sweep asks about; None if all axes are conditions.

    Args:
        axes: The swept axes.
        asked: Name of the axis that a user asked for; empty for none.
    """
    chosen = next((axis for axis in axes if axis.name == asked), None)
    choices = [axis for axis in axes if not is_condition(axis.name)]
    return chosen or min(choices, key=_rank, default=None)


def keep_question(sweep: Sweep, axis: str) -> None:
    """Store the axis that a user asks about with a sweep, which its later answers follow.

    Nothing is stored if the sweep already asks about it, or if its folder cannot be written.
    """
    known = find_question(axes_of(sweep.overrides)[0], sweep.question)
    if known is None or known.name != axis:
        with contextlib.suppress(StoreError):
            write_atomically(sweep.folder / QUESTION, sealed_json({"axis": axis}))


def _rank(axis: Axis) -> tuple[int, bool]:
    """Return the place of an axis in the order of questions: law, gains, other choices; words before numbers."""
    law, _, rest = axis.name.partition(".")
    if law != _LAW or axis.name.startswith(_PERIOD):
        return 2, axis.numbers is not None
    return int(bool(rest) and rest.rpartition(".")[2] != "kind"), axis.numbers is not None
