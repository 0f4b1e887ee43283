"""Config composition from the groups in conf/ and a list of overrides, as plain data in SI units."""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import cast

import yaml
from omegaconf import DictConfig, OmegaConf

from runner.base.bounded_yaml import CONFIG, read_yaml
from runner.base.errors import ConfigError
from runner.base.paths import check_inside, conf_dir
from runner.base.sanitize import quoted
from runner.config.compose.composer import Composer
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.units import to_si
from runner.config.composed import Composed
from runner.config.robot import ArmConfig


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
        _complete_stages(config, choices, config_dirs)
        resolved = cast("dict[str, object]", OmegaConf.to_container(config, resolve=True))
    except COMPOSITION_ERRORS as error:
        raise explain(error, config_dirs) from None
    problems = list(_strange_keys(resolved))
    if config_dirs:
        from runner.config.robot_files import mixed_arms  # for few configs

        problems += mixed_arms(resolved, choices.get("robot", ""), config_dirs)
    if problems:
        raise ConfigError(problems)
    to_si(resolved, config_dirs)
    take_data_file(resolved, config_dirs)
    return Composed(resolved, tuple(overrides), choices, tuple(config_dirs), root)


def _strange_keys(value: object, place: str = "") -> Iterator[str]:
    """Yield a problem for each key that is not a string, because the runner has no such keys."""
    for key, item in value.items() if isinstance(value, Mapping) else ():
        if isinstance(key, str):
            yield from _strange_keys(item, f"{place}{key}.")
        else:
            yield f"{place}{quoted(key)}: keys must be strings. Put it in quotes, or look for a typing error"


def _complete_stages(config: DictConfig, choices: Mapping[str, str], config_dirs: Sequence[Path]) -> None:
    """Complete the values of single stages in place, if the robot has stages.

    Each stage gets the missing keys of one arm. Such a key at the robot itself remains if its value is not the default.
    Validation then rejects it. A mapping that overrides some stages gets the others from the value that the group's
    file refers to, such as `period: ${robot.period}`.
    """
    robot = config.get("robot")
    stages = robot.get("stages") if isinstance(robot, DictConfig) else None
    if not isinstance(stages, DictConfig):
        return
    for key, value in _arm_defaults((conf_dir() / "robot_defaults.yaml").read_text()).items():
        if OmegaConf.to_container(robot, resolve=False).get(key) == value:  # type: ignore[union-attr] # a mapping
            del robot[key]
        for stage in stages.values():
            if isinstance(stage, DictConfig) and key not in stage:
                stage[key] = value
    for group, option in choices.items():
        for key, reference in _references(group, option, config_dirs):
            node = config.get(group)
            if not isinstance(node, DictConfig) or OmegaConf.is_interpolation(node, key) or key not in node:
                continue
            given, default = node[key], OmegaConf.select(config, reference)
            if isinstance(given, DictConfig) and isinstance(default, DictConfig):
                node[key] = {**default, **given}


@lru_cache(maxsize=1)
def _arm_defaults(text: str) -> dict[str, object]:
    defaults = yaml.safe_load(text)["robot"]
    return {key: value for key, value in defaults.items() if key in ArmConfig.model_fields}


def _references(group: str, option: str, config_dirs: Sequence[Path]) -> list[tuple[str, str]]:
    """Return key and target of each value in the file of an option that is a single reference."""
    for folder in (*config_dirs, conf_dir()):
        path = folder / group / f"{option}.yaml"
        if path.is_file():
            return _references_of(path.read_text(), path)
    return []


@lru_cache(maxsize=256)
def _references_of(text: str, path: Path) -> list[tuple[str, str]]:
    content = read_yaml(text, path, CONFIG)
    texts = [(str(key), value) for key, value in content.items() if isinstance(value, str)] if content else []
    return [(key, match[1]) for key, value in texts if (match := re.fullmatch(r"\$\{([\w.]+)\}", value))]


def take_data_file(resolved: Mapping[str, object], config_dirs: Sequence[Path]) -> None:
    """Put the content of a trajectory's data file into a composed config, in place.

    Raises:
        ConfigError: if the file does not exist, or contains no motion.
    """
    group = resolved.get("trajectory")
    if not (isinstance(group, dict) and group.get("kind") == "from_file" and isinstance(group.get("file"), str)):
        return
    from runner.trajectories.from_file import read_motion  # for few configs

    group["columns"] = read_motion(_find(group["file"], config_dirs))
    if group.get("duration") is None:
        group["duration"] = group["columns"]["t"][-1]


def _find(name: str, config_dirs: Sequence[Path]) -> Path:
    if ".." in Path(name).parts:
        raise ConfigError(f"trajectory.file: '{name}' leads out of its folder; give its whole path")
    places = [Path(name)] if Path(name).is_absolute() else [folder / name for folder in (*config_dirs, Path.cwd())]
    for place in places:
        if place.is_file():
            check_inside(place, config_dirs)
            return place
    searched = ", ".join(str(each.parent) for each in places)
    raise ConfigError(f"trajectory.file: no file '{name}'; looked in {searched}")
