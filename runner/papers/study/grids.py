"""Runs of a study as data: grids of overrides in `runs.yaml` of its folder.

    grids:
      turns:
        name: turns/{{ preset }}
        with: [experiment=thesis/figure_5_12, "duration={{ cycles * 4 }}"]
        over:
          preset: [as_reported, full_equations]
          schedule: {both: controller.schedule=both, turns: [controller.schedule=turns, plant=rk4]}
        values: {cycles: 5}

A grid is one run for each combination of levels of the axes in `over`. A run is named by `name` of the grid, or else
by the grid's key. The levels of the axes that `name` does not contain follow, separated by slashes. The overrides of
a run are those in `with`, then those of each axis: `axis=level` for a list, the overrides of the label for a group of
labels.

An override that consists only of `{{ axis }}` inserts that axis at this position. A listed axis that an expression
contains adds no override. Levels are inserted as written (3.0), expressions with nine digits at most (3). `values`
are further numbers for expressions, of a grid or, on the level of `grids`, of all grids. A list within a list of
overrides, as an alias inserts it, is replaced by its items. Calibrations are grids under `calibrations`.

`plugins: {law: controller}` of a grid states that its axis `law` takes user-supplied controllers. Each controller
that `runner reproduce` receives by --plugin is one more level, by its name.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from runner.base.bounded_yaml import STORED, read_yaml
from runner.base.errors import RunnerError, nearest
from runner.base.limits import read_text
from runner.config.compose.files import refuse_settings
from runner.config.compose.messages import describe
from runner.papers.study.code import UserPlugin
from runner.papers.study.grid import Level, Overrides, StudyGrid
from runner.papers.study.manifest import Profile
from runner.papers.study.results import Parts, name_of
from runner.papers.study.tunings import StudyTuning, TunedGrid, all_tunings, check_named
from runner.schema.model import StrictModel

FILE = "runs.yaml"
L = TypeVar("L", str, int, float)
G = TypeVar("G", bound=StudyGrid)


class _Values(StrictModel):
    values: dict[str, float]


class Grids:
    """The grids of a study.

    Args:
        path: Its runs.yaml.
        profile: Levels and repetitions instead of those in the file.
        parts: User-supplied parts, which are levels of the axes of their group.

    Attributes:
        runs: Overrides of every run by name.
        calibrations: Overrides of every calibration by name.
        parts: The parts of each of these names.
        tunings: Every tuning by name.

    Raises:
        RunnerError: with file, grid and every problem found.
    """

    def __init__(self, path: Path, profile: Profile | None = None, parts: Sequence[UserPlugin] = ()) -> None:
        self._path = path
        try:
            text = read_text(path, STORED.size)
        except (OSError, ValueError) as error:
            raise RunnerError(f"cannot read {path}: {error}") from None
        content = read_yaml(text, path)
        problems: list[str] = []
        roots = {root: _parse(root, StudyGrid, content, problems) for root in ("grids", "calibrations")}
        tuned = _parse("tunings", TunedGrid, content, problems)
        if profile is not None:
            problems += profile.problems({**roots["grids"], **roots["calibrations"], **tuned})
            roots, tuned = {root: profile.applied(own) for root, own in roots.items()}, profile.applied(tuned)
        roots = {root: _with_parts(root, own, parts, problems) for root, own in roots.items()}
        self._tuned = tuned = _with_parts("tunings", tuned, parts, problems)
        shared = content.get("values", {}) if isinstance(content, dict) else {}
        try:
            self._values = _Values(values=shared).values
        except ValidationError as error:
            problems += [*describe("", _Values, error)]
            self._values = {}
        keys = ("values", *roots, "tunings")
        for key in content if isinstance(content, dict) else ():
            if key not in keys:
                problems.append(f"{key}: unknown key{nearest(key, keys)}; keys: {', '.join(keys)}")
        self._grids = {**roots["grids"], **roots["calibrations"]}
        self.parts: dict[str, Parts] = {}
        self.runs, self.calibrations = (self._expanded(roots[root], root, problems) for root in roots)
        self.tunings: dict[str, StudyTuning] = {}
        try:
            self.tunings = all_tunings(tuned, self._values)
            if not problems:
                check_named(self.runs, {name: each.times for name, each in self.tunings.items()})
        except RunnerError as error:
            problems.append(str(error))
        tuned_with = (each.overrides for each in self.tunings.values())
        refuse_settings(chain(*self.runs.values(), *self.calibrations.values(), *tuned_with), path)
        if profile is not None:
            self.runs, self.calibrations = (
                {name: profile.repeated(overrides) for name, overrides in own.items()}
                for own in (self.runs, self.calibrations)
            )
        if problems:
            raise RunnerError("\n".join(f"{path}: {problem}" for problem in problems))

    def _expanded(self, grids: Mapping[str, StudyGrid], root: str, problems: list[str]) -> dict[str, Overrides]:
        runs: dict[str, Overrides] = {}
        for key, grid in grids.items():
            try:
                for parts, overrides in grid.runs(key, self._values):
                    if (name := name_of(parts)) in runs:
                        raise RunnerError(f"the name '{name}' is that of another run")
                    runs[name], self.parts[name] = overrides, parts
            except RunnerError as error:
                problems.append(f"{root}.{key}: {error}")
        return runs

    @property
    def plugins(self) -> frozenset[str]:
        """The groups of the user-supplied parts that its axes take."""
        return frozenset(group for grid in self._grids.values() for group in grid.plugins.values())

    def compared(self, part: UserPlugin) -> Iterator[tuple[str, Overrides, Overrides]]:
        """Yield name and overrides of each run and tuning of a part, and the overrides with our first level instead."""
        for key, grid in chain(self._grids.items(), self._tuned.items()):
            for axis in (axis for axis, group in grid.plugins.items() if group == part.group):
                ours = next(iter(grid.over[axis]))
                pairs = (grid.only(axis, level).runs(key, self._values) for level in (part.name, ours))
                for (parts, own), (_, other) in zip(*pairs, strict=True):
                    yield name_of(parts), own, other

    def grid(self, key: str) -> StudyGrid:
        """Return a grid.

        Raises:
            RunnerError: if there is none.
        """
        if key not in self._grids:
            raise RunnerError(f"{self._path}: there is no grid '{key}'{nearest(key, self._grids)}")
        return self._grids[key]

    def levels(self, key: str, axis: str, kind: type[L]) -> tuple[L, ...]:
        """Return the levels of an axis, all of one kind: str, int or float.

        Raises:
            RunnerError: if there is no such grid or axis, or a level is of another kind.
        """
        over = self._axis(key, axis)
        allowed = (int, float) if kind is float else (kind,)
        levels: list[Any] = [level for level in over if isinstance(level, allowed)]
        if len(levels) < len(over):
            raise RunnerError(f"{self._path}: grid '{key}': the levels of '{axis}' are not all of kind {kind.__name__}")
        return tuple(levels)

    def level(self, key: str, axis: str, place: int) -> Level:
        """Return a level of an axis by its place, which is counted from 0, from the last one if it is negative."""
        levels = [*self._axis(key, axis)]
        if not -len(levels) <= place < len(levels):
            raise RunnerError(f"{self._path}: grid '{key}': axis '{axis}' has {len(levels)} levels, no place {place}")
        return levels[place]

    def _axis(self, key: str, axis: str) -> Mapping[Level, Overrides | None]:
        over = self.grid(key).over
        if axis not in over:
            raise RunnerError(f"{self._path}: grid '{key}': there is no axis '{axis}'{nearest(axis, over)}")
        return over[axis]

    def value(self, key: str, name: str) -> float:
        """Return one of the `values` of a grid, or of all."""
        values = {**self._values, **self.grid(key).values}
        if name not in values:
            raise RunnerError(f"{self._path}: grid '{key}': there is no value '{name}'{nearest(name, values)}")
        return values[name]


def _parse(root: str, kind: type[G], content: object, problems: list[str]) -> dict[str, G]:
    found = content.get(root, {}) if isinstance(content, dict) else None
    if not isinstance(found, dict):
        problems.append(f"{root}: must be a group of grids by name")
        return {}
    grids = {}
    for key, value in found.items():
        try:
            grids[key] = kind.model_validate(value)
        except ValidationError as error:
            problems += [*describe(f"{root}.{key}", kind, error)]
    return grids


def _with_parts(root: str, grids: Mapping[str, G], parts: Sequence[UserPlugin], problems: list[str]) -> dict[str, G]:
    found = {}
    for key, grid in grids.items():
        try:
            found[key] = grid.with_parts(parts)
        except RunnerError as error:
            problems.append(f"{root}.{key}: {error}")
    return found
