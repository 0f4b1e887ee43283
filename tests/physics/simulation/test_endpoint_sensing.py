"""Mini on a Macro with flexible joints: blind, with a sensor of the tip and by its inertia."""

from dataclasses import replace

import numpy as np
import pytest
from support.arms import checked

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.plants.flexible_joints import FlexibleJoints
from runner.simulation.sensors import make_measured_tips

KEY = "plant.flexible_joints"
FLEXIBLE = (
    *("robot=combined", "plant=rk4_flexible", "noise=none", "torque_limits=none", "controller.payload=known"),
    f"{KEY}.motor_inertia={{macro: 2, mini: null}}",
)
MOVE = ("trajectory=quintic", "trajectory.duration=1", "trajectory.goal=[0.4,0.8,0.7]", "duration=2")
SENSED = "endpoint_sensor.read_by=[mini]"
DAMPED = "controller.coupling=inertial_damping"


def stiff(K):
    return f"{KEY}.stiffness={{macro: {K}, mini: null}}"


def worst(errors, rows):
    return np.linalg.norm(errors[rows], axis=1).max()


def carried(trace):
    """Error of the Macro's point, shape (T, 3), in m."""
    return trace.end_points[0] + trace.offsets[0] - trace.desired[:, 0]


@pytest.mark.parametrize("K", [1000, 3000, 10000])
def test_a_blind_mini_errs_as_the_macro_that_carries_it(simulated, K):
    trace = simulated(*FLEXIBLE, *MOVE, stiff(K))
    moving = trace.t <= 1.0
    assert worst(trace.error, moving) == pytest.approx(worst(carried(trace), moving), rel=0.12)


@pytest.mark.parametrize("K", [1000, 10000])
def test_with_full_reference_velocity_the_tip_errs_by_the_acceleration_asked_whatever_the_stiffness(simulated, K):
    trace = simulated(*FLEXIBLE, *MOVE, stiff(K), SENSED)
    asked = np.linalg.norm(trace.desired[:, 2], axis=1).max() / 300.0**2  # |xdd_d| / omega_n^2, m
    found = worst(trace.error, trace.t <= 1.0)
    assert found == pytest.approx(asked, rel=0.05)
    assert found == pytest.approx(4.15e-5, rel=0.05)  # m, of a simulation apart from this one


def test_a_series_of_goals_lags_behind_a_vibrating_base(simulated):
    trace = simulated(*FLEXIBLE, *MOVE, stiff(1000), SENSED, "controller.mini_reference_velocity=zero")
    assert worst(trace.error, trace.t <= 1.0) == pytest.approx(1.05e-3, rel=0.05)  # m, as above


def test_motor_friction_leaves_the_blind_tip_off_and_the_sensed_one_there(simulated):
    still = (*FLEXIBLE, *MOVE, stiff(1000), "duration=5", "plant.friction.coulomb=[1,1,1,0,0,0]",
             f"{KEY}.damping_ratio=0.1")  # fmt: skip
    blind, sensed = simulated(*still), simulated(*still, SENSED)
    assert np.linalg.norm(blind.error[-1]) > 2e-4
    assert np.linalg.norm(sensed.error[-1]) < 1e-6


def test_for_the_arm_that_bends_itself_it_is_an_encoder_behind_the_springs(simulated):
    """Not next to the motors, so the fast law that is stable by their encoders is not by the sensor."""
    macro = ("robot=macro", "plant=rk4_flexible", "noise=none", "torque_limits=none", "trajectory=goal",
             "trajectory.goal=[0.1,0.9,0.9]", "duration=8", f"{KEY}.static_deflection=unknown", f"{KEY}.stiffness=3000",
             f"{KEY}.damping_ratio=0.1", "plant.step=0.005")  # fmt: skip
    read, slow = "endpoint_sensor.read_by=[macro]", "controller.natural_frequency=3"
    blind, sensed = simulated(*macro), simulated(*macro, read, slow)
    assert np.linalg.norm(sensed.error[-1]) < 0.5 * np.linalg.norm(blind.error[-1])
    assert simulated(*macro, read).failure is not None


def test_on_a_rigid_arm_without_noise_it_changes_nothing(simulated):
    rigid = ("robot=combined", "plant=rk4", "noise=none", "torque_limits=none", "trajectory=quintic", "duration=0.5")
    plain, sensed = simulated(*rigid), simulated(*rigid, SENSED)
    assert np.abs(plain.tip - sensed.tip).max() < 1e-10


def test_a_sensor_that_is_late_or_slow_or_noisy_serves_worse_and_alike_in_equal_runs(simulated):
    def found(*keys):
        return worst(simulated(*FLEXIBLE, *MOVE, stiff(1000), SENSED, *keys).error, slice(None))

    exact = found()
    assert found("endpoint_sensor.delay=0.004") > 5.0 * exact
    assert found("endpoint_sensor.period=0.01") > 5.0 * exact
    noisy = found("endpoint_sensor.noise=1e-4", "endpoint_sensor.velocity=low_pass")
    assert noisy > 2.0 * exact
    assert noisy == found("endpoint_sensor.noise=1e-4", "endpoint_sensor.velocity=low_pass")


def damping_ratios(frequency, *keys):
    """Frequencies in Hz and damping ratios of the modes of the Macro with its brakes on, under the Mini's law."""
    config = validate(
        compose([*FLEXIBLE, "gravity=0", stiff(1000), f"{KEY}.damping_ratio=0", f"{KEY}.brake_time={{macro: 0}}",
                 f"controller.natural_frequency={{macro: 30, mini: {frequency}}}", *keys])
    )  # fmt: skip
    closed = assemble(config)
    plant, mini = closed.plant, closed.loops[1]
    assert isinstance(plant, FlexibleJoints)
    mini.controller.reset()
    x_d = np.zeros((3, 3))
    x_d[0] = closed.robot.model.tip_position(closed.q_start)
    theta = closed.q_start.copy()

    def move(state):
        plant.reset(closed.q_start, np.zeros(6))
        plant.q[:], plant.dq[:] = state[:6], state[6:]
        plant.theta[:3] = theta[:3]
        plant.theta[3:], plant.dtheta[3:] = plant.q[3:], plant.dq[3:]
        q = np.concatenate([theta[:3], plant.q[3:]])
        dq = np.concatenate([np.zeros(3), plant.dq[3:]])
        tips = make_measured_tips(replace(closed, nominal=closed.robot), config, 0)
        desired = tips["mini"].correct(0, q, dq, x_d) if tips else x_d
        tau = np.zeros(6)
        tau[3:] = mini.controller.torque(0.0, q, dq, desired)
        plant.advance(tau)
        return np.concatenate([plant.q, plant.dq])

    rest = np.concatenate([closed.q_start, np.zeros(6)])
    bumps = 1e-6 * np.eye(12)
    A = np.array([(move(rest + bump) - move(rest - bump)) / 2e-6 for bump in bumps]).T
    rates = np.log(np.linalg.eigvals(A).astype(complex)) / 1e-3
    slow = rates[(np.abs(rates) < 60.0) & (rates.imag > 5.0)]
    slow = slow[np.argsort(slow.imag)]
    return np.abs(slow) / (2.0 * np.pi), -slow.real / np.abs(slow)


def modal_masses():
    """Frequencies of the bare Macro's modes at home in rad/s, what they weigh at its tip and the Mini's along them."""
    robot = checked(*FLEXIBLE, stiff(1000)).arm
    macro, mini = robot.stages[0].model, robot.stages[1].model
    M, J = macro.mass_matrix(np.zeros(3)), macro.tip_jacobian(np.zeros(3))[:3]
    squares, modes = np.linalg.eigh(
        np.linalg.inv(np.linalg.cholesky(M)) @ (1000.0 * np.linalg.inv(np.linalg.cholesky(M)).T)
    )
    modes = np.linalg.solve(np.linalg.cholesky(M).T, modes)  # M-normed
    moves = J @ modes
    J_mini, turn = mini.tip_jacobian(np.zeros(3))[:3], robot.stages[1]
    base = robot.model.with_tip(turn.base_frame).tip_pose(np.zeros(6))[:3, :3]
    Lambda = base @ np.linalg.inv(J_mini @ np.linalg.solve(mini.mass_matrix(np.zeros(3)), J_mini.T)) @ base.T
    lengths = np.linalg.norm(moves, axis=0)
    along = moves / lengths
    return np.sqrt(squares), 1.0 / lengths**2, np.einsum("im,ij,jm->m", along, Lambda, along)


def test_the_mini_by_its_sensor_neither_damps_nor_excites_and_the_macro_vibrates_almost_bare():
    """Of the Mini's two masses the one at its tip rests; the one at its elbow is carried on."""
    omega, weight, _ = modal_masses()
    assert weight[:2] == pytest.approx([1.333, 2.0], abs=1e-3)
    f, zeta = damping_ratios(300, SENSED)
    assert f[:3] == pytest.approx(omega / (2.0 * np.pi), rel=0.03)
    assert np.abs(zeta[:3]).max() < 1e-3


@pytest.mark.parametrize("frequency", [300, 100])
def test_goals_instead_of_velocities_take_damping_away(frequency):
    omega, weight, m = modal_masses()
    _, zeta = damping_ratios(frequency, SENSED, "controller.mini_reference_velocity=zero")
    assert zeta[:2] == pytest.approx(-(m / weight * omega / frequency)[:2], rel=0.2)


@pytest.mark.parametrize("gain", [10.0, 20.0])
def test_inertial_damping_damps_as_its_formula_says(gain):
    omega, weight, m = modal_masses()
    _, zeta = damping_ratios(3, DAMPED, f"controller.damping_gain={gain}", SENSED)
    assert zeta[:2] == pytest.approx((m * (gain + 2.0 * 3.0) / (2.0 * weight * omega))[:2], rel=0.2)


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (("endpoint_sensor.read_by=[mimi]",), "no control loop is called 'mimi' (did you mean mini?)"),
        ((SENSED, "endpoint_sensor.period=0.0015"), "endpoint_sensor.period: 0.0015 s is not a multiple"),
        ((SENSED, "endpoint_sensor.delay=0.0004"), "endpoint_sensor.delay: 0.0004 s is not a multiple"),
        ((SENSED, "endpoint_sensor.noise=-1"), "endpoint_sensor.noise: must be 0 or more"),
        (
            (SENSED, "plant=rk4", "plant.dynamics=decoupled", "plant.wrist_rotation=parallel"),
            "plant.wrist_rotation=real",
        ),
        ((SENSED, "plant=rk4", "environment=wall", "controller=hybrid_force"), "take a law that feels no force"),
        ((DAMPED, "controller.damping_gain=-1"), "controller.damping_gain: must be 0 or more"),
    ],
)
def test_what_does_not_fit_is_refused(overrides, expected):
    with pytest.raises(ConfigError) as caught:
        checked("robot=combined", *overrides)
    assert expected in str(caught.value)


def test_a_law_of_joints_has_no_use_for_it():
    with pytest.raises(ConfigError, match="which ask for no tip"):
        validate(
            compose(
                [
                    "robot=macro",
                    "controller=computed_torque",
                    "trajectory=joint_quintic",
                    "endpoint_sensor.read_by=[whole]",
                ]
            )
        )
