"""Contradictions between the signals of a made-up log: each single inverted, exchanged or rescaled joint."""

import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.recordings.columns_map import Factor, Signal
from runner.recordings.consistency import check_consistency
from runner.recordings.other_meanings import HALF_TURN
from runner.recordings.recording import Recording

T = np.arange(0.0, 8.0, 0.008)


@pytest.fixture(scope="module")
def arm():
    return validate(compose(["robot=panda"])).arm.model


def motion(model, seed=0):
    rng = np.random.default_rng(seed)
    lower, upper = model.usual_range
    middle, swing = 0.5 * (lower + upper), np.minimum(0.25 * (upper - lower), 0.5)
    rates = rng.uniform(1.0, 2.5, model.nq)
    phases = rng.uniform(0.0, 2.0 * np.pi, model.nq)
    return middle + swing * np.sin(np.outer(T, rates) + phases)


def made(model, q=None, change=lambda signals: signals, kinds=("torque",), error=0.2, holds="torque", load=None):
    """Return a log of an arm whose masses differ from the model's, with friction and noise."""
    q = motion(model) if q is None else q
    rng = np.random.default_rng(1)
    dq, ddq = np.gradient(q, T, axis=0), np.gradient(np.gradient(q, T, axis=0), T, axis=0)
    other = (model if load is None else model.with_payload(*load)).pin_model.copy()
    for joint in range(1, other.njoints):
        inertia = other.inertias[joint]
        other.inertias[joint] = pin.Inertia(inertia.mass * (1.0 + error), inertia.lever, inertia.inertia)
    data = other.createData()
    torque = np.array([pin.rnea(other, data, *row) for row in zip(q, dq, ddq, strict=True)])
    torque += 1.0 * dq + 0.5 * np.sign(dq) + 0.05 * rng.normal(size=q.shape)
    if holds == "without_gravity":
        torque -= np.array([model.gravity_torque(row) for row in q])
    signals = {Signal("position", name): q[:, place] for place, name in enumerate(model.joint_names)}
    if "torque" in kinds:
        signals |= {Signal("torque", name): torque[:, place] for place, name in enumerate(model.joint_names)}
    if "tip" in kinds:
        tips = np.array([model.tip_position(row) for row in q])
        signals |= {Signal("tip", axis): tips[:, place] for place, axis in enumerate("xyz")}
    if "reference" in kinds:
        signals |= {Signal("reference", n): q[:, j] + 0.002 for j, n in enumerate(model.joint_names)}
    signals = change(dict(signals))
    columns = {signal: signal.words.replace(" ", "_") for signal in signals}
    return Recording(None, T, signals, columns, {name: Factor(1.0, "rad") for name in columns.values()}, False, [])


def position(model, joint):
    return Signal("position", model.joint_names[joint])


def scaled(signal, factor):
    return lambda signals: {**signals, signal: factor * signals[signal]}


def exchanged(one, other):
    return lambda signals: {**signals, one: signals[other], other: signals[one]}


def test_a_current_may_have_a_wrong_constant_but_not_another_sign(arm):
    torques = [Signal("torque", name) for name in arm.joint_names]
    for factor, wanted in ((0.4, None), (2.5, None), (0.1, "Say its constant: "), (-1.0, "opposite sign")):
        log = made(arm, change=scaled(torques[1], factor))
        verdict = check_consistency(arm, replace(log, currents=torques))
        if wanted is None:
            assert verdict.questions == ()
        else:
            assert wanted in verdict.questions[0]
    (question,) = check_consistency(arm, made(arm, change=scaled(torques[1], 0.1))).questions
    assert "Say its unit; of a per cent" in question


@pytest.mark.costs(2)
@pytest.mark.parametrize("kinds", [("torque",), ("tip",), ("reference",), ("torque", "tip", "reference")])
def test_a_right_log_is_not_doubted(arm, kinds):
    verdict = check_consistency(arm, made(arm, kinds=kinds))
    assert verdict.questions == ()
    assert verdict.notes == ()


@pytest.mark.costs(3)
@pytest.mark.parametrize("joint", range(7))
def test_an_inverted_joint_is_asked_for(arm, joint):
    (question,) = check_consistency(arm, made(arm, change=scaled(position(arm, joint), -1.0))).questions
    assert f"of_joint{joint + 1}: fits with the opposite sign" in question
    assert question.endswith("Say sign: -1.")


@pytest.mark.costs(3)
@pytest.mark.parametrize(("kinds", "joints"), [(("tip",), range(5)), (("reference",), range(7))])
def test_an_inverted_joint_is_told_by_the_tip_and_by_commands(arm, kinds, joints):
    for joint in joints:
        (question,) = check_consistency(
            arm, made(arm, kinds=kinds, change=scaled(position(arm, joint), -1.0))
        ).questions
        assert f"of_joint{joint + 1}: fits with the opposite sign" in question


@pytest.mark.costs(3)
def test_an_exchanged_pair_is_asked_for(arm):
    for one, other in ((0, 1), (1, 3), (4, 5)):
        (question,) = check_consistency(
            arm, made(arm, change=exchanged(position(arm, one), position(arm, other)))
        ).questions
        assert f"of_joint{one + 1} and columns.position_of_joint{other + 1}: fit if they are exchanged" in question


@pytest.mark.costs(3)
def test_torques_of_another_meaning_are_asked_for(arm):
    name = arm.joint_names[1]
    for change, wanted in (
        (scaled(Signal("torque", name), -1.0), "opposite sign"),
        (scaled(Signal("torque", name), 1.0 / 0.87), None),
        (scaled(Signal("torque", name), 0.05), "times the model's"),
        (scaled(Signal("torque", name), 0.0), "is 0 in all rows"),
    ):
        questions = check_consistency(arm, made(arm, change=change)).questions
        assert [wanted in question for question in questions] == ([True] if wanted else [])
    (question,) = check_consistency(arm, made(arm, holds="without_gravity")).questions
    assert question.startswith("columns of torques: fit if gravity is not in them")
    assert question.endswith("Say holds: without_gravity.")


@pytest.mark.parametrize("rotor", [0.0, 0.2, 2.0])
def test_torques_of_an_arm_with_other_rotors_are_in_no_other_unit(arm, rotor):
    log = made(arm.with_armature(np.full(arm.nq, rotor)))
    assert check_consistency(arm.with_armature(np.full(arm.nq, 0.4)), log).questions == ()


@pytest.mark.costs(3)
def test_clipped_torques_are_not_taken_for_another_meaning(arm):
    def clipped(share):
        def change(signals):
            limits = {signal: share * np.abs(values).max() for signal, values in signals.items()}
            return {s: np.clip(v, -limits[s], limits[s]) if s.kind == "torque" else v for s, v in signals.items()}

        return change

    questions = check_consistency(arm, made(arm, change=clipped(0.4))).questions
    assert questions[0].startswith("columns.torque_of_joint1: the torque of joint1 is 2.235 N m in 22% of the rows")
    assert all("it is clipped. Leave out the column" in question for question in questions)
    still = motion(arm)
    still[:, 1] = 0.3
    questions = check_consistency(arm, made(arm, q=still, change=clipped(0.4))).questions
    assert questions
    assert not any("of_joint2:" in question for question in questions)  # it does not move
    assert check_consistency(arm, made(arm, change=clipped(0.9))).questions == ()  # the model explains it


def test_degrees_are_asked_for(arm):
    def degrees(signals):
        return {s: v * 180.0 / np.pi if s.kind == "position" else v for s, v in signals.items()}

    (question,) = check_consistency(arm, made(arm, kinds=("reference",), change=degrees)).questions
    assert "columns of positions: fit if they are in deg" in question


def test_a_rigid_offset_of_the_tip_is_geometry(arm):
    verdict = check_consistency(arm, made(arm, kinds=("tip",), change=lambda s: {
        **s, Signal("tip", "z"): s[Signal("tip", "z")] + 0.01
    }))  # fmt: skip
    assert verdict.questions == ()
    assert verdict.notes[0].startswith("geometry differs by 10 mm: ")


def test_a_base_that_is_turned_by_half_a_turn_is_told_by_the_tip(arm):
    x, y = Signal("tip", "x"), Signal("tip", "y")
    (question,) = check_consistency(
        arm, made(arm, kinds=("tip",), change=lambda s: {**s, x: -s[x], y: -s[y]})
    ).questions
    assert "fit with opposite signs, as in a base that is turned by half a turn about z" in question
    assert question.endswith(HALF_TURN)


def test_the_unit_that_a_column_has_is_not_proposed(arm):
    found = made(arm, kinds=("tip",), change=lambda s: {**s, Signal("tip", "z"): s[Signal("tip", "z")][::-1].copy()})
    questions = " ".join(check_consistency(arm, found).questions)
    assert questions
    assert "if it is in m;" not in questions


def test_an_arm_that_stands_still_is_refused(arm):
    still = np.tile(motion(arm)[0], (len(T), 1))
    (question,) = check_consistency(arm, made(arm, still, kinds=())).questions
    assert question.startswith("the arm stands still")


def test_noise_of_an_encoder_is_no_motion(arm):
    still = motion(arm)[0] + 2e-4 * np.random.default_rng(2).normal(size=(len(T), arm.nq))
    (question,) = check_consistency(arm, made(arm, still)).questions
    assert question.startswith("the arm stands still: no joint moves by 0.0001 rad and by 6 times the noise")


@pytest.mark.parametrize("noise", [3e-4, 1e-3, 3e-3])
def test_degrees_are_not_proposed_because_they_shrink_noise(arm, noise):
    def noisy(signals):
        drawn = np.random.default_rng(3)
        own = {s: v + noise * drawn.normal(size=len(v)) for s, v in signals.items() if s.kind == "position"}
        return {**signals, **own}

    slow = motion(arm)[0] + 0.1 * (motion(arm) - motion(arm)[0])
    assert check_consistency(arm, made(arm, slow, noisy)).questions == ()
    questions = check_consistency(arm, made(arm, change=scaled(position(arm, 2), np.rad2deg(1.0)))).questions
    assert any("unit: deg" in question for question in questions)


@pytest.fixture(scope="module")
def light():
    return validate(compose(["robot=ur5e"])).arm.model


@pytest.mark.costs(3)
@pytest.mark.parametrize(
    ("centre", "where"),
    [((0.0, 0.0, 0.0), "at the tip"), ((0.0, 0.05, 0.1), r"at \(-?\d 5\d (9|10)\d\) mm in the frame")],
)
def test_a_heavy_payload_is_no_error_of_a_unit(light, centre, where):
    verdict = check_consistency(light, made(light, error=0.0, load=(5.0, np.array(centre))))
    assert verdict.questions == ()
    (note,) = verdict.notes
    assert re.match(f"a payload of about (4.9|5|5.1) kg {where}.* explains the torques; say payload: in the map", note)


@pytest.mark.costs(4)
@pytest.mark.parametrize("load", [None, (5.0, np.zeros(3))])
@pytest.mark.parametrize(("joints", "factor"), [([3], 1e3), (range(6), 1e3), (range(6), 5.0), ([1], 0.01)])
def test_a_unit_is_asked_for_even_with_a_payload(light, load, joints, factor):
    torques = [Signal("torque", light.joint_names[joint]) for joint in joints]

    def change(signals):
        return {**signals, **{signal: factor * signals[signal] for signal in torques}}

    verdict = check_consistency(light, made(light, error=0.0, change=change, load=load))
    assert verdict.questions
    assert all("Say its unit" in question for question in verdict.questions)
    assert verdict.notes == ()
