"""The finished runs of an outputs folder, in folders of their own and in shards."""

from pathlib import Path

from runner.errors import StoreError
from runner.store.run import Run, open_run
from runner.store.seal import DamagedError
from runner.store.shards import Outcome, open_row, outcome, read_outcomes, shard_files
from runner.store.stored import check_job


def find_run(outputs: Path, name: str) -> Run | None:
    """Return the run of that hash that has a folder of its own, or None when there is none that was finished.

    Raises:
        DamagedError: if it is damaged.
    """
    folder = outputs / "runs" / name
    if not (folder / "metrics.json").exists():
        return None
    check_job(folder, "metrics.json")
    return open_run(folder)


def find_outcome(outputs: Path, name: str) -> Outcome | None:
    """Return how the run of that hash in a folder of its own ended, or None when there is none that was finished.

    Raises:
        DamagedError: if it is damaged.
    """
    folder = outputs / "runs" / name
    if not (folder / "metrics.json").exists():
        return None
    run = Run(folder, {}, check_job(folder, "metrics.json"))
    return outcome(run if run.sealed else open_run(folder))


class Finished:
    """The finished runs, as they are when this is made; of two outcomes of one run the better counts.

    A good one is better than a failed one, and that is better than one that was cut short. Else that with a folder of
    its own counts, then that of the later shard.

    Args:
        outputs: The outputs folder.

    Attributes:
        damage: What is damaged of what was looked at, a text for each file; it counts as not there.
    """

    def __init__(self, outputs: Path) -> None:
        self._outputs = outputs
        runs = outputs / "runs"
        self._folders = {entry.name for entry in runs.iterdir()} if runs.is_dir() else set()
        self._found: dict[str, tuple[Path, int, Outcome]] = {}
        self.damage: list[str] = []
        for path in shard_files(outputs):
            try:
                for row, end in enumerate(read_outcomes(path)):
                    known = self._found.get(end.name)
                    if known is None or end.rank <= known[2].rank:
                        self._found[end.name] = (path, row, end)
            except DamagedError as error:
                self.damage.append(str(error))

    def in_folder(self, name: str) -> Outcome | None:
        """Return how the run in a folder of its own ended, or None when there is none."""
        if name not in self._folders:
            return None
        try:
            return find_outcome(self._outputs, name)
        except DamagedError as error:
            self.damage.append(str(error))
            return None

    def in_shard(self, name: str) -> Outcome | None:
        """Return how the run in a shard ended, or None when there is none."""
        found = self._found.get(name)
        return None if found is None else found[2]

    def outcome(self, name: str) -> Outcome | None:
        """Return how a run ended, or None when it is not finished."""
        ends = [end for end in (self.in_folder(name), self.in_shard(name)) if end is not None]
        return min(ends, key=lambda end: end.rank, default=None)

    def open(self, name: str) -> Run:
        """Open a run.

        Raises:
            StoreError: if it is not finished, or damaged; tells damaged shards, in which it may be.
        """
        shard = self._found.get(name)
        if shard is None:
            try:
                return open_run(self._outputs / "runs" / name)
            except DamagedError:
                raise
            except StoreError as error:
                raise StoreError("; ".join([str(error), *self.damage])) from error
        end = self.in_folder(name)
        if end is not None and end.rank <= shard[2].rank:
            return open_run(self._outputs / "runs" / name)
        return open_row(*shard[:2])
