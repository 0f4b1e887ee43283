"""Journal of a tuning in Optuna's format: a sealed line of JSON for each finished trial, in order."""

import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import BaseJournalBackend
from optuna.trial import FrozenTrial

from runner.base.bounded_json import decode_json
from runner.base.errors import StoreError, describe_write_error
from runner.store.seal import DamagedError, Lines
from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial
from runner.sweeps.tuning.sampler import make_optuna_trial, read_ended


class Journal:
    """Journal of a running tuning. The lock of the outputs folder ensures that only one process writes it.

    Args:
        path: File of the journal; created if missing.
        keys: The tuned keys.
        objectives: The objectives.

    Attributes:
        trials: The finished trials.
        history: The finished trials as Optuna objects.

    Raises:
        DamagedError: if the file is damaged.
        StoreError: if the file cannot be written.
    """

    def __init__(self, path: Path, keys: Sequence[TunedKey], objectives: Sequence[Objective]) -> None:
        self._path, self._keys = path, keys
        self.history: list[FrozenTrial] = []
        self.trials: list[Trial] = []
        try:
            _mend(path)
            if path.exists():
                self._study, self.history, self.trials = _load(path)
            else:
                directions = [objective.direction for objective in objectives]
                self._study = optuna.create_study(
                    storage=_open(path), study_name=path.parent.name, directions=directions
                )
        except OSError as error:
            raise StoreError(describe_write_error(error, path)) from error

    def append(self, trial: Trial) -> None:
        """Append a finished trial.

        Raises:
            StoreError: if the file cannot be written.
        """
        frozen = make_optuna_trial(self._keys, trial)
        try:
            self._study.add_trial(frozen)
        except OSError as error:
            raise StoreError(describe_write_error(error, self._path)) from error
        self.history.append(frozen)
        self.trials.append(trial)


def read_trials(path: Path) -> list[Trial]:
    """Return the trials of a journal without writing to it; its tuning may be running.

    Raises:
        StoreError: if the journal cannot be read.
    """
    if not path.exists():
        raise StoreError(f"cannot read {path}: no such file")
    return _load(path)[2]


class _SealedLines(BaseJournalBackend):
    """Log of Optuna's storage: a file of sealed lines, read once.

    Args:
        path: The file.

    Raises:
        ValueError: if a line is not as it was written.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._lines = path, Lines()
        content = path.read_bytes() if path.exists() else b""
        self._logs: list[dict[str, Any]] = [decode_json(text) for text in self._lines.read(content)]

    def read_logs(self, log_number_from: int) -> Iterable[dict[str, Any]]:
        """Return the entries from an index on."""
        return self._logs[log_number_from:]

    def append_logs(self, logs: list[dict[str, Any]]) -> None:
        """Append entries and flush them to the disk."""
        text = "".join(f"{self._lines.seal(json.dumps(log))}\n" for log in logs)
        with self._path.open("ab") as file:
            file.write(text.encode())
            file.flush()
            os.fsync(file.fileno())
        self._logs += logs


def _open(path: Path) -> JournalStorage:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return JournalStorage(_SealedLines(path))


def _load(path: Path) -> tuple[optuna.Study, list[FrozenTrial], list[Trial]]:
    try:
        # A folder in `tunings` has the name of its study; a copy elsewhere may have any name.
        name = path.parent.name if path.absolute().parent.parent.name == "tunings" else None
        study = optuna.load_study(study_name=name, storage=_open(path))
        history = study.get_trials(deepcopy=False)
        return study, history, [read_ended(frozen) for frozen in history]
    except (OSError, ValueError, LookupError, TypeError, AttributeError, AssertionError) as error:
        raise DamagedError(
            f"cannot read {path}: it is damaged: {error}; remove it to restart the tuning (its runs are found again)"
        ) from error


def _mend(path: Path) -> None:
    """Remove the incomplete last line that a killed writer left."""
    if path.exists():
        content = path.read_bytes()
        whole = content.rfind(b"\n") + 1
        if whole == 0:
            path.unlink()
        elif whole < len(content):
            with path.open("r+b") as file:
                file.truncate(whole)
