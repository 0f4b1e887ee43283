"""Sensors and mismatches of the user that go wrong."""

import re
from dataclasses import replace

import numpy as np
import pytest

from runner.base.errors import ConfigError, SimulationError
from runner.robots.mismatch import MISMATCHES
from runner.sensing import ENDPOINT_SENSORS, JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders, make_wrist_sensor


class Sensor:
    """Goes wrong at the sixth tick, t = 0.05 s."""

    def __init__(self, answer):
        self.answer = answer

    def measure(self, tick, q, dq):
        return self.answer(q, dq) if tick >= 5 else (q, dq)

    def read(self, tick, load):
        return self.answer(load) if tick >= 5 else load


def end_of(trace):
    assert trace.failure is not None
    assert trace.failure.time == pytest.approx(0.05)
    return trace.failure.reason


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (lambda q, dq: 1 / 0, r"ZeroDivisionError: division by zero \(test_sensors.py, line \d+, in <lambda>\)"),
        (lambda q, dq: q, r"Sensor.measure \(test_sensors.py, line \d+\) gave array.*; it must be positions and vel"),
        (lambda q, dq: (q, dq[:2]), r"Sensor.measure .* gave an array of shape \(2,\); it must be an array of shape"),
        (lambda q, dq: (q * np.nan, dq), r"gave nan at index \[0\]; it must be finite"),
        (lambda q, dq: None, r"gave None; it must be positions and velocities"),
        (
            lambda q, dq: (q.fill(0.0), dq),
            r"read-only \(test_sensors.py, line \d+, in <lambda>\); a plug-in cannot change",
        ),
        (lambda q, dq: (q, dq.fill(0.0)), r"read-only \(test_sensors.py"),
    ],
)
def test_encoders_that_go_wrong_end_the_run_with_the_place(closed_loop, answer, reason):
    loop = replace(closed_loop("robot=macro", "duration=0.2"), compiled=None)
    found = end_of(simulate(loop, [NOISES.guard(Sensor(answer))]))
    assert re.search(reason, found), found


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (
            lambda load: np.zeros(3),
            r"Sensor.read .* gave an array of shape \(3,\); it must be an array of shape \(6,\)",
        ),
        (lambda load: load.fill(0.0), r"read-only \(test_sensors.py, line \d+, in <lambda>\)"),
        (lambda load: {}["range"], r"KeyError: 'range' \(test_sensors.py"),
    ],
)
def test_a_wrist_sensor_that_goes_wrong_ends_the_run_with_the_place(closed_loop, checked_config, answer, reason):
    asked = ("robot=macro", "duration=0.2", "environment=push")
    loop, config = closed_loop(*asked), checked_config(*asked)
    loop = replace(loop, compiled=None)
    found = end_of(simulate(loop, make_encoders(loop, config.noise, 0, 0), WRIST_SENSORS.guard(Sensor(answer))))
    assert re.search(reason, found), found
    assert make_wrist_sensor(loop, config.wrist_sensor, 0, 0) is not None


def test_readings_of_torque_sensors_are_guarded():
    guarded = JOINT_TORQUE_SENSORS.guard(Sensor(lambda load: load[:1]))
    own = np.ones(3)
    answer = guarded.read(0, own)
    answer[:] = 0.0
    assert own.tolist() == [1.0] * 3
    with pytest.raises(SimulationError, match=r"Sensor.read .* gave an array of shape \(1,\)"):
        guarded.read(5, own)


def test_a_nominal_robot_that_is_no_robot_of_the_same_joints_is_refused(checked_config):
    macro, mini = (checked_config(f"robot={name}").arm for name in ("macro", "mini"))
    other = checked_config("robot=planar").arm
    assert MISMATCHES.guard(macro, None, macro, None) is macro
    with pytest.raises(ConfigError, match=r"mismatch.kind: build gave None; it must give a Robot"):
        MISMATCHES.guard(None, None, macro, None)
    with pytest.raises(ConfigError, match=r"a robot with other stages or joints: .*; they must be q1, q2, q3"):
        MISMATCHES.guard(other, None, macro, None)
    with pytest.raises(ConfigError, match=r"a robot with other stages or joints"):
        MISMATCHES.guard(mini, None, macro, None)
    wrong = macro.model.copy()
    wrong.pin_model.gravity.linear = np.array([0.0, 0.0, np.nan])
    with pytest.raises(ConfigError, match=r"masses or lengths that are not finite"):
        MISMATCHES.guard(replace(macro, model=wrong), None, macro, None)


@pytest.mark.parametrize(
    "kinds", [NOISES, WRIST_SENSORS, JOINT_TORQUE_SENSORS, ENDPOINT_SENSORS, MISMATCHES], ids=lambda kinds: kinds.group
)
def test_a_kind_that_no_plugin_has(cli, kinds):
    group, known = kinds.group, ", ".join(kinds.names())
    ending = cli("robot=macro", f"+{group}.kind=own", "duration=0.1")
    assert ending.code == 2
    assert (
        f"{group}.kind: 'own' is unknown; known: {known}; a plug-in adds its kind: --plugin {group}=FILE.py"
        in ending.err
    )


def test_the_kind_of_a_built_in_sensor_may_be_named(checked_config):
    named = ("+noise.kind=encoders", "+mismatch.kind=factors", "+wrist_sensor.kind=force_torque")
    config = checked_config("robot=macro", *named, "+joint_torque_sensor.kind=joint_torque")
    assert config.interpreted == []
    assert config.compilable


def test_readings_of_a_tip_sensor_are_guarded():
    class Tracker:
        def measure(self, number, tip):
            return tip[0]

    with pytest.raises(SimulationError, match=r"measure .* gave an array of shape \(3,\); it must be .* \(2, 3\)"):
        ENDPOINT_SENSORS.guard(Tracker()).measure(0, np.zeros((2, 3)))


def test_the_config_of_a_tip_sensor_says_which_loops_read_it(own_part, cli):
    module = """
        from runner.plugin import StrictModel


        class TrackerConfig(StrictModel):
            kind: str


        CONFIG = TrackerConfig
        """
    ending = cli(
        "--config-dir", own_part("endpoint_sensor", "tracker", module), "robot=macro", "endpoint_sensor=tracker"
    )
    assert ending.code == 2
    assert "module tracker of 'tracker' needs CONFIG, a class derived from runner.plugin.TipSensorConfig" in ending.err
