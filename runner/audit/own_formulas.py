"""A reader's own formulas against a robot: read from a file, evaluated at random configurations, compared."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from runner.audit.evaluation import evaluate
from runner.audit.expressions import ExpressionError, parse
from runner.audit.truth import Elements, FloatArray
from runner.config.bounded_yaml import YamlError, read_yaml
from runner.errors import RunnerError, nearest
from runner.robots.model import RobotModel
from runner.texts import quoted

_EQUAL = 1e-9


def _matrix(letter: str, matrices: FloatArray) -> dict[str, FloatArray]:
    rows, columns = matrices.shape[1:]
    return {f"{letter}_{i + 1}{j + 1}": matrices[:, i, j] for i in range(rows) for j in range(columns)}


def _each(function: Callable[[FloatArray], FloatArray], q: FloatArray) -> FloatArray:
    return np.array([function(row) for row in q])


QUANTITIES: Mapping[str, Callable[[RobotModel, FloatArray], dict[str, FloatArray]]] = {
    "position": lambda model, q: {f"P_{a}": values for a, values in zip("xyz", model.tip_positions(q).T, strict=True)},
    "jacobian": lambda model, q: _matrix("J", _each(model.tip_jacobian, q)),
    "mass-matrix": lambda model, q: _matrix("M", _each(model.mass_matrix, q)),
    "gravity": lambda model, q: {f"G_{i + 1}": values for i, values in enumerate(_each(model.gravity_torque, q).T)},
}
"""What can be compared, by name: its elements at rows of joint positions. Units are SI, frames the base."""


@dataclass(frozen=True)
class Difference:
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


def compare(model: RobotModel, quantity: str, path: Path, samples: int) -> list[Difference]:
    """Return how far each formula of a file is from the robot.

    Args:
        model: The robot.
        quantity: One of `QUANTITIES`.
        path: The file: YAML with `elements`, and `symbols` that they use beside q1, s1, c1 and so on.
        samples: How many configurations, drawn with seed 0, each joint from a full turn.

    Raises:
        RunnerError: If the file cannot be read, names an element that the robot has not, or holds an expression that
            cannot be evaluated; the message names the element and the position in it.
    """
    content = _read(path)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (samples, model.nq))
    truth = QUANTITIES[quantity](model, q)
    symbols: dict[str, FloatArray] = {}
    for i, angles in enumerate(q.T, start=1):
        symbols |= {f"q{i}": angles, f"s{i}": np.sin(angles), f"c{i}": np.cos(angles)}
    for name, text in content["symbols"].items():
        symbols[name] = _value(path, name, text, symbols)
    unknown = [name for name in content["elements"] if name not in truth]
    if unknown:
        names = list(truth)
        raise RunnerError(
            f"{path}: {quantity} has no element '{unknown[0]}'{nearest(unknown[0], names)}; elements: "
            f"{names[0]} to {names[-1]}"
        )
    found = {name: _value(path, name, text, symbols) for name, text in content["elements"].items()}
    return [_difference(name, values, truth, q) for name, values in found.items()]


def _difference(name: str, values: FloatArray, truth: Elements, q: FloatArray) -> Difference:
    error = np.abs(values - truth[name])
    worst = int(error.argmax())
    instead = ""
    if error[worst] > _EQUAL:
        for sign, word in ((1, ""), (-1, "-")):
            equal = [other for other, true in truth.items() if np.abs(sign * values - true).max() <= _EQUAL]
            instead = instead or (word + equal[0] if equal else "")
    return Difference(
        name,
        float(error[worst]),
        float(np.median(error)),
        q[worst],
        float(values[worst]),
        float(truth[name][worst]),
        instead,
    )


def _value(path: Path, name: str, text: str, symbols: Mapping[str, FloatArray]) -> FloatArray:
    try:
        return evaluate(parse(text), symbols)
    except ExpressionError as error:
        raise RunnerError(f"{path}, {name}, {error}") from error


def _read(path: Path) -> dict[str, dict[str, str]]:
    try:
        content: Any = read_yaml(path.read_text(encoding="utf-8"), path)
    except (OSError, UnicodeDecodeError, YamlError) as error:
        raise RunnerError(f"{path}: cannot be read as YAML: {error}") from error
    allowed = ("symbols", "elements")
    if not isinstance(content, dict) or "elements" not in content or set(content) - set(allowed):
        raise RunnerError(f"{path}: needs 'elements', each with its expression, and may have 'symbols'; nothing else")
    return {key: _expressions(path, key, content.get(key) or {}) for key in allowed}


def _expressions(path: Path, key: str, content: Any) -> dict[str, str]:
    if not isinstance(content, dict) or not all(isinstance(name, str) for name in content):
        raise RunnerError(f"{path}: '{key}' is a list of names, each with its expression")
    for name, value in content.items():
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise RunnerError(f"{path}: {key}.{name} is {quoted(value)}; allowed: an expression or a number")
    return {name: str(value) for name, value in content.items()}
