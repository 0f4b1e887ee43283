"""Resolved config of a run: the step of its plant, and the distance from start to goal."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from runner.store import Run

DISTANCE = "distance from start to goal"
UNITS = {DISTANCE: "m"}
"""Units of what is no key of a config."""


def resolve(config: Mapping[str, Any], step: float, home: Sequence[float] | None) -> Mapping[str, Any]:
    """Return a config with the step of its plant, and how far its path goes where it leads to a goal.

    Args:
        config: The config as it composed.
        step: The plant's step, in s.
        home: Where the tip of its arm starts, in m, unless the config says; None where that is not known.
    """
    resolved = {**config, "plant": {**config["plant"], "step": step}}
    trajectory = config.get("trajectory", {})
    start = trajectory["start"] if _is_point(trajectory.get("start")) else home
    if start is not None and _is_point(trajectory.get("goal")):
        resolved[DISTANCE] = float(f"{math.dist(start, trajectory['goal']):.4g}")
    return resolved


def is_one_arm(config: Mapping[str, Any]) -> bool:
    """Return whether the robot of a config is one arm, not a chain of arms."""
    robot = config.get("robot", {})
    return "tip" in robot and "home" in robot


class Resolver:
    """Resolves the configs of stored runs, of which many have the same robot."""

    def __init__(self) -> None:
        self._tips: dict[str, Sequence[float]] = {}

    def resolve(self, run: Run) -> Mapping[str, Any]:
        """Return the config of a stored run; see the function of that name. The distance is told of one arm only."""
        starts = run.config.get("trajectory", {}).get("start", ...) is None
        home = self._home(run) if starts and is_one_arm(run.config) else None
        return resolve(run.config, run.provenance["plant_step"], home)

    def _home(self, run: Run) -> Sequence[float]:
        robot = run.config["robot"]
        key = json.dumps(robot, sort_keys=True)
        if key not in self._tips:
            import numpy as np

            from runner.robots.model import RobotModel

            home = np.array(robot["home"], dtype=float)
            self._tips[key] = RobotModel(run.urdf, robot["tip"]).tip_position(home).tolist()
        return self._tips[key]


def _is_point(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(isinstance(part, int | float) for part in value)
