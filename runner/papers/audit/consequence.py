"""Simulated consequences of a wrong formula: functions of `equations/consequences`, with title and text.

Title, text and labels are in a YAML file next to the function's module and with the same name, under the function's
name:

    line:
      title: The line by the printed inverse
      text: The tip misses the line by {{ "%.1f" % max["as printed"] }} cm at worst.
      x_label: time (s)
      y_label: distance (cm)

Numbers are `max`, `min` and `last` of each curve by its name, and the additional numbers of the run.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from operator import itemgetter

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.papers.audit.sources import Where, consequence_of, source_of
from runner.papers.expressions.evaluator import OperationBudget, Scope
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.insertions import fill
from runner.schema.model import StrictModel


@dataclass(frozen=True)
class Consequence:
    """Simulated motion of a robot that uses a formula.

    Attributes:
        x: Abscissae, shape (T,).
        curves: Ordinates of each run by its name, shape (T,); NaN where it ended before.
        numbers: What the words need besides.
    """

    x: FloatArray
    curves: Mapping[str, FloatArray]
    numbers: Mapping[str, float | str] = field(default_factory=dict)


class Words(StrictModel):
    """Title, text and labels of a run.

    Attributes:
        title: What is run.
        text: What happens, in a sentence or two, with numbers.
        x_label: What the abscissae are, with unit.
        y_label: What the curves show, with unit.
        logarithmic: Whether the ordinates need a logarithmic axis.
    """

    title: str
    text: str
    x_label: str
    y_label: str
    logarithmic: bool = False


def simulate_consequence(where: Where, name: str) -> tuple[Words, Consequence]:
    """Run the function of a study that "module.name" stands for, and put its numbers into its words."""
    module, _, own = name.partition(".")
    run: Consequence = consequence_of(where, name)()
    path = source_of(where).equations / "consequences" / f"{module}.yaml"
    words = read_data(path, dict[str, Words])
    ends: Mapping[str, Callable[[FloatArray], float]]
    ends = {"max": np.nanmax, "min": np.nanmin, "last": itemgetter(-1)}
    told = {end: {name: of(values) for name, values in run.curves.items()} for end, of in ends.items()}
    if own not in words:
        raise RunnerError(f"{path}: {own}: no words{nearest(own, words)}")
    try:
        text = fill(words[own].text, Scope({}, {**told, **run.numbers}), OperationBudget())
    except ExpressionError as error:
        raise RunnerError(f"{path}: {own}: {error.reason}") from error
    return words[own].model_copy(update={"text": text}), run
