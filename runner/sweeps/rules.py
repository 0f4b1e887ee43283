"""Rules for the runs of a sweep: plug-ins, traces, failures, attempts and time limit."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner import store

TraceKeeping = Literal["all", "sample", "failed", "never"]

_SAMPLE = 100  # one run in so many, where that makes no more than
_LARGEST_SAMPLE = 200  # runs: a run with its trace is four files


@dataclass(frozen=True)
class Rules:
    """How the runs of a sweep are made and kept.

    Attributes:
        plugins: The user's parts that the command line named.
        outputs: The outputs folder, absolute: every worker must see it.
        sweep: The sweep's folder, absolute.
        trace: Which runs keep their trace.
        accept_failed: Whether a stored run that failed counts as done.
        accept_cut_short: Whether one does that was cut short.
        stop_at_failure: Whether the first failed run ends the sweep.
        attempts: How often a run is tried that is cut short.
        time_limit: Longest wall-clock time of a run, in s; None for no limit.
        one_in: One run in so many keeps its trace where a sample does.
    """

    plugins: Sequence[str]
    outputs: Path
    sweep: Path
    trace: TraceKeeping
    accept_failed: bool
    accept_cut_short: bool
    stop_at_failure: bool
    attempts: int
    time_limit: float | None
    one_in: int = _SAMPLE

    @property
    def kept(self) -> float:
        """Share of the runs that end well which keep their trace."""
        return 1.0 / self.one_in if self.trace == "sample" else float(self.trace == "all")

    def keeps_trace(self, name: str, failed: bool) -> bool:
        """Tell whether a run keeps its trace, and with it a folder of its own."""
        if self.trace == "sample":
            return failed or int(name, 16) % self.one_in == 0
        return self.trace == "all" or (failed and self.trace == "failed")

    def log(self, name: str) -> Path:
        """Return the file that says why a run without a folder of its own failed."""
        return self.sweep / "logs" / f"{name}.txt"

    def accepts(self, end: store.Outcome | None) -> bool:
        """Tell whether a stored run counts as done."""
        return end is not None and self.accepts_rank(end.rank)

    def accepts_rank(self, rank: int) -> bool:
        """Tell whether a stored run does whose outcome has a rank; see Outcome."""
        return rank == 0 or (self.accept_failed and (self.accept_cut_short or rank == 1))


def one_in(runs: int) -> int:
    """Return the number of runs of a sweep of which one is in its sample: a hundred, or a multiple of it."""
    return _SAMPLE * max(1, -(-runs // (_SAMPLE * _LARGEST_SAMPLE)))
