"""The substitute for bullet if PyBullet is not installed, and the messages about it."""

import platform

import pytest
from support.grids import plan_sweep
from support.printed import without_results

from runner.base import engines
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.validation import validate
from runner.simulation.provenance import command


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


@pytest.mark.parametrize("overrides", [(), ("robot=xarm7", "plant=default"), ("experiment=thesis/figure_3_5",)])
def test_the_default_plant_is_bullet_or_says_for_which_one_it_stands_in(installed, overrides):
    plant = plant_of(*overrides)
    if installed:
        assert plant == plant_of(*overrides, "plant=bullet")
    else:
        assert (plant["kind"], plant["integrator"], plant["step"]) == ("mujoco", "euler", None)
        assert plant == {**plant_of(*overrides, "plant=mujoco"), "in_place_of": "bullet"}


@pytest.mark.usefixtures("_missing")
def test_what_asks_for_another_plant_gets_it():
    for name in ("rk4", "kinematic", "mujoco"):
        assert plant_of(f"plant={name}")["kind"] == name
    assert plant_of("plant=mujoco")["in_place_of"] is None
    assert plant_of("robot=xarm7")["kind"] == "kinematic"  # its controller does
    assert plant_of("robot=xarm7", "plant=default")["kind"] == "mujoco"
    assert plant_of("experiment=meca500/circle")["kind"] == "mujoco"


def test_overrides_reach_the_plant_that_is_there(installed):
    plant = plant_of("plant.step=1e-4", "plant.friction.viscous=2", "plant.servo.stiffness=7")
    assert (plant["step"], plant["friction"]["viscous"], plant["servo"]["stiffness"]) == (1e-4, 2, 7)


def test_a_sweep_composes_as_a_run_does(installed):
    grid = plan_sweep(["plant=default,rk4", "plant.step=1e-3,1e-4"])
    for cell in range(len(grid)):
        assert grid.composed(cell).resolved == compose(grid.overrides(cell)).resolved


def test_the_recorded_command_names_what_stands_in(installed):
    recorded = {
        text: command(compose(text.split())) for text in ("robot=macro", "plant=default robot=mini", "plant=rk4")
    }
    assert recorded == {
        "robot=macro": "runner robot=macro" + ("" if installed else " plant=mujoco_fallback"),
        "plant=default robot=mini": f"runner plant={'bullet' if installed else 'mujoco_fallback'} robot=mini",
        "plant=rk4": "runner plant=rk4",
    }
    assert compose(["robot=mini", "plant=mujoco_fallback"]).resolved["plant"]["in_place_of"] == "bullet"


@pytest.mark.usefixtures("_missing")
def test_bullet_without_pybullet_says_what_to_do(cli, monkeypatch):
    monkeypatch.setattr(platform, "python_version_tuple", lambda: ("3", "12", "1"))
    ending = cli("plant=bullet", "noise.position=-1")
    assert (ending.code, ending.out) == (2, "")
    assert ending.err == (
        "runner: 2 problems in the config:\n"
        "  - plant.kind: bullet needs PyBullet, which is not installed; take plant=mujoco, or install it by "
        "`pip install pybullet`, which builds it with a C++ compiler for some minutes: Python 3.12 has no wheel "
        "of it, 3.11 has\n"
        "  - noise.position: must be 0 or more; found -1\n"
    )
    monkeypatch.setattr(platform, "python_version_tuple", lambda: ("3", "11", "7"))
    assert "take plant=mujoco, or install it by `pip install pybullet`\n" in cli("plant=bullet").err


def test_the_list_of_plants_says_that_bullet_is_missing(cli, installed):
    (line,) = [line for line in cli("list", "plants").out.splitlines() if line.startswith("bullet ")]
    assert ("PyBullet is not installed: " in line) != installed


@pytest.mark.usefixtures("_missing")
def test_a_sweep_over_bullet_says_so_before_anything_starts(cli):
    ending = cli("-m", "plant=rk4,bullet", "duration=0.1")
    assert (ending.code, ending.out) == (2, "")
    assert "[plant=bullet duration=0.1] plant.kind: bullet needs PyBullet" in ending.err
    assert "nothing was started" in ending.err


@pytest.mark.usefixtures("_missing")
def test_a_hint_names_no_plant_that_is_missing():
    with pytest.raises(
        ConfigError, match="take plant=mujoco or plant=rk4 or plant=rk4_flexible_links, or a controller"
    ):
        validate(compose(["plant=kinematic"]))


@pytest.mark.usefixtures("_missing")
def test_a_default_run_carries_a_caveat_and_one_that_asked_for_mujoco_none(cli):
    default, asked = cli("robot=macro"), cli("robot=macro", "plant=mujoco")
    assert (default.code, asked.code) == (0, 0)
    assert without_results(default.err) == (
        "runner: caveat: default_plant: mujoco stands in for bullet, the default plant, as PyBullet is not installed: "
        "bands and verdicts are stated for bullet\n"
    )
    assert without_results(asked.err) == ""
    assert default.folder != asked.folder
    assert without_results(cli("robot=macro", "seed=1", "caveats.default_plant.replaced=1").err) == ""


def test_versions_are_those_of_what_is_installed():
    assert set(engines.installed_versions(["numpy", "no-such-library"])) == {"numpy"}
