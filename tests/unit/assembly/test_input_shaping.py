"""Config of the input shaper: frequencies and names of modes, damping, and motions that cannot be shaped."""

import pytest
from pydantic import ValidationError

from runner.assembly.input_shaping import find_modes
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.input_shaper import InputShaperConfig
from runner.robots.vibration import Mode

MODES = [Mode(2.0, 0.01), Mode(5.0, 0.02)]


def _shaper(frequency, damping_ratio=None):
    return InputShaperConfig(kind="zv", frequency=frequency, damping_ratio=damping_ratio)


@pytest.mark.parametrize(
    ("frequency", "found"),
    [
        (3.0, [Mode(3.0, 0.0)]),
        ("mode_2", [MODES[1]]),
        (["mode_1", 7.5, "mode_2"], [MODES[0], Mode(7.5, 0.0), MODES[1]]),
    ],
)
def test_modes_are_found_by_frequency_or_name(frequency, found):
    assert find_modes(_shaper(frequency), MODES) == found


def test_a_damping_ratio_that_is_given_counts_for_all():
    assert find_modes(_shaper(["mode_1", 7.5], 0.3), MODES) == [Mode(2.0, 0.3), Mode(7.5, 0.3)]


@pytest.mark.parametrize("frequency", [0.0, -1.0, "mode_0", "first", True, [], [1.0] * 5])
def test_other_frequencies_are_refused(frequency):
    with pytest.raises(ValidationError, match="must be a number above 0, the name of a mode"):
        _shaper(frequency)


@pytest.mark.parametrize(
    ("modes", "problem"), [([], "this one is rigid"), (MODES, r"the plant has mode_1 \(2 Hz\), mode_2 \(5 Hz\)")]
)
def test_a_mode_that_the_plant_lacks_is_told(modes, problem):
    with pytest.raises(ConfigError, match=f"input_shaper.frequency: mode_3 .*{problem}"):
        find_modes(_shaper("mode_3"), modes)


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("trajectory=circle trajectory.easing=none", "input_shaper: the trajectory never ends"),
        ("trajectory=quintic", r"input_shaper.frequency: 1000 Hz found; a loop of 0.01 s sees motions below 50 Hz"),
    ],
)
def test_motions_that_cannot_be_shaped_are_told(override, problem):
    shaper = ("input_shaper=zv", "input_shaper.frequency=1000")
    with pytest.raises(ConfigError, match=problem):
        validate(compose(["robot=macro", "plant=rk4", "controller.period=0.01", *override.split(), *shaper]))
