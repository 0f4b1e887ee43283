"""Config composition from the groups in conf/ and a list of overrides, as plain data in SI units."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import cast

from runner.base.dotted_keys import with_references
from runner.base.errors import ConfigError
from runner.base.paths import check_inside
from runner.base.sanitize import quoted
from runner.config.compose.stages import with_stages
from runner.config.compose.units import to_si
from runner.config.compose.unresolved import Unresolved, read_unresolved
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
    folders = tuple(folder.resolve() for folder in config_dirs)
    return resolve(read_unresolved(overrides, folders, root), overrides, folders, root)


def resolve(
    unresolved: Unresolved, overrides: Sequence[str], config_dirs: Sequence[Path] = (), root: str = "config"
) -> Composed:
    """Resolve the references of a config.

    Args:
        unresolved: The config.
        overrides: The overrides, as typed.
        config_dirs: Config folders of the user.
        root: Name of the root file in conf/.

    Raises:
        ConfigError: for a reference to an unknown key, a key that is not a string, or a built-in robot if a config
            folder has a robot file of the same name.
    """
    chosen = unresolved.choices.items()
    choices = {group: name for group, name in chosen if name is not None and not group.startswith("hydra/")}
    values = with_stages(unresolved.values, choices, config_dirs)
    resolved = with_references(values)
    if resolved is None:
        resolved = _resolved_by_omegaconf(values, config_dirs)
    problems = list(_strange_keys(resolved))
    if config_dirs:
        from runner.config.robot_files import mixed_arms  # for few configs

        problems += mixed_arms(resolved, choices.get("robot", ""), config_dirs)
    if problems:
        raise ConfigError(problems)
    to_si(resolved, config_dirs)
    take_data_file(resolved, config_dirs)
    return Composed(resolved, tuple(overrides), choices, tuple(config_dirs), root)


def _resolved_by_omegaconf(values: Mapping[str, object], config_dirs: Sequence[Path]) -> dict[str, object]:
    from omegaconf import OmegaConf  # imported for few configs, as it takes long

    from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain

    try:
        return cast("dict[str, object]", OmegaConf.to_container(OmegaConf.create(dict(values)), resolve=True))
    except COMPOSITION_ERRORS as error:
        raise explain(error, config_dirs) from None


def _strange_keys(value: object, place: str = "") -> Iterator[str]:
    """Yield a problem for each key that is not a string, because the runner has no such keys."""
    for key, item in value.items() if isinstance(value, Mapping) else ():
        if isinstance(key, str):
            yield from _strange_keys(item, f"{place}{key}.")
        else:
            yield f"{place}{quoted(key)}: keys must be strings. Put it in quotes, or look for a typing error"


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
