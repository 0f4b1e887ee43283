"""Three-joint control along the xArm7 report's line."""

import numpy as np
import pytest

THREE = ("robot=xarm7", "controller=three_joint")


def test_as_reported_it_is_one_sample_late_and_exactly_on_the_line(simulated):
    trace = simulated(*THREE, "preset=as_reported")
    np.testing.assert_allclose(trace.tip[1:], trace.desired[:-1, 0], atol=1e-12)
    np.testing.assert_allclose(trace.tip[:, [0, 2]], np.broadcast_to([0.643, 0.1508], (len(trace.t), 2)), atol=1e-12)


def test_only_its_three_joints_move(simulated):
    trace = simulated(*THREE)
    np.testing.assert_array_equal(np.ptp(trace.q[:, [2, 4, 5, 6]], axis=0), np.zeros(4))
    assert np.abs(trace.error).max() < 1e-6


@pytest.mark.parametrize(
    ("overrides", "text"),
    [
        (("trajectory.goal=[0.75,0.2,0.1508]",), "three joints cannot reach"),
        (("controller.elbow=minus",), "joint"),
        (("trajectory.duration=0.2",), "the shortest feasible time is"),
    ],
)
def test_what_the_arm_cannot_do_is_refused(cli, overrides, text):
    ending = cli(*THREE, *overrides)
    assert ending.code == 2
    assert text in ending.err


def test_another_arm_is_refused(cli):
    ending = cli("robot=macro", "controller=three_joint")
    assert ending.code == 2
    assert "three_joint solves the xArm7's chain" in ending.err
