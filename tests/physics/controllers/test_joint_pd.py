"""PD control of each joint: its sag, what it needs of the model, its stability when sampled, and whole runs."""

import numpy as np
import pytest
from support.arms import checked

from runner.controllers.joint_space.joint_pd import JointPd, JointPdConfig

ARMS = {name: checked(f"robot={name}", "controller=joint_pd", "trajectory=goal").arm for name in ("macro", "xarm7")}


def law(name="macro", **changes):
    values = {
        "kind": "joint_pd",
        "task": "position",
        "natural_frequency": 30.0,
        "damping_ratio": 1.0,
        "period": 0.001,
        "gravity_compensation": True,
        "feedforward": True,
        "singularity_damping": 0.3,
        "null_space_frequency": 30.0,
        "inertia": "home",
    }
    return JointPd(ARMS[name].model, JointPdConfig(**(values | changes)), ARMS[name].home, joints=True)


@pytest.mark.parametrize("inertia", ["home", "posture"])
def test_torques_are_those_of_the_equation(inertia):
    model, home = ARMS["xarm7"].model, ARMS["xarm7"].home
    generator = np.random.default_rng(5)
    q, dq, reference = home + generator.normal(size=7), generator.normal(size=7), generator.normal(size=(3, 7))
    D = model.mass_matrix(home if inertia == "home" else q).diagonal()
    expected = D * (900.0 * (reference[0] - q) + 60.0 * (reference[1] - dq)) + model.gravity_torque(q)
    np.testing.assert_allclose(law("xarm7", inertia=inertia).torque(0.0, q, dq, reference), expected, rtol=1e-10)


def test_without_gravity_it_rests_at_the_sag_of_the_closed_form(simulated):
    trace = simulated("robot=macro", "controller=joint_pd", "controller.gravity_compensation=false", "plant=rk4",
                      "trajectory=joint_quintic", "duration=6")  # fmt: skip
    model, home = ARMS["macro"].model, ARMS["macro"].home
    config = checked("robot=macro", "controller=joint_pd", "trajectory=joint_quintic")
    w = config.loops[0].controller.parameters.own.k_p
    goal, rest = config.path.sample_joints(np.array([6.0]))[0, 0], trace.q[-1]
    sag = model.gravity_torque(rest) / (w * model.mass_matrix(home).diagonal())
    assert np.abs(sag).max() > 1e-3
    np.testing.assert_allclose(goal - rest, sag, atol=1e-6)


@pytest.mark.parametrize("name", ["macro", "xarm7"])
def test_the_sampled_loop_is_stable_up_to_the_limit(name):
    """At home, linear: the exact map of a double integrator whose torque is held for a period."""
    model, home = ARMS[name].model, ARMS[name].home
    M = model.mass_matrix(home)
    D = np.diag(M.diagonal())
    largest = np.linalg.eigvals(np.linalg.solve(M, D)).real.max()

    n = len(M)

    def torque(w, state):
        ours = law(name, natural_frequency=w, gravity_compensation=False)
        return ours.torque(0.0, home + state[:n], state[n:], np.array([home, np.zeros(n), np.zeros(n)]))

    def radius(w, h=0.001):
        gain = np.linalg.solve(M, np.array([torque(w, state) for state in np.eye(2 * n)]).T)
        held = np.block([[np.eye(n), h * np.eye(n)], [np.zeros((n, n)), np.eye(n)]])
        return np.abs(np.linalg.eigvals(held + np.vstack([0.5 * h**2 * gain, h * gain]))).max()

    limit = 1.0 / (0.001 * largest)
    assert radius(0.95 * limit) < 1.0 < radius(1.05 * limit)


@pytest.mark.parametrize("name", ["macro", "xarm7"])
def test_the_tip_reaches_a_goal(simulated, name):
    more = ("robot.armature=assumed",) if name == "xarm7" else ()
    trace = simulated(f"robot={name}", "controller=joint_pd", "controller.period=0.001",
                      "controller.natural_frequency=10", "trajectory=goal", "duration=3", *more)  # fmt: skip
    assert trace.failure is None
    np.testing.assert_allclose(trace.error[-1], 0.0, atol=1e-6)
