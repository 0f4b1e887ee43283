"""Guarded controllers: laws that raise, return or change what they must not, and the failure's place."""

import re
from dataclasses import replace

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError, SimulationError
from runner.controllers import CONTROLLERS, Loop, guard_law
from runner.plugins.guard import Guarded
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders


class Law:
    """A law of the user that goes wrong at t = 0.05 s."""

    def __init__(self, answer):
        self.answer = answer

    def reset(self):
        pass

    def torque(self, time, q, dq, reference):
        return self.answer() if time >= 0.05 else np.zeros(3)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (lambda: 1 / 0, r"ZeroDivisionError: division by zero \(test_controller.py, line \d+, in <lambda>\)"),
        (lambda: np.zeros(3) @ np.zeros(4), r"ValueError: matmul.* \(test_controller.py, line \d+, in <lambda>\)"),
        (
            lambda: np.zeros(2),
            r"Law.torque \(test_controller.py, line \d+\) gave an array of shape \(2,\); .*\(3,\)",
        ),
        (lambda: 0.0, r"Law.torque .* gave 0.0; it must be an array of shape \(3,\)"),
        (lambda: np.zeros((3, 1)), r"gave an array of shape \(3, 1\)"),
        (lambda: [0.0, np.nan, 0.0], r"Law.torque \(test_controller.py, line \d+\) gave nan at index \[1\]; .* finite"),
        (lambda: np.array([0.0, 0.0, np.inf]), r"gave inf at index \[2\]"),
        (lambda: None, r"Law.torque .* gave None; it must be"),
        (lambda: "no torque", r"gave 'no torque'; it must be an array of shape \(3,\)"),
    ],
)
def test_a_law_that_goes_wrong_is_a_failure_that_names_the_place(checked_config, closed_loop, answer, reason):
    loop = closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, loops=(Loop("macro", slice(0, 3), 0.01, guard_law(Law(answer), 3)),), compiled=None)
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert trace.failure is not None
    assert trace.failure.time == pytest.approx(0.05)
    assert len(trace.t) == 6
    assert re.search(reason, trace.failure.reason), trace.failure.reason


def test_a_law_that_changes_what_it_is_handed_is_a_failure(checked_config, closed_loop):
    class Writes(Law):
        def torque(self, time, q, dq, reference):
            reference[0] -= 1.0

    loop = closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, loops=(Loop("macro", slice(0, 3), 0.01, guard_law(Writes(None), 3)),), compiled=None)
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert re.fullmatch(
        r"ValueError: .*read-only \(test_controller.py, line \d+, in torque\); a plug-in cannot change what "
        "it is given: work on a copy",
        trace.failure.reason,
    )


def test_a_reset_that_raises_is_a_failure_at_the_start(checked_config, closed_loop):
    law = Law(None)
    law.reset = lambda: {}["memory"]
    loop = closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, loops=(Loop("macro", slice(0, 3), 0.01, guard_law(law, 3)),), compiled=None)
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert re.fullmatch(r"KeyError: 'memory' \(test_controller.py, line \d+, in <lambda>\)", trace.failure.reason)
    assert trace.failure.time == 0.0
    assert trace.q.tolist() == [loop.q_start.tolist()]


def test_limits_do_not_reach_into_the_users_own_array():
    own = np.array([1.0, 2.0, 3.0])
    answer = guard_law(Law(lambda: own), 3).torque(1.0, own, own, own)
    answer[:] = 0.0
    assert own.tolist() == [1.0, 2.0, 3.0]


class UsesWrench(Law):
    external_wrench = np.zeros(6)

    def update_wrench(self, reading):
        reading[0] = 0.0

    def messages(self):
        return 1 / 0


def test_a_law_that_uses_the_wrench_is_guarded():
    law = guard_law(UsesWrench(None), 3)
    with pytest.raises(SimulationError, match=r"read-only \(test_controller.py, line \d+, in update_wrench\)"):
        law.update_wrench(np.ones(6))
    (message,) = law.messages()
    assert re.fullmatch(r"ZeroDivisionError: division by zero \(test_controller.py, line \d+, in messages\)", message)
    law.part.external_wrench = np.zeros(3)
    with pytest.raises(SimulationError, match=r"UsesWrench.update_wrench .* gave an array of shape \(3,\)"):
        _ = law.external_wrench


def test_our_own_laws_are_not_guarded(checked_config):
    controller = assemble(checked_config("robot=macro", "plant=rk4")).loops[0].controller
    assert not isinstance(controller, Guarded)


@pytest.mark.parametrize(
    ("loops", "problem"),
    [
        (None, "build gave None; it must give a tuple of Loop"),
        ((), r"build gave \(\); it must give a tuple of Loop"),
        (["law"], r"build gave \['law'\]"),
        ([Loop("macro", slice(0, 2), 0.01, Law(None))], r"command the joints \[0, 1\]; .* each of the 3 once"),
        ([Loop("macro", slice(0, 3), 0.01, Law(None))] * 2, r"command the joints \[0, 0, 1, 1, 2, 2\]"),
    ],
)
def test_loops_that_are_none_are_refused(checked_config, loops, problem):
    with pytest.raises(ConfigError, match=problem):
        CONTROLLERS.guard(loops, None, checked_config("robot=macro").arm)
