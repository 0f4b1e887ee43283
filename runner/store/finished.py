"""Finished runs of an outputs folder, in run folders and in shards.

`outputs/finer/<hash>.json` has the metrics of a finished run with a finer plant step.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.atomic import refuse_links, write_atomically
from runner.base.errors import StoreError
from runner.store.names import Names, best_of_each, look_up
from runner.store.run import Run, open_run
from runner.store.seal import DamagedError, check_job, read_json, sealed_json
from runner.store.shards import Outcomes, RunOutcome, open_row, outcome, read_outcomes, shard_files

FINER = "finer"
_REMEDY = "delete it: `runner compare` computes it again"


def find_run(outputs: Path, name: str) -> Run | None:
    """Return the finished run with a hash from its own run folder, or None if there is none.

    Raises:
        DamagedError: if the run is damaged.
    """
    folder = outputs / "runs" / name
    if not (folder / "metrics.json").exists():
        return None
    check_job(folder, "metrics.json")
    return open_run(folder)


def find_outcome(outputs: Path, name: str) -> RunOutcome | None:
    """Return the outcome of the finished run with a hash in its own run folder, or None if there is none.

    Raises:
        DamagedError: if the run is damaged.
    """
    if not os.path.exists(f"{outputs}/runs/{name}/metrics.json"):  # noqa: PTH110 - asked of each run of a sweep
        return None
    folder = outputs / "runs" / name
    return outcome(Run(folder, {}, check_job(folder, "metrics.json")))


class Finished(Outcomes):
    """Finished runs at the time of construction, those in shards by ascending name.

    If a run has two outcomes, the better one counts. A good run is better than a failed run, and a failed run is better
    than an aborted run. Of equal outcomes, the one in a run folder counts, then the one in the later shard.

    Args:
        outputs: The outputs folder.

    Attributes:
        damage: Message for each damaged file that was read; such a file counts as missing.
        shard: Index of the shard that contains each run, shape (n,); see `shard_of`.
        row: Row of each run in its shard, shape (n,).
    """

    def __init__(self, outputs: Path) -> None:
        self._outputs = outputs
        runs = outputs / "runs"
        self._folders = {entry.name for entry in os.scandir(runs)} if runs.is_dir() else set()
        self._shards: list[Path] = []
        self.damage: list[str] = []
        parts: list[Outcomes] = []
        for path in shard_files(outputs):
            try:
                parts.append(read_outcomes(path))
                self._shards.append(path)
            except DamagedError as error:
                self.damage.append(str(error))
        sizes = [len(part) for part in parts]
        names = np.concatenate([part.names for part in parts] or [np.zeros(0, dtype="S1")])
        rank = np.concatenate([part.rank for part in parts] or [np.zeros(0, dtype=np.int8)])
        kept = best_of_each(names, rank, -np.arange(len(names)))
        starts = np.cumsum([0, *sizes])
        self.shard = np.searchsorted(starts, kept, side="right") - 1
        self.row = kept - starts[self.shard]
        caveats = np.concatenate([part.caveats for part in parts] or [np.zeros(0, dtype=np.int32)])
        failed = np.flatnonzero(rank[kept]).tolist()
        failures = {place: parts[self.shard[place]].failures.get(int(self.row[place]), "") for place in failed}
        machines = np.concatenate([part.machines for part in parts] or [np.zeros(0, dtype=object)])
        super().__init__(names[kept], rank[kept], caveats[kept], failures, machines[kept])

    def folders(self, names: Names) -> set[str]:
        """Return the given runs that may have their own run folder."""
        return self._folders.intersection(names) if self._folders else set()

    def places(self, names: Names) -> NDArray[np.intp]:
        """Return the indices in `names` of the given runs that are in shards, ascending."""
        found = np.unique(self.places_of(names))
        return found[found >= 0]

    def places_of(self, names: Names) -> NDArray[np.intp]:
        """Return the index in `names` of each given run, shape (n,); -1 for a run that is in no shard."""
        return look_up(names.texts, self.names)

    def in_folder(self, name: str) -> RunOutcome | None:
        """Return the outcome of a run in its own run folder, or None if there is none."""
        if name not in self._folders:
            return None
        try:
            return find_outcome(self._outputs, name)
        except DamagedError as error:
            self.damage.append(str(error))
            return None

    def shard_of(self, place: int) -> Path:
        """Return the shard that contains the run at an index of `names`."""
        return self._shards[int(self.shard[place])]

    def outcome(self, name: str) -> RunOutcome | None:
        """Return the outcome of a run, or None if it is not finished."""
        place, own = int(self.places_of(Names.of([name]))[0]), self.in_folder(name)
        ends = [*([] if own is None else [own]), *([] if place < 0 else [self[place]])]
        return min(ends, key=lambda end: end.rank, default=None)

    def open(self, name: str) -> Run:
        """Open a run.

        Raises:
            StoreError: if the run is unfinished or damaged; lists the damaged shards that may contain it.
        """
        place = int(self.places_of(Names.of([name]))[0])
        if place < 0:
            try:
                return open_run(self._outputs / "runs" / name)
            except DamagedError:
                raise
            except StoreError as error:
                raise StoreError("; ".join([str(error), *self.damage])) from error
        end = self.in_folder(name)
        if end is not None and end.rank <= self.rank[place]:
            return open_run(self._outputs / "runs" / name)
        return open_row(self.shard_of(place), int(self.row[place]))


def write_finer(outputs: Path, name: str, reason: str, metrics: Mapping[str, FloatArray]) -> None:
    """Store the metrics of a run with a finer step.

    Args:
        outputs: The outputs folder.
        name: Hash of the run.
        reason: Reason why the plant cannot use a finer step; empty if it can.
        metrics: Each metric in the first repetitions; a value that is not finite is read back as infinity.

    Raises:
        StoreError: if it cannot be written.
    """
    values = {key: [float(one) if np.isfinite(one) else None for one in row] for key, row in metrics.items()}
    refuse_links(outputs, outputs / FINER)
    write_atomically(outputs / FINER / f"{name}.json", sealed_json({"reason": reason, "metrics": values}))


def finer_names(outputs: Path) -> set[str]:
    """Return the hashes of the runs that have a stored result for a finer step, or a reason why they have none."""
    return {path.stem for path in (outputs / FINER).glob("[!.]*.json")}


def read_finer(outputs: Path, name: str) -> Mapping[str, Sequence[float]]:
    """Return each metric of a run with a finer step, in its first repetitions; empty if the run cannot have one.

    Raises:
        DamagedError: if the file differs from what was written.
    """
    record = read_json(outputs / FINER / f"{name}.json", _REMEDY)
    return {key: [np.inf if one is None else one for one in row] for key, row in record["metrics"].items()}
