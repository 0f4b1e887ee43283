"""Adaptive control of the joints: its equation, Lyapunov's function, what it learns, and how its gains are scaled."""

import numpy as np
import pytest
from support.arms import checked
from support.motions import to_and_fro

from runner.assembly.assemble import assemble
from runner.controllers.torque_law import PinocchioArm
from runner.plants.rk4 import Rk4

LINE = ("controller=adaptive", "controller.natural_frequency=30", "trajectory=joint_quintic", "plant=rk4")
UNIFORM = ("controller.scale=uniform", "controller.adaptation_gain=0.5", "controller.friction=false")


def closed_loop(*overrides):
    closed = assemble(checked(*LINE, *overrides))
    closed.close()
    return closed


def followed(closed, desired, h):
    """Errors of the joints and V at every tick, of a law on the true arm."""
    law, true = closed.loops[0].controller, closed.robot.model
    plant, numbers = Rk4(true, h, 1), law.parameters.own
    plant.reset(desired[0, 0], np.zeros(true.nq))
    law.reset()
    adapts = numbers.adaptation_gain > 0.0
    estimated, errors, energies = numbers.initial_parameters, [], []
    for tick, reference in enumerate(desired):
        e, s = reference[0] - plant.q, reference[1] - plant.dq + numbers.rate * (reference[0] - plant.q)
        wrong = np.concatenate([true.inertial_parameters, np.zeros(len(estimated) - 10 * true.nq)]) - estimated
        errors.append(e)
        energies.append(
            0.5 * (s @ true.mass_matrix(plant.q) @ s + (wrong**2)[adapts] @ (1.0 / numbers.adaptation_gain[adapts]))
        )
        plant.advance(law.torque(h * tick, plant.q, plant.dq, reference))
        estimated = law.state
    return np.linalg.norm(errors, axis=1), np.array(energies)


@pytest.mark.parametrize("name", ["macro", "xarm7"])
@pytest.mark.parametrize("friction", ["true", "false"])
def test_torques_and_parameters_are_those_of_the_equations(name, friction):
    closed = closed_loop(f"robot={name}", f"controller.friction={friction}")
    law, generator, n = closed.loops[0].controller, np.random.default_rng(5), closed.robot.model.nq
    arm, home, numbers = PinocchioArm(closed.robot.model), closed.robot.home, law.parameters.own
    D, theta = closed.robot.model.mass_matrix(home).diagonal(), numbers.initial_parameters.copy()
    for _ in range(3):
        q, dq = home + generator.normal(size=n), generator.normal(size=n)
        reference = np.array([q, dq, np.zeros(n)]) + generator.normal(size=(3, n))
        dq_r, ddq_r = reference[1] + 30.0 * (reference[0] - q), reference[2] + 30.0 * (reference[1] - dq)
        Y, s = arm.regressor(q, dq, dq_r, ddq_r), dq_r - dq
        if friction == "true":
            smooth = reference[1] / np.sqrt(reference[1] ** 2 + 1e-4)
            Y = np.hstack([Y, np.diag(dq_r), np.diag(smooth)])
        expected = Y @ theta + 30.0 * D * s
        torque = law.torque(0.0, q, dq, reference)
        np.testing.assert_allclose(torque, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
        s = s * (np.abs(expected) < closed.robot.model.effort_limits)
        needed = s @ (Y * numbers.adaptation_gain) @ Y.T @ s / (s @ (D * s))
        gains = numbers.adaptation_gain * 225.0 / max(225.0, needed)
        theta = theta + closed.loops[0].period * gains * (Y.T @ s)
        np.testing.assert_allclose(law.state, theta, rtol=1e-10, atol=1e-14)


@pytest.mark.parametrize(
    ("name", "swing", "more"),
    [
        ("macro", [0.8, -0.5, 0.6], ("controller.friction=false",)),
        ("macro", [0.8, -0.5, 0.6], UNIFORM),
        ("xarm7", [0.4, -0.3, 0.3, 0.4, -0.3, 0.3, 0.4], ("controller.friction=false", "robot.armature=assumed")),
    ],
)
def test_the_function_of_lyapunov_never_rises(name, swing, more):
    """Between ticks by less than a thousandth of its start, which is of the sampling."""
    h = 0.002 if name == "macro" else 0.001
    closed = closed_loop(f"robot={name}", "mismatch.mass=0.8", f"controller.period={h}", *more)
    errors, V = followed(closed, to_and_fro(swing, h, 6.0, closed.robot.home), h)
    assert np.diff(V).max() < 1e-3 * V[0]
    assert V[-1] < 0.8 * V[0]
    assert np.sqrt(np.mean(errors[-3000:] ** 2)) < 2e-3


def test_the_error_falls_from_period_to_period_as_a_prototype_s():
    h = 0.002
    closed = closed_loop("robot=macro", "mismatch.mass=0.8", f"controller.period={h}", *UNIFORM)
    errors, V = followed(closed, to_and_fro([0.8, -0.5, 0.6], h, 15.0, closed.robot.home), h)
    rms = 1e3 * np.sqrt(np.mean(errors[:-1].reshape(5, -1) ** 2, axis=1))
    assert rms == pytest.approx([0.784, 0.235, 0.194, 0.175, 0.161], rel=0.01)
    assert rms[4] < 0.25 * rms[0]
    assert V[0] == pytest.approx(0.320, rel=0.01)


@pytest.mark.parametrize("name", ["macro", "xarm7", "meca500"])
@pytest.mark.parametrize("friction", ["true", "false"])
def test_the_scale_by_parameter_bounds_the_frequencies_of_the_adaptation(name, friction):
    """The eigenvalues of D^-1/2 Y Gamma Y^T D^-1/2 for the motions that set the scale."""
    share = 0.49
    closed = closed_loop(f"robot={name}", f"controller.adaptation_gain={share}", f"controller.friction={friction}")
    gains, model, home = (
        closed.loops[0].controller.parameters.own.adaptation_gain,
        closed.robot.model,
        closed.robot.home,
    )
    n, root, arm = model.nq, np.sqrt(model.mass_matrix(home).diagonal()), PinocchioArm(model)
    reached = []
    for way in (*np.eye(n), np.ones(n)):
        Y = arm.regressor(home, way, way, 2.0 * way)
        if friction == "true":
            Y = np.hstack([Y, np.diag(way), np.diag(way / np.sqrt(way**2 + 1e-4))])
        scaled = Y / root[:, None]
        reached.append(np.linalg.eigvalsh(scaled * gains @ scaled.T)[-1])
    assert 0.05 * share * 900.0 < max(reached) <= share * 900.0


@pytest.mark.parametrize("more", [("robot=macro",), ("robot=macro", "torque_limits=thesis"),
                                  ("robot=xarm7", "robot.armature=assumed", "mismatch.mass=0.8")])  # fmt: skip
def test_a_goal_that_asks_too_much_at_first_is_reached(simulated, more):
    """Accelerations are a hundred times those that set the gains, or torques at their limits: it stays stable."""
    trace = simulated("controller=adaptive", "trajectory=goal", "plant=rk4", "mismatch.mass=0.9", *more)
    assert trace.failure is None
    assert np.abs(trace.error[-1]).max() < 1e-4


def test_columns_of_friction_take_friction_away(simulated):
    line = ("robot=macro", *LINE, "mismatch.mass=0.8", "plant.friction.viscous=0.2", "plant.friction.coulomb=0.5",
            "controller.period=0.002", "trajectory=joint_sinusoids", "trajectory.duration=14",
            "duration=14")  # fmt: skip
    path = checked(*line).path

    def error(on):
        trace = simulated(*line, f"controller.friction={on}")
        late = trace.t > 9.0
        return np.abs(trace.q[late] - path.sample_joints(trace.t[late])[:, 0]).max()

    assert error("true") < 0.25 * error("false")
