"""Guarded trajectories: samples that are none are refused before or during the run."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.trajectories import TRAJECTORIES


@dataclass
class Path:
    """A trajectory of the user that rests at a point."""

    start: object = (0.0, 1.0, 1.0)
    goal: object = None
    duration: object = 1.0
    run_duration: object = 2.0
    tracked: bool = True
    motion: object = None
    distance: object = None

    def sample(self, times):
        motion = np.zeros((len(times), 3, 3)) if self.motion is None else self.motion
        return motion / 0 if isinstance(motion, int) else motion

    def distance_to_path(self, points):
        return np.zeros(len(points)) if self.distance is None else self.distance


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"duration": -1.0}, r"Path: its duration is -1.0; it must be a time in s, 0 or more"),
        ({"run_duration": float("nan")}, r"its run_duration is nan"),
        ({"duration": True}, r"its duration is True"),
        ({"goal": [0.0, 1.0]}, r"its goal is an array of shape \(2,\); it must be an array of shape \(3,\)"),
        ({"start": None}, r"its start is None; it must be an array of shape \(3,\)"),
        (
            {"motion": np.zeros((1001, 3))},
            r"Path.sample \(test_trajectory.py, line \d+\) gave an array of shape \(1001, 3\)",
        ),
        ({"motion": np.full((1001, 3, 3), np.nan)}, r"Path.sample .* gave nan at index \[0, 0, 0\]"),
        ({"motion": 1}, r"ZeroDivisionError: division by zero \(test_trajectory.py, line \d+, in sample\)"),
        ({"distance": np.zeros(3)}, r"Path.distance_to_path .* gave an array of shape \(3,\); .* shape \(1001,\)"),
    ],
)
def test_a_trajectory_that_goes_wrong_is_refused_before_the_run(wrong, message):
    with pytest.raises(ConfigError, match=message):
        TRAJECTORIES.guard(Path(**wrong))


def test_a_trajectory_that_is_right_passes():
    guarded = TRAJECTORIES.guard(Path())
    assert guarded.start.tolist() == [0.0, 1.0, 1.0]
    assert guarded.sample(np.zeros(2)).shape == (2, 3, 3)


def test_a_trajectory_that_changes_what_it_is_handed_is_refused():
    class Writes(Path):
        def sample(self, times):
            times *= 2.0

    with pytest.raises(ConfigError, match=r"Writes: ValueError: .*read-only \(test_trajectory.py, line \d+, in sample"):
        TRAJECTORIES.guard(Writes())


def test_a_trajectory_that_goes_wrong_later_is_a_failure(checked_config, closed_loop):
    class Tires(Path):
        def sample(self, times):
            return super().sample(times) if len(times) == 1001 else times / {}

    loop = replace(closed_loop("robot=macro", "duration=0.2"), trajectory=TRAJECTORIES.guard(Tires()))
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert re.search(r"TypeError: .* \(test_trajectory.py, line \d+, in sample\)", trace.failure.reason)
    assert (trace.failure.time, len(trace.t)) == (0.0, 1)


def test_what_it_gave_cannot_be_changed_afterwards():
    path = Path(start=np.array([0.0, 1.0, 1.0]), motion=np.zeros((1001, 3, 3)))
    guarded = TRAJECTORIES.guard(path)
    motion = guarded.sample(np.zeros(1001))
    path.start[:], path.motion[:], path.duration = 7.0, 7.0, 7.0
    assert guarded.start.tolist() == [0.0, 1.0, 1.0]
    assert guarded.duration == 1.0
    assert not motion.any()
