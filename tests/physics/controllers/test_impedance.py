"""A tip that yields as its own mass on a spring and a damper."""

import numpy as np
import pytest

POSTURE = "[0.3,0.4,-0.5]"
ARMS = {
    "macro": ("robot=macro", f"robot.home={POSTURE}"),
    "combined": ("robot=combined", f"robot.stages.macro.home={POSTURE}", f"robot.stages.mini.home={POSTURE}"),
}
LAW = ("controller=impedance", "plant=rk4", "environment=push", "environment.start_time=0")


def pushed(checked_config, simulated, arm, *overrides):
    """Return the displacement of a resting arm's tip under a push, shape (T, 3), and the trace."""
    robot = checked_config(*ARMS[arm]).arm
    goal = robot.model.tip_position(robot.home).tolist()
    trace = simulated(*ARMS[arm], *LAW, f"trajectory.goal={goal}", *overrides)
    return trace.end_points[-1] - trace.end_points[-1, 0], trace


def test_it_gives_way_by_the_force_over_the_stiffness(checked_config, simulated):
    moved, _ = pushed(
        checked_config,
        simulated,
        "macro",
        "environment.force=[0.3,-0.2,0.4]",
        "controller.tip_stiffness=[100,200,400]",
        "controller.tip_damping=[30,30,30]",
        "duration=4",
    )
    np.testing.assert_allclose(moved[-1], [0.003, -0.001, 0.001], rtol=1e-6)


def test_on_the_way_it_has_the_mass_of_the_tip(checked_config, simulated):
    r"""Small motions follow Lambda x'' + D x' + K x = f, here against its matrix exponential."""
    from scipy.linalg import expm

    K, D, f = np.diag([100.0, 200.0, 400.0]), 10.0 * np.eye(3), np.array([0.03, -0.02, 0.04])
    moved, trace = pushed(
        checked_config,
        simulated,
        "macro",
        f"environment.force={f.tolist()}",
        f"controller.tip_stiffness={np.diag(K).tolist()}",
        f"controller.tip_damping={np.diag(D).tolist()}",
        "controller.period=2e-4",
        "duration=0.5",
    )
    model, q = checked_config(*ARMS["macro"]).arm.model, trace.q[0]
    J = model.tip_jacobian(q)[:3]
    mobility = J @ np.linalg.solve(model.mass_matrix(q), J.T)
    slope = np.block([[np.zeros((3, 3)), np.eye(3)], [-mobility @ K, -mobility @ D]])
    rest = np.concatenate([np.linalg.solve(K, f), np.zeros(3)])
    expected = [(rest - expm(slope * t) @ rest)[:3] for t in trace.t]
    np.testing.assert_allclose(moved, expected, atol=0.01 * np.abs(expected).max())


@pytest.mark.parametrize("acts", ["last_stage", "whole"])
def test_a_mini_on_a_macro_gives_way_alone_or_with_it(checked_config, simulated, acts):
    moved, trace = pushed(
        checked_config,
        simulated,
        "combined",
        "environment.force=[0.3,-0.2,0.4]",
        "controller.tip_stiffness=[100,200,400]",
        "controller.tip_damping=[10,10,10]",
        f"controller.actuated_stages={acts}",
        "duration=3",
    )
    assert trace.failure is None
    np.testing.assert_allclose(moved[-1], [0.003, -0.001, 0.001], rtol=2e-3)


def test_a_negative_stiffness_is_refused(cli):
    ending = cli("robot=macro", "controller=impedance", "controller.tip_stiffness=[1,-1,1]")
    assert ending.code == 2
    assert "controller.tip_stiffness" in ending.err
