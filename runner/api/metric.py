"""Metrics of a run, by name."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial

from runner import store
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.base.quantities import spread


@dataclass(frozen=True)
class Metric:
    """One metric over the repetitions of a run.

    Attributes:
        unit: Its unit, "1" for none.
        median: Median, a missing value counting as beyond every number; None when that is missing.
        min: Smallest value, None when there is none.
        max: Largest value, None as soon as one is missing.
        quantiles: By level, from "0.01" to "0.99", likewise; empty up to 2,000 repetitions.
        text: The median with the range, as in "0.688 mm (0.62 to 0.73)".
        read: Reads the values.
    """

    unit: str
    median: float | None
    min: float | None
    max: float | None
    quantiles: Mapping[str, float | None] = field(repr=False)
    text: str = field(repr=False)
    read: Callable[[], FloatArray] = field(repr=False, compare=False)

    @cached_property
    def values(self) -> tuple[float | None, ...]:
        """Value in each repetition; None where it has none, as it never settled or the repetition failed."""
        return tuple(None if value != value else value for value in self.read().tolist())

    def __str__(self) -> str:
        """Say the median with the range."""
        return self.text


class Metrics(Mapping[str, Metric]):
    """The metrics of a run by name; one that the run does not have is refused with the nearest that it has.

    Args:
        run: The run as it is stored.
    """

    def __init__(self, run: store.Run) -> None:
        self._run, self._record = run, run.metrics

    def __getitem__(self, name: str) -> Metric:
        if name not in self._record:
            known = ", ".join(self._record) or "none, as the run failed"
            raise UnknownMetricError(
                f"the run has no metric '{name}'{nearest(str(name), self._record)}; it has: {known}"
            )
        found = self._record[name]
        ends = found["unit"], found["median"], found["min"], found["max"]
        return Metric(*ends, found.get("quantiles", {}), spread(found), partial(self._run.values, name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._record)

    def __len__(self) -> int:
        return len(self._record)

    def __repr__(self) -> str:
        return f"<{len(self)} metrics: {', '.join(self)}>"


class UnknownMetricError(RunnerError, KeyError):
    """A metric that a run does not have; a KeyError, so that `in` and `get` of a mapping do what one expects."""

    __str__ = RunnerError.__str__  # a KeyError would quote the message
