"""Record of a run: its schema, and its metrics by name.

Digests detect only accidental damage. `find_faults` and `find_config_faults` detect invalid content with a valid
digest.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Strict, ValidationError

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, unknown
from runner.base.quantities import spread

_Number = float | None
_Ends = Annotated[tuple[_Number, _Number], Strict(False)]
_Entry = Annotated[tuple[str, _Ends], Strict(False)]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _Metric(_Part):
    unit: str
    values: list[_Number] | None = None
    median: _Number
    min: _Number
    max: _Number


class _Failure(_Part):
    reason: str
    time: _Number
    joint: str | None
    repetition: int | None


class _Caveat(_Part):
    rule: str
    text: str
    value: _Number


class _Share(_Part):
    kept: int | None
    of: int | None
    low: _Number
    high: _Number


class _Bound(_Share):
    min: _Number
    max: _Number
    reason: str


class _Spec(_Part):
    bounds: dict[str, _Bound]
    all: _Share
    history: dict[str, list[_Entry]] = {}


class _Provenance(_Part):
    date: str
    command: str
    commit: str | None
    versions: dict[str, str]
    machine: str | dict[str, str]
    seed: int
    plant_step: float
    warnings: list[str]


class _Arm(_Part):
    tip: str = ""
    home: list[float] = []


class _Config(_Part):
    seed: int = 0
    repetitions: int = 1
    robot: _Arm = _Arm()
    controller: dict[str, Any] = {}
    trajectory: dict[str, Any] = {}
    plant: dict[str, Any] = {}


class _Record(_Part):
    status: Literal["ok", "failed"]
    repetitions: int
    failure: _Failure | None = None
    caveats: list[_Caveat] = []
    spec: _Spec | None = None
    metrics: dict[str, _Metric]
    timing: dict[str, _Number]
    provenance: _Provenance


def find_faults(record: Any) -> str:
    """Return a message that describes the faults of a run's record; empty if there are none."""
    faults = _faults(_Record, record)
    return faults or ("failure: missing" if record["status"] == "failed" and not record.get("failure") else "")


def find_config_faults(config: Any) -> str:
    """Return a message on the values of a run's config that have another type than any run's; empty if there are none.

    Only values that readers of stored runs use are checked.
    """
    return _faults(_Config, config)


def _faults(model: type[_Part], content: Any) -> str:
    try:
        model.model_validate(content)
    except ValidationError as error:
        return "; ".join(f"{'.'.join(map(str, item['loc']))}: {item['msg']}" for item in error.errors()[:3])
    return ""


@dataclass(frozen=True)
class Metric:
    """One metric over the repetitions of a run.

    Attributes:
        unit: Unit, "1" for none.
        median: Median; a missing value counts as beyond every number. None if the median is missing.
        min: Smallest value; None if there is none.
        max: Largest value; None if a value is missing.
        quantiles: Quantiles by level, from "0.01" to "0.99"; empty up to 2,000 repetitions.
        repetitions: Number of repetitions.
        read: Reads the values, shape (repetitions,), NaN for none.
    """

    unit: str
    median: float | None
    min: float | None
    max: float | None
    quantiles: Mapping[str, float | None] = field(repr=False)
    repetitions: int = field(repr=False)
    read: Callable[[], FloatArray] = field(repr=False, compare=False)

    @cached_property
    def values(self) -> tuple[float | None, ...]:
        """Value in each repetition; None if the motion never settled or the repetition failed."""
        return tuple(None if value != value else value for value in self.read().tolist())

    @property
    def text(self) -> str:
        """The median with the range, as in "0.688 mm (0.62 to 0.73)"."""
        return self.beside(None)

    def beside(self, printed: float | None) -> str:
        """Return the median with the range, in the unit of a printed value next to it."""
        return spread(self.unit, self.median, self.min, self.max, self.repetitions, printed)

    def __str__(self) -> str:
        """Return the median with the range."""
        return self.text


class Metrics(Mapping[str, Metric]):
    """The metrics of a run by name. An unknown name raises an error with the nearest name.

    Args:
        record: The record of the run.
        values: Reads the values of a metric.
    """

    def __init__(self, record: Mapping[str, Any], values: Callable[[str], FloatArray]) -> None:
        self._stored, self._count, self._values = record["metrics"], record["repetitions"], values

    def __getitem__(self, name: str) -> Metric:
        if name not in self._stored:
            raise UnknownMetricError(unknown("metric", name, self._stored or ["none, because the run failed"]))
        found = self._stored[name]
        ends = found["unit"], found["median"], found["min"], found["max"]
        return Metric(*ends, found.get("quantiles", {}), self._count, partial(self._values, name))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Metrics) and self._stored == other._stored

    def __contains__(self, name: object) -> bool:
        return name in self._stored

    def __iter__(self) -> Iterator[str]:
        return iter(self._stored)

    def __len__(self) -> int:
        return len(self._stored)

    def __repr__(self) -> str:
        return f"<{len(self)} metrics: {', '.join(self)}>"


class UnknownMetricError(RunnerError, KeyError):
    """A metric that a run does not have; a KeyError, so that `in` and `get` of a mapping work."""

    __str__ = RunnerError.__str__  # a KeyError would quote the message
