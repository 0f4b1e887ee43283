"""Computation delay of loops: delays in ticks, patterns of misses, and what takes none."""

from types import SimpleNamespace

import pytest

from runner.assembly.cross_checks import count_late
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.plants import options_of
from runner.plants.computation import EXACT

ARM = ("robot=macro", "trajectory=goal", "duration=0.1")


def _config(*overrides):
    return validate(compose([*ARM, *overrides]))


@pytest.mark.parametrize("delay", [0, 1, 7])
def test_commands_act_as_many_ticks_late_as_the_key_says(delay):
    config = _config("plant=rk4", f"plant.computation.delay={delay}")
    assert config.timing.late == count_late(config.plant, config.loops) == (delay,)
    assert config.timing.delay == delay


def test_a_plant_without_the_key_takes_commands_at_once():
    assert options_of(SimpleNamespace()).computation is EXACT
    assert EXACT.is_even


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        (("plant=rk4", "plant.computation.delay=10000001"), r"plant.computation.delay: 10000001 ticks found"),
        (
            ("plant=rk4", f"plant.computation.miss={[0] + [1] * 19}".replace(" ", "")),
            r"plant.computation.miss: a pattern of 20 ticks, and the loop macro has 11 in the run",
        ),
    ],
)
def test_what_does_not_fit_into_a_run_is_told(overrides, problem):
    with pytest.raises(ConfigError, match=problem):
        _config(*overrides)
