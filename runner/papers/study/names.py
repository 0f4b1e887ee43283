"""Names and folders of the installed studies, found without importing them, and a new study from the template."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from runner.base.atomic import write_atomically
from runner.base.entry_points import EntryPoint, entry_points_of
from runner.base.errors import RunnerError, nearest
from runner.base.former_names import FILES
from runner.base.paths import STUDY_FILE, example_study_dir, studies_dir, studies_with

GROUP = "studies"
"""The group of entry points by which an installed package says that it is a study, after `runner.`."""


@dataclass(frozen=True)
class Location:
    """Location of a study.

    Attributes:
        name: What it is called.
        folder: Its folder.
        package: The installed package that the folder is; None for a folder that is none.
    """

    name: str
    folder: Path
    package: str | None = None


def study_names() -> tuple[str, ...]:
    """Return the names of the installed studies, sorted."""
    return tuple(sorted({*studies_with(STUDY_FILE), *(point.name for point in entry_points_of(GROUP))}))


def find_study(text: str, others: Sequence[str] = ()) -> Location:
    """Return the location of a study, by its name or its folder.

    Args:
        text: The name of an installed study, or a path to the folder of another.
        others: What else the command takes in its place, for the message.

    Raises:
        RunnerError: if there is none.
    """
    if (studies_dir() / text / STUDY_FILE).is_file() and "/" not in text:
        return Location(text, studies_dir() / text, f"runner.papers.studies.{text}")
    for point in entry_points_of(GROUP):
        if point.name == text:
            return Location(text, _folder_of(point), point.value)
    folder = Path(text).resolve()
    if (folder / STUDY_FILE).is_file():
        if folder.name in study_names():
            raise RunnerError(f"{text}: {folder.name} is the name of an installed study; rename the folder")
        return Location(folder.name, folder)
    for former, present in FILES.items():
        if (folder / former).is_file():
            raise RunnerError(f"{former} is now called {present}.")
    if folder.is_dir() or "/" in text:
        raise RunnerError(
            f"{text}: no study: there is no {STUDY_FILE} in it; `runner study new {text}` writes a first one"
        )
    names = (*study_names(), *others)
    raise RunnerError(
        f"no study '{text}'{nearest(text, names)}; studies: {', '.join(names)}, or a folder with a {STUDY_FILE}"
    )


def _folder_of(point: EntryPoint) -> Path:
    try:
        spec = find_spec(point.value)
    except ImportError as error:
        raise RunnerError(f"study {point.name}: package {point.value} cannot be found: {error}") from error
    folders = list(spec.submodule_search_locations or ()) if spec is not None else []
    if not folders or not (Path(folders[0]) / STUDY_FILE).is_file():
        raise RunnerError(f"study {point.name}: package {point.value} has no {STUDY_FILE}")
    return Path(folders[0])


def write_new(folder: Path) -> list[Path]:
    """Write a small study that runs at once; return its files.

    Args:
        folder: Its folder; created if it does not exist.

    Raises:
        RunnerError: if there is something in the folder already, or it cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RunnerError(f"{folder}: exists and is not empty; name a new folder")
    sources = sorted(path for path in example_study_dir().iterdir() if path.suffix in (".yaml", ".md"))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in sources:
            write_atomically(folder / path.name, path.read_bytes())
    except OSError as error:
        raise RunnerError(f"{folder}: cannot be written: {error.strerror}") from error
    return [folder / path.name for path in sources]
