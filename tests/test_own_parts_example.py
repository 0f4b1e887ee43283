"""The parts in examples/own_parts, used from outside as their pages say."""

import os
import sys

import numpy as np
import pytest

from runner.paths import examples_dir
from runner.plugins import use_plugins
from runner.store import open_run

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
    error = {plant: own("environment", "cable", f"plant={plant}").metrics["max_tracking_error"]["median"]
             for plant in ("rk4", "mujoco")}  # fmt: skip
    alone = open_run(cli(*SHORT, "plant=rk4").folder).metrics["max_tracking_error"]["median"]
    assert error["rk4"] > 2.0 * alone
    assert error["mujoco"] == pytest.approx(error["rk4"], rel=0.05)


def test_a_cable_without_pull_changes_nothing(own, cli):
    nothing = ("environment.stiffness=0", "environment.damping=0", "environment.bending=0", "plant=rk4")
    with_cable = own("environment", "cable", *nothing).trace
    alone = open_run(cli(*SHORT, "plant=rk4").folder).trace
    assert np.abs(with_cable["q1"] - alone["q1"]).max() < 1e-9
