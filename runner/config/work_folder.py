"""Config folders: whose files lie in them; that of a work, whose experiments are found as experiment=NAME/..."""

import os
from collections.abc import Sequence
from pathlib import Path

from runner.errors import ConfigError
from runner.paths import robots_dir

_WORK, _GROUP = "work.yaml", "experiment"


def place_in(folder: Path, config_path: str) -> str:
    """Return where a config stands in a folder: experiment/NAME/x of the work NAME as experiment/x, others as asked."""
    own = _own(folder)
    if own and (config_path == own or config_path.startswith(f"{own}/")):
        return f"{_GROUP}{config_path.removeprefix(own)}"
    return config_path


def option_in(folder: Path, group: str, name: str) -> str:
    """Return by which option of a group a file of a folder is chosen: NAME/x for the experiment x of the work NAME."""
    return f"{folder.resolve().name}/{name}" if group == _GROUP and _own(folder) else name


def check_inside(path: Path, folders: Sequence[Path]) -> None:
    """Check that a file found in a config folder lies there, whatever links lead to it; nothing is read before.

    A file that is found elsewhere, by its whole path, may lie anywhere, unless one of the folders is that of a work:
    the files of its runs are its own, or ours.

    Raises:
        ConfigError: if the file lies elsewhere.
    """
    own = [folder for folder in folders if path.is_relative_to(folder)]
    if not own and any((folder / _WORK).is_file() for folder in folders):
        own = [*folders, robots_dir()]
    place = Path(os.path.realpath(path))
    if own and not any(place.is_relative_to(os.path.realpath(folder)) for folder in own):
        raise ConfigError([f"{path}: is {place}, outside of the folder {own[0]}; put the file itself there"])


def _own(folder: Path) -> str:
    """Return how the configs of a work's experiments begin; nothing for a folder that is none, or holds such a one."""
    own = f"{_GROUP}/{folder.resolve().name}"
    return own if (folder / _WORK).is_file() and not (folder / own).is_dir() else ""
