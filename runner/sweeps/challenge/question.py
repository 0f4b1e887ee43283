"""Question of a challenge as a stored result asks it, and its variations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Class = Literal["numbers", "equivalent", "conditions", "fairness"]
CLASSES: Mapping[Class, str] = {
    "numbers": "numerical choices",
    "equivalent": "equivalent choices",
    "conditions": "conditions",
    "fairness": "fairness",
}
"""Classes of variations in the order of the budget, with their titles. They are never added up."""

Value = float | str


@dataclass(frozen=True)
class Side:
    """A side of the question.

    Attributes:
        name: Name in sentences, such as "operational_space".
        overrides: Overrides of its runs, without seed, repetitions and outputs.
        medians: Median of each metric in the stored result.
    """

    name: str
    overrides: Sequence[str]
    medians: Mapping[str, float]


@dataclass(frozen=True)
class Question:
    """A question with its stored answer.

    Attributes:
        metric: The metric.
        unit: Its unit.
        sides: A and B; the answer describes B against A.
        sign: -1 if B is smaller, 1 if it is larger, 0 if no difference was shown.
        size: Difference of B from A relative to the larger median; None if only one side has a value.
        error: Integration error in the difference; None if it is unknown.
        seed: The first seed that the stored result does not use.
        at: The condition in which it is asked, such as "robot=macro"; empty for the only one.
        left: Number of other conditions of the result, which are not asked.
        config_dirs: Config folders of the user.
        asks: The folders of the stored results.
    """

    metric: str
    unit: str
    sides: tuple[Side, Side]
    sign: int
    size: float | None
    error: float | None
    seed: int
    at: str
    left: int
    config_dirs: Sequence[Path]
    asks: Sequence[str]

    @property
    def is_fraction(self) -> bool:
        """True for a metric that is a fraction."""
        return "fraction" in self.metric


@dataclass(frozen=True)
class Variation:
    """One change of the asked case.

    Attributes:
        kind: Its class.
        family: Name of its family; for a key of the user's, the key.
        value: Its value.
        label: What is changed, in words.
        sides: Overrides that each side gets.
        place: Place of its family among those of that name.
        exact: True if no side draws anything.
    """

    kind: Class
    family: str
    value: Value
    label: str
    sides: Sequence[Sequence[str]]
    place: int = 0
    exact: bool = False


@dataclass(frozen=True)
class LeftOutVariation:
    """A variation that does not apply or cannot be simulated.

    Attributes:
        family: Name of its family.
        value: Its value.
        reason: Why it is left out.
        kind: Its class.
        applies: True if it applies, but its config is rejected.
    """

    family: str
    value: Value
    reason: str
    kind: Class
    applies: bool = False
