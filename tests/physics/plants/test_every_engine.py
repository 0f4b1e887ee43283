"""Arm under torques in every engine: energy, rest, contact and delays, except for the order of the step."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.engines import ENGINES, FIRST_ORDER, FOURTH_ORDER, WITHOUT_STOPS

from runner.robots.model import RobotModel

START = np.array([0.3, 0.5, -0.4]), np.array([1.0, 0.5, -0.5])
TORQUES = np.array([[5.0, -3.0, 2.0], [-8.0, 10.0, -4.0], [2.0, 15.0, -9.0], [0.0, 4.0, 1.0]])
TICK = 0.1
SLIDER = """
<robot name="slider"><link name="base"><inertial><mass value="0"/>
  <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="ram"><inertial><mass value="2"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.01"/></geometry></collision></link>
<joint name="q1" type="prismatic"><parent link="base"/><child link="ram"/><axis xyz="1 0 0"/>
  <limit lower="-10" upper="10" effort="1e9" velocity="1e9"/></joint></robot>
"""
LINE = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "duration=1.5")
PRESSED = (  # with a push of 5 N or so against a wall 2 mm away, in the direction x
    *("robot=meca500", "controller=operational_space", "controller.natural_frequency=20", "environment=wall"),
    *("environment.distance=0.002", "environment.stiffness=3000", "environment.damping=30"),
    *("plant.step=1e-4", "trajectory=quintic", "trajectory.duration=0.5", "duration=1.2"),
)


def swing(plant, model, seconds, torques=None):
    """Move from START, under no torques or TORQUES in turn; return the last state."""
    plant.reset(*START)
    for tau in np.zeros((round(seconds / TICK), model.nq)) if torques is None else torques:
        plant.advance(tau)
    return np.concatenate([plant.q, plant.dq])


@pytest.fixture(scope="module")
def reference(macro):
    """State after four ticks of held torques, by an adaptive integrator of eighth order."""
    state = np.concatenate(START)
    for tau in TORQUES:

        def slope(t, y, tau=tau):
            return np.concatenate([y[3:], macro.forward_dynamics(y[:3], y[3:], tau)])

        state = solve_ivp(slope, (0.0, TICK), state, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return state


@pytest.mark.parametrize("name", ENGINES)
def test_under_held_torques_the_error_has_the_order_of_the_engine(engine, name, macro, macro_urdf, reference):
    fine = 10 if name in FOURTH_ORDER else 200
    steps = (fine, 2 * fine, 4 * fine)
    ends = [swing(engine(name, macro_urdf, macro, TICK / n, n), macro, 0.4, TORQUES) for n in steps]
    errors = [np.linalg.norm(end - reference) for end in ends]
    order = 4.0 if name in FOURTH_ORDER else 1.0
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([order] * 2, abs=0.06 * order)


@pytest.mark.parametrize("name", FIRST_ORDER)
def test_one_step_is_semi_implicit_euler_on_the_forward_dynamics_of_pinocchio(engine, name, xarm7):
    h, model, draw = 1e-4, xarm7.model, np.random.default_rng(0)
    plant = engine(name, xarm7.urdf, model, h)
    lower, upper = model.usual_range
    for _ in range(20):
        q = 0.5 * (lower + upper) + 0.4 * (upper - lower) * draw.uniform(-1.0, 1.0, 7)
        dq, tau = draw.uniform(-2.0, 2.0, 7), draw.uniform(-20.0, 20.0, 7)
        plant.reset(q, dq)
        plant.advance(tau)
        acceleration = model.forward_dynamics(q, dq, tau)
        np.testing.assert_allclose((plant.dq - dq) / h, acceleration, atol=1e-8 * np.abs(acceleration).max())
        np.testing.assert_allclose(plant.q, q + h * plant.dq, atol=1e-14)


@pytest.mark.parametrize("name", ENGINES)
def test_a_free_swing_keeps_its_energy_and_its_momentum_about_the_vertical(engine, name, macro, macro_urdf):
    """No torque acts about the first joint, which is vertical. What a first-order step loses goes with the step."""

    def kept(steps):
        plant = engine(name, macro_urdf, macro, TICK / steps, steps)
        q, dq = np.split(swing(plant, macro, 1.0), 2)
        return np.array([macro.energy(q, dq), (macro.mass_matrix(q) @ dq)[0]])

    start = np.array([macro.energy(*START), (macro.mass_matrix(START[0]) @ START[1])[0]])
    scale = np.array([macro.energy(np.zeros(3), np.zeros(3)), abs(start[1])])
    if name in FOURTH_ORDER:
        assert (np.abs(kept(200) - start) < 1e-8 * scale).all()
        return
    coarse, fine = kept(200) - start, kept(400) - start
    np.testing.assert_allclose(fine, 0.5 * coarse, rtol=0.05, atol=1e-9)
    assert (np.abs(2.0 * fine - coarse) < 3e-4 * scale).all()


@pytest.mark.parametrize("name", ENGINES)
def test_held_torques_that_bear_the_arm_keep_it_at_rest(engine, name, macro, macro_urdf):
    plant, q = engine(name, macro_urdf, macro, 1e-3, 10), np.array([0.0, -0.3, 0.2])
    plant.reset(q, np.zeros(3))
    for _ in range(10):
        plant.advance(macro.gravity_torque(q))
    np.testing.assert_allclose(plant.q, q, atol=1e-9)


@pytest.mark.parametrize("name", ENGINES)
def test_another_gravity_is_that_of_a_tilted_base(engine, name, macro, macro_urdf):
    plant, tilted = engine(name, macro_urdf, macro, 1e-4), macro.copy()
    gravity = np.array([3.0, -4.0, 2.0])
    plant.set_gravity(gravity)
    tilted.pin_model.gravity.linear = gravity
    plant.reset(*START)
    plant.advance(np.zeros(3))
    expected = START[1] + 1e-4 * tilted.forward_dynamics(*START, np.zeros(3))
    np.testing.assert_allclose(plant.dq, expected, atol=1e-6)


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("steps", [2, 3, 10])
def test_steps_of_a_tick_are_bit_identical_to_as_many_ticks(engine, name, steps, macro, macro_urdf):
    whole, single = engine(name, macro_urdf, macro, 1e-3, steps), engine(name, macro_urdf, macro, 1e-3, 1)
    expected = swing(single, macro, 0.0, np.repeat(TORQUES, steps, axis=0))
    np.testing.assert_array_equal(swing(whole, macro, 0.0, TORQUES), expected)


@pytest.mark.parametrize("name", ENGINES)
def test_after_a_reset_a_run_is_bit_identical(engine, name, macro, macro_urdf):
    plant = engine(name, macro_urdf, macro, 1e-3, 10)
    first = swing(plant, macro, 0.0, TORQUES)
    np.testing.assert_array_equal(swing(plant, macro, 0.0, TORQUES), first)
    np.testing.assert_array_equal(swing(engine(name, macro_urdf, macro, 1e-3, 10), macro, 0.0, TORQUES), first)


@pytest.mark.parametrize("name", ENGINES)
def test_torques_act_for_one_tick_are_only_read_and_the_state_is_renewed_in_place(engine, name, macro, macro_urdf):
    plant, tau = engine(name, macro_urdf, macro, 1e-3), np.array([1.0, 2.0, 3.0])
    tau.setflags(write=False)
    q, dq = plant.q, plant.dq
    plant.set_gravity(np.zeros(3))
    plant.reset(np.zeros(3), np.zeros(3))
    plant.advance(tau)
    turning = dq.copy()
    plant.advance(np.zeros(3))
    assert plant.q is q
    assert plant.dq is dq
    assert np.abs(turning).min() > 1e-4
    np.testing.assert_allclose(dq, turning, rtol=1e-2)


@pytest.mark.parametrize("name", ENGINES)
def test_a_run_is_what_its_torques_do_late_and_limited(simulated, closed_loop, name):
    case = (*LINE, *ENGINES[name].split(), "torque_limits.max=20", "plant.computation.delay=3", "noise=thesis")
    trace = simulated(*case)
    prompt = simulated(*(part for part in case if "delay" not in part))
    assert np.abs(trace.tau).max() == 20.0
    np.testing.assert_array_equal(trace.tau[:4], np.tile(prompt.tau[0], (4, 1)))
    plant = closed_loop(*case).plant
    plant.reset(trace.q[0], trace.dq[0])
    for row, tau in enumerate(trace.tau[:-1], start=1):
        plant.advance(tau)
        np.testing.assert_allclose(plant.q, trace.q[row], atol=1e-12)


@pytest.mark.parametrize("name", [name for name in ENGINES if name not in WITHOUT_STOPS])
def test_a_joint_stops_at_its_limit(engine, name, xarm7):
    model = xarm7.model
    plant, q = engine(name, xarm7.urdf, model, 1e-3, 10), xarm7.home.copy()
    joint = 3
    lower = model.position_limits[0, joint]
    push = np.zeros(7)
    plant.set_gravity(np.zeros(3))
    q[joint] = lower + 0.1
    push[joint] = -2.0
    plant.reset(q, np.zeros(7))
    for _ in range(200):
        plant.advance(push)
    assert plant.q[joint] == pytest.approx(lower, abs=0.02)


@pytest.mark.parametrize("name", [name for name in ENGINES if name.startswith(("bullet", "mujoco"))])
@pytest.mark.parametrize("damping", [0.0, 40.0])
def test_a_mass_that_hits_a_wall_moves_as_on_a_spring_and_a_damper(engine, name, damping):
    """Closed form: m x'' + c x' + k x = 0 from x = 0, x' = v, while the force pushes."""
    m, k, v = 2.0, 8000.0, 0.5
    decay, omega = damping / (2.0 * m), np.sqrt(k / m - (damping / (2.0 * m)) ** 2)
    deepest = np.arctan2(omega, decay) / omega if decay else 0.5 * np.pi / omega
    depth = v / omega * np.exp(-decay * deepest) * np.sin(omega * deepest)

    def error(step):
        plant = engine(name, SLIDER, RobotModel(SLIDER, "ram"), step)
        plant.add_wall(np.array([0.03, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]), k, damping)
        plant.reset(np.zeros(1), np.array([v]))
        way = []
        for _ in range(round(0.15 / step)):
            plant.advance(np.zeros(1))
            way.append(float(plant.q[0]) - 0.02)  # its ball touches at 20 mm
        rebound = -float(plant.dq[0])
        return abs(max(way) - depth) / depth, rebound

    (coarse, _), (fine, rebound) = error(1e-4), error(2.5e-5)
    assert fine < 0.4 * coarse  # first order; touching falls between two steps
    assert fine < 2e-3
    # The wall never pulls: they part where k x + c x' = 0, at omega t = pi - 2 arctan(decay / omega).
    parted = (np.pi - 2.0 * np.arctan2(decay, omega)) / omega
    assert rebound == pytest.approx(v * np.exp(-decay * parted), rel=5e-3)


@pytest.mark.parametrize("name", ENGINES)
def test_a_tool_at_rest_on_a_wall_is_held_by_stiffness_times_depth(simulated, checked_config, name):
    """The law pulls with Lambda omega_n^2 e, the wall pushes back with k d along its normal, -x."""
    config = checked_config(*PRESSED, *ENGINES[name].split())
    start = config.path.start
    trace = simulated(*PRESSED, *ENGINES[name].split(), f"trajectory.goal=[{start[0] + 0.02},{start[1]},{start[2]}]")
    assert trace.failure is None
    force, tip = trace.contact.external[-1], trace.tip[-1]
    depth = tip[0] - (start[0] + 0.002)
    assert force[0] == pytest.approx(-3000.0 * depth, rel=1e-4)
    assert force[0] < -0.9
    assert np.abs(force[1:3]).max() < 1e-9
    assert np.abs(trace.dq[-1]).max() < 1e-3


@pytest.mark.parametrize("steps", [1, 4, 10])
@pytest.mark.parametrize("name", ["bullet", "mujoco", "mujoco rk4"])
def test_a_wall_pushes_by_stiffness_times_depth_whatever_the_steps_of_a_tick(closed_loop, name, steps):
    wall = ("environment=wall", "environment.distance=-0.001", "environment.stiffness=3000", "environment.damping=0")
    timing = (f"plant.step={1e-4 / steps}", "controller.period=1e-4")
    closed = closed_loop("robot=meca500", "controller=operational_space", *ENGINES[name].split(), *wall, *timing)
    closed.plant.reset(closed.q_start, np.zeros(6))
    closed.plant.advance(closed.robot.model.gravity_torque(closed.q_start))
    wrench = closed.plant.contact_wrench()
    assert wrench[0] == pytest.approx(-3.0, rel=0.01)  # it has moved by then
    np.testing.assert_allclose(wrench[1:3], 0.0, atol=1e-12 if name != "bullet" else 1e-6)  # its solver leaves 2e-7 N
