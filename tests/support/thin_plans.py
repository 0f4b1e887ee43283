"""Plans of studies made thin, and their runs, made once for all test processes.

A thin plan has the runs of the whole one by name. Runs that differ only in numbers are of a kind: of each kind the
first and the last are made, and stand in for the others. `make test-slow` runs whole plans.
"""

import fcntl
import hashlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol, TypeVar

from runner import store
from runner.store import Calibration, Run
from runner.sweeps.job import calibrate, run

Overrides = tuple[str, ...]


class HasFolder(Protocol):
    """Something that is stored in a folder."""

    @property
    def folder(self) -> Path: ...


Kept = TypeVar("Kept", bound=HasFolder)

_NUMBER = re.compile(r"-?\d+(\.\d*)?(e-?\d+)?")
_OPTIONS = ("experiment=", "preset=", "plant=", "robot=")


def stand_ins(jobs: Mapping[str, Overrides], every: tuple[str, ...] = ()) -> dict[str, str]:
    """Return the name of the run that stands for each, by name.

    Args:
        jobs: Overrides by name.
        every: How the names begin of runs that stand for themselves in any case.
    """
    kinds: dict[Overrides, list[str]] = {}
    for name, overrides in jobs.items():
        kind = tuple(o if o.startswith(_OPTIONS) else _NUMBER.sub("0", o) for o in overrides)
        kinds.setdefault((name,) if name.startswith(every) else kind, []).append(name)
    return {
        name: names[-1] if 2 * index >= len(names) else names[0]
        for names in kinds.values()
        for index, name in enumerate(names)
    }


def make_runs(
    folder: Path,
    jobs: Mapping[str, Overrides],
    stands_for: Mapping[str, str] | None = None,
    config_dirs: Sequence[Path] = (),
) -> dict[str, Run]:
    """Return the runs of jobs by name.

    Args:
        folder: Shared by all test processes; the first process that needs a run simulates it.
        jobs: Overrides by name.
        stands_for: Name of the run that stands for each; None if each represents itself.
        config_dirs: Config folders of the study's own.
    """

    def run_here(*overrides: str) -> Run:
        return run(*overrides, config_dirs=config_dirs)

    stands_for = {name: name for name in jobs} if stands_for is None else stands_for
    made = make_once(folder, {name: jobs[name] for name in stands_for.values()}, run_here, store.open_run)
    return {name: made[stands_for[name]] for name in jobs}


def make_calibrations(folder: Path, jobs: Mapping[str, Overrides]) -> dict[str, Calibration]:
    """Return the calibrations of jobs by name."""
    return make_once(folder, jobs, calibrate, store.open_calibration)


def make_once(
    folder: Path, jobs: Mapping[str, Overrides], make: Callable[..., Kept], read: Callable[[Path], Kept]
) -> dict[str, Kept]:
    """Return the results of jobs by name; the first process that needs one makes it.

    Args:
        folder: Shared by all test processes.
        jobs: Overrides by name.
        make: Makes a result from its overrides; this function's name and the overrides identify the result.
        read: Reads what was made from its folder.
    """
    made: dict[str, Kept] = {}
    left = dict(jobs)
    while left:
        for name, overrides in list(left.items()):
            # Jobs in another process are left for later, except for the last.
            with _mine(folder / _digest(make.__name__, *overrides), wait=len(left) == 1) as note:
                if note is None:
                    continue
                if not note.read_text():
                    note.write_text(str(make(*overrides, f"outputs={folder / 'outputs'}").folder))
                made[name] = read(Path(note.read_text()))
                del left[name]
    return {name: made[name] for name in jobs}


def _digest(*texts: str) -> str:
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()


@contextmanager
def _mine(path: Path, wait: bool) -> Iterator[Path | None]:
    """Hold a file that no other process holds meanwhile; None where one does and `wait` is false."""
    with path.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            yield None
        else:
            yield path
