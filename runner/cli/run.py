"""`runner OVERRIDES` and `runner -m OVERRIDES`: compose the config with Hydra, check it, run and store.

Lines that contain only overrides are composed here, once. Hydra's own command, which composes twice, takes lines with
Hydra flags or keys.
"""

import itertools
import shlex
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig, OmegaConf

from runner.base.environment_variables import quiet_environment
from runner.base.paths import conf_dir
from runner.cli.ending import tell_run, tell_sweep
from runner.config.compose.compose import from_hydra
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.hydra_config import hydra_config, parse
from runner.config.compose.no_code import code_refused
from runner.config.compose.overrides import force
from runner.config.compose.user_settings import user_overrides

if TYPE_CHECKING:
    from runner.store import Run
    from runner.sweeps.run import Ended

# What conf/config.yaml says of Hydra itself, which leaves that file aside where it is asked for its own help.
_WITHOUT_OURS = (
    "hydra/sweeper=runner", "hydra/job_logging=none", "hydra/hydra_logging=none", "hydra.run.dir=.",
    "hydra.output_subdir=null",
)  # fmt: skip


_MANY, _OF_SWEEPER = ("-m", "--multirun"), "hydra.sweeper."
_CONFIG_DIR = ("--config-dir", "-cd")


class _Task:
    """Makes the run or the sweep of a command line, for Hydra or without it, and holds what came of it.

    An error that is raised within Hydra is kept for `main` to raise: Hydra would print its own text.
    """

    def __init__(self, arguments: Sequence[str]) -> None:
        self._arguments = arguments
        self.run: Run | None = None
        self.made = False
        self.ended: Ended | None = None
        self.error: Exception | None = None
        self.thresholds: Any = None

    def __call__(self, config: DictConfig) -> None:
        """Make one run; Hydra calls this."""
        node = HydraConfig.get()
        # Unresolved, as an override may hold an interpolation of the config's keys.
        overrides: Any = OmegaConf.to_container(node.overrides.task, resolve=False)
        own = [Path(each.path) for each in node.runtime.config_sources if each.provider == "command-line"]
        try:
            self.make(config, node, overrides, own)
        except Exception as error:
            self.error = error

    def make(self, config: DictConfig, node: Any, overrides: Sequence[str], own: Sequence[Path]) -> None:
        """Make one run.

        Args:
            config: The config as Hydra composed it.
            node: Hydra's own node of it.
            overrides: The overrides as `force` leaves them.
            own: Config folders of the user.
        """
        from runner.sweeps.job import find_or_make  # after the config has composed: bad input is answered at once

        typed = [override.removeprefix("++") for override in overrides]
        composed = from_hydra(config, node.runtime.choices, typed, own)
        self.thresholds = composed.resolved.get("caveats")
        self.run, self.made = find_or_make(composed)

    def make_sweep(self, overrides: Sequence[str], own: Sequence[Path]) -> None:
        """Make a sweep.

        Args:
            overrides: The overrides as `force` leaves them, those of hydra.sweeper among them.
            own: Config folders of the user.
        """
        from runner.sweeps.loading import Loader
        from runner.sweeps.run import sweep_typed

        loader = Loader(own)
        sweeper = loader.sweeper(overrides)
        ours = [each for each in overrides if not each.startswith(_OF_SWEEPER)]
        self.ended = sweep_typed(ours, sweeper, loader, shlex.join(["runner", *self._arguments]))

    def sweep(self, make: Callable[[], "Ended"]) -> None:
        """Make a sweep; our sweeper calls this."""
        try:
            self.ended = make()
        except Exception as error:
            self.error = error


def main(arguments: Sequence[str]) -> int:
    """Make the run or the sweep of a command line; print the folder made as the last line."""
    quiet_environment()
    task = _Task(arguments)
    try:
        make = _composed(task, arguments)
        if make is None:
            _let_hydra_take(task, arguments)
    except COMPOSITION_ERRORS as error:
        raise explain(error, _config_dirs(arguments)) from None
    if make is not None:
        make()
    if task.error is not None:
        raise task.error
    if task.ended is not None:
        return tell_sweep(task.ended)
    if task.run is None:
        return 0  # --cfg, --hydra-help and the like
    return tell_run(task.run, task.made, task.thresholds)


def _composed(task: _Task, arguments: Sequence[str]) -> Callable[[], None] | None:
    """Compose a line of overrides alone; return what makes its run or its sweep, None if Hydra must take the line."""
    many = any(word in _MANY for word in arguments)
    of_sweeper = [word for word in arguments if many and word.startswith(_OF_SWEEPER)]
    line = _plain_line([word for word in arguments if word not in (*_MANY, *of_sweeper)])
    if line is None or not all(folder.is_dir() for folder in line[1]):
        return None
    overrides, own = force([*line[0], *of_sweeper]), [folder.absolute() for folder in line[1]]
    if many:
        return partial(task.make_sweep, overrides, own)
    if any(each.is_sweep_override() for each in parse(overrides)):
        return None
    config = hydra_config(overrides, own)
    return partial(task.make, config, config.hydra, overrides, own)


def _plain_line(arguments: Sequence[str]) -> tuple[list[str], list[Path]] | None:
    """Return the overrides and the config folders of a line; None if it has other flags or keys of Hydra's."""
    overrides, config_dirs, words = [], [], iter(arguments)
    for word in words:
        if word in _CONFIG_DIR:
            config_dirs.append(Path(next(words, "")))
        elif word.startswith("--config-dir="):
            config_dirs.append(Path(word.partition("=")[2]))
        elif word.startswith("-") or "=" not in word or "hydra" in word:
            return None
        else:
            overrides.append(word)
    return overrides, config_dirs


def _let_hydra_take(task: _Task, arguments: Sequence[str]) -> None:
    installing = bool({"-sc", "--shell-completion"} & set(arguments))
    helping = "--hydra-help" in arguments
    sys.argv = [
        "runner",
        *(arguments if installing else [*user_overrides(), *force(arguments)]),
        *(_WITHOUT_OURS if helping else ()),
    ]
    # The absolute path works from a console script and from a wheel, where a relative one does not.
    with code_refused():
        hydra.main(version_base="1.3", config_path=str(conf_dir()), config_name="config")(task)()


def _config_dirs(arguments: Sequence[str]) -> list[Path]:
    """Return the folders named by --config-dir, for messages about what stands in them."""
    found = [argument.partition("=")[2] for argument in arguments if argument.startswith("--config-dir=")]
    found += [after for before, after in itertools.pairwise(arguments) if before in _CONFIG_DIR]
    return [Path(folder) for folder in found]
