"""Watching the user's parts: what they raise, or give in a wrong shape or as NaN, is told with its place."""

import inspect
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from runner.errors import ConfigError, RunnerError, SimulationError, told
from runner.trace import FloatArray
from runner.trajectories import Trajectory


def is_ours(part: object) -> bool:
    """Tell whether an object or a module comes with this package, where no watching is needed."""
    name = part.__name__ if isinstance(part, ModuleType) else type(part).__module__
    return name.startswith("runner.")


def watch(part: object, law: Callable[..., FloatArray], size: int) -> Callable[..., FloatArray]:
    """Return a law that ends the run as a failure where it raises, or gives no finite numbers of its size.

    Args:
        part: Whose law it is, a controller or an environment; one of ours is returned as it is.
        law: Its `torque`, `joint_positions` or `wrench`, which takes the time first.
        size: How many numbers it gives.
    """
    if is_ours(part):
        return law

    def watched(time: float, *measured: FloatArray) -> FloatArray:
        try:
            answer = law(time, *measured)
        except (np.linalg.LinAlgError, RunnerError):
            raise
        except Exception as error:
            raise SimulationError(told(error), time) from error
        fault = _fault(answer, (size,))
        if fault:
            raise SimulationError(f"{_place(law)} gave {fault}", time)
        return np.array(answer, dtype=np.float64)  # clipping at limits must not reach into the user's own array

    return watched


def reset(controller: Any, *start: FloatArray) -> None:
    """Reset a controller.

    Raises:
        ConfigError: where one of the user's raises; names the place.
    """
    try:
        controller.reset(*start)
    except Exception as error:
        if is_ours(controller):
            raise
        raise ConfigError([f"controller: {told(error)}"]) from error


class WatchedPlant:
    """A plant of the user's, whose `advance` ends the run as a failure where it raises; all else is the plant's own.

    Args:
        plant: The plant.
    """

    def __init__(self, plant: Any) -> None:
        self.plant = plant
        """What is watched."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self.plant, name)

    def advance(self, command: FloatArray) -> None:
        """Advance the plant by a tick.

        Raises:
            SimulationError: where it raises; names the place.
        """
        try:
            self.plant.advance(command)
        except Exception as error:
            raise SimulationError(told(error), float("nan")) from error


def check_trajectory(trajectory: Trajectory) -> None:
    """Check that a trajectory of the user's gives what a run and its metrics need.

    Raises:
        ConfigError: where it raises, or gives a wrong shape or values that are not finite; names the place.
    """
    if is_ours(trajectory):
        return
    try:
        problems = list(_trajectory_faults(trajectory))
    except Exception as error:
        problems = [told(error)]
    if problems:
        raise ConfigError(f"trajectory: {type(trajectory).__name__}: {problem}" for problem in problems)


def _trajectory_faults(trajectory: Trajectory) -> Iterator[str]:
    for name in ("duration", "run_duration"):
        value = getattr(trajectory, name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < np.inf:
            yield f"its {name} is {value!r}; it must be a time in s, 0 or more"
            return
    for name, point in (("start", trajectory.start), ("goal", trajectory.goal)):
        fault = None if point is None and name == "goal" else _fault(point, (3,))
        if fault:
            yield f"its {name} is {fault}"
    times = np.linspace(0.0, trajectory.duration, 1001)
    motion = trajectory.sample(times)
    fault = _fault(motion, (len(times), 3, 3))
    if fault:
        yield f"{_place(trajectory.sample)} gave {fault}"
        return
    fault = _fault(trajectory.distance_to_path(np.array(motion)[:, 0]), (len(times),))
    if fault:
        yield f"{_place(trajectory.distance_to_path)} gave {fault}"


def watch_metrics(
    family: ModuleType, measured: Callable[[], Mapping[str, float | None]], notices: list[str]
) -> Mapping[str, float | None]:
    """Return the values that a metric family of the user's gives; where it fails, none of its metrics has a value.

    Args:
        family: The family's module.
        measured: What evaluates it.
        notices: Takes what went wrong, in words.
    """
    try:
        values = dict(measured())
        wrong = [name for name in values if not any(f"_{known}_" in f"_{name}_" for known in family.UNITS)]
        if wrong:
            notices.append(f"metric {wrong[0]}: {family.__name__}.UNITS names no unit for it; it is left out")
        kept = {name: value for name, value in values.items() if name not in wrong}
        for name, value in kept.items():
            fault = None if value is None else _fault(value, ())
            if fault:
                notices.append(f"metric {name}: {_place(family.evaluate)} gave {fault}")
                kept[name] = None
        return {name: None if value is None else float(value) for name, value in kept.items()}
    except Exception as error:
        notices.append(f"metrics of {family.__name__}: {told(error)}")
        return dict.fromkeys(family.UNITS)


def _fault(answer: Any, shape: tuple[int, ...]) -> str | None:
    """Return what is wrong with an array, in words; None where nothing is."""
    wanted = f"it must be an array of shape {shape}" if shape else "it must be a number"
    try:
        array = np.asarray(answer, dtype=np.float64)
    except (TypeError, ValueError):
        return f"{answer!r}; {wanted}"
    if array.shape != shape:
        return f"{f'an array of shape {array.shape}' if array.ndim else repr(answer)}; {wanted}"
    if not np.isfinite(array).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        return f"{array[index]}{f' at index {list(index)}' if shape else ''}; it must be finite"
    return None


def _place(function: Callable[..., Any]) -> str:
    """Return where a function of the user's stands."""
    code = inspect.unwrap(getattr(function, "__func__", function)).__code__
    return f"{code.co_qualname} ({Path(code.co_filename).name}, line {code.co_firstlineno})"
