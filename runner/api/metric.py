"""The metrics of a run, by name."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from runner.errors import RunnerError, nearest
from runner.quantities import spread


@dataclass(frozen=True)
class Metric:
    """One metric over the repetitions of a run.

    Attributes:
        unit: Its unit, "1" for none.
        median: Median, a missing value counting as beyond every number; None when that is missing.
        min: Smallest value, None when there is none.
        max: Largest value, None as soon as one is missing.
        values: Value in each repetition; None where it has none, as it never settled or the repetition failed.
    """

    unit: str
    median: float | None
    min: float | None
    max: float | None
    values: tuple[float | None, ...]

    def __str__(self) -> str:
        """Say the median with the range, as in "0.688 mm (0.62 to 0.73)"."""
        return spread(vars(self))


class Metrics(Mapping[str, Metric]):
    """The metrics of a run by name; one that the run does not have is refused with the nearest that it has.

    Args:
        record: The metrics as they are stored.
    """

    def __init__(self, record: Mapping[str, Mapping[str, Any]]) -> None:
        self._record = record

    def __getitem__(self, name: str) -> Metric:
        if name not in self._record:
            known = ", ".join(self._record) or "none, as the run failed"
            raise UnknownMetricError(
                f"the run has no metric '{name}'{nearest(str(name), self._record)}; it has: {known}"
            )
        found = self._record[name]
        return Metric(found["unit"], found["median"], found["min"], found["max"], tuple(found["values"]))

    def __iter__(self) -> Iterator[str]:
        return iter(self._record)

    def __len__(self) -> int:
        return len(self._record)

    def __repr__(self) -> str:
        return f"<{len(self)} metrics: {', '.join(self)}>"


class UnknownMetricError(RunnerError, KeyError):
    """A metric that a run does not have; a KeyError, so that `in` and `get` of a mapping do what one expects."""

    __str__ = RunnerError.__str__  # a KeyError would quote the message
