"""Public functions that open a stored run or sweep."""

from pathlib import Path
from typing import TYPE_CHECKING

from runner import store
from runner.api.boundary import public, public_class
from runner.store.kinds import find_folder

if TYPE_CHECKING:
    from runner.api.run import Run
    from runner.api.sweep import Sweep
    from runner.api.tuning import Tuning


@public
def open_run(folder: str | Path) -> "Run":
    """Open a stored run.

        >>> made = runner.run(robot="macro", duration=0.1)
        >>> runner.open_run(made.folder).status
        'ok'

    Args:
        folder: Folder of the run, such as "outputs/runs/0871075a1b2c3d4e5f607182"; "latest" for the run that was
            simulated or reused last.

    Raises:
        RunnerError: if the folder is not a run, or the run is unfinished or damaged.
    """
    from runner.api.run import Run

    return public_class(Run, store.open_run(find_folder(folder, ("run",))))


@public
def open_sweep(folder: str | Path) -> "Sweep":
    """Open a stored sweep, still running or ended.

    Args:
        folder: Folder of the sweep in `outputs/sweeps`; "latest" for the one simulated or reused last.

    Raises:
        RunnerError: if the folder is not a sweep, or is damaged.
    """
    from runner.api.sweep import Sweep

    return public_class(Sweep, store.open_sweep(find_folder(folder, ("sweep", "tuning"))))


@public
def open_tuning(folder: str | Path) -> "Tuning":
    """Open a stored tuning.

        >>> made = runner.tune(robot="macro", trajectory="quintic", duration=0.1, workers=0, trials=2,
        ...                    controller__natural_frequency=(5, 50), minimize="max_tracking_error")
        >>> len(runner.open_tuning(made.folder).to_frame())
        2

    Args:
        folder: Folder of the tuning in `outputs/tunings`; "latest" for the one simulated or reused last.

    Raises:
        RunnerError: if the folder is not a tuning, or is damaged.
    """
    from runner.api.tuning import Tuning
    from runner.sweeps.tuning import study

    return public_class(Tuning, study.open_tuning(find_folder(folder, ("tuning",))))
