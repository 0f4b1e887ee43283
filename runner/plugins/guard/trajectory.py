"""Runtime checks of trajectory plug-ins."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.plugins.guard.faults import ask, checked, find_fault, place, told_of_part
from runner.plugins.guard.read_only import read_only


class WatchedTrajectory:
    """A trajectory of the user's, tried out when it is made; its points and times are those that it had then.

    It ends the run as a failure where it raises later, or gives a wrong shape or values that are not finite.

    Args:
        trajectory: What is watched.

    Raises:
        ConfigError: where it does so at once; names the place.
    """

    def __init__(self, trajectory: Any, *_: Any) -> None:
        try:
            problems = list(_faults(trajectory))
            if not problems:
                self.start = read_only(np.array(trajectory.start, dtype=float))
                self.goal = None if trajectory.goal is None else read_only(np.array(trajectory.goal, dtype=float))
                self.duration, self.run_duration = float(trajectory.duration), float(trajectory.run_duration)
                self.tracked = bool(trajectory.tracked)
        except RunnerError:
            raise
        except Exception as error:
            problems = [told_of_part(error)]
        if problems:
            raise ConfigError(f"trajectory: {type(trajectory).__name__}: {problem}" for problem in problems)
        self._trajectory = trajectory

    def sample(self, times: FloatArray) -> FloatArray:
        """Return its motion; see Trajectory."""
        part = self._trajectory.sample
        return checked(ask(part, 0.0, read_only(times)), (len(times), 3, 3), part, 0.0)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distances of points; see Trajectory. Those of several runs are asked for run by run."""
        if points.ndim > 2:
            return np.stack([self.distance_to_path(np.ascontiguousarray(own)) for own in points])
        part = self._trajectory.distance_to_path
        return checked(ask(part, 0.0, read_only(points)), (len(points),), part, 0.0)

    def __deepcopy__(self, _: object) -> "WatchedTrajectory":
        """Return itself, as nothing that it gives away reaches what it holds."""
        return self


def _faults(trajectory: Any) -> Iterator[str]:
    for name in ("duration", "run_duration"):
        value = getattr(trajectory, name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < np.inf:
            yield f"its {name} is {value!r}; it must be a time in s, 0 or more"
            return
    for name, point in (("start", trajectory.start), ("goal", trajectory.goal)):
        fault = None if point is None and name == "goal" else find_fault(point, (3,))
        if fault:
            yield f"its {name} is {fault}"
    times = np.linspace(0.0, trajectory.duration, 1001)
    motion = trajectory.sample(read_only(times))
    fault = find_fault(motion, (len(times), 3, 3))
    if fault:
        yield f"{place(trajectory.sample)} gave {fault}"
        return
    points = read_only(np.array(motion, dtype=float)[:, 0])
    fault = find_fault(trajectory.distance_to_path(points), (len(times),))
    if fault:
        yield f"{place(trajectory.distance_to_path)} gave {fault}"
