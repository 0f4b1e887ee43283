"""Names and folders of the installed studies, found without importing them."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path

from runner.base.errors import RunnerError, nearest
from runner.base.paths import WORK_FILE, works_dir, works_with

GROUP = "runner.studies"
"""The group of entry points by which an installed package says that it is a work."""


@dataclass(frozen=True)
class Place:
    """Where a work is.

    Attributes:
        name: What it is called.
        folder: Its folder.
        package: The installed package that the folder is; None for a folder that is none.
    """

    name: str
    folder: Path
    package: str | None = None

    @property
    def ours(self) -> bool:
        """Whether it is one of ours, whose configs are those of the runner, but for robots that it brings."""
        return self.folder.parent == works_dir()


def work_names() -> tuple[str, ...]:
    """Return the names of the installed works, sorted."""
    return tuple(sorted({*works_with(WORK_FILE), *(point.name for point in _installed())}))


def find_work(text: str, others: Sequence[str] = ()) -> Place:
    """Return where a work is, by its name or its folder.

    Args:
        text: The name of an installed work, or a path to the folder of another.
        others: What else the command takes in its place, for the message.

    Raises:
        RunnerError: if there is none.
    """
    if (works_dir() / text / WORK_FILE).is_file() and "/" not in text:
        return Place(text, works_dir() / text, f"runner.studies.{text}")
    for point in _installed():
        if point.name == text:
            return Place(text, _folder_of(point), point.value)
    folder = Path(text).resolve()
    if (folder / WORK_FILE).is_file():
        if folder.name in work_names():
            raise RunnerError(f"{text}: {folder.name} is the name of an installed work; rename the folder")
        return Place(folder.name, folder)
    if folder.is_dir() or "/" in text:
        raise RunnerError(
            f"{text}: no work: there is no {WORK_FILE} in it; `runner work new {text}` writes a first one"
        )
    names = (*work_names(), *others)
    raise RunnerError(
        f"no work '{text}'{nearest(text, names)}; works: {', '.join(names)}, or a folder with a {WORK_FILE}"
    )


def _installed() -> tuple[EntryPoint, ...]:
    return tuple(entry_points(group=GROUP))


def _folder_of(point: EntryPoint) -> Path:
    try:
        spec = find_spec(point.value)
    except ImportError as error:
        raise RunnerError(f"work {point.name}: package {point.value} cannot be found: {error}") from error
    folders = list(spec.submodule_search_locations or ()) if spec is not None else []
    if not folders or not (Path(folders[0]) / WORK_FILE).is_file():
        raise RunnerError(f"work {point.name}: package {point.value} has no {WORK_FILE}")
    return Path(folders[0])
