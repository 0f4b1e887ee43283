"""plant=bullet with and without PyBullet: names, bits, messages."""

import hashlib
import platform
import sys

import pytest
from support.grids import plan_sweep

from runner.assembly.validation import validate
from runner.base import engines
from runner.config.compose.compose import compose
from runner.plants import stepped_bullet
from runner.simulation.provenance import command
from runner.simulation.run import simulate_repetition
from runner.store.identity import run_hash


@pytest.fixture(params=[pytest.param(True, marks=pytest.mark.bullet), False], ids=["with PyBullet", "without"])
def installed(request, monkeypatch):
    """A machine with PyBullet, or without."""
    monkeypatch.setattr(engines, "has_pybullet", lambda: request.param)
    return request.param


@pytest.fixture
def _missing(monkeypatch):
    monkeypatch.setattr(engines, "has_pybullet", lambda: False)


def plant_of(*overrides):
    return compose(overrides).resolved["plant"]


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize("overrides", [(), ("robot=xarm7", "plant=default"), ("experiment=thesis/figure_3_5",)])
def test_the_default_plant_is_bullet(overrides):
    assert plant_of(*overrides) == plant_of(*overrides, "plant=bullet")


def test_a_sweep_composes_as_a_run_does(installed):
    grid = plan_sweep(["plant=default,rk4", "plant.step=1e-3,1e-4"])
    for cell in range(len(grid)):
        assert grid.composed(cell).resolved == compose(grid.overrides(cell)).resolved


@pytest.mark.usefixtures("installed")
def test_the_recorded_command_names_the_plant():
    recorded = {
        text: command(compose(text.split())) for text in ("robot=macro", "plant=default robot=mini", "plant=rk4")
    }
    assert recorded == {
        "robot=macro": "runner robot=macro",
        "plant=default robot=mini": "runner plant=bullet robot=mini",
        "plant=rk4": "runner plant=rk4",
    }


def names_and_bits(*overrides):
    """Return the hash of a run, and a digest of its motion."""
    config = validate(compose(overrides))
    trace = simulate_repetition(config)
    assert trace.failure is None
    motion = b"".join((part + 0.0).tobytes() for part in (trace.q, trace.dq, trace.tau))
    return run_hash(config.resolved, config.arm.urdf), hashlib.sha256(motion).hexdigest()[:16]


MOTIONS = {  # with and without PyBullet, on each Python
    ("robot=macro", "duration=0.3", "noise=thesis"): "27be37fb2dcce6f9",
    ("robot=macro", "duration=0.3", "robot.friction.coulomb=0.5"): "f82975ecb96c66dc",
    ("robot=ur5e", "duration=0.1", "controller=computed_torque"): "b3b4b964eb8ec436",
}


@pytest.mark.parametrize("overrides", MOTIONS)
def test_runs_have_their_names_and_bits_without_pybullet(overrides, monkeypatch, capsys):
    own = names_and_bits(*overrides)
    assert own[1] == MOTIONS[overrides]
    forget()
    monkeypatch.setattr(engines, "has_pybullet", lambda: False)
    monkeypatch.setitem(sys.modules, "pybullet", None)  # to import it is an error
    assert names_and_bits(*overrides) == own
    assert (
        "PyBullet is not installed: the step of plant=bullet is not compared on this machine" in capsys.readouterr().err
    )
    forget()


def forget():
    """Forget which steps were compared."""
    for known in (stepped_bullet.find_arm, stepped_bullet._tell):
        known.cache_clear()


@pytest.mark.usefixtures("_missing")
def test_a_run_without_pybullet_ends_where_pybullet_would_go_on():
    forget()
    trace = simulate_repetition(
        validate(compose(["robot=so101", "controller=held_torques", "duration=1.5", "plant=bullet"]))
    )
    assert "a joint reaches its position limit; PyBullet goes on there, but is not installed" in trace.failure.reason
    assert 0.0 < trace.failure.time < 1.5
    forget()


@pytest.mark.usefixtures("_missing")
def test_what_only_pybullet_can_do_says_what_to_do(cli, monkeypatch):
    monkeypatch.setattr(platform, "python_version_tuple", lambda: ("3", "12", "1"))
    ending = cli("robot=meca500", "plant=bullet", "environment=wall", "controller=operational_space")
    assert (ending.code, ending.out) == (2, "")
    assert ending.err.endswith(
        "plant.kind: bullet needs PyBullet for this arm, which is not installed; take plant=mujoco, or install it by "
        "`pip install pybullet`, which builds it with a C++ compiler for some minutes: Python 3.12 has no wheel "
        "of it, 3.11 has\n"
    )
    monkeypatch.setattr(platform, "python_version_tuple", lambda: ("3", "11", "7"))
    assert engines.bullet_missing().endswith("take plant=mujoco, or install it by `pip install pybullet`")


@pytest.mark.parametrize("same", [True, False])
def test_another_pybullet_names_runs_if_its_bits_differ(same, monkeypatch):
    monkeypatch.setattr(engines, "installed_versions", lambda names: {"pybullet": "9.9"})
    monkeypatch.setattr(stepped_bullet, "find_arm", lambda *_: "an arm" if same else None)
    assert stepped_bullet.bullet_versions() == {"bullet": "3.27", **({} if same else {"pybullet": "9.9"})}


def test_versions_are_those_of_what_is_installed():
    assert set(engines.installed_versions(["numpy", "no-such-library"])) == {"numpy"}
