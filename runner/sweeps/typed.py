"""Plan of a sweep's command line, with the axes that its config files bring."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from runner.base.dotted_keys import dotted, leaves
from runner.base.errors import ConfigError
from runner.config.compose.composer import Composer
from runner.config.compose.files import groups
from runner.store.axes import SweepAxis, override_value
from runner.sweeps.plan import Grid
from runner.sweeps.swept import SweptKey, parse_sweep


def plan_typed(
    arguments: Sequence[str | SweepAxis], source: Composer, of_sweeper: Sequence[str] = ()
) -> tuple[Grid, DictConfig]:
    """Return the plan of a command line, and the config of the sweeper.

    Axes of a config file, such as those of `experiment=sweep/frequency_period`, precede the typed overrides, which
    replace them.

    Args:
        arguments: Overrides as typed, without those of Hydra, and axes with typed values.
        source: Composer of the configs.
        of_sweeper: Overrides of hydra.sweeper.

    Raises:
        ConfigError: if an override is not valid, or one of several options of a group brings axes.
    """
    keys = parse_sweep(arguments, groups(source.config_dirs), source.hydra)
    fixed = [*of_sweeper, *(key.override(0) for key in keys if len(key.values) == 1)]
    sweeper: DictConfig = source.load(fixed, mode=RunMode.MULTIRUN).hydra.sweeper
    if problems := [problem for key in keys for problem in _lost_axes(key, fixed, sweeper.params, source)]:
        raise ConfigError(problems)
    return Grid([*_axes(sweeper.params), *arguments], source), sweeper


def _axes(params: DictConfig | None) -> list[str]:
    """Return hydra.sweeper.params as overrides; strings are read as on the command line."""
    plain: Any = {} if params is None else OmegaConf.to_container(params, resolve=True)
    pairs = ((dotted(place), value) for place, value in leaves(plain, lists=False))
    return [f"{key}={value if isinstance(value, str) else override_value(value)}" for key, value in pairs]


def _lost_axes(
    key: SweptKey, fixed: Sequence[str], params: Mapping[str, Any] | None, source: Composer
) -> Iterator[str]:
    """Yield a problem for each of several options that brings axes."""
    numbers = [number for number in range(len(key.values)) if key.chooses(number)] if len(key.values) > 1 else []
    for number in numbers:
        try:
            own = source.load([*fixed, key.override(number)]).hydra.sweeper.params
        except ConfigError:
            continue  # the check of the cells reports it
        if own and own != params:
            names = ", ".join(text.partition("=")[0] for text in _axes(own))
            yield (
                f"{key.override(number)}: brings axes ({names}), which a list of options does not sweep over. Allowed: "
                f"a single option, one sweep after the other, or all in one grid: {key.name}=[A,B]"
            )
