"""Outcomes of the jobs of a sweep, in a few bytes each."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from runner.base.machine import Machine
from runner.store import Finished, RunOutcome
from runner.store.names import Names, best_of_each, look_up

_NOT_YET, _CUT_SHORT = -1, 2


class Ends(Mapping[str, RunOutcome]):
    """Outcomes of the finished jobs of a sweep, by name.

    Args:
        names: Name of each cell's run or calibration.
    """

    def __init__(self, names: Names) -> None:
        first = best_of_each(names.texts, np.arange(len(names)))
        self._first = first  # cell of each distinct name
        self._names = names.texts[first]
        self._rank = np.full(len(first), _NOT_YET, dtype=np.int8)
        self._caveats = np.zeros(len(first), dtype=np.int32)
        self._failures: dict[int, str] = {}
        self._machines = np.full(len(first), Machine(), dtype=object)
        self._places = look_up(names.texts, self._names).astype(np.int32)

    def add(self, outcomes: Iterable[RunOutcome]) -> None:
        """Add the outcomes of finished jobs, which must belong to the sweep."""
        given = list(outcomes)
        places = look_up(Names.of(end.name for end in given).texts, self._names)
        self._rank[places] = [end.rank for end in given]
        self._caveats[places] = [end.caveats for end in given]
        self._machines[places] = [end.machine for end in given]
        for place, end in zip(places.tolist(), given, strict=True):
            self._failures.pop(place, None)
            if end.failure:
                self._failures[place] = end.failure

    def add_stored(self, finished: Finished, stored: NDArray[np.intp]) -> None:
        """Add the outcomes of jobs in shards, given by their indices in `finished.names`."""
        places = look_up(finished.names[stored], self._names)
        self._rank[places], self._caveats[places] = finished.rank[stored], finished.caveats[stored]
        self._machines[places] = finished.machines[stored]
        for which in np.flatnonzero(finished.rank[stored]).tolist():
            self._failures[int(places[which])] = finished.failures[int(stored[which])]

    @property
    def left(self) -> NDArray[np.intp]:
        """Cells of the unfinished jobs, one for each job, in order."""
        return np.sort(self._first[self._rank == _NOT_YET])

    @property
    def failed(self) -> NDArray[np.intp]:
        """The cells that failed, in order."""
        return np.flatnonzero(self._rank[self._places] > 0)

    @property
    def caveats(self) -> NDArray[np.int32]:
        """Number of caveats of each cell that ended."""
        found: NDArray[np.int32] = self._caveats[self._places][self._rank[self._places] != _NOT_YET]
        return found

    @property
    def machines(self) -> Counter[Machine]:
        """Number of jobs that ended on each machine; an unknown machine is a Machine without parts."""
        return Counter(self._machines[self._rank != _NOT_YET].tolist())

    def __len__(self) -> int:
        return int(np.sum(self._rank != _NOT_YET))

    def __iter__(self) -> Iterator[str]:
        return iter(Names(self._names[self._rank != _NOT_YET]))

    def __getitem__(self, name: str) -> RunOutcome:
        place = int(look_up(Names.of([name]).texts, self._names)[0])
        if place < 0 or self._rank[place] == _NOT_YET:
            raise KeyError(name)
        rank, caveats = int(self._rank[place]), int(self._caveats[place])
        return RunOutcome(name, self._failures.get(place, ""), rank == _CUT_SHORT, caveats, self._machines[place])
