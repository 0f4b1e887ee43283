"""Cache of the stored run of each command line."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.config.compose.data_files import has_data_file
from runner.plugins.discovery import has_users_parts, in_use
from runner.store.latest import note
from runner.store.recall.answers import keep, recall
from runner.store.recall.basis import basis

if TYPE_CHECKING:
    from runner.config.compose.compose import Composed
    from runner.store import Run

_CONFIG_DIR = ("--config-dir", "-cd")
# Hydra's names of where configs come from that the key holds; the last is how we name it the user's config folders.
_READ = {"hydra", "main", "command-line", "schema", "hydra.searchpath in command-line"}


def find_again(key: str | None) -> "tuple[Run, Any] | None":
    """Return the stored run that a command line gave before, with its thresholds of caveats; None where it must run.

    Args:
        key: The key of the line; see line_key.
    """
    answer = None if key is None else recall(key)
    if not (isinstance(answer, dict) and answer.keys() == {"run", "outputs", "thresholds", "spec"}):
        return None
    from runner.statistics.spec import bounds_of
    from runner.store import DamagedError, find_run, judge_run

    try:
        run = find_run(Path(answer["outputs"]), answer["run"])
    except DamagedError:
        return None  # told where it is made again
    if run is None:
        return None
    note(run.folder)
    return judge_run(run, bounds_of(answer)), answer["thresholds"]


def keep_run(
    key: str | None, arguments: Sequence[str], composed: "Composed", run: "Run", sources: Sequence[str]
) -> None:
    """Keep which run a command line gave, where it follows from nothing but what its key is a digest of.

    Args:
        key: The line's key from before it was composed; files that changed since then leave nothing to keep.
        arguments: What is typed.
        composed: The config that it composed.
        run: The run that this gave.
        sources: From where Hydra took configs, by the names of its providers.
    """
    resolved = composed.resolved
    alone = set(sources) <= _READ and not has_users_parts() and all(map(_is_read, _arms(resolved.get("robot"))))
    alone = alone and not has_data_file(resolved)  # which may lie anywhere, and change
    if key is not None and alone and key == line_key(arguments):
        told = {"thresholds": resolved.get("caveats"), "spec": resolved.get("spec")}
        keep(key, {"run": run.folder.name, "outputs": resolved["outputs"], **told})


def line_key(arguments: Sequence[str]) -> str | None:
    """Return the digest that a run is kept under.

    It is None for a line with plug-ins, whose source is not read, or with flags or keys of Hydra's, which may make it
    another thing than a run.
    """
    line = None if in_use() else plain_line(arguments)
    return None if line is None else basis(arguments, line[1])


def plain_line(arguments: Sequence[str]) -> tuple[list[str], list[Path]] | None:
    """Return the overrides and the config folders of a line; None if it has other flags or keys of Hydra's."""
    overrides, config_dirs, words = [], [], iter(arguments)
    for word in words:
        if word in _CONFIG_DIR:
            config_dirs.append(Path(next(words, "")))
        elif word.startswith("--config-dir="):
            config_dirs.append(Path(word.partition("=")[2]))
        elif word.startswith("-") or "=" not in word or "hydra" in word:
            return None
        else:
            overrides.append(word)
    return overrides, config_dirs


def _arms(robot: Any) -> Iterator[Mapping[str, Any]]:
    stages = robot.get("stages")
    yield from stages.values() if isinstance(stages, Mapping) else (robot,)


def _is_read(arm: Mapping[str, Any]) -> bool:
    """Tell whether an arm is a URDF in one of the folders that are read; an MJCF may take files from anywhere."""
    return isinstance(arm.get("urdf"), str) and not arm.get("mjcf") and not Path(arm["urdf"]).is_absolute()
