"""Public class of a stored tuning: trials and the best run."""

from typing import TYPE_CHECKING

from runner import store
from runner.api import page
from runner.api.boundary import public, public_class
from runner.api.run import Run
from runner.base.errors import RunnerError
from runner.base.quantities import quantity
from runner.base.sanitize import one_line
from runner.sweeps.tuning import study
from runner.sweeps.tuning.objective import best

if TYPE_CHECKING:
    import pandas as pd


class Tuning(study.Tuning):
    """A stored tuning: `runner.tune` makes one, `runner.open_tuning` opens one."""

    def to_frame(self) -> "pd.DataFrame":
        """Return the trials, one row each: the tuned keys, the objectives, failure, hash of the run, and best.

        `best` is True for the best trial; with several objectives, for the trials on the Pareto front.
        """
        import pandas as pd

        best = set(self._best())
        objectives = [objective.metric for objective in self.study.objectives]
        rows = [
            {**trial.params, **dict(zip(objectives, trial.values, strict=True))}
            | {"failure": trial.failure, "hash": trial.run, "best": number in best}
            for number, trial in enumerate(self.trials)
        ]
        columns = [*(key.name for key in self.study.keys), *objectives, "failure", "hash", "best"]
        return pd.DataFrame(rows, columns=columns).rename_axis("trial")

    @public
    def best(self) -> Run:
        """Return the run of the best trial; with several objectives, of the first trial on the Pareto front.

        Raises:
            RunnerError: if all trials failed.
        """
        best = self._best()
        if not best:
            raise RunnerError(f"{self.folder}: no trial ended well, so none is the best")
        return public_class(Run, store.Finished(self.folder.parent.parent).open(self.trials[best[0]].run))

    def _best(self) -> list[int]:
        return best(self.trials, self.study.objectives)

    def _lines(self) -> list[str]:
        study, trials = self.study, self.trials
        failed = sum(bool(trial.failure) for trial in trials)
        lines = [f"{len(trials)} trials of {', '.join(key.name for key in study.keys)}, {failed} of them failed"]
        for number in self._best():
            trial = trials[number]
            told = ", ".join(
                f"{objective.metric} {quantity(value, objective.unit)}"
                for objective, value in zip(study.objectives, trial.values, strict=True)
            )
            lines.append(f"chosen: {told} with {', '.join(key.override(trial.params[key.name]) for key in study.keys)}")
        return lines

    def __repr__(self) -> str:
        first, *rest = self._lines()
        return "\n  ".join(map(one_line, [f"Tuning: {first}", *rest, str(self.folder)]))

    def _repr_html_(self) -> str:
        first, *rest = self._lines()
        return page.heading("Tuning", first) + page.listed("", rest) + page.code(self.folder)
