"""User-supplied formulas from a file, compared with a robot model at random configurations."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import Field

from runner.base.arrays import FloatArray
from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.papers.audit.derivations import Elements, columns
from runner.papers.audit.entry import Written
from runner.papers.audit.evaluation import evaluate_all
from runner.papers.audit.model_derivations import by_model, sample
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel

_EQUAL = 1e-9
QUANTITIES = ("position", "jacobian", "mass-matrix", "gravity")
"""Quantities that can be compared; see `model_derivations.py` for the elements."""


class _Formulas(StrictModel):
    """A file of formulas."""

    symbols: dict[str, Written] = Field(default_factory=dict)
    elements: dict[str, Written]


@dataclass(frozen=True)
class FormulaDifference:
    """One formula against the robot.

    Attributes:
        element: Its name.
        largest: Largest error over the samples.
        typical: Median error.
        at: Joint positions at which the error is largest, shape (n,), in rad.
        found: What the formula gives there.
        true: What is true there.
        instead: Another element of the robot that the formula equals, with its sign, or "".
    """

    element: str
    largest: float
    typical: float
    at: FloatArray
    found: float
    true: float
    instead: str


def compare(model: RobotModel, quantity: str, path: Path, samples: int) -> list[FormulaDifference]:
    """Return the error of each formula of a file against the robot.

    Args:
        model: The robot.
        quantity: One of `QUANTITIES`.
        path: The file: YAML with `elements`, and `symbols` that they use besides q1, s1, c1 and so on.
        samples: How many configurations, drawn with seed 0, each joint from a full turn.

    Raises:
        RunnerError: If the file cannot be read, names an element that the robot has not, or holds an expression that
            cannot be evaluated; the message names the element and the position in it.
    """
    content = read_data(path, _Formulas)
    joints = tuple(f"q{i + 1}" for i in range(model.nq))
    symbols = sample(model, joints, samples, np.random.default_rng(0))
    q = columns(symbols, joints)
    whole = by_model(model).named(quantity.replace("-", "_"), q, 0.0 * q, 0.0 * q)
    true_values = {name: values for name, values in whole.items() if values.ndim == 1}
    names = list(true_values)
    for name in content.elements:
        if name not in true_values:
            told = f"{path}: {quantity} has no element '{name}'{nearest(name, names)}"
            raise RunnerError(f"{told}; elements: {names[0]} to {names[-1]}")
    try:
        values = evaluate_all(content.elements, evaluate_all(content.symbols, symbols))
    except RunnerError as error:
        raise RunnerError(f"{path}, {error}") from error
    return [_difference(name, values[name], true_values, q) for name in content.elements]


def _difference(name: str, values: FloatArray, true_values: Elements, q: FloatArray) -> FormulaDifference:
    error = np.abs(values - true_values[name])
    worst = int(error.argmax())
    instead = [
        word + other
        for sign, word in ((1, ""), (-1, "-"))
        for other, true in true_values.items()
        if error[worst] > _EQUAL and np.abs(sign * values - true).max() <= _EQUAL
    ]
    at = float(error[worst]), float(np.median(error)), q[worst], float(values[worst]), float(true_values[name][worst])
    return FormulaDifference(name, *at, "".join(instead[:1]))
