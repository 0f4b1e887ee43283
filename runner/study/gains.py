"""Tuned gains of a study: the file `gains.yaml`, and their insertion into overrides of runs."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.config.compose.user_settings import refuse_settings
from runner.store.atomic import write_atomically
from runner.study.grid import Overrides

FILE = "gains.yaml"
Gains = Mapping[str, Sequence[Mapping[str, float]]]
"""Of each tuning, by name, the values of its keys by each of its seeds."""

_KEY = "gains="


def read_gains(folder: Path) -> Gains:
    """Return the gains that are kept in the folder of a study; none where there is no such file.

    Raises:
        RunnerError: if the file cannot be read or does not fit.
    """
    path = folder / FILE
    gains = read_data(path, dict[str, list[dict[str, float]]]) if path.is_file() else {}
    refuse_settings((key for each in gains.values() for own in each for key in own), path)
    return gains


def write_gains(folder: Path, gains: Gains) -> None:
    """Write gains into a folder.

    Raises:
        OSError: if they cannot be written.
    """
    content = {name: [dict(own) for own in each] for name, each in gains.items()}
    text = yaml.safe_dump(content, sort_keys=False, width=200, default_flow_style=None)
    write_atomically(folder / FILE, f"# Made by the tunings of the study; see docs/paper.md.\n{text}".encode())


def put_in(overrides: Overrides, gains: Gains) -> Overrides:
    """Return a run's overrides with the gains of a tuning in place of the override that names it.

    One whose gains are not known yet stays as it is.

    Raises:
        RunnerError: if a tuning has no such number.
    """
    return tuple(text for override in overrides for text in _put_in(override, gains))


def without_gains(overrides: Overrides) -> Overrides:
    """Return a run's overrides without those that name a tuning."""
    return tuple(text for text in overrides if not text.startswith(_KEY))


def named(overrides: Overrides) -> list[tuple[str, int]]:
    """Return the names of the tunings whose gains some overrides take, each with its number.

    Raises:
        RunnerError: if one ends in no number.
    """
    return [_named(text) for text in overrides if text.startswith(_KEY)]


def check_named(runs: Mapping[str, Overrides], times: Mapping[str, int]) -> None:
    """Check that all tunings that runs name are there.

    Args:
        runs: Overrides of each run.
        times: How many times each tuning is made, by its name.

    Raises:
        RunnerError: with the run and the name nearest to what it names.
    """
    for run, overrides in runs.items():
        for name, number in named(overrides):
            if name not in times:
                raise RunnerError(f"run '{run}': there is no tuning '{name}'{nearest(name, times)}")
            if not 1 <= number <= times[name]:
                raise RunnerError(f"run '{run}': tuning '{name}' is made {times[name]} times; found {number}")


def _put_in(override: str, gains: Gains) -> list[str]:
    if not override.startswith(_KEY):
        return [override]
    name, number = _named(override)
    if name not in gains:
        return [override]
    if number > len(gains[name]):
        raise RunnerError(f"{override}: {FILE} has the gains of {len(gains[name])} tunings; make them anew")
    return [f"{key}={value:.9g}" for key, value in gains[name][number - 1].items()]


def _named(override: str) -> tuple[str, int]:
    name, _, number = override.removeprefix(_KEY).rpartition("/")
    if not number.isdecimal() or int(number) < 1:
        raise RunnerError(f"{override}: must end in the number of a tuning, 1 or more")
    return name, int(number)
