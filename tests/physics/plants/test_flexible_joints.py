"""Flexible joints: modes, energy, stability bounds and rest against closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.arms import model_of

from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints
from runner.robots.model import RobotModel

HOME = np.zeros(3)  # rad, of the thesis
LOCKED = 1e12  # kg m^2, a motor that does not turn
ONE_JOINT = """<robot name="one"><link name="base"/><link name="arm"><inertial><mass value="1"/><origin xyz="0 0 0"/>
<inertia ixx="3" iyy="3" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="q" type="revolute">
<parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>
</joint></robot>"""


def macro():
    return model_of("macro")


def springs(stiffness, motors, damping):
    zero = np.zeros(len(stiffness))
    return Flexibility(stiffness, motors, damping, zero + np.inf, zero)


def made(model, stiffness, motor, step, damping=0.0, steps=1):
    full = np.ones(model.nq)
    return FlexibleJoints(model, springs(stiffness * full, motor * full, damping * full), step, steps)


def linearised(move, rest, width=1e-6):
    """Derivative of a map at its fixed point, by central differences."""
    bumps = width * np.eye(len(rest))
    return np.array([(move(rest + bump) - move(rest - bump)) / (2.0 * width) for bump in bumps]).T


def put(plant, state):
    plant.q[:], plant.theta[:], plant.dq[:], plant.dtheta[:] = np.split(state, 4)


def rates(plant, model, law, q, step):
    """Eigenvalues of the arm under a sampled law about rest, shape (4 nq,)."""
    plant.reset(q, np.zeros(model.nq))
    rest = np.concatenate([plant.q, plant.theta, plant.dq, plant.dtheta])

    def move(state):
        put(plant, state)
        plant.advance(law(plant))
        return np.concatenate([plant.q, plant.theta, plant.dq, plant.dtheta])

    return np.linalg.eigvals(linearised(move, rest))


def test_modes_with_locked_motors_are_those_of_stiffness_and_mass():
    model = macro()
    M, step = model.mass_matrix(HOME), 1e-3
    model.pin_model.gravity.linear = np.zeros(3)  # whose stiffness is not in the closed form
    plant = made(model, 1000.0, LOCKED, step)
    values = rates(plant, model, lambda _: np.zeros(3), HOME, step)
    angles = np.abs(np.angle(values)) / step
    found = np.sort(angles[angles > 1.0])[::2]
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, 1000.0 * np.eye(3))).real))
    assert found == pytest.approx(expected, rel=1e-6)
    assert found / (2.0 * np.pi) == pytest.approx([2.724, 3.559, 6.576], abs=5e-4)


def test_energy_is_kept_without_damping():
    plant = made(macro(), 1000.0, 2.0, 1e-3, steps=50)
    plant.reset(HOME, np.array([0.3, -0.2, 0.4]))
    first, energies, bent = plant.energy(), [], []
    for _ in range(50):
        plant.advance(np.zeros(3))
        energies.append(plant.energy())
        bent.append(np.abs(plant.theta - plant.q).max())
    assert np.abs(plant.q - HOME).max() > 1.0
    assert max(bent) > 1e-2
    assert energies == pytest.approx([first] * 50, rel=1e-8)


def test_the_distance_to_the_rigid_arm_falls_as_one_over_the_stiffness():
    model, motor, tau, time = macro(), 2.0, np.array([3.0, 30.0, 8.0]), 0.3
    rigid = model.with_armature(motor * np.ones(3))

    def slope(_, y):
        return np.concatenate([y[3:], rigid.forward_dynamics(y[:3], y[3:], tau)])

    at = np.linspace(0.0, time, 31)[1:]
    start = np.concatenate([HOME, np.zeros(3)])
    expected = solve_ivp(slope, (0.0, time), start, "DOP853", at, rtol=1e-11, atol=1e-13).y[:3].T
    stiffness, distances = np.array([1e4, 3e4, 1e5]), []
    for K in stiffness:
        plant = made(model, K, motor, 2.5e-4, 0.02 * np.sqrt(K), steps=40)
        plant.reset(HOME, np.zeros(3))
        found = []
        for _ in at:
            plant.advance(tau)
            found.append(plant.q.copy())
        distances.append(np.abs(np.array(found) - expected).max())
    assert np.polyfit(np.log(stiffness), np.log(distances), 1)[0] == pytest.approx(-1.0, abs=0.05)


@pytest.mark.parametrize(("damping_ratio", "factor"), [(0.02, 1.0008), (0.05, 1.005), (0.10, 1.020)])
def test_link_encoders_bear_the_gains_of_routh(damping_ratio, factor):
    links, motor, stiffness, step = 3.0, 2.0, 1000.0, 2e-5
    model = RobotModel(ONE_JOINT, "arm")
    reduced = links * motor / (links + motor)
    natural = np.sqrt(stiffness / reduced)
    plant = made(model, stiffness, motor, step, 2.0 * damping_ratio * natural * reduced)

    def radius(omega):
        def law(plant):
            return -(links + motor) * (omega**2 * plant.q + 2.0 * omega * plant.dq)

        return np.abs(rates(plant, model, law, np.zeros(1), step)).max()

    limit = factor * damping_ratio * natural
    assert radius(0.98 * limit) < 1.0 < radius(1.02 * limit)


def test_motor_encoders_bear_gains_until_the_motor_alone_is_too_light_for_the_period():
    model, step, omega = macro().with_payload(0.2), 1e-2, 30.0  # the Mini's mass

    def radius(motor):
        plant = FlexibleJoints(model, springs(*(np.full(3, value) for value in (300.0, motor, 0.0))), step / 10.0, 10)
        G = model.gravity_torque(HOME)
        plant.reset(HOME, np.zeros(3))
        rest, M = plant.theta.copy(), model.mass_matrix(HOME) + motor * np.eye(3)

        def law(plant):
            return M @ (omega**2 * (rest - plant.theta) - 2.0 * omega * plant.dtheta) + G

        return np.abs(rates(plant, model, law, HOME, step)).max()

    def bound(motor):
        return omega * step * (1.0 + np.linalg.eigvalsh(model.mass_matrix(HOME)).max() / motor)

    assert bound(1.7) < 1.0 < bound(1.6)
    assert radius(1.7) < 1.0 < radius(1.6)


def test_the_largest_rate_is_that_of_two_masses_on_a_spring():
    stiffness, links, motor, damping = 1000.0, 3.0, 2.0, 0.4
    rate = springs(*np.array([[stiffness], [motor], [damping]])).largest_rate(np.array([[links]]))
    assert rate == pytest.approx(np.sqrt(stiffness * (1.0 / links + 1.0 / motor)), rel=1e-9)


def test_a_stretched_arm_has_a_faster_mode_than_at_home():
    model = macro().with_payload(0.2)
    stretched = np.array([0.0, 0.0, -np.pi / 2.0])
    assert np.linalg.norm(model.tip_position(stretched)) == pytest.approx(2.0)
    damping = 0.04 * np.sqrt(1000.0 * np.diag(model.mass_matrix(HOME)))
    arm = springs(np.full(3, 1000.0), np.full(3, 2.0), damping)
    ratio = arm.largest_rate(model.mass_matrix(stretched)) / arm.largest_rate(model.mass_matrix(HOME))
    assert ratio == pytest.approx(1.76, abs=0.01)


def test_rigid_joints_move_as_those_of_a_rigid_arm():
    model, tau = macro(), np.array([3.0, 30.0, 8.0])
    rigid = FlexibleJoints(model, springs(np.full(3, np.inf), np.zeros(3), np.zeros(3)), 2.5e-4, 1200)
    rigid.reset(HOME, np.zeros(3))
    rigid.advance(tau)

    def slope(_, y):
        return np.concatenate([y[3:], model.forward_dynamics(y[:3], y[3:], tau)])

    end = solve_ivp(slope, (0.0, 0.3), [*HOME, 0, 0, 0], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert np.concatenate([rigid.q, rigid.dq]) == pytest.approx(end, abs=1e-9)
    assert np.array_equal(rigid.theta, rigid.q)


def test_at_rest_springs_carry_the_weight():
    plant = made(macro(), 1000.0, 2.0, 1e-3, steps=200)
    plant.reset(HOME, np.zeros(3))
    weight = macro().gravity_torque(HOME)
    plant.advance(weight)
    assert plant.q == pytest.approx(HOME, abs=1e-12)
    assert 1000.0 * (plant.theta - plant.q) == pytest.approx(weight, abs=1e-9)


def test_motors_add_their_spin_to_the_mass_matrix_and_nothing_else():
    model, motors, dq = macro(), np.array([1.0, 2.0, 3.0]), np.array([0.2, 0.3, -0.4])
    own = model.with_armature(motors)
    assert own.mass_matrix(HOME) - model.mass_matrix(HOME) == pytest.approx(np.diag(motors), abs=1e-14)
    assert own.coriolis_torque(HOME, dq) == pytest.approx(model.coriolis_torque(HOME, dq), abs=1e-14)
    ddq = own.forward_dynamics(HOME, dq, np.zeros(3))
    bias = own.coriolis_torque(HOME, dq) + own.gravity_torque(HOME)
    assert own.mass_matrix(HOME) @ ddq == pytest.approx(-bias, abs=1e-12)
