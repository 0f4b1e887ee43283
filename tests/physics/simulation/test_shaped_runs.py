"""Input shapers on a flexible arm, from the config to the residual vibration."""

import numpy as np
import pytest
from support.arms import checked

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.plants import PLANTS
from runner.robots.vibration import Mode
from runner.store import simulated_part
from runner.trajectories.shaped import zero_vibration

FLEXIBLE = ("robot=macro", "plant=rk4_flexible", "noise=none", "torque_limits=none")
# Motors so heavy that their law leads them as if nothing pulled at them; only joint 1 turns, and rings on its own.
LED = (
    *FLEXIBLE, "controller=computed_torque", "controller.period=0.001", "plant.flexible_joints.motor_inertia=1e5",
    "trajectory=joint_quintic", "trajectory.goal_configuration=[0.05,0,0]", "trajectory.duration=0.2",
)  # fmt: skip
PATH = ("trajectory=quintic", "plant.step=0.005", "input_shaper=zv")
F0 = np.sqrt(1000.0 / 2.0) / (2.0 * np.pi)  # Hz, K 1000 N m/rad on 2 kg m^2


def ringing(trace, end, zeta):
    """Return the amplitude at an end of joint 1's vibration after it, in rad."""
    return Mode(F0, zeta).amplitude(trace.t, trace.q[:, 0], end)


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_the_residual_vibration_is_the_closed_form_whatever_the_frequency_error(simulated, zeta):
    arm = (*LED, f"plant.flexible_joints.damping_ratio={zeta}", "duration=1.2")
    alone = ringing(simulated(*arm), 0.2, zeta)
    for kind, ratio in [("zv", 0.7), ("zv", 0.9), ("zv", 1.1), ("zv", 1.3), ("zvd", 0.7), ("zvd", 0.9), ("zvd", 1.3)]:
        impulses = zero_vibration(kind, F0 * ratio, zeta)
        keys = (f"input_shaper.frequency={F0 * ratio}", f"input_shaper.damping_ratio={zeta}")
        left = ringing(simulated(*arm, f"input_shaper={kind}", *keys), 0.2 + impulses.delay, zeta) / alone
        assert left == pytest.approx(impulses.residual(F0, zeta), rel=0.02), (kind, ratio)


@pytest.mark.parametrize("kind", ["zv", "zvd"])
def test_the_mode_that_is_named_rests(simulated, kind):
    """At home only joint 1 rings, between two modes of the other joints."""
    arm = (*LED, "plant.flexible_joints.damping_ratio=0.02", "duration=1")
    left = simulated(*arm, f"input_shaper={kind}", "input_shaper.frequency=mode_2")
    end = 0.2 + zero_vibration(kind, F0, 0.02).delay
    assert ringing(left, end, 0.02) / ringing(simulated(*arm), 0.2, 0.02) < 1e-3


def test_on_a_move_of_the_whole_arm_a_shaper_for_each_mode_beats_a_slower_move(simulated):
    """Peak vibration after the move, in mm."""

    def rings(duration, *shaper):
        arm = (*FLEXIBLE, "plant.step=0.0025", "trajectory=quintic", "trajectory.goal=[0.4,0.7,0.6]", "duration=4")
        trace = simulated(*arm, f"trajectory.duration={duration}", *shaper)
        moving = np.flatnonzero(np.abs(trace.desired[:, 1]).max(axis=1) > 1e-9)[-1]
        away = trace.error[moving + 1 :] - trace.error[trace.t > 3.7].mean(axis=0)
        return 1e3 * np.linalg.norm(away, axis=1).max()

    modes = ("input_shaper=zv", "input_shaper.frequency=[mode_1,mode_2,mode_3]")
    found = [rings(0.5), rings(0.5, "input_shaper=zv"), rings(0.5, "input_shaper=zvd"), rings(0.5, *modes)]
    assert found == pytest.approx([21.6, 6.5, 3.4, 1.0], rel=0.05)
    assert [rings(0.68), rings(0.87), rings(0.9)] == pytest.approx([7.8, 4.6, 4.0], rel=0.05)


def test_modes_are_those_of_the_posture_where_the_arm_starts():
    def delay(*keys):
        config = checked(*FLEXIBLE, *PATH, *keys)
        assert config.timing.ticks == np.ceil((config.path.duration + 1.0) / 0.01)
        return config.path.duration - 3.0

    assert delay() == pytest.approx(0.5 / 2.724, rel=1e-3)
    assert delay("input_shaper.damping_ratio=0.6") == pytest.approx(0.5 / (2.724 * 0.8), rel=1e-3)
    assert delay("robot.home=[0,1.1,1.1]") != pytest.approx(delay(), rel=0.05)
    assert delay("input_shaper.frequency=[2.5,5.0]") == pytest.approx(0.2 + 0.1)


def test_the_macro_with_its_mini_rings_slower():
    soft = ("stiffness={macro: 1000, mini: null}", "motor_inertia={macro: 2, mini: null}")
    keys = ("robot=combined", "plant=rk4_flexible", *(f"plant.flexible_joints.{key}" for key in soft))
    config = validate(compose([*keys, "trajectory=quintic", "trajectory.goal=[0.4,0.8,0.7]", "input_shaper=zv"]))
    frequencies = [mode.frequency for mode in PLANTS.modes(config.plant, config.arm, config.arm.home)]
    assert frequencies == pytest.approx([2.511, 3.361, 6.149], abs=5e-4)
    assert config.path.duration - 3.0 == pytest.approx(0.5 / 2.511, rel=1e-3)


def test_it_shapes_on_any_plant_with_a_frequency_in_hertz(simulated):
    trace = simulated("robot=macro", "trajectory=goal", "input_shaper=zv", "input_shaper.frequency=2.5", "duration=0.3")
    assert np.abs(np.diff(trace.desired[:, 0], axis=0)).max(axis=1).nonzero()[0].tolist() == [19]


def test_the_names_of_runs_without_a_shaper_know_nothing_of_it():
    assert "input_shaper" not in simulated_part(compose(["robot=macro"]).resolved)
    assert compose(["robot=macro", "input_shaper=none"]).resolved == compose(["robot=macro"]).resolved
    assert simulated_part(compose(["robot=macro", "input_shaper=zv"]).resolved)["input_shaper"]["kind"] == "zv"


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (("plant=rk4",), "mode_1 is a mode of a flexible plant, and this one is rigid; take plant=rk4_flexible, or Hz"),
        (
            ("input_shaper.frequency=mode_4",),
            "mode_4 found; the plant has mode_1 (2.724 Hz), mode_2 (3.559 Hz), mode_3",
        ),
        (("input_shaper.frequency=50",), "50 Hz found; a loop of 0.01 s sees motions below 50 Hz"),
        (("input_shaper.frequency=0",), "must be a number above 0, the name of a mode such as mode_1"),
        (("input_shaper.frequency=mode1",), "found 'mode1'"),
        (("input_shaper.frequency=[1,2,3,4,5]",), "a list of up to 4"),
        (("input_shaper.frequency=[]",), "found []"),
        (("input_shaper.damping_ratio=1",), "input_shaper.damping_ratio: must be below 1"),
        (("input_shaper.kind=zvdd",), "did you mean zvd?"),
        (("trajectory=circle", "trajectory.easing=none"), "input_shaper: the trajectory never ends"),
    ],
)
def test_what_does_not_fit_is_refused(overrides, expected):
    with pytest.raises(ConfigError) as caught:
        checked(*FLEXIBLE, *PATH, *overrides)
    assert expected in str(caught.value)
