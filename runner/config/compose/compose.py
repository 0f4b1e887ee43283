"""Config composition from the groups in conf/ and a list of overrides, as plain data in SI units."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import cast

from omegaconf import DictConfig, OmegaConf

from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.config.compose.composer import Composer
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.data_files import take_data_file
from runner.config.compose.stage_defaults import complete_stage_arms, complete_stages
from runner.config.compose.units import to_si
from runner.config.composed import Composed


def compose(overrides: Sequence[str], config_dirs: Sequence[Path] = (), root: str = "config") -> Composed:
    """Compose a config as `runner OVERRIDES` does.

    Args:
        overrides: Hydra overrides, such as "robot=macro" and "noise.position=1e-3".
        config_dirs: Config folders of the user.
        root: Name of the root file in conf/.

    Raises:
        ConfigError: for an unknown option or key, a value that cannot be parsed, or a file that is not YAML.
    """
    composer = Composer(config_dirs, root)
    config = composer.load(overrides)
    return from_hydra(config, config.hydra.runtime.choices, overrides, composer.config_dirs, root)


def from_hydra(
    config: DictConfig,
    chosen: Mapping[str, str | None],
    overrides: Sequence[str],
    config_dirs: Sequence[Path],
    root: str = "config",
) -> Composed:
    """Resolve a config that Hydra composed.

    Args:
        config: The config, with or without Hydra's own node; the function completes it in place.
        chosen: The option of each group, including groups of Hydra.
        overrides: The overrides, as typed.
        config_dirs: Config folders of the user.
        root: Name of the root file in conf/.

    Raises:
        ConfigError: for an interpolation of an unknown key, a key that is not a string, or a built-in robot if a config
            folder has a robot file of the same name.
    """
    try:
        choices = {group: name for group, name in chosen.items() if name is not None and not group.startswith("hydra/")}
        OmegaConf.set_struct(config, False)
        config.pop("hydra", None)
        complete_stage_arms(config)
        complete_stages(config, choices, config_dirs)
        resolved = cast("dict[str, object]", OmegaConf.to_container(config, resolve=True))
    except COMPOSITION_ERRORS as error:
        raise explain(error, config_dirs) from None
    problems = list(_strange_keys(resolved))
    if config_dirs:
        from runner.config.arms import mixed_arms  # loads Pinocchio

        problems += mixed_arms(resolved, choices.get("robot", ""), config_dirs)
    if problems:
        raise ConfigError(problems)
    to_si(resolved, config_dirs)
    take_data_file(resolved, config_dirs)
    return Composed(resolved, tuple(overrides), choices, tuple(config_dirs), root)


def _strange_keys(value: object, place: str = "") -> Iterator[str]:
    """Yield a problem for each key that is not a string, because the runner has no such keys."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            if isinstance(key, str):
                yield from _strange_keys(item, f"{place}{key}.")
            else:
                yield f"{place}{quoted(key)}: keys must be strings. Put it in quotes, or look for a typing error"
