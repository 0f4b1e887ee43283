"""Public functions run, sweep, tune and calibrate."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from runner import store
from runner.api.boundary import public, public_class
from runner.api.functions import use_functions
from runner.api.overrides import config_folders, run_overrides, sweep_overrides, tuning_overrides
from runner.api.run import Run
from runner.api.sweep import Sweep
from runner.api.tuning import Tuning
from runner.base.errors import ConfigError
from runner.plugins.discovery import named_parts, use_plugins

Folders = Sequence[str | Path] | str | Path


@public
def run(*overrides: str, config_dirs: Folders = (), plugins: Sequence[str] = (), **values: object) -> Run:
    """Simulate one run, or return the stored run, as `runner OVERRIDES` does.

        >>> runner.run("robot=macro", "noise=thesis", duration=0.1, controller__period=0.01).status
        'ok'
        >>> runner.run("robot=macro", "noise=thesis", "duration=0.1", **{"controller.period": 0.01}).status
        'ok'

    Args:
        overrides: Overrides as on the command line, such as "robot=macro" and "noise.position=1e-3".
        config_dirs: Your config folders, searched before the built-in ones.
        plugins: Your plug-ins as GROUP=MODULE, such as "controller=mine/spring.py". They stay loaded; restart Python
            after you edit such a file.
        values: Overrides as keywords; two underscores mean a dot. Strings are read as on the command line. `controller`
            may also be a function, see docs/plugins.md.

    Raises:
        RunnerError: if the config cannot be run (a ConfigError, which lists all its problems), or a folder cannot be
            written.
    """
    from runner.sweeps import job

    use_plugins(plugins)
    texts = run_overrides(overrides, use_functions(values))
    return public_class(Run, job.run(*texts, config_dirs=config_folders(config_dirs)))


@public
def sweep(
    *overrides: str,
    workers: int = 2,
    address: str | None = None,
    config_dirs: Folders = (),
    plugins: Sequence[str] = (),
    **values: object,
) -> Sweep:
    """Simulate every combination of some values, as `runner -m OVERRIDES` does.

    Stored runs are reused, so the same call resumes an interrupted sweep.

        >>> sweep = runner.sweep("noise=thesis", robot=["macro", "mini"], duration=0.1, workers=0)
        >>> sweep.run(robot="mini").status
        'ok'

    Args:
        overrides: Overrides as on the command line: "robot=macro,mini", "seed=range(0,20)".
        workers: Number of processes on this machine; 0 simulates the runs in this process.
        address: Address of a running Dask scheduler, such as "tcp://127.0.0.1:8786", instead of `workers`.
        config_dirs: See `run`.
        plugins: See `run`.
        values: See `run`; a list, tuple, range or array is an axis of the sweep. Wrap a single value that is itself a
            list in another list: `torque_limits__max=[[1, 2, 3]]`.

    Raises:
        RunnerError: if a config cannot be run, before the first run starts.
    """
    from runner.config.compose.composer import Composer
    from runner.sweeps.finer_step import work_out_sweep
    from runner.sweeps.run import Engine, run_sweep
    from runner.sweeps.typed import plan_typed

    use_plugins(plugins)
    folders, entries = config_folders(config_dirs), sweep_overrides(overrides, use_functions(values))
    texts = [each if isinstance(each, str) else each.typed for each in entries]
    _reject_hydra(texts)
    engine, loader = Engine(workers, address), Composer(folders)
    plan, _ = plan_typed(entries, loader)
    ended = run_sweep(plan, engine, _command(["-m"], folders, texts))
    sweep = store.open_sweep(ended.folder)
    if not ended.left:
        work_out_sweep(sweep)
    return public_class(Sweep, sweep)


@public
def tune(
    *overrides: str,
    minimize: str | Sequence[str] = (),
    maximize: str | Sequence[str] = (),
    trials: int = 100,
    jobs: int = 4,
    workers: int = 2,
    config_dirs: Folders = (),
    plugins: Sequence[str] = (),
    **values: object,
) -> Tuning:
    """Tune numbers of the config to optimize metrics, as `runner tune OVERRIDES --minimize METRIC` does.

        >>> tuning = runner.tune(robot="macro", trajectory="quintic", duration=0.1, workers=0, trials=2,
        ...                      controller__natural_frequency=(5, 50), minimize="max_tracking_error")
        >>> len(tuning.to_frame())
        2

    Args:
        overrides: Overrides as on the command line; "controller.natural_frequency=interval(5,50)" tunes a key.
        minimize: Metrics to minimize.
        maximize: Metrics to maximize.
        trials: Total number of trials, including those of earlier calls.
        jobs: Number of trials that run at the same time; the choice of trials depends on it.
        workers: Number of processes on this machine; 0 simulates the trials in this process.
        config_dirs: See `run`.
        plugins: See `run`.
        values: See `run`; a tuple (low, high) is the range of a tuned key.

    Raises:
        RunnerError: if a key cannot be tuned, a config in its range cannot be run, or a metric does not exist.
    """
    from runner.sweeps.run import Engine
    from runner.sweeps.tuning import run as tuning
    from runner.sweeps.tuning.objective import Objective

    use_plugins(plugins)
    folders, texts = config_folders(config_dirs), tuning_overrides(overrides, use_functions(values))
    _reject_hydra(texts)
    Engine(workers, None)  # its check
    objectives = [Objective(metric, "minimize") for metric in _several(minimize)]
    objectives += [Objective(metric, "maximize") for metric in _several(maximize)]
    if not objectives or len({objective.metric for objective in objectives}) < len(objectives):
        raise ConfigError("name each metric once, in minimize=... or maximize=...")
    words = [f"--{objective.direction}={objective.metric}" for objective in objectives]
    words += [f"--trials={trials}", f"--jobs={jobs}"]
    _check_counts(trials=trials, jobs=jobs)
    command = _command(["tune"], folders, [*texts, *words])
    made = tuning.tune([*texts, f"hydra.sweeper.workers={workers}"], objectives, trials, jobs, command, folders)
    return public_class(Tuning, made)


@public
def calibrate(
    *overrides: str, config_dirs: Folders = (), plugins: Sequence[str] = (), **values: object
) -> store.Calibration:
    """Calibrate a tool or sensor in simulation, or return the stored result, as `runner calibrate OVERRIDES` does.

        >>> runner.calibrate(calibration="gravity", calibration__orientations=8, repetitions=2).status
        'ok'

    Args:
        overrides: Overrides as on the command line, such as "calibration=gravity".
        config_dirs: See `run`.
        plugins: See `run`.
        values: See `run`.

    Raises:
        RunnerError: if the config cannot be carried out, or a folder cannot be written.
    """
    from runner.sweeps import job

    use_plugins(plugins)
    texts = run_overrides(overrides, values)
    return job.calibrate(*texts, config_dirs=config_folders(config_dirs))


def _several(metrics: str | Sequence[str]) -> Sequence[str]:
    return [metrics] if isinstance(metrics, str) else metrics


def _check_counts(**counts: int) -> None:
    wrong = [f"{name}: must be a whole number, 1 or more; found {count!r}" for name, count in counts.items()
             if isinstance(count, bool) or not isinstance(count, int) or count < 1]  # fmt: skip
    if wrong:
        raise ConfigError(wrong)


def _reject_hydra(texts: Sequence[str]) -> None:
    found = [f"{text}: give workers=... and address=... as arguments" for text in texts if text.startswith("hydra.")]
    if found:
        raise ConfigError(found)


def _command(words: Sequence[str], folders: Sequence[Path], texts: Sequence[str]) -> str:
    """Return the equivalent command line, which is stored with the result."""
    added = [word for text in named_parts() for word in ("--plugin", text)]
    own = [word for folder in folders for word in ("--config-dir", str(folder))]
    return shlex.join(["runner", *added, *words, *own, *texts])
