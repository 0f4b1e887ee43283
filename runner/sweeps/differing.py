"""Resolved configs of a sweep's cells, with step and distance, and the values that differ beyond the swept keys.

If `robot` is swept, the gains, the path and the encoder noise may change with it, because a robot's file proposes
them. These values may cause differences that seem to come from the arms.
"""

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from runner.base.dotted_keys import dotted, leaves, split_override
from runner.base.memory import Memory
from runner.config.compose.units import key_unit
from runner.store.run import Run
from runner.store.seal import MEND, DamagedError, simulated_part

if TYPE_CHECKING:
    from runner.store.axes import Axis


DISTANCE = "distance from start to goal"


def unit_of(key: str) -> str:
    """Return the unit of a compared value: of the distance to the goal, or of a config key; "1" without one."""
    return "m" if key == DISTANCE else key_unit(key)


def resolve(config: Mapping[str, Any], step: float, home: Sequence[float] | None) -> Mapping[str, Any]:
    """Return a config with the step of its plant and, if its path leads to a goal, the distance to that goal.

    Args:
        config: The composed config.
        step: The plant's step, in s.
        home: Start position of the tip if the config has none, in m; None if unknown.
    """
    resolved = {**config, "plant": {**config["plant"], "step": step}}
    trajectory = config.get("trajectory", {})
    start = trajectory["start"] if _is_point(trajectory.get("start")) else home
    if start is not None and _is_point(trajectory.get("goal")):
        resolved[DISTANCE] = _rounded(math.dist(start, trajectory["goal"]))
    return resolved


def is_one_arm(config: Mapping[str, Any]) -> bool:
    """Return True if the robot of a config is one arm, not a chain of arms."""
    robot = config.get("robot", {})
    return "tip" in robot and "home" in robot


@dataclass(frozen=True, eq=False)
class Distance:
    """Distance from an arm's tip in its home position to a goal, in m; it is computed when it matters.

    Attributes:
        urdf: URDF of the arm.
        tip: Frame of the tip.
        home: Joint positions at the start.
        goal: The goal, in m.
    """

    urdf: str
    tip: str
    home: tuple[float, ...]
    goal: tuple[float, ...]

    def __float__(self) -> float:
        try:
            return _rounded(math.dist(_tip_position(self.urdf, self.tip, self.home), self.goal))
        except ValueError as error:
            fault = f"robot.home of a stored run: {list(self.home)} does not fit its robot"
            raise DamagedError(f"{fault}; {MEND}") from error

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Distance) and (astuple(self) == astuple(other) or float(self) == float(other))


class Resolver:
    """Resolves the configs of stored runs; runs with the same robot share the text of its URDF."""

    def __init__(self) -> None:
        self._urdfs: dict[str, str] = {}

    def resolve(self, run: Run) -> Mapping[str, Any]:
        """Return the resolved config of a stored run; see the function `resolve`. A chain of arms has no distance."""
        resolved = resolve(run.config, run.provenance["plant_step"], None)
        trajectory = run.config.get("trajectory", {})
        if trajectory.get("start", ...) is None and _is_point(trajectory.get("goal")) and is_one_arm(run.config):
            robot = run.config["robot"]
            key = json.dumps(robot, sort_keys=True)
            if key not in self._urdfs:
                self._urdfs[key] = run.urdf
            distance = Distance(self._urdfs[key], robot["tip"], tuple(robot["home"]), tuple(trajectory["goal"]))
            return {**resolved, DISTANCE: distance}
        return resolved


@lru_cache(maxsize=64)
def _tip_position(urdf: str, tip: str, joints: tuple[float, ...]) -> tuple[float, ...]:
    from runner.robots.model import RobotModel

    return tuple(RobotModel(urdf, tip).tip_position(np.array(joints, dtype=float)).tolist())


def _rounded(distance: float) -> float:
    return float(f"{distance:.4g}")


def _is_point(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(isinstance(part, int | float) for part in value)


Codes = NDArray[np.int32]
Levels = NDArray[np.intp]

_NAMES = ("kind", "name")  # of the option that an axis chooses
# Keys of a robot that act by themselves. Its other keys describe the arm or propose values that other groups contain.
_OF_A_ROBOT = ("payload", "settling_band", "tool")
_MOST_TOGETHER = 3  # axes that a value may depend on together
_NAMED = 4


@dataclass(frozen=True)
class UnsweptDifference:
    """Value that differs between cells although it was not swept.

    Attributes:
        key: Dotted key of the value, or its description.
        axes: Names of the axes that determine the value; empty if there are none.
        values: Each value as a string, after the levels of these axes that have it, such as ("macro, mini", "0.01").
    """

    key: str
    axes: tuple[str, ...]
    values: Sequence[tuple[str, str]]

    @property
    def unit(self) -> str:
        """Unit of the value; "1" without one."""
        return unit_of(self.key)


class Resolved:
    """Values that differ between the resolved configs of a sweep."""

    def __init__(self) -> None:
        self._first: Mapping[str, Any] = {}
        self._cells = 0
        self._given: set[str] = set()
        self._codes: dict[str, Codes] = {}  # for each key that differs: string number of each cell
        self._texts: dict[str, dict[str | None, int]] = {}  # numbers of a key's strings; the first cell has 0
        self._memory = Memory(1024)

    def add(
        self, config: Mapping[str, Any], overrides: Sequence[str] = (), cells: "range | Levels | None" = None
    ) -> None:
        """Add the config of one or more cells; keys that do not affect the simulation are left out.

        Args:
            config: The resolved config; a group that is one object in several configs must not be changed.
            overrides: Overrides of the config. Their keys are axes, or the same in all cells, and need no memory,
                except keys whose value interpolates other keys.
            cells: Numbers of the cells, an array of shape (n,) or a range; None for the next cell.
        """
        cells = range(self._cells, self._cells + 1) if cells is None else cells
        part = simulated_part(config)
        self._given.update(split_override(text)[0] for text in overrides if "${" not in text)
        self._first = self._first or part
        # Most groups are the same in all cells and need no comparison.
        changed = [name for name in {**self._first, **part} if not _is_same(self._first.get(name), part.get(name))]
        before, now = (self._entries(some, changed) for some in (self._first, part))
        self._cells = max(self._cells, max(cells[0], cells[-1]) + 1)
        for key in dict.fromkeys([*before, *now]):
            if key in self._given:
                continue
            if before.get(key) != now.get(key):
                texts = self._texts.setdefault(key, {before.get(key): 0})
                self._put(key, cells, texts.setdefault(now.get(key), len(texts)))

    def _entries(self, config: Mapping[str, Any], names: Sequence[str]) -> dict[str, str]:
        """Return the values of some groups of a config as strings, by dotted key."""
        found: dict[str, str] = {}
        for name in names:
            if name in config:
                found |= self._memory.recall(_flat, name, config[name])
        return found

    def _put(self, key: str, cells: "range | Levels", code: int) -> None:
        codes = self._codes.get(key)
        if codes is None or len(codes) < self._cells:
            longer = np.zeros(max(64, 2 * self._cells), dtype=np.int32)
            longer[: 0 if codes is None else len(codes)] = () if codes is None else codes
            codes = self._codes[key] = longer
        codes[slice(cells.start, cells.stop, cells.step) if isinstance(cells, range) else cells] = code

    def differences(self, axes: Sequence["Axis"]) -> list[UnsweptDifference]:
        """Return the differences beyond the axes, in the order of their first occurrence."""
        found = []
        for key, some in self._codes.items():
            if key in self._given:
                continue
            texts = list(self._texts[key])
            codes = np.zeros(self._cells, dtype=np.intp)
            count = min(len(some), self._cells)
            codes[:count] = some[:count]
            group = key.partition(".")[0]
            of_option = any(axis.name == group != key for axis in axes)
            if any(key == axis.name or (key.startswith(f"{axis.name}.") and axis.name != group) for axis in axes):
                continue
            if of_option and is_of_option(key):
                continue
            # A key that only some options have is part of the option.
            present = codes != texts.index(None) if of_option and None in texts else np.ones(len(codes), dtype=bool)
            if np.any(codes[present] != codes[present][:1]):
                found.append(_difference(key, codes, texts, present, axes))
        return found


def in_words(differences: Sequence[UnsweptDifference]) -> str:
    """Return a line with the number of differences and the first of them; empty if there are none."""
    if not differences:
        return ""
    count, named = len(differences), [difference.key for difference in differences[:_NAMED]]
    more = f" and {count - len(named)} more" if count > len(named) else ""
    axes = list(dict.fromkeys(name for difference in differences for name in difference.axes))
    by = f" with {', '.join(axes)}" if axes else ""
    values = "1 config value differs" if count == 1 else f"{count} config values differ"
    return f"{values} beyond the swept axes{by}: {', '.join(named)}{more}"


def is_of_option(key: str) -> bool:
    """Return True if a key of a swept group names its option or describes the arm; such keys are not compared."""
    group, _, rest = key.partition(".")
    return rest in _NAMES or (group == "robot" and rest.partition(".")[0] not in _OF_A_ROBOT)


def _difference(
    key: str, codes: Levels, texts: Sequence[str | None], present: NDArray[np.bool_], axes: Sequence["Axis"]
) -> UnsweptDifference:
    codes = codes[present]
    for count in range(1, min(len(axes), _MOST_TOGETHER) + 1):
        for some in itertools.combinations(axes, count):
            places = [axis.level[present] for axis in some]
            together = _numbered(places, [len(axis.values) for axis in some])
            one = np.zeros(int(together.max()) + 1, dtype=np.intp)
            one[together] = codes
            if np.array_equal(one[together], codes):
                first = np.unique(together, return_index=True)[1]
                levels: dict[str, list[str]] = {}
                for cell in first.tolist():
                    name = " and ".join(axis.text(int(place[cell])) for axis, place in zip(some, places, strict=True))
                    levels.setdefault(texts[codes[cell]] or "–", []).append(name)
                values = [(", ".join(names), text) for text, names in levels.items()]
                return UnsweptDifference(key, tuple(axis.name for axis in some), values)
    return UnsweptDifference(key, (), [("", texts[code] or "–") for code in np.unique(codes).tolist()])


def _numbered(levels: Sequence[Levels], counts: Sequence[int]) -> Levels:
    """Return one number for each combination of levels that occurs, shape (cells,), in the order of the levels."""
    together = levels[0]
    for level, count in zip(levels[1:], counts[1:], strict=True):
        together = together * count + level
    if int(together.max()) < 4 * len(together) + 64:
        return together
    return np.asarray(np.unique(together, return_inverse=True)[1])


def _is_same(one: Any, other: Any) -> bool:
    return one is other or bool(one == other)


def _flat(name: str, value: Any) -> dict[str, str]:
    return dict(entries({name: value}))


def entries(config: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the values of a config by their dotted keys, as strings."""
    return ((dotted(place), value_text(value)) for place, value in leaves(config, lists=False))


def value_text(value: Any) -> str:
    """Return a value as a string; 1 and 1.0 give the same string."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value:.12g}"
    if isinstance(value, Distance):
        return value_text(float(value))
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{', '.join(map(value_text, value))}]"
    return str(value)
