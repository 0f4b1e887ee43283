"""Data file of a trajectory, copied into the config.

A stored run does not need the file.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from runner.base.errors import ConfigError
from runner.base.paths import check_inside


def take_data_file(resolved: Mapping[str, Any], config_dirs: Sequence[Path]) -> None:
    """Put the content of a trajectory's data file into a composed config, in place.

    Args:
        resolved: The config as plain data.
        config_dirs: Config folders of the user, searched before the working folder.

    Raises:
        ConfigError: if the file does not exist, or contains no motion.
    """
    group = resolved.get("trajectory")
    if not (isinstance(group, dict) and group.get("kind") == "from_file" and isinstance(group.get("file"), str)):
        return
    from runner.trajectories.table import read_table  # for few configs

    group["columns"] = read_table(_find(group["file"], config_dirs))
    if group.get("duration") is None:
        group["duration"] = group["columns"]["t"][-1]


def _find(name: str, config_dirs: Sequence[Path]) -> Path:
    if ".." in Path(name).parts:
        raise ConfigError([f"trajectory.file: '{name}' leads out of its folder; give its whole path"])
    places = [Path(name)] if Path(name).is_absolute() else [folder / name for folder in (*config_dirs, Path.cwd())]
    for place in places:
        if place.is_file():
            check_inside(place, config_dirs)
            return place
    raise ConfigError(
        [f"trajectory.file: no file '{name}'; looked in {', '.join(str(each.parent) for each in places)}"]
    )
