"""Definition of a tuning (keys, objectives and folder), and stored tunings."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from runner.base.atomic import write_atomically
from runner.store.seal import DamagedError, read_json, sealed_json
from runner.store.sweep import write_jobs
from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial, best

JOURNAL = "journal.log"
"""File of a tuning's journal."""

_FILE = "tuning.json"
_MEND = "the tuning's command makes it again"


@dataclass(frozen=True)
class TuningDefinition:
    """Definition of a tuning.

    Attributes:
        overrides: The overrides that all trials share, as typed, without those that do not affect the simulation.
        keys: The tuned keys.
        objectives: The objectives.
        at_once: Number of simultaneous trials: trial n is chosen when the trials up to n - at_once have ended.
        command: The command that starts and continues the tuning.
    """

    overrides: Sequence[str]
    keys: Sequence[TunedKey]
    objectives: Sequence[Objective]
    at_once: int
    command: str

    def trial_overrides(self, trial: Trial) -> list[str]:
        """Return the overrides of a trial."""
        return [*self.overrides, *(key.override(trial.params[key.name]) for key in self.keys)]

    def folder(self, outputs: Path, probes: Sequence[str]) -> Path:
        """Return the folder of the tuning.

        Args:
            outputs: The outputs folder.
            probes: Hashes of runs in the ranges. They change with the config, robot and source that the trials share,
                so a change of these gives another tuning.
        """
        objectives = [asdict(objective) for objective in self.objectives]
        content = [list(probes), [asdict(key) for key in self.keys], objectives, self.at_once]
        return outputs / "tunings" / hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]

    def write(self, folder: Path, trials: Sequence[Trial], fresh: "Fresh | None" = None) -> None:
        """Write the definition and the list of runs, which makes the tuning a sweep for all other commands.

        Raises:
            StoreError: if a file cannot be written.
        """
        more = {"trials": len(trials), "fresh": None if fresh is None else asdict(fresh)}
        write_atomically(folder / _FILE, sealed_json({**asdict(self), **more}))
        write_jobs(folder, [(self.trial_overrides(trial), trial.run) for trial in trials if trial.run], self.command)


@dataclass(frozen=True)
class Fresh:
    """Runs on a seed that the tuning did not use; see fresh.py.

    Attributes:
        trial: Number of the chosen trial; of several on a Pareto front, the best one in the first objective.
        default: Hash of the run with the default values of the tuned keys.
        tuned: Hash of the run with the values of the trial.
    """

    trial: int
    default: str
    tuned: str


@dataclass(frozen=True)
class Tuning:
    """Stored tuning, running or finished.

    Attributes:
        folder: Folder of the tuning.
        study: Definition of the tuning.
        trials: The finished trials.
        fresh: Runs of the default and the tuned config on another seed; None if there are none.
    """

    folder: Path
    study: TuningDefinition
    trials: Sequence[Trial]
    fresh: Fresh | None = None


def count_trials(trials: Sequence[Trial]) -> str:
    """Return the numbers of trials and of failed ones; also that of their runs if some trials have the same one."""
    failed = sum(bool(trial.failure) for trial in trials)
    made = [trial.run for trial in trials if trial.run]
    shared = f"; {len(set(made))} runs, because equal trials share one" if len(set(made)) < len(made) else ""
    return f"{len(trials)} trials, {failed} of them failed{shared}"


def at_ends(tuning: Tuning) -> list[str]:
    """Return a sentence for each end of a range that is near the value of a chosen trial."""
    study, numbers = tuning.study, best(tuning.trials, tuning.study.objectives)
    found = []
    for key in study.keys:
        values = [tuning.trials[number].params[key.name] for number in numbers]
        for end in ("lower", "upper"):
            near = [value for value in values if key.end_near(value) == end]
            which = (
                f"the chosen value, {values[0]:.3g}, lies"
                if len(values) == 1
                else f"{len(near)} of {len(values)} chosen values lie"
            )
            if near:
                found.append(
                    f"{key.name}: {which} within 2 % of the {end} end of its range ({key.low:.3g} to {key.high:.3g}). "
                    "A wider range may give a better one."
                )
    return found


def open_tuning(folder: Path) -> Tuning:
    """Open a stored tuning.

    Raises:
        DamagedError: if the folder is not a tuning, or is damaged.
    """
    from runner.sweeps.tuning.journal import read_trials  # imports Optuna

    path, journal = folder / _FILE, folder / JOURNAL
    try:
        content = read_json(path, _MEND)
        study = TuningDefinition(
            overrides=content["overrides"],
            keys=[TunedKey(**key) for key in content["keys"]],
            objectives=[Objective(**objective) for objective in content["objectives"]],
            at_once=content["at_once"],
            command=content["command"],
        )
        ended, fresh = content["trials"], content["fresh"] and Fresh(**content["fresh"])
    except (KeyError, TypeError) as error:
        raise DamagedError(
            f"cannot read {path}: it does not describe a tuning: {type(error).__name__}: {error}; {_MEND}"
        ) from error
    trials = read_trials(journal)
    if len(trials) < ended:
        raise DamagedError(f"cannot read {journal}: it has {len(trials)} of the {ended} trials that ended; {_MEND}")
    return Tuning(folder, study, trials, fresh)
