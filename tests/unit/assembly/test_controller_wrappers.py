"""Observer and notch around controllers: what they need of controllers, plants, sensors and periods."""

import pytest

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose

ARM = ("robot=macro", "trajectory=goal", "plant=rk4")
OBSERVER, NOTCH = "disturbance_observer=momentum", "notch=torques"


def _validate(*overrides):
    return validate(compose([*ARM, *overrides]))


@pytest.mark.parametrize("overrides", [(), (OBSERVER,), (NOTCH, "notch.frequency=10", "notch.width=2")])
def test_controllers_of_torques_may_have_them(overrides):
    assert _validate(*overrides).commands == "torque"


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        ((OBSERVER, "disturbance_observer.torque=measured"), "measured needs torque sensors in the joints"),
        (
            (OBSERVER, "robot=combined", "plant.dynamics=decoupled"),
            "disturbance_observer.bandwidth: its momenta are those of the whole arm",
        ),
        ((NOTCH, "notch.frequency=60", "controller.period=0.01"), "notch.frequency: .* has 60 Hz, of a loop of 0.01 s"),
        ((NOTCH, "notch.width=60", "controller.period=0.01"), "notch.width: 60 Hz, of a loop of 0.01 s"),
    ],
)
def test_what_they_lack_is_told(overrides, problem):
    with pytest.raises(ConfigError, match=problem):
        _validate(*overrides)
