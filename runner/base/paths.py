"""Paths of configs, robots, studies, examples and report templates, in a checkout or an installed wheel."""

import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from runner.base.errors import ConfigError

STUDY_FILE = "study.yaml"
"""File that marks a folder as a study."""

_PACKAGE = Path(__file__).resolve().parents[1]


@cache
def _root() -> Path:
    checkout = _PACKAGE.parent
    return checkout if (checkout / "conf" / "config.yaml").is_file() else _PACKAGE / "_data"


def package_dir() -> Path:
    """Return the source folder of this package."""
    return _PACKAGE


def conf_dir() -> Path:
    """Return the folder of the Hydra groups."""
    return _root() / "conf"


def ships(path: Path) -> bool:
    """Return True if a file is built-in, or of a built-in study. A built-in config has more rights than others."""
    return not {conf_dir(), studies_dir()}.isdisjoint(path.resolve().parents)


def robots_dir() -> Path:
    """Return the folder of the built-in URDFs."""
    return _root() / "robots"


def studies_dir() -> Path:
    """Return the folder of the built-in studies, with one folder for each."""
    return _PACKAGE / "papers" / "studies"


def studies_with(file: str) -> list[str]:
    """Return the sorted names of the built-in studies that have a file or folder, such as "claims.yaml"."""
    return sorted(path.parents[file.count("/")].name for path in studies_dir().glob(f"*/{file}"))


def examples_dir() -> Path:
    """Return the folder of the examples that `runner example` copies."""
    return _root() / "examples"


def example_study_dir() -> Path:
    """Return the folder of the template of `runner study new`."""
    return examples_dir() / "own_paper"


def templates_dir() -> Path:
    """Return the folder of the report templates."""
    return _root() / "reports" / "templates"


def check_inside(path: Path, folders: Sequence[Path]) -> None:
    """Check that a file found in a config folder is really inside it, after resolving links; nothing is read before.

    A file with an absolute path outside the folders can be anywhere. However, if one of the folders is a study, all
    files must be inside the folders or built-in.

    Raises:
        ConfigError: if the file is elsewhere.
    """
    own = [folder for folder in folders if path.is_relative_to(folder)]
    if not own and any((folder / STUDY_FILE).is_file() for folder in folders):
        own = [*folders, robots_dir()]
    place = Path(os.path.realpath(path))
    if own and not any(place.is_relative_to(os.path.realpath(folder)) for folder in own):
        raise ConfigError(f"{path}: is {place}, outside of the folder {own[0]}; put the file itself there")
