"""Exact derivatives against differences of whole runs, and against what must hold of them."""

import numpy as np
import pytest

from runner.analysis import differences

OWN = ("gains", "masses", "armature", "lengths", "gravity", "limits", "noise", "friction", "payload")
MACRO = ("robot=macro", "plant=rk4", "trajectory=quintic", "noise=thesis", "duration=0.3")
TWO_RATES = (
    "robot=combined", "controller=macro_mini", "plant=rk4", "trajectory=quintic", "noise=thesis", "duration=0.1",
)  # fmt: skip
SEVEN = ("robot=xarm7", "controller=operational_space", "plant=rk4", "trajectory=quintic", "duration=0.1")
INTEGRAL = ("robot=macro", "controller=computed_torque", "controller.integral_gain=500", *MACRO[1:])
# Clipped torques, friction that holds, commands that act late, velocities that are differences, and a payload.
HARD = (
    "robot=macro", "plant=rk4", "trajectory=goal", "torque_limits=thesis", "duration=0.2", "noise=thesis",
    "robot.armature=[0.5,0.3,0]",
    "plant.friction.viscous=0.2", "plant.friction.coulomb=0.1", "plant.computation.delay=1", "noise.bias=1e-4",
    "noise.velocity=finite_difference", "robot.payload.mass=0.5",
)  # fmt: skip

# The signal that an adaptive law learns from is 0 at the first tick.
HELD = ("robot=macro", "controller=adaptive", *MACRO[1:3], "plant.friction.coulomb=0.1", "duration=0.1")


# The cost is that of the parameters: all groups on only the Macro in a short run, on the other arms in slow tests.
SMALL = [
    (MACRO, OWN), (HARD, OWN), (INTEGRAL, ("gains", "masses")), (TWO_RATES, ("lengths",)), (SEVEN, ("masses",)),
    (HELD, ("lengths",)),
]  # fmt: skip
LARGE = [pytest.param(overrides, OWN, marks=pytest.mark.slow) for overrides in (TWO_RATES, SEVEN, INTEGRAL)]


@pytest.mark.costs(3)
@pytest.mark.parametrize(("overrides", "groups"), [*SMALL, *LARGE])
def test_derivatives_agree_with_central_differences_to_1e_6(analysed, overrides, groups):
    found = analysed(*overrides, groups=groups)
    sure = 0
    for name, by in differences(found, list(found.metrics)).items():
        gaps = np.abs(by.derivatives - found.derivatives[name])
        size = np.abs(found.derivatives[name])
        judged = by.doubts <= 1e-7 * size
        sure += int((judged | ((size == 0.0) & (gaps == 0.0))).sum())
        assert np.all(gaps[judged] <= 1e-6 * size[judged]), name
        assert np.all(gaps <= 1e-6 * size + 10.0 * by.doubts), name
    assert sure >= 0.3 * len(found.metrics) * len(found.parameters)


@pytest.mark.parametrize("late", [1, 3])
def test_derivatives_of_torques_are_those_of_the_ticks_at_which_they_act(analysed, late):
    """Nothing clips, so that each torque of the 15 ticks counts; the first one acts until the second does."""
    found = analysed(
        *("robot=macro", "plant=rk4", f"plant.computation.delay={late}", "controller.natural_frequency=10"),
        *("trajectory=quintic", "trajectory.duration=0.15", "duration=0.15"),
        groups=("gains",),
    )
    names = ["peak_torque", "rms_torque", "torque_chatter", "control_effort", "energy"]
    for name, by in differences(found, names).items():
        assert found.derivatives[name] == pytest.approx(by.derivatives, rel=1e-6), name


@pytest.mark.costs(5)
def test_an_arm_that_is_heavier_in_all_links_moves_alike_with_larger_torques(analysed):
    """Law and plant are both proportional to the masses where nothing clips, so that the arm takes the same way."""
    for overrides, groups in ((MACRO, OWN), (SEVEN, ("masses",))):
        found = analysed(*overrides, groups=groups)
        masses = [place for place, parameter in enumerate(found.parameters) if parameter.group == "masses"]
        expected = {"rms_tracking_error": 0.0, "peak_joint_speed": 0.0, "peak_torque": 1.0, "energy": 1.0}
        for name, sum_ in (expected | {"control_effort": 2.0}).items():
            elasticities = found.elasticities(name)[masses]
            assert elasticities.sum() == pytest.approx(sum_, abs=1e-9 * max(1.0, np.abs(elasticities).max())), name
            assert np.abs(elasticities).max() > 1e-6  # each matters by itself


def test_the_sample_s_share_of_the_noise(analysed):
    """At rest the error follows only from noise: it, and each metric of it, is proportional to the amplitude."""
    found = analysed(
        "robot=macro", "plant=rk4", "trajectory=quintic", "noise=thesis", "noise.position=1e-4",
        groups=("noise",),
    )  # fmt: skip
    assert found.elasticities("steady_state_error")[0] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.costs(3)
def test_a_clipped_peak_is_the_limit(analysed):
    found = analysed(*HARD, groups=OWN)
    at = {parameter.name: place for place, parameter in enumerate(found.parameters)}
    derivatives = found.derivatives["peak_torque"]
    assert derivatives[at["torque_limits.max"]] == 1.0
    assert not np.delete(derivatives, at["torque_limits.max"]).any()


def test_ranks_begin_with_what_matters_most(analysed):
    found = analysed(*MACRO, groups=OWN)
    sizes = np.abs(found.elasticities("peak_torque"))[found.ranked("peak_torque")]
    assert np.all(np.diff(sizes) <= 0.0)
