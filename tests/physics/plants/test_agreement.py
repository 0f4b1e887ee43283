"""Agreement of engines: MuJoCo, PyBullet and Runge-Kutta on smooth closed loops."""

import functools

import numpy as np
import pytest
from support import strangers

from runner.assembly.assemble import assemble
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders

CLOSED = {
    "macro": ("trajectory.goal=[0.3,0.9,1.2]", "trajectory.duration=1", "plant.step=0.001"),
    "combined": ("trajectory.goal=[0.05,0.95,1.05]", "trajectory.duration=0.5", "plant.step=0.00025"),
    "xarm7": ("controller=operational_space", "trajectory.duration=1", "plant.step=0.001"),
    "meca500": ("controller=operational_space", "trajectory.duration=0.5", "plant.step=0.001"),
    "kuka": ("trajectory.duration=1", "plant.step=0.001"),
}
"""Smooth motions without noise and saturation."""


@pytest.fixture(scope="module")
def followed(checked_config):
    """Simulate one of CLOSED on a plant, once; return its trace."""

    @functools.cache
    def simulate_on(robot, *plant):
        overrides = ("trajectory=quintic", "duration=1", *CLOSED[robot], *plant)
        config = (
            strangers.config(robot, *overrides) if robot == "kuka" else checked_config(f"robot={robot}", *overrides)
        )
        closed = assemble(config)
        try:
            return simulate(closed, make_encoders(closed, config.noise, 0, 0), None)
        finally:
            closed.plant.close()

    return simulate_on


def largest_error(trace):
    return np.linalg.norm(trace.tip - trace.desired[:, 0], axis=1).max()


@pytest.mark.parametrize("robot", CLOSED)
def test_runge_kutta_in_mujoco_is_that_of_rk4(followed, robot):
    ours, theirs = followed(robot, "plant=rk4"), followed(robot, "plant=mujoco", "plant.integrator=rk4")
    assert ours.failure is theirs.failure is None
    assert np.ptp(ours.tip, axis=0).max() > 0.02
    assert np.linalg.norm(ours.tip - theirs.tip, axis=1).max() < (1e-9 if robot == "combined" else 1e-11)


@pytest.mark.bullet
@pytest.mark.parametrize("robot", CLOSED)
def test_euler_in_mujoco_is_that_of_bullet(followed, robot):
    bullet = followed(robot, "plant=bullet")
    mujoco = followed(robot, "plant=mujoco", "plant.integrator=euler")
    assert largest_error(mujoco) == pytest.approx(largest_error(bullet), rel=1e-5)
    exact = followed(robot, "plant=rk4")
    assert np.abs(bullet.q - mujoco.q).max() < 1e-4 * np.abs(bullet.q - exact.q).max()


@pytest.mark.bullet
@pytest.mark.parametrize(("robot", "scale"), [("macro", 1.0), ("mini", 0.1)])
@pytest.mark.parametrize("end", [1.5, 2.0])  # s: in motion, and where it ends
def test_bullet_converges_to_rk4_at_first_order(simulated, robot, scale, end):
    period = 0.01 * scale

    def final_state(plant, steps_per_tick):
        trace = simulated(
            f"robot={robot}",
            f"plant={plant}",
            f"plant.step={period / steps_per_tick!r}",
            "trajectory=quintic",
            f"trajectory.duration={2.0 * scale}",
            f"duration={end * scale}",
        )
        assert trace.failure is None
        assert trace.t[-1] == pytest.approx(end * scale)
        return np.concatenate([trace.q[-1], trace.dq[-1] * scale])

    reference = final_state("rk4", 4)
    differences = [np.linalg.norm(final_state("bullet", n) - reference) for n in (5, 10, 20, 40)]
    ratios = np.divide(differences[1:], differences[:-1])
    assert ratios.min() > 0.45
    assert ratios.max() < 0.55
