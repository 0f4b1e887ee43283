"""Recordings compared with a run: of the run itself, and of a part of its signals."""

import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from runner.base.errors import RunnerError
from runner.recordings.columns_map import Signal
from runner.recordings.compare import compare_recording
from runner.recordings.friction import Friction, FrictionEstimate
from runner.recordings.setting import setting_of
from runner.recordings.smoothing import cutoff, derivative, low_pass
from runner.recordings.verdict import explained, noise_torques, verdict_lines
from runner.recordings.words import aligned_text, friction_lines, lag_lines
from runner.sweeps.job import run

JOINTS = "a1: {joint: q1, unit: rad}, a2: {joint: q2, unit: rad}, a3: {joint: q3, unit: rad}"
TORQUES = "c1: {torque: q1, unit: N m}, c2: {torque: q2, unit: N m}, c3: {torque: q3, unit: N m}"
TIP = "x: {tip: x, unit: m}, y: {tip: y, unit: m}, z: {tip: z, unit: m}"


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return run(
        "robot=macro", "controller=computed_torque", "trajectory=joint_quintic", "plant=rk4", "duration=1.5",
        "trajectory.duration=1.0",
        "trajectory.goal_configuration=[0.8,-0.5,0.6]", "controller.period=0.002", "robot.armature=[0.5,0.4,0.2]",
        f"outputs={tmp_path_factory.mktemp('outputs')}",
    )  # fmt: skip


@pytest.fixture
def compared(stored, tmp_path):
    """Return a function that compares a run with its own signals, from the columns of a map."""

    def compare(columns, rows=slice(None), shift=0.0, change=lambda frame: frame, **options):
        trace = stored.trace().iloc[rows].copy()
        trace["t"] += shift
        names = {f"q{j}": f"a{j}" for j in (1, 2, 3)} | {f"tau{j}": f"c{j}" for j in (1, 2, 3)}
        change(trace.rename(columns={**names, "tip_x": "x", "tip_y": "y", "tip_z": "z"})).to_csv(
            tmp_path / "recording.csv", index=False
        )
        (tmp_path / "map.yaml").write_text(f"time: {{column: t, unit: s}}\ncolumns: {{{columns}}}\n")
        return compare_recording(stored, tmp_path / "recording.csv", tmp_path / "map.yaml", **options)

    return compare


def test_a_run_held_against_itself_is_the_same(stored, compared):
    found = compared(f"{JOINTS}, {TORQUES}, {TIP}", shift=1.7e9 + 3.2)
    assert found.offset.start == pytest.approx(0.0, abs=1e-6)  # after its first row
    assert found.span == (0.0, 1.5)
    for one in found.residuals:
        assert one.largest == pytest.approx(0.0, abs=1e-4 * np.abs(one.simulated).max())
        assert one.fit == pytest.approx(1.0, abs=1e-3)
    chatter = {name for name in stored.metrics if "chatter" in name}
    assert set(found.metrics) == set(stored.metrics) - chatter - {n for n in stored.metrics if "saturation" in n}
    for name, (simulated, recorded) in found.metrics.items():
        assert simulated == stored.metrics[name].median
        assert recorded == pytest.approx(simulated, rel=0.01, abs=2e-5), name


def test_what_is_not_recorded_is_in_no_metric(compared):
    of_tip = compared(TIP)
    assert {"max_tracking_error", "settling_time"} <= set(of_tip.metrics)
    assert not {"peak_torque", "energy", "peak_joint_speed"} & set(of_tip.metrics)
    assert (of_tip.friction, of_tip.no_friction) == (None, "no position of q1, q2, q3 is recorded")
    of_joints = compared(JOINTS)
    assert {"max_tracking_error", "peak_joint_speed_q2"} <= set(of_joints.metrics)
    assert not {"peak_torque", "energy"} & set(of_joints.metrics)
    assert (of_joints.friction, of_joints.no_friction) == (None, "no torque is recorded")
    of_all = compared(f"{JOINTS}, {TORQUES}")
    assert (of_all.friction, of_all.no_friction) == (None, "the recording lasts 1.5 s; needed: 2 s or more")
    of_some = compared("a1: {joint: q1, unit: rad}, c1: {torque: q1, unit: N m}")
    assert of_some.metrics == {}
    assert of_some.no_friction == "no position of q2, q3 is recorded"


def test_the_words_have_the_filled_gaps(compared):
    gone = [*range(100, 112), *range(300, 303)]
    found = compared(JOINTS, change=lambda frame: frame.drop(frame.index[gone]), fill_gaps=0.03)
    assert aligned_text(found).endswith("; 1 gap of up to 26 ms is filled")
    assert "filled" not in aligned_text(compared(JOINTS))


def keyed(keys):
    return ", ".join(f"c{j}: {{torque: q{j}, unit: N m, {keys}}}" for j in (1, 2, 3))


def test_torques_without_gravity_are_compared_without_it(stored, compared):
    model = setting_of(stored).config.arm.model

    def without(frame):
        gravity = np.array([model.gravity_torque(q) for q in frame[["a1", "a2", "a3"]].to_numpy()])
        assert np.abs(gravity).max() > 1.0
        return frame.assign(**{f"c{j + 1}": frame[f"c{j + 1}"] - gravity[:, j] for j in range(3)})

    found = compared(f"{JOINTS}, {keyed('holds: without_gravity')}", change=without)
    for one in found.residuals:
        assert one.largest == pytest.approx(0.0, abs=1e-3 * max(1.0, np.abs(one.simulated).max()))
    assert not {"peak_torque", "energy"} & set(found.metrics)


def test_sensors_behind_the_gears_feel_no_rotor(stored, compared):
    setting = setting_of(stored)
    model = setting.config.arm.model
    on_links = setting.torques("torque", "link")
    ddq = np.gradient(setting.trace.dq, setting.trace.t, axis=0)
    differences = setting.trace.tau - on_links - model.armature * ddq
    assert np.abs(model.armature * ddq).max() > 0.01
    assert np.sqrt(np.mean(differences[10:-10] ** 2)) < 0.05 * np.sqrt(np.mean((model.armature * ddq) ** 2))
    found = compared(f"{JOINTS}, {keyed('side: link')}")
    assert [one.simulated for one in found.residuals if one.signal.kind == "torque"][1] == pytest.approx(on_links[:, 1])


def test_commanded_positions_are_read_and_not_compared(compared):
    commanded = "a1: {joint: q1, unit: rad}, a2: {joint: q2, unit: rad}, a3: {reference: q3, unit: rad}"
    found = compared(commanded)
    assert [one.signal.words for one in found.residuals] == ["position of q1", "position of q2"]
    assert Signal("reference", "q3") in found.recording.signals


def test_a_lag_behind_the_commands_is_no_time_offset(stored, compared):
    """All joints of the log move 30 ms later than in the run; without its commands this would be its offset."""
    desired = setting_of(stored).desired_joints

    def late(frame):
        t = frame["t"].to_numpy()
        for j in (1, 2, 3):
            frame[f"d{j}"] = desired[:, j - 1]
            frame[f"a{j}"] = np.interp(t - 0.03, t, frame[f"a{j}"])
        return frame

    commands = ", ".join(f"d{j}: {{reference: q{j}, unit: rad}}" for j in (1, 2, 3))
    alone = compared(JOINTS, change=late)
    assert (alone.offset.start, alone.lags, alone.by_commands) == (pytest.approx(0.03, abs=5e-4), {}, False)
    found = compared(f"{JOINTS}, {commands}", change=late)
    assert found.offset.start == pytest.approx(0.0, abs=1e-6)
    for log, run_ in found.lags.values():
        assert log - run_ == pytest.approx(0.03, abs=1e-3)
        assert run_ == pytest.approx(0.0, abs=2e-3)
    assert "by the commanded positions" in aligned_text(found)
    assert next(lag_lines(found)).startswith("Joints move later than their commands: q1 30")


def test_friction_below_zero_is_named(stored, compared):
    found = compared(f"{JOINTS}, {TORQUES}")
    joints = [
        FrictionEstimate("q1", "rad", -6.4, 1.6, 0.1, 0.2, 0.0, np.ones(1), np.zeros(1)),
        FrictionEstimate("q2", "rad", 3.3, 1.9, -0.1, 0.2, 0.0, np.ones(1), np.zeros(1)),
        FrictionEstimate("q3", "rad", -2e-6, 1e-6, -2e-6, 1e-6, 0.0, np.ones(1), np.zeros(1)),  # as good as zero
    ]
    (line,) = (line for line in friction_lines(replace(found, friction=Friction(joints, [], 10.0))) if "Below" in line)
    assert line.startswith("Below zero, with the whole interval: q1 viscous. No friction is")


CAUSES = (
    "friction",
    "rotor inertia",
    "a payload",
    "an offset",
    "a scale of each torque",
    "gravity in another direction",
)


@pytest.mark.parametrize("cause", CAUSES)
def test_the_cause_of_the_torques_differences_is_named(stored, compared, cause):
    """The recorded torques are the run's with one cause, which explains nearly all of the differences."""
    model = setting_of(stored).config.arm.model

    def caused(frame):
        q, dq = (np.column_stack([frame[f"{name}{j}"] for j in (1, 2, 3)]) for name in ("a", "dq"))
        ddq = derivative(dq, 0.002)

        def dynamics(arm):
            data = arm.pin_model.createData()
            return np.array([pin.rnea(arm.pin_model, data, *row) for row in zip(q, dq, ddq, strict=True)])

        gravity = pin.Motion(np.array([1.7, 0.5, -9.6]), np.zeros(3))
        tilted = model.with_change(lambda pin_model: setattr(pin_model, "gravity", gravity))
        more = {
            "friction": lambda: 0.8 * dq + 0.5 * np.sign(dq),
            "rotor inertia": lambda: ddq * [0.4, 0.2, 0.3],
            "an offset": lambda: np.full(q.shape, 1.0),
            "a scale of each torque": lambda: dynamics(model) * [0.2, 0.3, -0.1],
            "gravity in another direction": lambda: dynamics(tilted) - dynamics(model),
            "a payload": lambda: dynamics(model.with_payload(1.5)) - dynamics(model),
        }[cause]()
        return frame.assign(**{f"c{j}": frame[f"c{j}"] + more[:, j - 1] for j in (1, 2, 3)})

    found = compared(f"{JOINTS}, {TORQUES}", change=caused)
    shares = explained(found)
    assert max(shares, key=shares.get) == cause
    assert shares[cause] > 0.95
    text = " ".join(verdict_lines(found))
    assert re.match(
        r"Over 1.5 s the model predicts positions within .* rad for 95 % of the time \(q\d\) and torques to", text
    )
    assert re.search(rf"explains: .*{cause} (9\d|100) %", text)
    assert "a lag of the arm, as no commands are known" in text


def test_the_accuracy_is_that_of_the_differences(stored, compared):
    def off(frame):
        return frame.assign(a2=frame["a2"] + 0.004, c1=1.1 * frame["c1"], c2=frame["c2"], c3=frame["c3"])

    text = next(verdict_lines(compared(f"{JOINTS}, {TORQUES}", change=off)))
    assert "within 4.00·10⁻³ rad for 95 % of the time (q2)" in text
    assert "(q1: 9.1 %)" in text
    of_tip = list(verdict_lines(compared(TIP)))
    assert "the tip's coordinates within" in of_tip[0]
    assert "masses, as it holds no torques" in of_tip[-1]


def test_tiny_differences_of_torques_get_no_cause(compared):
    for more, named in ((1.002, False), (1.2, True)):
        found = compared(f"{JOINTS}, {TORQUES}", change=lambda frame, more=more: frame.assign(c2=more * frame["c2"]))
        text = " ".join(verdict_lines(found))
        assert ("a scale of each torque" in text) is named
        assert ("explain" in text) is named


def test_a_part_of_a_run(compared):
    found = compared(JOINTS, rows=slice(100, 500), shift=-0.2)
    assert found.offset.start == pytest.approx(-0.2, abs=1e-4)
    assert found.span == pytest.approx((0.2, 0.998), abs=0.003)


@pytest.mark.parametrize(
    ("columns", "change", "wanted"),
    [
        (JOINTS, lambda frame: frame.assign(a2=frame.a2 * 57.29578), "columns.a2: .* looks like deg: say unit: deg"),
        (JOINTS.replace("rad", "deg"), lambda frame: frame, "columns.a1: .* looks like rad: say unit: rad"),
        (f"{JOINTS}, {TIP}", lambda frame: frame.assign(z=frame.z * 1e3), "columns.z: fits if it is in mm; "),
        (TORQUES, lambda frame: frame, "columns: needs the position of a joint, or a coordinate of the tip"),
        (JOINTS, lambda frame: frame.iloc[:120], "too short: it lasts 0.238 s, and the run 1.5 s"),
    ],
)
def test_what_does_not_fit_the_run(compared, columns, change, wanted):
    with pytest.raises(RunnerError, match=wanted):
        compared(columns, change=change)


def test_a_run_that_failed_is_refused(tmp_path):
    failed = run("robot=macro", "duration=0.5", "plant=rk4", "controller.natural_frequency=1e5", f"outputs={tmp_path}")
    with pytest.raises(RunnerError, match="a recording is compared with a run that ended well"):
        compare_recording(failed, tmp_path / "recording.csv", tmp_path / "map.yaml")


def test_causes_are_named_where_torques_hold_no_gravity(stored, compared):
    model = setting_of(stored).config.arm.model

    def change(frame):
        q, dq = (np.column_stack([frame[f"{name}{j}"] for j in (1, 2, 3)]) for name in ("a", "dq"))
        gravity = np.array([model.gravity_torque(row) for row in q])
        return frame.assign(**{f"c{j}": (frame[f"c{j}"] - gravity[:, j - 1] + 0.8 * dq[:, j - 1]) for j in (1, 2, 3)})

    without = TORQUES.replace("N m}", "N m, holds: without_gravity}")
    shares = explained(compared(f"{JOINTS}, {without}", change=change))
    assert shares["friction"] > 0.95


def test_friction_and_rotors_below_zero_explain_nothing(compared):
    def pushed(frame):
        return frame.assign(**{f"c{j}": frame[f"c{j}"] - 0.8 * frame[f"dq{j}"] for j in (1, 2, 3)})

    shares = explained(compared(f"{JOINTS}, {TORQUES}", change=pushed))
    assert shares["friction"] < 0.2


def test_torques_that_noise_of_the_positions_hides_are_not_judged(compared):
    def noisy(frame):
        drawn = np.random.default_rng(4)
        return frame.assign(**{f"a{j}": frame[f"a{j}"] + 2e-3 * drawn.normal(size=len(frame)) for j in (1, 2, 3)})

    found = compared(f"{JOINTS}, {TORQUES}", change=noisy)
    assert explained(found) == {}
    hides = "torques of q1, q2, q3, because the noise of the measured positions makes as large ones"
    assert hides in " ".join(verdict_lines(replace(found, follows_measured=True)))
    assert hides not in " ".join(verdict_lines(found))


def test_noise_makes_the_torques_of_white_accelerations(compared):
    """The formula against torques of drawn noise behind the low-pass."""
    found = compared(f"{JOINTS}, {TORQUES}")
    period, joints = found.recording.period, found.model.joint_names
    still = np.random.default_rng(5).normal(scale=1e-3, size=(20_000, 3))
    t = period * np.arange(len(still))
    signals = {Signal("position", joint): still[:, place] for place, joint in enumerate(joints)}
    made = noise_torques(replace(found, recording=replace(found.recording, t=t, signals=signals)))
    ddq = derivative(derivative(low_pass(still, period, cutoff(period)), period), period)[500:-500]
    expected = np.sqrt(np.mean((ddq @ found.model.mass_matrix(np.zeros(3))) ** 2, axis=0))
    assert list(made.values()) == pytest.approx(expected, rel=0.1)
