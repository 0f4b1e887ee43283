"""A published work: which runs it needs, what is expected of them, and the report that is made of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from runner.reporting.document import Document
from runner.reporting.expected_caveats import ExpectedCaveat
from runner.reporting.job import Jobs
from runner.store import Calibration, Run

Calibrations = Mapping[str, tuple[str, ...]]
"""Overrides of each calibration by its name."""


@dataclass(frozen=True)
class Work:
    """A published work, as the module `work.py` of its folder has it.

    Attributes:
        jobs: Gives the runs that it needs, by name.
        document: Makes its report from the runs and calibrations, by name.
        expected: The caveats that its runs are to have.
        calibrations: Gives the calibrations that it needs, by name.
        measure: Measures what no run does, such as computing times, into an outputs folder.
    """

    jobs: Callable[[], Jobs]
    document: Callable[[Mapping[str, Run], Mapping[str, Calibration]], Document]
    expected: Sequence[ExpectedCaveat] = ()
    calibrations: Callable[[], Calibrations] = dict
    measure: Callable[[Path], None] = lambda outputs: None


def load_work(name: str) -> Work:
    """Return a work by the name of its folder."""
    work: Work = import_module(f"runner.works.{name}.work").WORK
    return work
