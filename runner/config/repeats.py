"""Periodicity check of the desired motion, for controllers that learn from period to period."""

from typing import Protocol, runtime_checkable

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.config.run import RunConfig
from runner.trajectories.trajectory import joint_reference

_SAMPLES = 4096  # of the motion in a run, at ticks
_SAME = 1e-6  # of the motion's extent: splines at rest at both ends repeat less well than that between rows
_REPEATING = (
    "allowed: trajectory=circle or lissajous with trajectory.easing=none, or trajectory=from_file with rows that "
    "repeat, controller.repeats_every their period and duration no longer than they last"
)


@runtime_checkable
class LearnsPeriods(Protocol):
    """A config of controllers that learn from one period of the desired motion for the next."""

    repeats_every: float
    period: float


def check_repeats(config: RunConfig) -> None:
    """Check that the desired motion repeats as a law that learns from it is told.

    Raises:
        ConfigError: where the run ends before what was learned acts, or the motion is not the same a period later.
    """
    law, timing = config.controller, config.timing
    if not isinstance(law, LearnsPeriods):
        return
    every, end = law.repeats_every, timing.ticks * timing.tick
    late = round(every / timing.tick)
    if timing.ticks <= 2 * late:
        raise ConfigError(
            [
                f"duration: {end:g} s is no longer than two of controller.repeats_every, {every:g} s; the first period "
                f"teaches nothing, and what the second teaches acts in the third; allowed: above {2.0 * every:g} s"
            ]
        )
    ticks = np.unique(np.linspace(0, timing.ticks - late, _SAMPLES).astype(int))
    now, then = (_positions(config, (ticks + shift) * timing.tick) for shift in (0, late))
    unlike = np.abs(then - now).max(axis=1)
    extent = float(np.ptp(np.concatenate([now, then]), axis=0).max())
    if extent > 0.0 and unlike.max() <= _SAME * extent:
        return
    what = _first_difference(config, ticks * timing.tick, unlike, _SAME * extent) if extent > 0.0 else "rests"
    raise ConfigError([f"controller.repeats_every: {every:g} s, but the desired motion {what}; {_REPEATING}"])


def _first_difference(config: RunConfig, times: FloatArray, unlike: FloatArray, same: float) -> str:
    first, largest = int(np.argmax(unlike > same)), int(unlike.argmax())
    unit = "m" if joint_reference(config.path, times[:1]) is None else "rad"
    return (
        f"is not the same that time later: first at {times[first]:g} s, and by up to {unlike[largest]:.3g} "
        f"{unit} at {times[largest]:g} s"
    )


def _positions(config: RunConfig, times: FloatArray) -> FloatArray:
    """Return desired positions of the joints, or of the tip where none are led, shape (T, k)."""
    joints = joint_reference(config.path, times)
    motion = config.path.sample(times) if joints is None else joints
    return motion[:, 0]
