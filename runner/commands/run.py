"""`runner OVERRIDES` and `runner -m OVERRIDES`: Hydra composes, we check, run and store."""

import itertools
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig, OmegaConf

from runner.commands.ending import tell_run, tell_sweep
from runner.config.compose import from_hydra
from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.no_code import code_refused
from runner.config.overrides import force
from runner.paths import conf_dir
from runner.quiet import quiet_environment
from runner.recall.runs import keep_run, line_key

if TYPE_CHECKING:
    from runner.store import Run
    from runner.sweeps.run import Ended

# What conf/config.yaml says of Hydra itself, which leaves that file aside where it is asked for its own help.
_WITHOUT_OURS = (
    "hydra/sweeper=runner", "hydra/job_logging=none", "hydra/hydra_logging=none", "hydra.run.dir=.",
    "hydra.output_subdir=null",
)  # fmt: skip


class _Task:
    """What Hydra calls, and what came of it; Hydra hands nothing back.

    An error is kept for `main` to raise: in here Hydra would print its own text.
    """

    def __init__(self, arguments: Sequence[str]) -> None:
        self._arguments, self._key = arguments, line_key(arguments)
        self.run: Run | None = None
        self.made = False
        self.ended: Ended | None = None
        self.error: Exception | None = None
        self.thresholds: Any = None

    def __call__(self, config: DictConfig) -> None:
        """Make one run."""
        from runner.execution import find_or_make  # after the config has composed: bad input is answered at once

        hydra_config = HydraConfig.get()
        # Unresolved, as an override may hold an interpolation of the config's keys.
        typed: Any = OmegaConf.to_container(hydra_config.overrides.task, resolve=False)
        overrides = tuple(override.removeprefix("++") for override in typed)
        own = [Path(source.path) for source in hydra_config.runtime.config_sources if source.provider == "command-line"]
        try:
            composed = from_hydra(config, hydra_config.runtime.choices, overrides, own)
            self.thresholds = composed.resolved.get("caveats")
            self.run, self.made = find_or_make(composed)
            sources = [source.provider for source in hydra_config.runtime.config_sources]
            keep_run(self._key, self._arguments, composed, self.run, sources)
        except Exception as error:
            self.error = error

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
    installing = bool({"-sc", "--shell-completion"} & set(arguments))
    helping = "--hydra-help" in arguments
    sys.argv = ["runner", *(arguments if installing else force(arguments)), *(_WITHOUT_OURS if helping else ())]
    try:
        # The absolute path works from a console script and from a wheel, where a relative one does not.
        with code_refused():
            hydra.main(version_base="1.3", config_path=str(conf_dir()), config_name="config")(task)()
    except COMPOSITION_ERRORS as error:
        raise explain(error, _config_dirs(arguments)) from None
    if task.error is not None:
        raise task.error
    if task.ended is not None:
        return tell_sweep(task.ended)
    if task.run is None:
        return 0  # --cfg, --hydra-help and the like
    return tell_run(task.run, task.made, task.thresholds)


def _config_dirs(arguments: Sequence[str]) -> list[Path]:
    """Return the folders named by --config-dir, for messages about what stands in them."""
    found = [argument.partition("=")[2] for argument in arguments if argument.startswith("--config-dir=")]
    found += [after for before, after in itertools.pairwise(arguments) if before in ("--config-dir", "-cd")]
    return [Path(folder) for folder in found]
