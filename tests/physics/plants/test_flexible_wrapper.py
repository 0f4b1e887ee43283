"""Flexible joints around PyBullet and MuJoCo, against the Runge-Kutta scheme and the closed forms that hold there."""

import numpy as np
import pytest
from support.physics import assert_order

from runner.plants.flexible_joints import SeriesElastic
from runner.plants.plant import unwrapped

KEY = "plant.flexible_joints"
ENGINES = ["bullet_flexible", "mujoco_flexible"]
MACRO = ("robot=macro", "noise=none", "torque_limits=none")
MOVE = ("trajectory=quintic", "trajectory.duration=0.5", "trajectory.goal=[0.2,0.9,0.8]", "duration=0.6")
COMBINED = (
    *("robot=combined", "noise=none", "torque_limits=none", "controller.payload=known", "trajectory=quintic"),
    *("trajectory.duration=1", "trajectory.goal=[0.4,0.8,0.7]", "duration=1", "plant.step=1e-4"),
    *(f"{KEY}.stiffness={{macro: 1000, mini: null}}", f"{KEY}.motor_inertia={{macro: 2, mini: null}}"),
)


@pytest.fixture(params=ENGINES)
def engine(request):
    return f"plant={request.param}"


def test_the_error_halves_with_the_step(simulated, engine):
    exact = simulated(*MACRO, *MOVE, "plant=rk4_flexible", "plant.step=0.001").tip
    off = [
        np.abs(simulated(*MACRO, *MOVE, engine, f"plant.step={step}").tip - exact).max() for step in (4e-4, 2e-4, 1e-4)
    ]
    assert_order(off, 1, within=0.13)
    assert off[2] < 1e-4


def test_soft_springs_ask_for_heavy_motors(simulated, engine):
    """At 10 ms and K 300 the law by the motors is stable from B 1.7 on, and not at 1.6, with the Mini's mass."""
    heavy = (*MACRO, "gravity=0", "robot.payload.mass=0.2", "trajectory=goal", "trajectory.goal=[0.02,1,1]",
             f"{KEY}.stiffness=300", "plant.step=1e-4", "duration=3.5")  # fmt: skip

    def grows(motor):
        trace = simulated(*heavy, engine, f"{KEY}.motor_inertia={motor}")
        speed = np.abs(trace.dq).max(axis=1)
        return trace.failure is not None or speed[-60:].max() > speed[200:260].max()

    assert grows(1.6)
    assert not grows(1.75)


def test_a_sensed_tip_errs_by_the_acceleration_and_a_blind_one_as_its_macro(simulated, engine):
    sensed = simulated(*COMBINED, engine, "endpoint_sensor.read_by=[mini]")
    asked = np.linalg.norm(sensed.desired[:, 2], axis=1).max() / 300.0**2
    assert np.linalg.norm(sensed.error, axis=1).max() == pytest.approx(asked, rel=0.1)
    blind = simulated(*COMBINED, engine)
    carried = blind.end_points[0] + blind.offsets[0] - blind.desired[:, 0]
    macro, tip = (np.linalg.norm(error, axis=1).max() for error in (carried, blind.error))
    assert tip == pytest.approx(macro, rel=0.24)


@pytest.mark.bullet
@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (("endpoint_sensor.read_by=[mini]", "controller.mini_reference_velocity=zero"), -0.0064),
        (("endpoint_sensor.read_by=[mini]", "controller.coupling=inertial_damping",
          "controller.natural_frequency.mini=3", "controller.damping_gain=20"), 0.0851),
    ],
)  # fmt: skip
def test_a_mode_gains_and_loses_damping_as_on_runge_kutta(simulated, law, expected):
    ring = ("experiment=thesis_beyond/flexible_ring", "plant=bullet_flexible", "plant.step=1e-4", "duration=2",
            f"{KEY}.stiffness={{macro: 1000, mini: null}}", f"{KEY}.motor_inertia={{macro: 2, mini: null}}",
            f"{KEY}.damping_ratio=0", f"{KEY}.brake_time={{macro: 0}}")  # fmt: skip
    trace = simulated(*ring, *law)
    M = np.array([[2.0, 0.0, 0.0], [0.0, 3.0, 1.0], [0.0, 1.0, 1.0]])  # of the bare Macro at home
    y = (trace.q[:, :3] - trace.q[0, :3]) @ M @ np.linalg.eigh(M)[1][:, -1]
    peaks = 1 + np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:]))
    peaks = peaks[(trace.t[peaks] > 0.3) & (y[peaks] > 0.1 * y[peaks].max())]
    slope, period = np.polyfit(trace.t[peaks], np.log(y[peaks]), 1)[0], np.diff(trace.t[peaks]).mean()
    assert -slope * period / (2.0 * np.pi) == pytest.approx(expected, rel=0.4)


def test_a_shaper_finds_the_modes(simulated, engine):
    """A shaper for each mode leaves less than half of the vibration."""
    left = []
    for shaper in ((), ("input_shaper=zv", "input_shaper.frequency=[mode_1,mode_2,mode_3]")):
        trace = simulated(*MACRO, *MOVE, "duration=2", engine, "plant.step=0.001", *shaper)
        resting = np.abs(trace.desired[:, 1]).max(axis=1) < 1e-9
        left.append(np.ptp(trace.error[resting & (trace.t > 0.95)], axis=0).max())
    assert left[1] < 0.5 * left[0]


@pytest.mark.bullet
def test_what_the_engine_holds_is_released(closed_loop):
    closed = closed_loop(*MACRO, "plant=bullet_flexible", "trajectory=goal")
    assert isinstance(unwrapped(closed.plant), SeriesElastic)


@pytest.mark.bullet
def test_undamped_joints_with_brakes_keep_their_energy(closed_loop):
    """To the second order of the step, for ever: the scheme is symplectic."""
    closed = closed_loop(*MACRO, "plant=bullet_flexible", "gravity=0", "plant.step=1e-3", "controller.period=0.001",
                         f"{KEY}.damping_ratio=0", f"{KEY}.brake_time={{macro: 0}}", "trajectory=goal")  # fmt: skip
    plant = closed.plant
    plant.reset(np.zeros(3), np.array([0.5, 0.3, -0.4]))
    plant.dtheta[:] = 0.0
    energies = []
    for _ in range(5000):
        plant.advance(np.zeros(3))
        energies.append(plant.energy())
    halves = np.split(np.array(energies), 2)
    assert halves[0].mean() == pytest.approx(halves[1].mean(), rel=1e-3)
