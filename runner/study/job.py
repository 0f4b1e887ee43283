"""Stored results of a study by name; missing and omitted results raise errors."""

from collections.abc import Mapping
from typing import Any, TypeVar

from runner.base.errors import RunnerError, nearest
from runner.store import Calibration, Run

PRESETS = ("as_reported", "full_equations")
Thing = TypeVar("Thing")
Stored = TypeVar("Stored", Run, Calibration)


class MissingError(RunnerError):
    """A run or calibration that a report needs, and that was not made."""


class LeftOutError(MissingError):
    """A run or calibration that the profile leaves out."""


class Results(dict[str, Thing]):
    """The runs or calibrations of a study by name; asking for one that was not made raises MissingError.

    One that is not of the study is refused with the nearest name, so that no condition is left without its runs.

    Args:
        found: Those that were made.
        missing: Why the others were not, by name.
        dropped: Why others again were not asked for, by name; patterns of names do not stand for them.
    """

    def __init__(
        self, found: Mapping[str, Thing], missing: Mapping[str, str], dropped: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(found)
        self.missing = dict(missing)
        self.dropped = dict(dropped or {})
        self.derived: dict[object, Any] = {}
        """Values that a study computes from all results, by the keys that it chooses."""

    def __missing__(self, name: str) -> Thing:
        if name in self.missing:
            raise MissingError(f"{name}: {self.missing[name]}")
        if name in self.dropped:
            raise LeftOutError(f"{name}: {self.dropped[name]}")
        raise RunnerError(f"the study has no run or calibration '{name}'{nearest(name, [*self, *self.missing])}")


def distinct(named: Mapping[str, Stored]) -> list[Stored]:
    """Return runs or calibrations, each once: one may have several names. Reports count these."""
    return list({each.hash: each for each in named.values()}.values())
