"""`runner OVERRIDES` and `runner -m OVERRIDES`: Hydra composes, we check, run and store."""

import itertools
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig, OmegaConf

from runner.config.compose import from_hydra, quiet_environment
from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.no_code import code_refused
from runner.config.overrides import force
from runner.errors import RunnerError
from runner.paths import conf_dir
from runner.texts import one_line

if TYPE_CHECKING:
    from runner.store import Run
    from runner.sweeps.run import Ended

_FAILURES_SHOWN = 20
# What conf/config.yaml says of Hydra itself, which leaves that file aside where it is asked for its own help.
_WITHOUT_OURS = (
    "hydra/sweeper=runner", "hydra/job_logging=none", "hydra/hydra_logging=none", "hydra.run.dir=.",
    "hydra.output_subdir=null",
)  # fmt: skip


class _Task:
    """What Hydra calls, and what came of it; Hydra hands nothing back.

    An error is kept for `main` to raise: in here Hydra would print its own text.
    """

    def __init__(self) -> None:
        self.run: Run | None = None
        self.ended: Ended | None = None
        self.error: Exception | None = None
        self.thresholds: Any = None

    def __call__(self, config: DictConfig) -> None:
        """Make one run."""
        from runner.execution import execute  # after the config has composed: bad input is answered at once

        hydra_config = HydraConfig.get()
        # Unresolved, as an override may hold an interpolation of the config's keys.
        typed: Any = OmegaConf.to_container(hydra_config.overrides.task, resolve=False)
        overrides = tuple(override.removeprefix("++") for override in typed)
        own = [Path(source.path) for source in hydra_config.runtime.config_sources if source.provider == "command-line"]
        try:
            composed = from_hydra(config, hydra_config.runtime.choices, overrides, own)
            self.thresholds = composed.resolved.get("caveats")
            self.run = execute(composed)
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
    task = _Task()
    completing = bool({"-sc", "--shell-completion"} & set(arguments))
    if completing and "COMP_LINE" not in os.environ and any(word.startswith("query=") for word in arguments):
        raise RunnerError('the shell asks so, with COMP_LINE set; let it do so by eval "$(runner -sc install=bash)"')
    helping = "--hydra-help" in arguments
    sys.argv = ["runner", *(arguments if completing else force(arguments)), *(_WITHOUT_OURS if helping else ())]
    try:
        # The absolute path works from a console script and from a wheel, where a relative one does not.
        with code_refused():
            hydra.main(version_base="1.3", config_path=str(conf_dir()), config_name="config")(task)()
    except COMPOSITION_ERRORS as error:
        raise explain(error, _config_dirs(arguments)) from None
    if task.error is not None:
        raise task.error
    if task.ended is not None:
        return _tell_sweep(task.ended)
    if task.run is None:
        return 0  # --cfg, --hydra-help and the like
    return _tell_run(task.run, task.thresholds)


def _tell_run(run: "Run", thresholds: Any) -> int:
    for warning in run.provenance["warnings"]:
        print(one_line(f"runner: warning: {warning}"), file=sys.stderr)
    _tell_caveats(run, thresholds)
    if run.failure:
        print(one_line(f"runner: {run.failure_text}"), file=sys.stderr)
    print(run.folder)
    return 1 if run.failure else 0


def _tell_caveats(run: "Run", thresholds: Any) -> None:
    """Print why a run's result may mislead, and where other thresholds than those asked for were used."""
    from runner.caveats import changes_since

    for caveat in run.caveats:
        print(one_line(f"runner: caveat: {caveat['rule']}: {caveat['text']}"), file=sys.stderr)
    changes = changes_since(run.caveat_rules, thresholds)
    if changes:
        print(one_line(f"runner: stored before; its caveats were looked for by {'; '.join(changes)}"), file=sys.stderr)


def _tell_sweep(ended: "Ended") -> int:
    if ended.failures:
        from runner.commands.columns import aligned

        rows = [[" ".join(overrides), why, str(where)] for overrides, why, where in ended.failures[:_FAILURES_SHOWN]]
        count = len(ended.failures)
        print(f"runner: {count} run{'s' if count > 1 else ''} failed", file=sys.stderr)
        print(aligned([["run", "why", "more in"], *rows]), file=sys.stderr)
        if len(ended.failures) > len(rows):
            print(f"  and {len(ended.failures) - len(rows)} more", file=sys.stderr)
    counts = ended.ends.caveats
    if counts.any():
        told = f"{(counts > 0).sum()} of {len(counts)} cells have caveats, {counts.max()} at most"
        print(f"runner: {told}; `runner table {ended.folder}` says which", file=sys.stderr)
    if ended.left:
        print(f"runner: stopped at a failure; left: {ended.left}", file=sys.stderr)
    _tell_differences(ended)
    print(ended.folder)
    return 1 if ended.failures else 0


def _tell_differences(ended: "Ended") -> None:
    """Say in a line that cells differ beyond what was swept, where they do."""
    from runner.store import open_sweep
    from runner.sweeps.differing import in_words
    from runner.sweeps.measurements import axes_of

    axes, _ = axes_of(open_sweep(ended.folder).overrides)
    also = in_words(ended.resolved.differences(axes))
    if also:
        print(one_line(f"runner: {also}; the report lists their values"), file=sys.stderr)


def _config_dirs(arguments: Sequence[str]) -> list[Path]:
    """Return the folders named by --config-dir, for messages about what stands in them."""
    found = [argument.partition("=")[2] for argument in arguments if argument.startswith("--config-dir=")]
    found += [after for before, after in itertools.pairwise(arguments) if before in ("--config-dir", "-cd")]
    return [Path(folder) for folder in found]
