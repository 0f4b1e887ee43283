"""Config folders, including the folder of a study with its experiments as experiment=NAME/..."""

from pathlib import Path

from runner.base.paths import STUDY_FILE

_GROUP = "experiment"


def place_in(folder: Path, config_path: str) -> str:
    """Return the path of a config in a folder: experiment/x for experiment/NAME/x of the study NAME."""
    own = _own(folder)
    if own and (config_path == own or config_path.startswith(f"{own}/")):
        return f"{_GROUP}{config_path.removeprefix(own)}"
    return config_path


def option_in(folder: Path, group: str, name: str) -> str:
    """Return by which option of a group a file of a folder is chosen: NAME/x for the experiment x of the study NAME."""
    return f"{folder.resolve().name}/{name}" if group == _GROUP and _own(folder) else name


def _own(folder: Path) -> str:
    """Return how the configs of a study's experiments begin; nothing for a folder that is none, or holds such a one."""
    own = f"{_GROUP}/{folder.resolve().name}"
    return own if (folder / STUDY_FILE).is_file() and not (folder / own).is_dir() else ""
