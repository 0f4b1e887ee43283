"""The parts in examples/own_parts, used from outside as their pages say."""

import os
import re
import shlex
import sys

import numpy as np
import pytest

from runner.base.paths import examples_dir
from runner.plugins.discovery import load, use_plugins
from runner.store import open_run, open_runs

HERE = examples_dir() / "own_parts"
SHORT = ("robot=macro", "trajectory=quintic", "duration=1.0")


@pytest.fixture
def own(cli, monkeypatch):
    """Run with a part of the folder; return the stored run."""
    monkeypatch.delenv("RUNNER_PLUGINS", raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])

    def run(group, name, *overrides):
        use_plugins([f"{group}={HERE / name}.py"])
        ending = cli("--config-dir", HERE, *SHORT, f"{group}={name}", *overrides)
        assert ending.code == 0, ending.err
        return open_run(ending.folder)

    yield run
    os.environ.pop("RUNNER_PLUGINS", None)


def test_a_cable_pulls_the_arm_from_its_path(own, cli):
    error = {plant: own("environment", "cable", f"plant={plant}").metrics["max_tracking_error"].median
             for plant in ("rk4", "mujoco")}  # fmt: skip
    alone = open_run(cli(*SHORT, "plant=rk4").folder).metrics["max_tracking_error"].median
    assert error["rk4"] > 2.0 * alone
    assert error["mujoco"] == pytest.approx(error["rk4"], rel=0.05)


def test_a_cable_without_pull_changes_nothing(own, cli):
    nothing = ("environment.stiffness=0", "environment.damping=0", "environment.bending=0", "plant=rk4")
    with_cable = own("environment", "cable", *nothing).trace()
    alone = open_run(cli(*SHORT, "plant=rk4").folder).trace()
    assert np.abs(with_cable["q1"] - alone["q1"]).max() < 1e-9


def test_backlash_hides_reversals_up_to_its_play(monkeypatch):
    monkeypatch.syspath_prepend(HERE)
    module = load("noise", "backlash", "backlash")
    config = module.BacklashConfig(kind="backlash", play=0.02, resolution=1e-9, noise=0.0)
    encoders = module.build(config, ("q1",), 400, 1e-3, np.random.default_rng(0))
    t = np.arange(400) * 1e-3
    true = 0.05 * np.sin(2.0 * np.pi * t / 0.2)
    found = np.array([encoders.measure(k, true[k : k + 1], np.zeros(1))[0][0] for k in range(400)])
    assert np.abs(found - true).max() == pytest.approx(0.01, rel=1e-3)
    assert np.ptp(found[200:]) == pytest.approx(np.ptp(true) - 0.02, rel=1e-3)


def test_encoders_with_backlash_run_and_disturb(own, cli):
    law = ("controller=computed_torque", "plant=rk4")
    worse = own("noise", "backlash", *law)
    best = own("noise", "backlash", "noise.play=0", "noise.resolution=1e-9", *law)
    exact = open_run(cli(*SHORT, *law, "noise.velocity=finite_difference").folder)
    error = [run.metrics["rms_tracking_error"].median for run in (worse, best, exact)]
    assert error[0] > 2.0 * error[1]
    assert error[1] == pytest.approx(error[2], rel=1e-4)
    assert worse.config["noise"]["kind"] == "backlash"


def test_quantities_fit_the_keys_of_a_plugin(own):
    assert own("noise", "backlash", "noise.play=0.05deg").config["noise"]["play"] == pytest.approx(8.7266e-4, rel=1e-4)


def test_noise_of_a_plugin_follows_from_seed_and_repetition(own):
    run = own("noise", "backlash", "noise.noise=1e-4", "repetitions=3", "plant=rk4")
    values = run.values("rms_tracking_error")
    assert len(set(values.tolist())) == 3
    again = own("noise", "backlash", "noise.noise=1e-4", "repetitions=2", "plant=rk4")
    assert again.values("rms_tracking_error").tolist() == values[:2].tolist()


def test_a_wrist_sensor_with_crosstalk(own):
    pushed = ("environment=push", "environment.force=[0,0,5]", "environment.start_time=0", "plant=rk4", "duration=0.1")
    run = own("wrist_sensor", "crosstalk", "wrist_sensor.share=0.1", *pushed)
    load, reading = (
        run.trace()[[f"{stem}_force_{axis}" for axis in "xyz"]].to_numpy()[-1] for stem in ("load", "reading")
    )
    mixed = 0.9 * np.eye(3) + 0.1
    assert reading == pytest.approx(mixed @ load)
    assert np.abs(reading - load).max() > 0.1


def test_torques_from_motor_currents_are_what_the_observer_reads(own, cli):
    observer = (
        "controller=computed_torque", "plant=rk4", "disturbance_observer=momentum",
        "disturbance_observer.torque=measured",
    )  # fmt: skip
    sensed = ("joint_torque_sensor.constant=1", "joint_torque_sensor.resolution=0")
    right = own("joint_torque_sensor", "motor_current", *observer, *sensed).metrics["rms_tracking_error"].median
    wrong = own("joint_torque_sensor", "motor_current", *observer).metrics["rms_tracking_error"].median
    ours = open_run(cli(*SHORT, *observer, "joint_torque_sensor=ideal").folder).metrics["rms_tracking_error"].median
    assert right == pytest.approx(ours)
    assert wrong > 2.0 * right


def test_a_wrong_link_is_what_ours_is_on_an_arm_of_one_wrong_link(own, cli):
    law = ("controller=computed_torque", "plant=rk4")
    all_links = [
        own("mismatch", "one_link", *law, f"mismatch.joint={joint}", "mismatch.mass=0.8") for joint in (1, 2, 3)
    ]
    error = [run.metrics["rms_tracking_error"].median for run in all_links]
    none = open_run(cli(*SHORT, *law).folder).metrics["rms_tracking_error"].median
    whole = open_run(cli(*SHORT, *law, "mismatch.mass=0.8").folder).metrics["rms_tracking_error"].median
    assert error[0] == pytest.approx(none, rel=1e-6)  # link 1 of the Macro has no mass
    assert none < 0.1 * min(error[1:])
    assert max(error[1:]) < whole


def test_a_mismatch_of_a_plugin_is_drawn_in_each_repetition(own):
    run = own("mismatch", "one_link", "mismatch.spread=0.2", "repetitions=3", "plant=rk4")
    assert len(set(run.values("rms_tracking_error").tolist())) == 3


def test_a_sweep_keeps_runs_with_and_without_a_plugin_apart(own, cli):
    alone = own("mismatch", "one_link", "controller=computed_torque", "plant=rk4")
    ending = cli(
        "-m", "--config-dir", HERE, *SHORT, "controller=computed_torque", "plant=rk4", "mismatch=none,one_link",
        "hydra.sweeper.workers=0",
    )  # fmt: skip
    assert ending.code == 0, ending.err
    runs = open_runs(ending.folder)
    assert [run.config["mismatch"].get("kind") for run in runs] == [None, "one_link"]
    assert runs[1].hash == alone.hash
    error = [run.metrics["rms_tracking_error"].median for run in runs]
    assert error[1] > 2.0 * error[0]


def test_encoders_of_a_plugin_serve_every_loop_of_a_robot_of_several_arms(own):
    run = own("noise", "backlash", "robot=combined", "plant=rk4", "duration=0.2")
    assert run.status == "ok"


def test_a_run_with_encoders_of_a_plugin_has_no_derivatives(own, cli):
    run = own("noise", "backlash", "controller=computed_torque", "plant=rk4")
    ending = cli("sensitivity", run.folder)
    assert ending.code == 2
    assert "no derivatives of this run: noise=backlash: such parts have no compiled form" in ending.err


def test_a_calibration_takes_our_wrist_sensor_alone(cli):
    ending = cli("calibrate", "--config-dir", HERE, "wrist_sensor=crosstalk")
    assert ending.code == 2
    assert "a calibration supports only the built-in force/torque sensor; found the plug-in 'crosstalk'" in ending.err


COMMANDS = [
    line.strip().removeprefix("$ ")
    for page in sorted((HERE.parent.parent / "docs").glob("*.md"))
    for line in page.read_text(encoding="utf-8").splitlines()
    if line.strip().removeprefix("$ ").startswith("runner --plugin") and "examples/own_parts" in line
]


def test_every_part_stands_in_a_command_of_the_pages():
    assert sorted(re.findall(r"own_parts/(\w+)\.py", " ".join(COMMANDS))) == sorted(
        path.stem for path in HERE.glob("*.py")
    )


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.split("/")[2].partition(".")[0])
def test_the_commands_of_the_pages_run(cli, monkeypatch, tmp_path, command):
    monkeypatch.delenv("RUNNER_PLUGINS", raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.chdir(HERE.parent.parent)
    ending = cli(*shlex.split(command)[1:], "duration=0.1", f"outputs={tmp_path}")
    os.environ.pop("RUNNER_PLUGINS", None)
    assert ending.code == 0, ending.err
