"""Options of the config groups: names and one-line descriptions, read from the files."""

from collections.abc import Sequence
from pathlib import Path

from runner.base.paths import STUDY_FILE, conf_dir

_HEAD = 10_000  # characters to search for the first comment of a file


def groups(config_dirs: Sequence[Path] = ()) -> list[str]:
    """Return the sorted names of the config groups, without Hydra's own groups."""
    found = {
        entry.name
        for folder in (*config_dirs, conf_dir())
        if folder.is_dir()
        for entry in folder.iterdir()
        if entry.is_dir()
    }
    return sorted(found - {"hydra"})


def group_options(group: str, config_dirs: Sequence[Path] = ()) -> dict[str, str]:
    """Return the options of a group with their descriptions, sorted by name.

    Args:
        group: Name of the group, such as "robot".
        config_dirs: Config folders of the user.

    Returns:
        Name of each option, such as "thesis/figure_3_5", and the first comment in its file except directives.
    """
    found: dict[str, str] = {}
    for folder in (conf_dir(), *config_dirs):
        files = described_files(folder / group)
        found |= {option_in(folder, group, name): description for name, description in files.items()}
    return dict(sorted(found.items()))


def described_files(root: Path) -> dict[str, str]:
    """Return the YAML files below a folder by name without suffix, each with its first comment, sorted by name."""
    files = sorted(path for path in root.rglob("*.yaml") if path.is_file())
    return {path.relative_to(root).with_suffix("").as_posix(): _first_comment(path) for path in files}


def _first_comment(path: Path) -> str:
    with path.open(errors="replace") as file:
        for line in file.read(_HEAD).splitlines():
            text = line.strip()
            if text.startswith("#") and not text.startswith(("# @package", "# runner ")):
                return text.lstrip("# ")
    return ""


_GROUP = "experiment"


def place_in(folder: Path, config_path: str) -> str:
    """Return the path of a config in a folder: experiment/x for experiment/NAME/x of the study NAME."""
    own = _own(folder)
    if own and (config_path == own or config_path.startswith(f"{own}/")):
        return f"{_GROUP}{config_path.removeprefix(own)}"
    return config_path


def option_in(folder: Path, group: str, name: str) -> str:
    """Return the option name of a file in a folder: NAME/x for the experiment x of the study NAME."""
    return f"{folder.resolve().name}/{name}" if group == _GROUP and _own(folder) else name


def _own(folder: Path) -> str:
    """Return the prefix of a study's experiments; "" for another folder, or one that has a folder of that prefix."""
    own = f"{_GROUP}/{folder.resolve().name}"
    return own if (folder / STUDY_FILE).is_file() and not (folder / own).is_dir() else ""
