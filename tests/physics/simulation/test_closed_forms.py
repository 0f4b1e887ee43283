"""Quantities of the closed loop that theory gives in closed form, so that no reference run is needed."""

import numpy as np
import pytest
from support.arms import model_of
from support.covers import covered

from runner.trajectories.motion import quintic_motion

ARMS = [("macro", 1.0), ("mini", 0.1)]  # name, and by what its lengths, masses, times and torques are scaled
SCALES = dict(ARMS)
PLANTS = ("bullet", "mujoco", "rk4")
ON_PLANTS = {"robot": tuple(SCALES), "plant": PLANTS}
SAMPLED = {"robot": tuple(SCALES), "steps": (1, 4, 10), "share": (0.98, 0.99, 1.01, 1.02)}
SIMILAR = {"plant": PLANTS, "limits": ("none", "thesis"), "motion": ("goal", "quintic")}
HOME_TIP, GOAL = np.array([0.0, 1.0, 1.0]), np.array([0.1679, -0.7571, 0.4255])
DISTANCE = np.linalg.norm(GOAL - HOME_TIP)


def numbers(values):
    return f"[{','.join(map(repr, np.asarray(values).tolist()))}]"


def quintic(scale, t_f, rest=0.0):
    return ("trajectory=quintic", f"trajectory.duration={t_f * scale!r}", f"duration={(t_f + rest) * scale!r}")


# Lag: a goal law that follows a moving goal lags by the speed over k_p / k_v.


@pytest.mark.parametrize("case", covered(ON_PLANTS | {"t_f": (2.0, 3.0, 4.0, 6.0)}))
def test_lag_without_feedforward(simulated, case):
    robot, plant, t_f = case.values()
    scale, tolerance = SCALES[robot], 0.02 if t_f == 2.0 else 0.002
    trace = simulated(f"robot={robot}", f"plant={plant}", "controller.feedforward=false", *quintic(scale, t_f))
    expected = 2.0 / 30.0 * 1.875 * DISTANCE / t_f * scale
    assert np.linalg.norm(trace.error, axis=1).max() == pytest.approx(expected, rel=tolerance)


@pytest.mark.parametrize("damping_ratio", [0.7, 1.5])
@pytest.mark.parametrize("frequency", [20.0, 40.0])
def test_lag_grows_with_damping_and_falls_with_frequency(simulated, damping_ratio, frequency):
    trace = simulated(
        "controller.feedforward=false",
        f"controller.natural_frequency={frequency}",
        f"controller.damping_ratio={damping_ratio}",
        "controller.period=0.005",
        *quintic(1.0, 6.0),
    )
    expected = 2.0 * damping_ratio / frequency * 1.875 * DISTANCE / 6.0
    assert np.linalg.norm(trace.error, axis=1).max() == pytest.approx(expected, rel=0.02)


# Sag: without the gravity term the loop's spring k_p carries the arm.


@pytest.mark.parametrize("case", covered(ON_PLANTS | {"trajectory": ("goal", "quintic")}))
def test_sag_without_gravity_compensation(simulated, arms, case):
    robot, plant, trajectory = case.values()
    scale = SCALES[robot]
    motion = quintic(scale, 3.0, 2.0) if trajectory == "quintic" else (f"duration={5.0 * scale}",)
    trace = simulated(f"robot={robot}", f"plant={plant}", "controller.gravity_compensation=false", *motion)
    model, q = arms[robot], trace.q[-1]
    weight = np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q))
    expected = model.tip_jacobian(q)[:3] @ weight / (30.0 / scale) ** 2
    assert np.linalg.norm(trace.error[-1] - expected) < 0.02 * np.linalg.norm(expected)
    assert 8.5e-3 * scale**2 < np.linalg.norm(expected) < 9.2e-3 * scale**2  # the mini's is a hundredth


@pytest.mark.parametrize(("robot", "scale"), ARMS)
def test_no_sag_with_gravity_compensation(simulated, robot, scale):
    trace = simulated(f"robot={robot}", *quintic(scale, 3.0, 2.0))
    assert np.abs(trace.error[-1]).max() < 1e-9 * scale


# Stability of the sampled loop with the torque held. With w = wn h a deviation obeys, from tick to tick, a 2x2 matrix.


def tick_matrix(w, rise):
    """State (x, h dx) over a tick; the constant acceleration a moves x by rise a h^2."""
    return np.array([[1.0 - rise * w**2, 1.0 - 2.0 * rise * w], [-(w**2), 1.0 - 2.0 * w]])


def envelope_factor(simulated, robot, scale, plant, w, steps):
    """By what a small error's envelope changes per tick, and by what the theory says it does."""
    period = float(w) / 30.0 * scale
    goal, start = np.array([0.3, 0.9, 1.0]), np.array([0.300001, 0.899999, 1.000001])
    trace = simulated(
        f"robot={robot}",
        f"plant={plant}",
        f"plant.step={period / steps!r}",
        f"controller.period={period!r}",
        "controller.singularity_damping=0",
        f"trajectory.goal={numbers(goal * scale)}",
        f"trajectory.start={numbers(start * scale)}",
        f"duration={70 * period!r}",
    )
    assert trace.failure is None
    rise = 0.5 if plant == "rk4" else (steps + 1) / (2 * steps)
    error = np.linalg.norm(trace.error, axis=1)
    assert error.max() < 0.1 * scale  # still small, where the posture's own curvature does not count
    return (error[70] / error[30]) ** (1.0 / 40.0), np.abs(np.linalg.eigvals(tick_matrix(w, rise))).max()


@pytest.mark.parametrize(("robot", "scale"), ARMS)
@pytest.mark.parametrize(("w", "stable"), [(0.95, True), (0.99, True), (1.01, False), (1.05, False)])
def test_sampled_stability_on_rk4(simulated, robot, scale, w, stable):
    factor, expected = envelope_factor(simulated, robot, scale, "rk4", w, 1)
    assert (factor < 1.0) == stable
    assert factor == pytest.approx(expected, rel=1e-3)


@pytest.mark.bullet
@pytest.mark.parametrize("case", covered(SAMPLED))
def test_sampled_stability_on_bullet(simulated, case):
    robot, steps, share = case.values()
    limit = 2.0 * steps * (np.sqrt(1.0 + 1.0 / steps) - 1.0)  # 4 - 4 w - w^2 / n = 0
    assert limit == pytest.approx({1: 0.83, 4: 0.944, 10: 0.976}[steps], abs=2e-3)  # as printed
    factor, expected = envelope_factor(simulated, robot, SCALES[robot], "bullet", share * limit, steps)
    assert (factor < 1.0) == (share < 1.0)
    assert factor == pytest.approx(expected, rel=1e-3)


# Similarity: the mini is the macro with lengths, masses, times and torques a tenth. Gravity does not scale.


def assert_similar(simulated, plant, motion, limits, gravity):
    macro, mini = (
        simulated(
            f"robot={robot}",
            f"plant={plant}",
            f"torque_limits={limits}",
            f"gravity={g}",
            *([f"plant.min_inertia={1e-9 * scale**3}"] if plant == "mujoco" else []),  # as m L^2 is
            *(quintic(scale, 2.0, 2.0) if motion == "quintic" else (f"duration={4.0 * scale}",)),
        )
        for (robot, scale), g in zip(ARMS, gravity, strict=True)
    )
    assert macro.failure is None
    assert len(macro.t) == len(mini.t) == 401
    for of_macro, of_mini in (
        (macro.q, mini.q),
        (macro.dq, 0.1 * mini.dq),
        (macro.tau, 10.0 * mini.tau),
        (macro.tip, 10.0 * mini.tip),
        (macro.t, 10.0 * mini.t),
    ):
        np.testing.assert_allclose(of_mini, of_macro, rtol=0.0, atol=1e-9 * np.abs(of_macro).max())
    limited = np.abs(macro.tau).max() == pytest.approx(50.0)
    assert limited == (limits == "thesis")  # the limit is at work where there is one


@pytest.mark.parametrize("case", covered(SIMILAR))
def test_without_gravity_the_arms_are_similar(simulated, case):
    assert_similar(simulated, **case, gravity=(0.0, 0.0))


@pytest.mark.parametrize("case", covered(SIMILAR))
def test_with_ten_times_the_gravity_the_mini_is_similar(simulated, case):
    assert_similar(simulated, **case, gravity=(9.81, 98.1))


def test_under_one_gravity_the_arms_are_not_similar(simulated):
    macro, mini = (
        simulated(f"robot={robot}", "torque_limits=thesis", f"duration={4.0 * scale}") for robot, scale in ARMS
    )
    assert np.abs(macro.q - mini.q).max() > 0.1


def test_gravity_errors_are_a_hundredth_on_the_mini(simulated):
    macro, mini = (
        simulated(f"robot={robot}", "controller.gravity_compensation=false", *quintic(scale, 4.0, 2.0))
        for robot, scale in ARMS
    )
    ratio = np.linalg.norm(macro.error[-1]) / np.linalg.norm(mini.error[-1])
    assert ratio == pytest.approx(100.0, rel=0.02)


@pytest.mark.parametrize(("gravity", "tolerance"), [(0.0, 0.005), (9.81, 0.02)])
def test_noise_errors_are_a_thousandth_on_the_mini(simulated, gravity, tolerance):
    macro, mini = (
        simulated(f"robot={robot}", f"gravity={gravity}", "noise=thesis", *quintic(scale, 4.0, 2.0)).error[500:]
        for robot, scale in ARMS
    )
    assert np.abs(macro).max() > 1e-4
    np.testing.assert_allclose(1000.0 * mini, macro, rtol=0.0, atol=tolerance * np.abs(macro).max())


# The thesis' straight path, and the torque it takes.


@pytest.mark.parametrize(("robot", "scale"), ARMS)
def test_the_path_passes_the_base_axis(closed_loop, robot, scale):
    trajectory = closed_loop(f"robot={robot}", *quintic(scale, 4.0)).trajectory
    path = trajectory.sample(np.linspace(0.0, trajectory.duration, 20001))[:, 0]
    assert np.hypot(path[:, 0], path[:, 1]).min() == pytest.approx(0.0951 * scale, abs=5e-5 * scale)


@pytest.mark.parametrize(("robot", "scale"), ARMS)
@pytest.mark.parametrize(
    ("plant", "t_f", "below"),
    [
        ("bullet", 3.0, False),
        ("bullet", 3.85, False),
        ("bullet", 3.86, True),
        ("bullet", 3.9, True),
        ("bullet", 5.0, True),
        ("rk4", 3.85, False),  # the exact plant wants 10 ms more: 50.12 N m at 3.86 s
        ("rk4", 3.87, True),
        ("rk4", 5.0, True),
    ],
)
def test_peak_torque_of_joint_1_keeps_the_limit_from_3_86_s_on(simulated, robot, scale, plant, t_f, below):
    trace = simulated(f"robot={robot}", f"plant={plant}", *quintic(scale, t_f))
    peak = np.abs(trace.tau[:, 0]).max()
    assert (peak < 50.0 * scale) == below
    if t_f == 3.86:
        assert peak == pytest.approx(50.0 * scale, rel=0.01)


def test_the_ideal_motion_takes_the_limit_at_3_82_s(arms):
    # Inverse dynamics along the path, without sampling or plant. Joint 1 feels no gravity: torque goes as t_f^-2.
    macro = arms["macro"]
    motion = quintic_motion(HOME_TIP, GOAL, 1.0).sample(np.linspace(0.0, 1.0, 2001))
    q, torque = np.zeros(3), []
    for position, velocity, acceleration in motion:
        for _ in range(4):
            J = macro.tip_jacobian(q)[:3]
            q = q + np.linalg.solve(J, position - macro.tip_position(q))
        J = macro.tip_jacobian(q)[:3]
        dq = np.linalg.solve(J, velocity)
        ddq = np.linalg.solve(J, acceleration - macro.tip_bias_acceleration(q, dq))
        torque.append((macro.mass_matrix(q) @ ddq + macro.coriolis_torque(q, dq))[0])
    assert np.sqrt(np.abs(torque).max() / 50.0) == pytest.approx(3.8207, abs=5e-4)


@pytest.fixture(scope="module")
def arms():
    return {name: model_of(name) for name, _ in ARMS}
