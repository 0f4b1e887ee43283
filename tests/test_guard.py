"""Parts of the user's that go wrong: told with their place, and nothing else lost."""

import re
from dataclasses import dataclass, replace
from types import ModuleType

import numpy as np
import pytest

from runner.assembly import assemble, make_encoders, make_wrist_sensor, metric_context
from runner.controllers import Loop
from runner.errors import ConfigError
from runner.guard import WatchedPlant, check_trajectory, reset, watch
from runner.interaction import Interaction
from runner.metrics import evaluate, summary
from runner.simulation import simulate


class Law:
    """A law of the user's that goes wrong at t = 0.05 s."""

    def __init__(self, answer):
        self.answer = answer

    def reset(self):
        pass

    def torque(self, time, q, dq, reference):
        return self.answer() if time >= 0.05 else np.zeros(3)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (lambda: 1 / 0, r"ZeroDivisionError: division by zero \(test_guard.py, line \d+, in <lambda>\)"),
        (lambda: np.zeros(3) @ np.zeros(4), r"ValueError: matmul.* \(test_guard.py, line \d+, in <lambda>\)"),
        (lambda: np.zeros(2), r"Law.torque \(test_guard.py, line \d+\) gave an array of shape \(2,\); .* shape \(3,\)"),
        (lambda: 0.0, r"Law.torque .* gave 0.0; it must be an array of shape \(3,\)"),
        (lambda: np.zeros((3, 1)), r"gave an array of shape \(3, 1\)"),
        (lambda: [0.0, np.nan, 0.0], r"Law.torque \(test_guard.py, line \d+\) gave nan at index \[1\]; .* finite"),
        (lambda: np.array([0.0, 0.0, np.inf]), r"gave inf at index \[2\]"),
        (lambda: None, r"Law.torque .* gave None; it must be"),
        (lambda: "no torque", r"gave 'no torque'; it must be an array of shape \(3,\)"),
    ],
)
def test_a_law_that_goes_wrong_is_a_failure_that_names_the_place(checked_config, closed_loop, answer, reason):
    loop = closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, loops=(Loop("macro", slice(0, 3), 0.01, Law(answer)),))
    trace = simulate(loop, make_encoders(checked_config("robot=macro", "duration=0.2"), loop, 0))
    assert trace.failure is not None
    assert trace.failure.time == pytest.approx(0.05)
    assert len(trace.t) == 6
    assert re.search(reason, trace.failure.reason), trace.failure.reason


class Wind:
    """An environment of the user's that goes wrong at t = 0.05 s."""

    def __init__(self, answer):
        self.answer = answer

    def reset(self, tip):
        pass

    def wrench(self, time, tip, velocity):
        return self.answer() if time >= 0.05 else np.zeros(6)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (lambda: 1 / 0, r"ZeroDivisionError: division by zero \(test_guard.py, line \d+, in <lambda>\)"),
        (
            lambda: np.zeros(3),
            r"Wind.wrench \(test_guard.py, line \d+\) gave an array of shape \(3,\); .* \(6,\)",
        ),
        (lambda: np.full(6, np.nan), r"Wind.wrench .* gave nan at index \[0\]; it must be finite"),
    ],
)
def test_an_environment_that_goes_wrong_is_one_too(checked_config, closed_loop, answer, reason):
    config, loop = checked_config("robot=macro", "duration=0.2"), closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, interaction=Interaction(loop.robot, Wind(answer), loop.tick))
    trace = simulate(loop, make_encoders(config, loop, 0), make_wrist_sensor(config, loop, 0))
    assert trace.failure.time == pytest.approx(0.05)
    assert re.search(reason, trace.failure.reason), trace.failure.reason


class Plant:
    """A plant of the user's that stands still and breaks in its third tick."""

    def __init__(self):
        self.q, self.dq, self.ticks = np.array([0.1, 0.2, 0.3]), np.zeros(3), 0

    def reset(self, q, dq):
        self.ticks = 0

    def advance(self, tau):
        self.ticks += 1
        if self.ticks == 3:
            raise RuntimeError("a gear broke")

    def close(self):
        pass


def test_a_plant_that_raises_is_a_failure_that_names_the_place(checked_config, closed_loop):
    loop = replace(closed_loop("robot=macro", "duration=0.2"), plant=WatchedPlant(Plant()))
    trace = simulate(loop, make_encoders(checked_config("robot=macro", "duration=0.2"), loop, 0))
    assert re.fullmatch(r"RuntimeError: a gear broke \(test_guard.py, line \d+, in advance\)", trace.failure.reason)
    assert trace.failure.time == pytest.approx(0.02)
    assert trace.q.tolist() == [[0.1, 0.2, 0.3]] * 3


def test_a_watched_plant_has_what_the_plant_has_and_no_more():
    plant = WatchedPlant(Plant())
    assert plant.ticks == 0
    assert not hasattr(plant, "add_wall")


def test_a_reset_that_raises_is_told_with_its_place():
    law = Law(None)
    law.reset = lambda: {}["memory"]
    with pytest.raises(ConfigError, match=r"controller: KeyError: 'memory' \(test_guard.py, line \d+, in <lambda>\)"):
        reset(law)


def test_limits_do_not_reach_into_the_users_own_array():
    own = np.array([1.0, 2.0, 3.0])
    law = Law(lambda: own)
    answer = watch(law, law.torque, 3)(1.0, None, None, None)
    answer[:] = 0.0
    assert own.tolist() == [1.0, 2.0, 3.0]


def test_our_own_laws_are_not_watched(checked_config):
    controller = assemble(checked_config("robot=macro", "plant=rk4")).loops[0].controller
    assert watch(controller, controller.torque, 3) == controller.torque


@dataclass
class Path:
    """A trajectory of the user's that rests at a point."""

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
            r"Path.sample \(test_guard.py, line \d+\) gave an array of shape \(1001, 3\)",
        ),
        ({"motion": np.full((1001, 3, 3), np.nan)}, r"Path.sample .* gave nan at index \[0, 0, 0\]"),
        ({"motion": 1}, r"ZeroDivisionError: division by zero \(test_guard.py, line \d+, in sample\)"),
        ({"distance": np.zeros(3)}, r"Path.distance_to_path .* gave an array of shape \(3,\); .* shape \(1001,\)"),
    ],
)
def test_a_trajectory_that_goes_wrong_is_refused_before_the_run(wrong, message):
    with pytest.raises(ConfigError, match=message):
        check_trajectory(Path(**wrong))


def test_a_trajectory_that_is_right_passes():
    check_trajectory(Path())


@pytest.mark.parametrize(
    ("give", "value", "notice"),
    [
        (lambda: {"own": 2.0}, 2.0, None),
        (lambda: {"own": np.float64(2.0)}, 2.0, None),
        (lambda: {"own": None}, None, None),
        (lambda: {"own": float("nan")}, None, r"metric own: .*evaluate_own .* gave nan; it must be finite"),
        (lambda: {"own": np.zeros(2)}, None, r"metric own: .* gave an array of shape \(2,\); it must be a number"),
        (lambda: {"own": 1 / 0}, None, r"metrics of mine: ZeroDivisionError: .* \(test_guard.py, line \d+"),
        (lambda: {"own": 2.0, "other": 1.0}, 2.0, r"metric other: mine.UNITS names no unit for it; it is left out"),
        (lambda: 3, None, r"metrics of mine: TypeError"),
    ],
)
def test_a_metric_that_goes_wrong_has_no_value_and_the_others_stay(
    checked_config, closed_loop, monkeypatch, give, value, notice
):
    family = ModuleType("mine")
    family.UNITS = {"own": "m"}

    def evaluate_own(trace, context):
        return give()

    family.evaluate = evaluate_own
    monkeypatch.setattr(summary, "families", lambda: (*summary._FAMILIES, family))
    config = checked_config("robot=macro", "duration=0.1")
    loop = closed_loop("robot=macro", "duration=0.1")
    notices = []
    values = evaluate(simulate(loop, make_encoders(config, loop, 0)), metric_context(config, loop), notices)
    assert values["own"] == value
    assert "peak_torque" in values
    assert "other" not in values
    assert len(notices) == (notice is not None)
    if notice is not None:
        assert re.search(notice, notices[0]), notices[0]
