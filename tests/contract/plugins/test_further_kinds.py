"""Further built-in kinds, made up for each registry: they act as their equals among the keys of the default kinds."""

import numpy as np
import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.controllers import CONTROLLERS
from runner.simulation.run import simulate_repetition
from tools.option_walk import judge_all
from tools.option_walk.made_up_kinds import KINDS, made_up_kinds
from tools.option_walk.scenes import SCENES
from tools.option_walk.walk import FAULTS, Step, Walk, interpreted, steps_of, unwalked

ARM = ("robot=macro", "trajectory=quintic", "trajectory.duration=0.5", "duration=0.3", "controller=computed_torque")


@pytest.fixture
def folder(tmp_path):
    with made_up_kinds(tmp_path) as own:
        yield own


@pytest.fixture
def trace(folder):
    """Simulate overrides, with the options of the made-up kinds."""

    def run(*overrides):
        return simulate_repetition(validate(compose([*ARM, *overrides], [folder])))

    return run


@pytest.mark.parametrize("plant", ["rk4", "mujoco"])
@pytest.mark.parametrize(
    ("made_up", "equal"),
    [
        ("noise=shifted", "noise.bias=0.01"),  # a config derived from that of the default kind
        ("mismatch=heavier", "mismatch.mass=1.5"),
        ("mismatch=lighter", "mismatch.mass=0.5"),
    ],
)
def test_a_further_kind_acts_as_its_equal_among_the_keys(trace, plant, made_up, equal):
    own, same, without = (trace(f"plant={plant}", *words) for words in ([made_up], [equal], []))
    np.testing.assert_allclose(own.q, same.q, rtol=0.0, atol=1e-10)
    assert np.abs(own.q - without.q).max() > 1e-4


def test_encoders_with_hysteresis_are_those_of_every_plant(trace, capsys):
    """They were ignored on rk4, and an internal error on mujoco."""
    on_rk4, on_mujoco = (trace("noise=hysteresis", *plant.split(), *SHORT) for plant in ("plant=rk4", MUJOCO))
    np.testing.assert_allclose(on_rk4.q, on_mujoco.q, atol=1e-9)
    assert np.abs(on_rk4.q - trace("plant=rk4", *SHORT).q).max() > 1e-3
    assert "noise=hysteresis: no compiled form; the control loops are interpreted" in capsys.readouterr().err


SHORT = "duration=0.1", "plant.step=0.001"  # before rounding grows
MUJOCO = "plant=mujoco plant.integrator=rk4"


def test_a_further_law_is_not_drawn_with_others(folder):
    """Its nominal models differ from repetition to repetition nevertheless."""
    config = validate(compose([*ARM, "controller=soft_pd", "plant=rk4", "mismatch=sampled"], [folder]))
    assert not CONTROLLERS.features("soft_pd").TAKES_DRAWN
    first, second = (simulate_repetition(config, repetition) for repetition in (0, 1))
    assert np.abs(first.q - second.q).max() > 1e-4


def test_a_joint_motion_of_a_further_trajectory_is_followed(trace):
    moved = trace("trajectory=swing", "plant=rk4", "duration=0.6")
    np.testing.assert_allclose(moved.q[-1] - moved.q[0], 0.05, atol=1e-4)


@pytest.mark.costs(16)
def test_no_option_is_without_effect_and_untold(folder):
    """A bounded share of `python -m tools.option_walk`."""
    options = {kind.kinds.group: kind.option for kind in KINDS}
    steps = [step for plant in ("rk4", "kinematic") for step in steps_of(f"plain{IDEAL[plant]}", plant, folder)]
    steps += steps_of("friction", "rk4", folder)
    assert {step.change for step in steps} >= {options[group] for group in ("noise", "mismatch", "plant", "trajectory")}
    judged = judge_all(steps, folder, "compiled")
    judged += judge_all(steps_of("plain", "mujoco", folder)[:8], folder, "interpreted")
    assert [str(each) for each in judged if each.verdict in FAULTS] == []


IDEAL = {"rk4": "", "kinematic": " ideal"}


@pytest.mark.bullet
@pytest.mark.costs(10)
def test_every_kind_and_key_has_a_scene_that_changes_it(monkeypatch):
    """A new kind or key needs one in `tools/option_walk/scenes.py`."""
    assert unwalked() == []
    monkeypatch.setattr("tools.option_walk.walk.SCENES", {"arm": SCENES["arm"]})
    assert {("notch", "notch.width"), ("controller whole_body", "controller.period")} < {*unwalked()}


def test_the_walk_finds_what_has_no_effect(folder, monkeypatch):
    monkeypatch.setattr("tools.option_walk.walk.EXCEPTIONS", {})
    judge = Walk(folder).judge
    assert judge(Step("arm", "rk4", "++controller.singularity_damping=0.33"))[0] == "SILENT"
    assert judge(Step("arm", "rk4", "++robot.payload.mass=1.0"))[0] == "acts"
    assert judge(Step("arm", "rk4", "++noise.velocity_bandwidth=9.0"))[0] == "reported"
    assert judge(Step("arm", "rk4", "++robot.payload.mass=-1.0"))[0] == "rejected"
    monkeypatch.setattr("tools.option_walk.walk.run_hash", lambda *_: "same")
    assert Walk(folder).judge(Step("arm", "rk4", "++robot.payload.mass=1.0"))[0] == "NOT IN THE HASH"
    with interpreted():
        monkeypatch.setattr("tools.option_walk.walk.simulate_run", lambda _: 1 / 0)
        assert judge(Step("arm", "rk4", "++robot.payload.mass=1.2"))[0] == "CRASHED"
