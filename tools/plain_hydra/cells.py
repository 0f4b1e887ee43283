"""Cells of one line, by plain Hydra and by the runner.

Plain Hydra is its own sweeper, which splits the line into jobs, and its own composition of each job. Both sides then
resolve the config in the same way, with the units and stages of the runner.
"""

import itertools
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import CachingConfigRepository
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra._internal.defaults_list import Overrides
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import OverrideType
from hydra.types import RunMode

from runner.base.errors import ConfigError
from runner.config.compose.compose import resolve
from runner.config.compose.composer import Composer
from runner.config.compose.unresolved import from_hydra
from runner.sweeps.plan import Grid
from runner.sweeps.typed import plan_typed

Cells = tuple[int, list[dict[str, Any]]]
"""Number of cells, and the configs of those that are composed."""
Choice = Callable[[int], Sequence[int]]
"""Function that returns the cells to compose, of a number of cells."""


def of_runner(line: Sequence[str], choose: Choice) -> Cells | str:
    """Return the cells of a line by the runner; a string if it refuses the line."""
    try:
        plan = _plan(tuple(line))
        return len(plan), [dict(plan.composed(cell).resolved) for cell in choose(len(plan))]
    except ConfigError as error:
        return f"runner: {error}"


def of_hydra(line: Sequence[str], choose: Choice) -> Cells | str:
    """Return the cells of a line by plain Hydra; a string if it refuses the line or crashes."""
    try:
        overrides = OverridesParser.create(config_loader=_hydra()).parse_overrides(_typed(line))
        (jobs,) = BasicSweeper.split_arguments(overrides, None)
        return len(jobs), [compose_plain(jobs[cell]) for cell in choose(len(jobs))]
    except Exception as error:  # of Hydra, OmegaConf, the parser, or a crash of the sweeper
        return f"Hydra: {type(error).__name__}: {error}"


def single_runs(line: Sequence[str]) -> list[dict[str, Any]]:
    """Return the config of each combination of a line's values, as plain Hydra composes it for a single run.

    Each override counts, also a repeated one. Values of unknown keys are added, because the runner judges them later.
    """
    overrides = OverridesParser.create(config_loader=_hydra()).parse_overrides(_typed(line))
    texts = [
        [f"{each.get_key_element()}={value}" for value in each.sweep_string_iterator()]
        if each.is_sweep_override()
        else [str(each.input_line)]
        for each in overrides
    ]
    return [compose_plain(job, add=True) for job in itertools.product(*texts)]


def compose_plain(job: Sequence[str], add: bool = False) -> dict[str, Any]:
    """Return the config of a job, whose options Hydra composes and into which it then puts the values.

    Args:
        job: Overrides, one value each.
        add: True to add unknown keys.
    """
    overrides = OverridesParser.create().parse_overrides(list(job))
    values = Overrides(CachingConfigRepository(_hydra().repository), overrides).config_overrides
    # Hydra composes equal options once, from its own function in the runner's cache.
    config = Composer()._of_options([each for each in overrides if each not in values], "config", RunMode.RUN)
    for each in values if add else ():
        each.type = OverrideType.FORCE_ADD if each.type == OverrideType.CHANGE else each.type
    ConfigLoaderImpl._apply_overrides_to_config(values, config)
    return dict(resolve(from_hydra(config), job, ()).resolved)


def _typed(line: Sequence[str]) -> list[str]:
    """Return a line without overrides of Hydra's own, after the axes that they or an experiment bring."""
    params: list[str] = []
    if any(text.startswith(("experiment=", "hydra.")) for text in line):  # only these bring axes
        config = _hydra().load_configuration("config", list(line), RunMode.MULTIRUN, from_shell=False)
        params = [f"{key}={value}" for key, value in (config.hydra.sweeper.params or {}).items()]
    return [*params, *(text for text in line if not text.startswith("hydra."))]


@lru_cache(maxsize=1)
def _plan(line: tuple[str, ...]) -> Grid:
    ours = [text.removeprefix("++") for text in line if not text.startswith("hydra.")]
    return plan_typed(ours, Composer(), [text for text in line if text.startswith("hydra.")])[0]


@lru_cache(maxsize=1)
def _hydra() -> ConfigLoaderImpl:
    loader = Composer().hydra
    assert isinstance(loader, ConfigLoaderImpl)
    return loader
