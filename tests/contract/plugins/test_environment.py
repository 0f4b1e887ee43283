"""Guarded environments: wrenches that are none, and the failure's place."""

import re
from dataclasses import replace

import numpy as np
import pytest

from runner.environments import ENVIRONMENTS
from runner.environments.external_wrench import Interaction
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders, make_wrist_sensor


class Wind:
    """An environment of the user that goes wrong at t = 0.05 s."""

    def __init__(self, answer):
        self.answer = answer

    def reset(self, tip):
        pass

    def wrench(self, time, tip, velocity):
        return self.answer() if time >= 0.05 else np.zeros(6)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (lambda: 1 / 0, r"ZeroDivisionError: division by zero \(test_environment.py, line \d+, in <lambda>\)"),
        (
            lambda: np.zeros(3),
            r"Wind.wrench \(test_environment.py, line \d+\) gave an array of shape \(3,\); .* \(6,\)",
        ),
        (lambda: np.full(6, np.nan), r"Wind.wrench .* gave nan at index \[0\]; it must be finite"),
    ],
)
def test_an_environment_that_goes_wrong_is_a_failure_that_names_the_place(checked_config, closed_loop, answer, reason):
    config, loop = checked_config("robot=macro", "duration=0.2"), closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, interaction=Interaction(loop.robot, ENVIRONMENTS.guard(Wind(answer)), loop.tick))
    trace = simulate(
        loop,
        make_encoders(loop, config.noise, config.settings.seed, 0),
        make_wrist_sensor(loop, config.wrist_sensor, config.settings.seed, 0),
    )
    assert trace.failure.time == pytest.approx(0.05)
    assert re.search(reason, trace.failure.reason), trace.failure.reason


@pytest.mark.parametrize("method", ["reset", "wrench"])
def test_an_environment_that_changes_what_it_is_handed_is_a_failure(checked_config, closed_loop, method):
    wind = Wind(lambda: np.zeros(6))

    def write(*handed):
        handed[-1][:] = 1.0

    setattr(wind, method, write)
    config, loop = checked_config("robot=macro", "duration=0.2"), closed_loop("robot=macro", "duration=0.2")
    loop = replace(loop, interaction=Interaction(loop.robot, ENVIRONMENTS.guard(wind), loop.tick))
    trace = simulate(
        loop,
        make_encoders(loop, config.noise, config.settings.seed, 0),
        make_wrist_sensor(loop, config.wrist_sensor, config.settings.seed, 0),
    )
    assert trace.failure.time == 0.0
    assert re.search(r"read-only \(test_environment.py, line \d+, in write\)", trace.failure.reason)
