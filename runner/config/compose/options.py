"""Options of the config groups: names and one-line descriptions, read from the files."""

from collections.abc import Sequence
from pathlib import Path

from runner.base.paths import STUDY_FILE, conf_dir

_HEAD = 10_000  # characters, in which the first comment of a file stands


def groups(config_dirs: Sequence[Path] = ()) -> list[str]:
    """Return the names of the config groups, sorted; Hydra's own are none of them."""
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
        config_dirs: Config folders of the user's.

    Returns:
        Name of each option, such as "thesis/figure_3_5", and its file's first comment that is no directive.
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
    """Return by which option of a group a file of a folder is chosen: NAME/x for the experiment x of the study NAME."""
    return f"{folder.resolve().name}/{name}" if group == _GROUP and _own(folder) else name


def _own(folder: Path) -> str:
    """Return how the configs of a study's experiments begin; nothing for a folder that is none, or holds such a one."""
    own = f"{_GROUP}/{folder.resolve().name}"
    return own if (folder / STUDY_FILE).is_file() and not (folder / own).is_dir() else ""
