"""The report on three engines: what it compares and concludes, against closed forms."""

import math
from argparse import Namespace
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from fixtures.studies import Made

pytest.importorskip("pybullet", reason="PyBullet is not installed")

from runner.papers.commands.reproduce import _chosen
from runner.papers.studies.engines import contact, same_arm
from runner.plants.compiled_motion import CompiledStep
from runner.plants.mujoco import Mujoco
from runner.store import Run


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    return made("engines").runs


def test_it_is_not_made_with_all_studies() -> None:
    names = {
        study.name for study in _chosen(Namespace(study="all", code=False, profile="", parts=())) if study is not None
    }
    assert names == {"thesis", "thesis_beyond", "xarm7", "meca500"}


def test_the_textbooks_mass_matrix_is_that_of_its_kinetic_energy(runs: Mapping[str, Run]) -> None:
    """The energy of the two cylinders, from the velocities of their middles."""
    rng = np.random.default_rng(3)
    for q, dq in rng.uniform(-1.0, 1.0, (10, 2, 2)):
        inertia = (3.0 * 0.03**2 + 1.0) / 12.0
        upper = 0.5 * dq[0] * np.array([-math.sin(q[0]), math.cos(q[0])])
        turn = q[0] + q[1]
        lower = 2.0 * upper + 0.5 * dq.sum() * np.array([-math.sin(turn), math.cos(turn)])
        energy = 0.5 * (upper @ upper + lower @ lower + inertia * (dq[0] ** 2 + dq.sum() ** 2))
        assert 0.5 * dq @ same_arm._two_links(q[1]) @ dq == pytest.approx(energy, rel=1e-12)


def test_a_changed_arm_is_found_to_be_another(runs: Mapping[str, Run]) -> None:
    """The comparison distinguishes an engine with another mass from Pinocchio."""
    run = runs["open/planar/MuJoCo Euler/0.001"]
    heavier = run.urdf.replace('<mass value="1.0"', '<mass value="1.001"', 1)
    assert heavier != run.urdf
    least = run.config["plant"]["min_inertia"]
    other = Mujoco(heavier, run.model, 1e-3, 1, "euler", least)
    off = same_arm.difference(run.model, other)
    assert min(off.values()) > 1e-5
    own = same_arm.difference(run.model, same_arm.mujoco_of(run))
    assert max(own.values()) < 1e-12


def test_the_compiled_step_is_compared_with_the_classical_step(runs: Mapping[str, Run]) -> None:
    """They agree to rounding; with another step of the compiled code they do not."""
    model = runs["open/planar/MuJoCo Euler/0.001"].model
    compiled, longer = (CompiledStep(model, step) for step in (same_arm.STEP, 1.01 * same_arm.STEP))
    for state in same_arm.random_states(model)[:5]:
        assert same_arm._step_difference(model, compiled, *state) < 1e-12
        assert same_arm._step_difference(model, longer, *state) > 1e-4


def test_the_closed_form_of_the_impact_is_the_solution_of_its_equation(runs: Mapping[str, Run]) -> None:
    """A head of 1 kg under 10 N, from rest 0.05 m before the wall, by steps far below what any plant takes."""
    x, v, h, peak = -0.05, 0.0, 1e-6, 0.0
    while v >= 0.0:
        v += h * (10.0 - (1e4 * x if x > 0.0 else 0.0))
        x += h * v
        peak = max(peak, 1e4 * x)
    assert contact.closed_form_peak(runs["impact/PyBullet/0.001"]) == pytest.approx(peak, rel=1e-4)
