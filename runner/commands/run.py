"""`runner OVERRIDES` and `runner -m OVERRIDES`: Hydra composes, we check, run and store."""

import itertools
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from runner.config.compose import force, from_hydra, quiet_environment
from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.errors import ConfigError
from runner.paths import conf_dir


class _Jobs:
    """What the jobs of one command line led to; Hydra hands nothing back."""

    def __init__(self) -> None:
        self.stored: list[tuple[tuple[str, ...], Any]] = []
        self.problems: list[str] = []
        self.crash: Exception | None = None

    def do(self, config: DictConfig) -> None:
        """Run one job; what goes wrong is kept, as Hydra would print it in its own words.

        The other jobs of a sweep still run after a bad config, but not after a full disk or an error of ours.
        """
        if self.crash is not None:
            return
        from runner.execution import execute  # after the config has composed: bad input is answered at once

        hydra_config = HydraConfig.get()
        # Unresolved, as an override may hold an interpolation of the config's keys.
        typed: Any = OmegaConf.to_container(hydra_config.overrides.task, resolve=False)
        overrides = tuple(override.removeprefix("++") for override in typed)
        own = [Path(source.path) for source in hydra_config.runtime.config_sources if source.provider == "command-line"]
        try:
            self.stored.append((overrides, execute(from_hydra(config, hydra_config.runtime.choices, overrides, own))))
        except ConfigError as error:
            prefix = f"[{' '.join(overrides)}] " if hydra_config.mode == RunMode.MULTIRUN else ""
            self.problems += [prefix + problem for problem in error.problems]
        except Exception as error:  # main raises it: in here Hydra would print its own text and end the sweep
            self.crash = error


def main(arguments: Sequence[str]) -> int:
    """Run the jobs of a command line; print the folder made as the last line."""
    quiet_environment()
    jobs = _Jobs()
    completing = bool({"-sc", "--shell-completion"} & set(arguments))
    multirun = bool({"-m", "--multirun"} & set(arguments))
    with tempfile.TemporaryDirectory() as scratch:
        # Hydra's sweeper leaves its own notes in its folder; sweep.json says the same and more.
        aside = [f"hydra.sweep.dir={scratch}"] if multirun else []
        sys.argv = ["runner", *(arguments if completing else force(arguments)), *aside]
        try:
            # The absolute path works from a console script and from a wheel, where a relative one does not.
            hydra.main(version_base="1.3", config_path=str(conf_dir()), config_name="config")(jobs.do)()
        except COMPOSITION_ERRORS as error:
            raise explain(error, _config_dirs(arguments)) from None
    if jobs.crash is not None:
        raise jobs.crash
    if jobs.problems:
        stored = len(jobs.stored)
        raise ConfigError(jobs.problems, f"  {stored} other runs of the sweep are stored already" if stored else "")
    if not jobs.stored:
        return 0  # --cfg, --hydra-help and the like
    return _tell(jobs, multirun)


def _tell(jobs: _Jobs, multirun: bool) -> int:
    from runner import store

    failed = 0
    for overrides, run in jobs.stored:
        for warning in run.provenance["warnings"]:
            print(f"runner: warning: {warning}", file=sys.stderr)
        if run.status == "failed":
            failed += 1
            print(f"runner: [{' '.join(overrides)}] {run.failure_text}", file=sys.stderr)
    if multirun:
        outputs = jobs.stored[0][1].folder.parent.parent
        print(store.write_sweep(outputs, [(overrides, run.hash) for overrides, run in jobs.stored]))
    else:
        print(jobs.stored[-1][1].folder)
    return 1 if failed else 0


def _config_dirs(arguments: Sequence[str]) -> list[Path]:
    """Return the folders named by --config-dir, for messages about what stands in them."""
    found = [argument.partition("=")[2] for argument in arguments if argument.startswith("--config-dir=")]
    found += [after for before, after in itertools.pairwise(arguments) if before in ("--config-dir", "-cd")]
    return [Path(folder) for folder in found]
