"""The trials of a tuning as Optuna's journal: lines of JSON, one for each trial that ended, in order."""

from collections.abc import Sequence
from pathlib import Path

import optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend, JournalFileOpenLock
from optuna.trial import FrozenTrial

from runner.errors import StoreError
from runner.tuning.key import Key
from runner.tuning.objective import Objective
from runner.tuning.sampler import ended, read_ended
from runner.tuning.trial import Trial

_STUDY = "tuning"


class Journal:
    """The journal of a tuning at work. Only one may write: the lock of the outputs folder sees to it.

    Args:
        path: Its file, made when missing.
        keys: The tuned keys.
        objectives: What is to get better.

    Attributes:
        trials: The trials that ended.
        history: The same as Optuna keeps them.

    Raises:
        StoreError: if the file is damaged, or the disk does not take it.
    """

    def __init__(self, path: Path, keys: Sequence[Key], objectives: Sequence[Objective]) -> None:
        self._path, self._keys = path, keys
        try:
            _mend(path)
            if path.exists():
                self._study = _load(path)
            else:
                directions = [objective.direction for objective in objectives]
                self._study = optuna.create_study(storage=_open(path), study_name=_STUDY, directions=directions)
        except OSError as error:
            raise StoreError(f"cannot write {path}: {error.strerror}") from error
        self.history: list[FrozenTrial] = self._study.get_trials(deepcopy=False)
        self.trials = [read_ended(frozen) for frozen in self.history]

    def append(self, trial: Trial) -> None:
        """Add a trial that ended.

        Raises:
            StoreError: if the disk does not take it.
        """
        frozen = ended(self._keys, trial)
        try:
            self._study.add_trial(frozen)
        except OSError as error:
            raise StoreError(f"cannot write {self._path}: {error.strerror}") from error
        self.history.append(frozen)
        self.trials.append(trial)


def read_trials(path: Path) -> list[Trial]:
    """Return the trials of a journal, which may be at work; nothing is written.

    Raises:
        StoreError: if it cannot be read.
    """
    if not path.exists():
        raise StoreError(f"cannot read {path}: no such file")
    return [read_ended(frozen) for frozen in _load(path).get_trials(deepcopy=False)]


class _Unlocked(JournalFileOpenLock):
    """No lock of its own: Optuna's would outlive a process that is killed, by half a minute."""

    def acquire(self) -> bool:
        """Do nothing."""
        return True

    def release(self) -> None:
        """Do nothing."""


def _open(path: Path) -> JournalStorage:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return JournalStorage(JournalFileBackend(str(path), _Unlocked(str(path))))


def _load(path: Path) -> optuna.Study:
    try:
        return optuna.load_study(study_name=_STUDY, storage=_open(path))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StoreError(
            f"cannot read {path}: {type(error).__name__}: {error}; remove it to begin the tuning anew (its runs are "
            "found again)"
        ) from error


def _mend(path: Path) -> None:
    """Cut off the half line that a writer left behind who was killed."""
    if path.exists():
        content = path.read_bytes()
        whole = content.rfind(b"\n") + 1
        if whole == 0:
            path.unlink()
        elif whole < len(content):
            with path.open("r+b") as file:
                file.truncate(whole)
