"""Times of a run: plant steps in a tick, ticks in a run, and delays, from the config."""

import math

import pytest

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose

ARM = ("robot=macro", "plant=rk4", "trajectory=goal", "controller.period=0.01")


def _timing(*overrides):
    return validate(compose([*ARM, *overrides])).timing


@pytest.mark.parametrize(("duration", "ticks"), [(0.01, 1), (0.1, 10), (0.101, 11), (0.1099999999, 11), (2.0, 200)])
def test_a_run_has_the_ticks_that_cover_its_duration(duration, ticks):
    timing = _timing(f"duration={duration}")
    assert timing.ticks == ticks == math.ceil(round(duration / timing.tick, 6))


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_a_tick_has_a_whole_number_of_plant_steps(steps):
    timing = _timing(f"plant.step={0.01 / steps!r}")
    assert timing.steps_per_tick == steps
    assert timing.steps_per_tick * timing.step == pytest.approx(timing.tick, rel=1e-12)


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("plant.step=0.003", r"controller.period: 0.01 s is not a multiple of plant.step, 0.003 s"),
        ("plant.step=1e-8", r"plant.step: 1e-08 s are 1e\+06 steps in controller.period"),
        ("duration=0.009", r"duration: 0.009 s is shorter than one controller period"),
    ],
)
def test_times_that_do_not_fit_are_told(override, problem):
    with pytest.raises(ConfigError, match=problem):
        _timing(override)


def test_the_fastest_loop_gives_the_tick():
    stages = ("robot=combined", "controller.period.macro=0.03", "controller.period.mini=0.01")
    assert _timing(*stages, "controller.period={macro:0.03,mini:0.01}").tick == 0.01
    with pytest.raises(ConfigError, match=r"controller.period.macro: 0.025 s is not a multiple of the fastest loop's"):
        _timing("robot=combined", "controller.period={macro:0.025,mini:0.01}")
