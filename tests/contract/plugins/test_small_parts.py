"""The smallest part of each group, in examples/small_parts: each changes a run, a report or a calibration."""

import os
import sys

import numpy as np
import pytest
import yaml

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.paths import examples_dir
from runner.config.compose.compose import compose
from runner.plugins.discovery import GROUPS, use_plugins
from runner.reporting.document import Curves
from runner.reporting.run_report import run_document
from runner.reporting.sweep.report import sweep_document
from runner.simulation.run import simulate_repetition
from runner.store import open_run, open_sweep

HERE = examples_dir() / "small_parts"
PAGE = examples_dir().parent / "docs" / "plugins.md"
LONGEST = 25  # lines with text
ARM = ("robot=macro", "trajectory=quintic", "controller=computed_torque", "plant=rk4", "duration=0.1")
TORQUES = ("disturbance_observer=momentum", "disturbance_observer.torque=measured", "joint_torque_sensor=ideal")
PUSHED = (*ARM, "environment=push", "environment.start_time=0.01")
PARTS = {
    "controller": ("tip_spring", ARM),
    "endpoint_sensor": ("shifted_camera", ("robot=macro", "trajectory=quintic", "plant=rk4", "duration=0.1")),
    "environment": ("water", ARM),
    "joint_torque_sensor": ("noisy_torque", (*ARM, *TORQUES)),
    "mismatch": ("heavy", ARM),
    "noise": ("zero_offset", ARM),
    "plant": ("euler", ARM),
    "trajectory": ("rise", ARM),
    "wrist_sensor": ("weak_gauge", PUSHED),
}
"""A part of each group of configs, and the run that it changes."""
OTHERS = {"calibration": "flange_position", "metric": "path_length", "section": "shares"}


@pytest.fixture
def use(monkeypatch):
    """Use a part of the folder."""
    monkeypatch.delenv("RUNNER_PLUGINS", raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield lambda group, name: use_plugins([f"{group}={HERE / name}.py"])
    os.environ.pop("RUNNER_PLUGINS", None)


def test_every_group_has_a_short_part():
    names = {group: name for group, (name, _) in PARTS.items()} | OTHERS
    assert sorted(names) == sorted(GROUPS)
    assert sorted(names.values()) == sorted(path.stem for path in HERE.glob("*.py"))
    lengths = {path.name: sum(map(bool, path.read_text().split("\n"))) for path in HERE.glob("*.py")}
    assert {name: length for name, length in lengths.items() if length > LONGEST} == {}
    chosen = {path.parent.name: yaml.safe_load(path.read_text())["kind"] for path in HERE.rglob("*.yaml")}
    assert chosen == {group: name for group, name in names.items() if group not in ("metric", "section")}


@pytest.mark.parametrize("group", PARTS)
def test_a_part_changes_the_trace(use, group):
    name, run = PARTS[group]
    without = simulate_repetition(validate(compose(run)))
    use(group, name)
    trace = simulate_repetition(validate(compose([*run, f"{group}={name}"], [HERE])))
    assert trace.failure is None
    assert np.abs(signal(group, trace) - signal(group, without)).max() > 1e-9


def signal(group, trace):
    """Return the signal that a part changes: the motion, or the readings that no law of the run uses."""
    return trace.contact.reading if group == "wrist_sensor" else trace.q


def test_a_law_that_reads_the_wrist_sensor_takes_that_of_a_plug_in_by_overrides(use):
    use("wrist_sensor", "weak_gauge")
    law = ("robot=meca500", "trajectory=quintic", "controller=admittance", "wrist_sensor=weak_gauge")
    with pytest.raises(ConfigError, match=r"controller\.sensor\.kind: found 'weak_gauge'; allowed: force_torque"):
        validate(compose(law, [HERE]))
    line = next(line for line in PAGE.read_text().splitlines() if "wrist_sensor@controller.sensor" in line)
    config = validate(compose([key.strip("'") for key in line.split() if "controller.sensor" in key] + [*law], [HERE]))
    assert (config.wrist_sensor.kind, config.controller.sensor.kind) == ("weak_gauge", "force_torque")


def test_a_metric_is_in_the_record(use, cli):
    use("metric", "path_length")
    assert open_run(cli(*ARM).folder).metrics["path_length"].median > 0.0


def test_a_section_is_in_the_report_on_a_run(use, cli):
    run = open_run(cli(*ARM).folder)
    titles = [section.title for section in run_document(run).sections]
    use("section", "shares")
    first, added, *others = run_document(run).sections
    assert [first.title, *(section.title for section in others)] == titles
    (figure,) = added.blocks
    assert isinstance(figure, Curves)
    assert [series.name for series in figure.panels[0].series] == ["joint 1", "joint 2", "joint 3"]


def test_a_section_is_in_the_report_on_a_sweep(use, sweep12):
    before = sweep_document(sweep12)
    use("section", "shares")
    document = sweep_document(open_sweep(sweep12.folder))
    assert len(document.sections) == len(before.sections) + 1
    assert document.shown == before.shown + 1
    added = document.sections[before.shown]
    assert added.title == "Shares"
    (curve,) = added.blocks[0].panels[0].series
    assert curve.x.size >= 12
    assert (np.diff(curve.x) >= 0.0).all()


def test_a_calibration_is_judged(use, cli):
    use("calibration", "flange_position")
    ending = cli("calibrate", "--config-dir", HERE, "calibration=flange_position", "repetitions=3")
    assert ending.code == 0, ending.err
    assert [line.split()[0] for line in ending.out.splitlines()[1:4]] == ["x", "y", "z"]
