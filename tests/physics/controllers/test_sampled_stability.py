"""Bound of sampled velocity loops against the eigenvalues of the exact map of law and arm at home."""

import numpy as np
import pytest
from support.arms import checked

from runner.controllers.stability import velocity_loop
from tools.laws import ARM_LAWS, LAWS

H = 0.001
HOMES = {name: checked(f"robot={name}").arm.home.tolist() for name in ("macro", "xarm7")}


def configured(robot, law, w, *more):
    line = (f"robot={robot}", f"controller={law}", f"controller.period={H}", f"controller.natural_frequency={w}",
            f"controller.null_space_frequency={w}")  # fmt: skip
    fixed = ("controller.gravity_compensation=false", "gravity=0", "trajectory=goal")
    damped = () if law == "adaptive" else ("controller.damping_ratio=1",)
    return checked(*line, *fixed, *damped, *more)


def bound_of(config):
    return velocity_loop(config.loops, config.arm, config.path)


def radius(config):
    """Spectral radius of small motions about home, under the torques of the law, held for a period.

    States of the law, such as integrals and parameters, keep their initial values because they move slowly.
    """
    (loop,), model, home = config.loops, config.arm.model, config.arm.home
    law, n, small = loop.controller, model.nq, 1e-6
    at_rest = np.array([home, np.zeros(n), np.zeros(n)]) if loop.follows_joints else None
    tip = np.array([model.tip_position(home), np.zeros(3), np.zeros(3)])

    def torque(q, dq):
        law.reset()
        law.state = law.start(home)
        return law.torque(0.0, q, dq, tip if at_rest is None else at_rest).copy()

    rest = np.zeros(n)
    gain = np.array(
        [(torque(home + small * e, rest) - torque(home - small * e, rest)) / (2.0 * small) for e in np.eye(n)]
        + [(torque(home, small * e) - torque(home, -small * e)) / (2.0 * small) for e in np.eye(n)]
    ).T
    acceleration = np.linalg.solve(model.mass_matrix(home), gain)
    held = np.block([[np.eye(n), H * np.eye(n)], [np.zeros((n, n)), np.eye(n)]])
    return np.abs(np.linalg.eigvals(held + np.vstack([0.5 * H**2 * acceleration, H * acceleration]))).max()


@pytest.mark.parametrize("robot", ["macro", "xarm7"])
@pytest.mark.parametrize("law", ARM_LAWS)
def test_the_bound_is_that_of_the_exact_map(robot, law):
    stays = ("trajectory=joint_quintic", f"trajectory.goal_configuration={HOMES[robot]}")
    more = stays if LAWS[law].follows_joints else ()
    one = bound_of(configured(robot, law, 1.0, *more))
    limit = 1.0 / one.share
    below, above = (configured(robot, law, share * limit, *more) for share in (0.95, 1.05))
    assert bound_of(above).share == pytest.approx(1.05)
    assert radius(below) <= 1.0 + 1e-9
    assert radius(above) > 1.0 + 1e-3


def test_the_coupling_is_that_of_the_mass_matrix():
    """Of the Macro at home: M from the thesis' closed form is [[2, 0, 0], [0, 3, 1], [0, 1, 1]]."""
    found = bound_of(configured("macro", "joint_pd", 30.0))
    M = np.array([[2.0, 0.0, 0.0], [0.0, 3.0, 1.0], [0.0, 1.0, 1.0]])
    assert found.coupling == pytest.approx(np.linalg.eigvals(np.linalg.solve(M, np.diag(np.diag(M)))).real.max())


def test_each_stage_has_its_own_loop():
    config = checked("robot=combined")
    h_w = [loop.period * loop.controller.velocity_gain.mass / 2.0 for loop in config.loops]
    assert bound_of(config).share == pytest.approx(max(h_w))


def test_controllers_that_say_no_gain_have_no_bound():
    config = configured("macro", "joint_pd", 30.0)
    assert velocity_loop((), config.arm, config.path) is None


@pytest.mark.parametrize("inertia", ["home", "posture"])
def test_a_motion_of_the_joints_is_looked_at_on_its_way(inertia):
    config = configured("xarm7", "joint_pd", 30.0, "trajectory=joint_quintic", f"controller.inertia={inertia}")
    model, home = config.arm.model, config.arm.home
    largest = 0.0
    for q in (home, *config.path.sample_joints(np.linspace(0.0, config.path.duration, 9))[:, 0]):
        M = model.mass_matrix(q)
        D = (model.mass_matrix(home) if inertia == "home" else M).diagonal()
        largest = max(largest, np.linalg.eigvals(np.linalg.solve(M, np.diag(D))).real.max())
    at_home = bound_of(configured("xarm7", "joint_pd", 30.0, "trajectory=goal")).coupling
    assert bound_of(config).coupling == pytest.approx(largest)
    assert largest >= at_home
    assert inertia == "posture" or largest > 1.3 * at_home
