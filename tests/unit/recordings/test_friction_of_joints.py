"""Friction identified from torques that closed forms and other masses give."""

import re
import warnings

import numpy as np
import pinocchio as pin
import pytest
from scipy.signal import lfilter
from scipy.special import stdtrit

from runner.recordings.block_intervals import block_scores
from runner.recordings.equations import motion_of
from runner.recordings.friction import _half_widths, identify_friction
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

H = 0.004
T = np.arange(0.0, 10.0, H)
VISCOUS, COULOMB, CONSTANT = np.array([1.2, 0.8, 0.5]), np.array([1.5, 1.0, 0.6]), np.array([0.3, -0.2, 0.0])


@pytest.fixture(scope="module")
def model():
    return RobotModel(read_urdf(find_urdf("macro.urdf"), {}), "tip")


def moved(times=T):
    """Return q, dq and ddq of a swing of three joints, shapes (N, 3)."""
    w = np.array([2.1, 3.3, 4.7])
    phase, faster = np.outer(times, w) + w, 1.7 * np.outer(times, w)
    q = 0.5 * np.sin(phase) + 0.2 * np.sin(faster)
    dq = w * (0.5 * np.cos(phase) + 0.34 * np.cos(faster))
    ddq = -w * w * (0.5 * np.sin(phase) + 0.578 * np.sin(faster))
    return q, dq, ddq


def torques(model, motion):
    return np.array(
        [pin.rnea(model.pin_model, model.pin_model.createData(), *row) for row in zip(*motion, strict=True)]
    )


def friction_of(dq):
    return VISCOUS * dq + COULOMB * np.sign(dq) + CONSTANT


def test_friction_is_found_within_its_interval(model):
    motion = moved()
    q, dq, _ = motion
    noise = np.random.default_rng(0)
    found = identify_friction(
        model,
        q + noise.uniform(-1e-4, 1e-4, q.shape),
        torques(model, motion) + friction_of(dq) + noise.normal(0.0, 0.3, q.shape),
        H,
    )
    assert (found.lacking, found.frequency) == ([], 10.0)
    for joint, b, c in zip(found.joints, VISCOUS, COULOMB, strict=True):
        assert joint.viscous == pytest.approx(b, rel=0.05)
        assert joint.coulomb == pytest.approx(c, rel=0.05)
        assert abs(joint.viscous - b) < 2.0 * joint.viscous_half < 0.2 * b
        assert abs(joint.coulomb - c) < 2.0 * joint.coulomb_half < 0.2 * c


def test_rounding_does_not_change_it(model):
    """Columns of the regressor that hold only rounding are no columns."""
    motion = moved()
    noise = np.random.default_rng(0)
    measured = torques(model, motion) + friction_of(motion[1]) + noise.normal(0.0, 0.3, motion[0].shape)
    one, other = (identify_friction(model, q, measured, H) for q in (motion[0], motion[0] * (1.0 + 1e-15)))
    for joint, same in zip(one.joints, other.joints, strict=True):
        assert joint.viscous == pytest.approx(same.viscous, rel=1e-8)
        assert joint.coulomb_half == pytest.approx(same.coulomb_half, rel=1e-8)


def test_intervals_hold_the_friction_about_as_often_as_they_say(model):
    motion = moved()
    clean = torques(model, motion) + friction_of(motion[1])
    held = []
    for seed in range(12):
        white = np.random.default_rng(seed).normal(0.0, 0.05, clean.shape)
        correlated = lfilter([1.0], [1.0, -np.exp(-H / 0.1)], white, axis=0)  # over 0.1 s
        found = identify_friction(model, motion[0], clean + correlated, H)
        for joint, b, c in zip(found.joints, VISCOUS, COULOMB, strict=True):
            held += [abs(joint.viscous - b) < joint.viscous_half, abs(joint.coulomb - c) < joint.coulomb_half]
    assert len(held) == 72
    assert 0.85 < np.mean(held) <= 1.0


def test_intervals_of_few_rows_are_wider_for_what_other_masses_take_up(model):
    """Two and a half seconds leave about 30 rows of one joint; its masses, b, c and o take up half of them."""
    motion = moved(np.arange(0.0, 2.5, 0.01))
    clean = torques(model, motion) + friction_of(motion[1])
    clean[:, 1:] = np.nan
    held = []
    for seed in range(80):
        noise = np.random.default_rng(seed).normal(0.0, 0.3, clean.shape)
        (joint,) = identify_friction(model, motion[0], clean + noise, 0.01).joints
        assert len(joint.speed) < 40
        held += [abs(joint.viscous - 1.2) < joint.viscous_half, abs(joint.coulomb - 1.5) < joint.coulomb_half]
    assert 0.88 < np.mean(held) <= 1.0


def test_other_masses_are_not_mistaken_for_friction(model):
    other = model.with_payload(1.5, np.array([0.1, 0.0, 0.05]))
    motion = moved()
    found = identify_friction(model, motion[0], torques(other, motion) + friction_of(motion[1]), H)
    assert [joint.viscous for joint in found.joints] == pytest.approx(VISCOUS, rel=0.05)
    assert [joint.coulomb for joint in found.joints] == pytest.approx(COULOMB, rel=0.05)


@pytest.mark.parametrize("rotors", [[0.3, 0.3, 0.3], [2.0, 0.1, 1.0]])
def test_rotors_that_the_model_lacks_are_not_mistaken_for_friction(model, rotors):
    """Coulomb friction is exact by the columns of the rotors, and off without them, as behind the gears."""
    motion = moved()
    tau = torques(model.with_armature(np.array(rotors)), motion) + friction_of(motion[1])

    def off(**options):
        joints = identify_friction(model, motion[0], tau, H, **options).joints
        return max(abs(joint.coulomb - c) for joint, c in zip(joints, COULOMB, strict=True))

    assert off() < 0.01
    assert off(rotors=False) > 2.0 * off()


def test_an_arm_without_friction_has_none(model):
    motion = moved()
    noise = np.random.default_rng(1).normal(0.0, 0.3, motion[0].shape)
    for joint in identify_friction(model, motion[0], torques(model, motion) + noise, H).joints:
        assert abs(joint.viscous) < 1.5 * joint.viscous_half
        assert abs(joint.coulomb) < 1.5 * joint.coulomb_half


def test_what_the_points_of_the_figure_show(model):
    motion = moved()
    joint = identify_friction(model, motion[0], torques(model, motion) + friction_of(motion[1]), H).joints[0]
    apart = np.abs(joint.torque - 1.2 * joint.speed - 1.5 * np.sign(joint.speed))
    assert np.median(apart) < 0.03
    assert apart.max() < 0.5  # where another joint turns round, whose jump the low-pass spreads


def test_a_joint_that_creeps_has_no_friction(model):
    q, dq, ddq = moved()
    motion = tuple(part * [1.0, 1.0, 1e-3] for part in (q, dq, ddq))
    found = identify_friction(model, motion[0], torques(model, motion) + friction_of(motion[1]), H)
    assert found.lacking == ["q3: it moves too little, or in only one direction"]


def test_a_single_bad_sample_stops_no_joint(model):
    """The fastest speed is that of the motion, however large the jump is."""
    q, dq, _ = motion = moved()
    spoilt = q.copy()
    spoilt[1250, 1] += 5.0
    tau = torques(model, motion) + friction_of(dq)
    assert identify_friction(model, spoilt, tau, H).lacking == []
    clean, other = (motion_of(model, each, tau, H, 10.0) for each in (q, spoilt))
    assert other.fastest == pytest.approx(clean.fastest, rel=0.05)
    assert clean.fastest == pytest.approx(np.abs(clean.dq).max(axis=0), rel=0.03)


@pytest.mark.parametrize("lasts", [0.5, 1.0])
def test_a_joint_that_moves_in_a_small_part_of_the_log_moves(model, lasts):
    t = np.arange(0.0, 40.0, H)
    q = moved(t)[0]
    share = np.clip((t - 20.0) / lasts, 0.0, 1.0)
    q[:, 2] = 0.8 * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    motion = motion_of(model, q, np.zeros_like(q), H, 10.0)
    assert motion.fastest[2] == pytest.approx(0.8 * 1.875 / lasts, rel=0.1)
    assert not motion.creeps(2)


def integrated(dq, period):
    """Return q, dq and ddq of joints that start at zero, from their speeds."""
    way = np.cumsum(0.5 * period * (dq[1:] + dq[:-1]), axis=0)
    return np.vstack([np.zeros(dq.shape[1]), way]), dq, np.gradient(dq, period, axis=0)


def test_slow_motion_tells_nothing_of_friction_that_is_larger_near_standstill(model):
    """All joints swing for 6 s, then creep at 1.5 % of their largest speed, at which stiction doubles the torque."""
    dq = moved()[1]
    fastest = np.abs(dq).max(axis=0)
    swings = (0.5 - 0.5 * np.tanh((T - 6.0) / 0.2))[:, None]
    creeps = 0.015 * fastest * np.tanh((8.0 - T) / 0.05)[:, None]
    motion = integrated(swings * dq + (1.0 - swings) * creeps, H)
    stiction = 2.0 * COULOMB * np.sign(motion[1]) * np.exp(-((motion[1] / (0.02 * fastest)) ** 2))
    found = identify_friction(model, motion[0], torques(model, motion) + friction_of(motion[1]) + stiction, H)
    assert [joint.viscous for joint in found.joints] == pytest.approx(VISCOUS, rel=0.05)
    assert [joint.coulomb for joint in found.joints] == pytest.approx(COULOMB, rel=0.05)


@pytest.mark.parametrize("turns", [True, False])
def test_coulomb_friction_that_another_mass_explains_is_not_given(model, turns):
    """q3 turns the last link over each time that q2 turns round: gravity on q2 then has the sign of its speed."""
    period, stroke, pause = 0.01, 4.0, 1.0
    t = np.arange(0.0, 30.0, period)
    number, since = np.divmod(t, stroke + pause)
    way, share = np.where(number % 2 == 0, 1.0, -1.0), np.clip(since / stroke, 0.0, 1.0)
    speed = (
        0.08 * way * np.minimum(1.0, 20.0 * np.minimum(share, 1.0 - share)) * (1.0 + 0.5 * np.sin(2 * np.pi * share))
    )
    x = np.clip((since - stroke) / pause, 0.0, 1.0)
    posture = 0.5 * np.pi * way * (1.0 - 2.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x**2))
    q2 = integrated(speed[:, None], period)[0]
    q = np.column_stack([0.0 * t, q2, posture if turns else 0.5 + 0.0 * t])
    dq = np.gradient(q, period, axis=0)
    tau = torques(model, (q, dq, np.gradient(dq, period, axis=0))) + friction_of(dq)
    tau[:, [0, 2]] = np.nan
    found = identify_friction(model, q, tau, period)
    assert [joint.joint for joint in found.joints] == ([] if turns else ["q2"])
    assert ("q2: its motion does not tell friction from other masses and inertias" in found.lacking) == turns


@pytest.mark.parametrize("every", [1, 8])
def test_friction_does_not_depend_on_the_rate(model, every):
    motion = moved()
    tau = torques(model, motion) + friction_of(motion[1])
    found = identify_friction(model, motion[0][::every], tau[::every], H * every)
    assert [joint.coulomb for joint in found.joints] == pytest.approx(COULOMB, rel=0.05)


def test_joints_without_torque_or_in_one_direction_have_no_friction(model):
    q, dq, ddq = (part.copy() for part in moved())
    q[:, 2], dq[:, 2], ddq[:, 2] = 0.1 * T, 0.1, 0.0
    tau = torques(model, (q, dq, ddq)) + friction_of(dq)
    tau[:, 0] = np.nan
    found = identify_friction(model, q, tau, H)
    assert [joint.joint for joint in found.joints] == ["q2"]
    assert found.lacking == ["q1: no torque is recorded", "q3: it moves too little, or in only one direction"]


@pytest.mark.parametrize("held", [False, True], ids=["instant", "held"])
@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_intervals_over_motions_at_the_middles_of_held_torques(model, held, noise):
    """Torques of an instant, or means over a row, of motions with other phases: 95 % hold, and none is far off."""
    held_friction, errors = [], []
    for seed in range(8):
        random = np.random.default_rng(seed)
        start = random.uniform(0.0, 100.0)
        times = start + T[:2000]
        parts = [-0.375, -0.125, 0.125, 0.375] if held else [0.0]  # of a row
        means = []
        for part in parts:
            motion = moved(times + part * H)
            means.append(torques(model, motion) + friction_of(motion[1]))
        q = moved(times)[0] + random.normal(0.0, 1e-4 * noise, (len(times), 3))
        tau = np.mean(means, axis=0) + random.normal(0.0, noise, q.shape)
        for joint, b, c in zip(identify_friction(model, q, tau, H).joints, VISCOUS, COULOMB, strict=True):
            errors.append([joint.viscous / b - 1.0, joint.coulomb / c - 1.0])
            held_friction += [abs(joint.viscous - b) < joint.viscous_half, abs(joint.coulomb - c) < joint.coulomb_half]
    assert len(held_friction) == 48
    assert np.mean(held_friction) > 0.85
    assert np.abs(errors).max() < (0.1 if noise else 0.01)


@pytest.mark.parametrize(("most", "clipped"), [(6.0, True), (np.inf, False)])
def test_a_torque_that_is_clipped_tells_no_friction(model, most, clipped):
    motion = moved()
    tau = torques(model, motion) + friction_of(motion[1])
    tau[:, 0] = np.round(np.minimum(tau[:, 0], most) / 0.05) * 0.05
    tau[::9, 0] = np.nextafter(tau[::9, 0], 0.0)  # as interpolation between rows rounds
    found = identify_friction(model, motion[0], tau, H)
    assert len(found.lacking) == clipped
    assert all(
        re.match(r"q1: its torque is clipped, at 6 in \d+% of the rows in which it moves", one) for one in found.lacking
    )


@pytest.mark.parametrize("value", [0.0, 5.0])
def test_a_constant_torque_is_not_clipped(model, value):
    motion = moved()
    tau = torques(model, motion) + friction_of(motion[1])
    tau[:, 0] = value
    found = identify_friction(model, motion[0], tau, H)
    assert [joint.joint for joint in found.joints] == ["q2", "q3"]
    assert found.lacking == [f"q1: its torque is constant: {value:g} in all rows in which it moves"]


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(lambda q, tau: (0.0 * q, tau), id="stands still"),
        pytest.param(lambda q, tau: (q, 0.0 * tau), id="no torque acts"),
        pytest.param(lambda q, tau: (q, np.full_like(tau, np.nan)), id="no torque is recorded"),
        pytest.param(lambda q, tau: (1e12 * q, 1e12 * tau), id="as large as allowed"),
        pytest.param(lambda q, tau: (1e-300 * q, 1e-300 * tau), id="tiny"),
        pytest.param(lambda q, tau: (np.where(q > 0.0, 1.0, 0.0), tau), id="jumps"),
        pytest.param(lambda q, tau: (q[:, [0, 0, 0]], tau[:, [0, 0, 0]]), id="joints move as one"),
        pytest.param(lambda q, tau: (q[:50], tau[:50]), id="50 rows"),
        pytest.param(lambda q, tau: (q, np.where(np.arange(len(q))[:, None] == 700, 1e12, 0.0 * tau)), id="a spike"),
    ],
)
@pytest.mark.parametrize("period", [H, 1.0])
def test_awkward_recordings_give_finite_friction_or_a_reason_and_no_warning(model, change, period):
    """Warnings are errors in all tests."""
    motion = moved(T[:1250])
    q, tau = change(motion[0], torques(model, motion) + friction_of(motion[1]))
    found = identify_friction(model, q, tau, period)
    assert len(found.joints) + len(found.lacking) == 3
    assert np.isfinite(found.frame().drop(columns="unit").to_numpy(dtype=float)).all()


def test_friction_as_a_frame(model):
    motion = moved()
    found = identify_friction(model, motion[0], torques(model, motion) + friction_of(motion[1]), H)
    frame = found.frame()
    assert frame.index.tolist() == ["q1", "q2", "q3"]
    assert frame["coulomb"].tolist() == [joint.coulomb for joint in found.joints]
    assert frame.columns.tolist() == ["unit", "viscous", "viscous_half", "coulomb", "coulomb_half", "constant"]


def test_widths_of_intervals_are_those_of_the_covariance_and_are_real_without_residuals():
    drawn = np.random.default_rng(5)
    own, blocks = drawn.normal(size=(60, 3)), np.arange(60) // 6
    taken, rest = np.linalg.qr(own)[0], drawn.normal(size=60)
    bread, scores = np.linalg.pinv(own.T @ own), block_scores(own, taken, rest, blocks)
    wanted = stdtrit(9, 0.975) * np.sqrt(np.diagonal(bread @ scores.T @ scores @ bread))
    assert _half_widths(own, taken, rest, blocks) == pytest.approx(wanted, rel=1e-9)
    nearly = np.column_stack([own, own[:, 0] + 1e-7 * drawn.normal(size=60)])  # rounding made a variance negative
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isfinite(_half_widths(nearly, np.linalg.qr(nearly)[0], rest, blocks)).all()
