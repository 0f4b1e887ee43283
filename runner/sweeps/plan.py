"""The cells of a sweep: composed, checked and named before anything starts."""

import itertools
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hydra import initialize_config_dir
from hydra.core.config_loader import ConfigLoader
from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode
from omegaconf import DictConfig
from tqdm import tqdm

from runner import store
from runner.assembly import assemble
from runner.config.compose import Composed
from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.no_code import code_refused
from runner.config.options import groups
from runner.config.overrides import force
from runner.config.run import RunConfig
from runner.config.sweep import SweepConfig
from runner.config.validation import validate
from runner.errors import ConfigError
from runner.paths import conf_dir
from runner.sweeps.swept import parse_sweep
from runner.sweeps.template import Template

_PROBLEMS_SHOWN = 20


@dataclass(frozen=True)
class Checked:
    """What the check of a plan gave.

    Attributes:
        names: Hash of each cell's run.
        outputs: Folder in which the runs are stored.
        settings: How the sweep is run.
    """

    names: Sequence[str]
    outputs: Path
    settings: SweepConfig


class Plan:
    """Every combination of the values of a sweep's keys; the last key changes fastest.

    Args:
        arguments: Overrides, such as "robot=macro,mini" and "noise.position=1e-4,1e-3".
        loader: Hydra's loader.
        load: Composes a config from overrides of options, as Hydra does for one job.
        config_dirs: Config folders of the user's.

    Raises:
        ConfigError: for what is no override, and for a key that is swept over no value.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        loader: ConfigLoader,
        load: Callable[[list[str]], DictConfig],
        config_dirs: Sequence[Path],
    ) -> None:
        self._load = load
        self._config_dirs = tuple(folder.resolve() for folder in config_dirs)
        self._keys = parse_sweep(force(arguments), groups(config_dirs), loader)
        self._templates: dict[tuple[int, ...], Template | ConfigError] = {}
        self._assembled: dict[str, ConfigError | None] = {}

    def __len__(self) -> int:
        return math.prod(len(key.values) for key in self._keys)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell, as typed; what only says how and where it is made is left out."""
        pairs = zip(self._keys, self._numbers(cell), strict=True)
        return tuple(
            key.overrides[number].removeprefix("++")
            for key, number in pairs
            if key.name != "outputs" and not key.name.startswith("sweep.")
        )

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell.

        Raises:
            ConfigError: if it does not compose.
        """
        numbers = self._numbers(cell)
        pairs = list(zip(self._keys, numbers, strict=True))
        template = self._template(tuple(number for key, number in pairs if key.option))
        resolved = template.resolve([number for key, number in pairs if not key.option])
        return Composed(resolved, self.overrides(cell), template.choices, self._config_dirs)

    def check(self) -> Checked:
        """Compose and check all cells.

        Raises:
            ConfigError: telling each problem once, with the first cell that has it.
        """
        names: list[str] = []
        problems: dict[str, list[int]] = {}
        first: RunConfig | None = None
        for cell in tqdm(range(len(self)), desc="checking", unit="run", delay=1.0, disable=None):
            try:
                composed = self.composed(cell)
                config = validate(composed.resolved, composed.config_dirs)
                first = first or config
                _check_alike(first, config)
                self._check_assembly(composed, config)
                names.append(store.run_hash(composed.resolved, config.arm.urdf))
            except ConfigError as error:
                for problem in error.problems:
                    problems.setdefault(problem, []).append(cell)
        if problems or first is None:
            shown = itertools.islice(problems.items(), _PROBLEMS_SHOWN)
            more = len(problems) - _PROBLEMS_SHOWN
            hint = "  nothing was started" if more <= 0 else f"  and {more} more problems; nothing was started"
            raise ConfigError([self._describe(*item) for item in shown], hint)
        return Checked(names, Path(first.settings.outputs), first.sweep)

    def _check_assembly(self, composed: Composed, config: RunConfig) -> None:
        """Assemble each robot on each plant from each start once: some problems show only there."""
        parts = [composed.resolved[group] for group in ("robot", "plant")]
        key = json.dumps([*parts, composed.resolved["trajectory"].get("start")])
        if key not in self._assembled:
            self._assembled[key] = None
            try:
                assemble(config).plant.close()
            except ConfigError as error:
                self._assembled[key] = error
        problem = self._assembled[key]
        if problem is not None:
            raise problem

    def _describe(self, problem: str, cells: Sequence[int]) -> str:
        others = f" and {len(cells) - 1} other cells:" if len(cells) > 1 else ""
        return f"[{' '.join(self.overrides(cells[0]))}]{others} {problem}"

    def _numbers(self, cell: int) -> list[int]:
        """Return the number of each key's value in a cell."""
        numbers = []
        for key in reversed(self._keys):
            cell, number = divmod(cell, len(key.values))
            numbers.append(number)
        return numbers[::-1]

    def _template(self, numbers: tuple[int, ...]) -> Template:
        if numbers not in self._templates:
            self._templates[numbers] = self._compose(numbers)
        template = self._templates[numbers]
        if isinstance(template, ConfigError):
            raise template
        return template

    def _compose(self, numbers: Sequence[int]) -> Template | ConfigError:
        options = [key for key in self._keys if key.option]
        texts = [key.overrides[number] for key, number in zip(options, numbers, strict=True)]
        try:
            config = self._load(texts)
            chosen = config.hydra.runtime.choices
            return Template(config, chosen, self._config_dirs, [key for key in self._keys if not key.option])
        except COMPOSITION_ERRORS as error:
            return explain(error, self._config_dirs)
        except ConfigError as error:
            return error


def plan_sweep(overrides: Sequence[str], config_dirs: Sequence[Path] = ()) -> Plan:
    """Plan what `runner -m OVERRIDES` makes, from Python; see Plan."""
    search = [f"hydra.searchpath=[{','.join(f'file://{folder.resolve()}' for folder in config_dirs)}]"]
    with code_refused(), initialize_config_dir(str(conf_dir()), version_base="1.3", job_name="runner"):
        loader = GlobalHydra.instance().config_loader()

    def load(options: list[str]) -> DictConfig:
        with code_refused():
            return loader.load_configuration("config", [*(search if config_dirs else []), *options], RunMode.RUN)

    return Plan(overrides, loader, load, config_dirs)


def _check_alike(first: RunConfig, other: RunConfig) -> None:
    if (first.settings.outputs, first.sweep) != (other.settings.outputs, other.sweep):
        raise ConfigError(["outputs, sweep.*: must have one value in all runs of a sweep"])
