"""Guarded trajectories: samples that are none are refused before or during the run."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.trajectories import TRAJECTORIES, guard_joint_motion


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
        rest = np.zeros((len(times), 3, 3))
        rest[:, 0] = 0.0 if self.start is None else self.start
        motion = rest if self.motion is None else self.motion
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
        tired = False

        def sample(self, times):
            return times / {} if self.tired else super().sample(times)

    path = Tires()
    loop = replace(closed_loop("robot=macro", "duration=0.2"), trajectory=TRAJECTORIES.guard(path))
    path.tired = True
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert re.search(r"TypeError: .* \(test_trajectory.py, line \d+, in sample\)", trace.failure.reason)
    assert (trace.failure.time, len(trace.t)) == (0.0, 1)


def test_what_it_gave_cannot_be_changed_afterwards():
    path = Path(start=np.array([0.0, 1.0, 1.0]), motion=np.zeros((1001, 3, 3)), tracked=False)
    guarded = TRAJECTORIES.guard(path)
    motion = guarded.sample(np.zeros(1001))
    path.start[:], path.motion[:], path.duration = 7.0, 7.0, 7.0
    assert guarded.start.tolist() == [0.0, 1.0, 1.0]
    assert guarded.duration == 1.0
    assert not motion.any()


class Wave(Path):
    """A wave with a corner, whose samples a function may spoil."""

    def __init__(self, spoil=lambda times, motion: motion, **others):
        super().__init__(goal=[0.0, 1.0, 1.0], **others)
        self.spoil = spoil

    def sample(self, times):
        own, w = np.minimum(times, 0.8), 2.0 * np.pi / 0.8
        sine, cosine, moves = np.sin(w * own), np.cos(w * own), times < 0.8
        turns = np.stack([1.0 - cosine, w * sine * moves, w**2 * cosine * moves], axis=1)
        rises = np.stack([sine, w * cosine * moves, -(w**2) * sine * moves], axis=1)
        motion = np.stack([0.0 * rises, rises, turns], axis=2) * 0.1
        motion[:, 0] += self.start
        return self.spoil(times, motion)


def scaled(*factors):
    return lambda times, motion: motion * np.array(factors)[:, None]


PLACE = r"Wave: Wave\.sample \(test_trajectory\.py, line \d+\) gave a "


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda times, motion: motion + np.eye(3)[0][:, None] * 0.05, r"position at t = 0 that is 0\.0866 m from its"),
        (lambda times, motion: motion + np.eye(3)[0][:, None] * 2e-6, r"position at t = 0 that is 3\.46e-06 m from"),
        (lambda times, motion: motion + np.eye(3)[0][:, None] * (times > 0.5)[:, None, None] * 0.2, r"position that j"),
        (scaled(1.0, 2.0, 1.0), r"velocity that differs from the derivative of its position by 50 % \(median"),
        (scaled(1.0, 0.0, 1.0), r"velocity that differs from the derivative of its position by 100 %"),
        (scaled(1.0, 1.0, 2.0), r"acceleration that differs from the derivative of its velocity by 50 %"),
        (lambda times, motion: motion[..., [0, 2, 1]] * [[1], [-1], [1]], "velocity that differs"),
    ],
    ids=["elsewhere", "barely elsewhere", "jump", "velocity", "no velocity", "acceleration", "axes"],
)
def test_a_motion_that_contradicts_itself_is_refused(spoil, message):
    with pytest.raises(ConfigError, match=PLACE + message):
        TRAJECTORIES.guard(Wave(spoil))


@pytest.mark.parametrize(
    "trajectory",
    [
        Wave(),
        Wave(scaled(1.0, 1.0, 0.0)),  # without feed-forward
        Wave(scaled(1.0, 1.05, 1.2)),
        Wave(lambda times, motion: motion + np.eye(3)[0][:, None] * 5e-7),
        Wave(lambda times, motion: motion + np.eye(3)[0][:, None] * 0.05, tracked=False),  # only a goal
        Wave(lambda times, motion: motion + np.eye(3)[0][:, None] * (times > 0.5)[:, None, None], duration=0.0),
        Path(motion=None, duration=0.0),
    ],
)
def test_motions_of_usual_accuracy_pass(trajectory):
    assert TRAJECTORIES.guard(trajectory).start.tolist() == [0.0, 1.0, 1.0]


def test_a_motion_of_steps_passes():
    class Steps(Path):
        def sample(self, times):
            motion = super().sample(times)
            motion[:, 0, 0] += 0.1 * np.floor(5.0 * np.minimum(times, 1.0))
            return motion

    TRAJECTORIES.guard(Steps())


@dataclass
class Bend:
    """A joint motion of the user."""

    start: object = (0.0, 0.0)
    duration: float = 1.0
    samples: int = 100
    factors: tuple = (1.0, 1.0, 1.0)

    def sample(self, times):
        rows = np.stack([1.0 - np.cos(times), np.sin(times), np.cos(times)], axis=1) * np.array(self.factors)
        return np.stack([rows, rows], axis=2)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            {"start": (0.0, 0.1)},
            r"Bend\.sample \(.*line \d+\) gave a position at t = 0 that is 0\.1 rad from its start",
        ),
        ({"factors": (1.0, 2.0, 2.0)}, r"gave a velocity that differs .* by 50 %"),
        ({"factors": (1.0, np.nan, 1.0)}, r"Bend: Bend\.sample \(.*line \d+\) gave nan at index"),
    ],
)
def test_a_joint_motion_that_contradicts_itself_is_refused(wrong, message):
    assert guard_joint_motion(Bend(), (2,)).duration == 1.0
    with pytest.raises(ConfigError, match=message):
        guard_joint_motion(Bend(**wrong), (2,))
