"""The report on what precision costs: its solutions by closed forms, and its chapters from motions of known errors."""

from argparse import Namespace
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from fixtures.studies import Made
from scipy.special import ellipk
from support.precision_runs import error
from support.study_plans import cut
from support.thin_plans import make_runs

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.papers.commands.reproduce import _chosen
from runner.papers.studies.precision import measure, tried
from runner.papers.studies.precision.exact import AdaptiveStep, Collocation, energy_drift
from runner.papers.studies.precision.figures import large_enough
from runner.papers.study.expected_caveats import unexpected_caveats
from runner.papers.study.results import MissingError
from runner.papers.study.study import load_study
from runner.plants.rk4 import Rk4
from runner.reporting.document import Table
from runner.robots.model import RobotModel
from runner.store import Run

STUDY = load_study("precision")
LENGTH, ANGLE = 0.5, 2.0  # m, rad from hanging
PENDULUM = f"""<robot name="pendulum">
  <link name="base"/>
  <link name="bob"><inertial><origin xyz="0 0 {-LENGTH}"/><mass value="2"/>
    <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="q1" type="revolute"><parent link="base"/><child link="bob"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="100" velocity="100"/></joint>
  <joint name="end" type="fixed"><origin xyz="0 0 {-LENGTH}"/><parent link="bob"/><child link="tip"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def model() -> RobotModel:
    return RobotModel(PENDULUM, "tip")


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    """Every run of the plan, off by a known error."""
    return made("precision").runs


def test_it_is_not_made_with_all_studies() -> None:
    assert "precision" not in {
        study.name for study in _chosen(Namespace(study="all", code=False, profile="", parts=())) if study is not None
    }


@pytest.mark.costs(6)
def test_the_caveats_of_whole_runs_are_expected(shared_store: Path) -> None:
    """The recorded runs are cut to a moment, in which no joint is fast."""
    largest = {}
    for name, job in STUDY.jobs().items():
        case, arm, plant, _ = name.split("/")
        if plant == measure.PLANT:
            largest.setdefault(f"{case}/{arm}", (name, job))
    runs = make_runs(shared_store, dict(largest.values()))
    assert {caveat["rule"] for run in runs.values() for caveat in run.caveats} == {"did_not_follow", "joint_speed"}
    assert unexpected_caveats(runs, STUDY.expected) == []


@pytest.mark.parametrize("way", ["adaptive", "collocation"])
def test_a_pendulum_hangs_after_a_quarter_of_its_period(model: RobotModel, way: str) -> None:
    """From rest at an angle it swings with the period 4 K(sin^2 (angle / 2)) / omega, by the elliptic integral."""
    omega = np.sqrt(9.81 / LENGTH)
    assert np.linalg.norm(model.gravity) == pytest.approx(9.81)
    quarter = float(ellipk(np.sin(0.5 * ANGLE) ** 2)) / omega
    plant = AdaptiveStep(model, quarter, 1e-15) if way == "adaptive" else Collocation(model, quarter)
    plant.reset(np.array([ANGLE]), np.zeros(1))
    plant.advance(np.zeros(1))
    assert plant.q[0] == pytest.approx(0.0, abs=1e-13)
    assert plant.dq[0] == pytest.approx(-2.0 * omega * np.sin(0.5 * ANGLE), rel=1e-13)


def test_a_held_torque_does_its_work(model: RobotModel) -> None:
    """The gain of energy is torque times way, by both methods."""
    for plant in (AdaptiveStep(model, 0.3, 1e-15), Collocation(model, 0.3)):
        plant.reset(np.array([ANGLE]), np.zeros(1))
        plant.advance(np.array([5.0]))
        q, dq = float(plant.q[0]), float(plant.dq[0])
        kinetic = 0.5 * 2.0 * (LENGTH * dq) ** 2
        potential = -2.0 * 9.81 * LENGTH * (np.cos(q) - np.cos(ANGLE))
        assert kinetic + potential == pytest.approx(5.0 * (q - ANGLE), rel=1e-12)


def test_the_drift_of_energy_is_told_over_the_largest_kinetic_energy(model: RobotModel) -> None:
    """Twice as fast at one place of two: the energy there is four times the kinetic one, and the drift its gain."""
    still, moving = np.array([[0.0], [0.0]]), np.array([[1.0], [2.0]])
    assert energy_drift(model, still, moving) == pytest.approx((4.0 - 1.0) / 4.0)
    assert energy_drift(model, still, moving[[0, 0]]) == 0.0


def test_runge_kutta_by_pinocchio_is_the_compiled_scheme(model: RobotModel) -> None:
    plants = [kind(model, 0.01, 20) for kind in (Rk4, measure.Interpreted)]
    for plant in plants:
        plant.reset(np.array([ANGLE]), np.zeros(1))
        plant.advance(np.zeros(1))
    np.testing.assert_allclose(plants[0].q, plants[1].q, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(plants[0].dq, plants[1].dq, rtol=0.0, atol=1e-12)


def test_what_is_worked_out_of_a_case_is_of_fourth_order_and_two_methods_agree() -> None:
    jobs = STUDY.jobs()
    steps = {
        step: validate(compose(cut(jobs[f"control/macro/Runge-Kutta/{step}"], 0.1))) for step in ("0.01", "0.0025")
    }
    solved = measure._solved(steps)
    assert solved["energy"] is None
    assert max(solved["apart"].values()) < 1e-13
    coarse, fine = (solved["interpreted"][step]["joints"] for step in steps)
    assert np.log(coarse / fine) / np.log(4.0) == pytest.approx(4.0, abs=0.4)
    assert set(solved["compiled_seconds"]) == set(steps)


def tried_by(errors: Mapping[float, float]) -> list[tried.SteppedPlant]:
    return [tried.SteppedPlant(step, off, off, 1.0) for step, off in errors.items()]


def test_the_order_is_the_power_between_the_two_largest_steps() -> None:
    assert tried.order(tried_by({0.08: 8.0, 0.02: 0.5, 0.01: 9.0})) == pytest.approx(2.0)
    assert tried.order(tried_by({0.08: np.nan, 0.02: 0.5})) is None


@pytest.mark.parametrize(
    ("errors", "step"),
    [
        ({0.4: 1e-3, 0.2: 5e-4, 0.1: 2.5e-4}, None),  # first order gains what it costs
        ({0.4: 1e-9, 0.1: 4e-12, 0.025: 3e-14, 0.00625: 4e-14}, 0.025),
        ({0.4: 1e-15, 0.2: 2e-15}, 0.4),
        ({0.4: np.nan, 0.2: np.nan}, 0.4),
    ],
)
def test_the_knee_is_where_the_error_no_longer_falls_in_proportion(errors: dict[float, float], step: float) -> None:
    at = tried.knee(tried_by(errors))
    assert (None if at is None else at.step) == step


def test_the_largest_step_that_does_is_found() -> None:
    steps = tried_by({0.4: 3.0, 0.2: 1.5, 0.1: 0.7})
    at = large_enough(steps, 2.0)
    assert at is not None
    assert at.step == 0.2
    assert large_enough(steps, 0.7) is None
    assert large_enough(tried_by({0.4: np.nan}), 1.0) is None


def test_errors_are_those_of_the_motions(runs: Mapping[str, Run]) -> None:
    for plant, own in (("PyBullet", "PyBullet"), (tried.COMPILED, measure.PLANT)):
        for one in tried.by_steps(runs, "control", "combined", plant):
            assert one.joints == pytest.approx(error(own, one.step), rel=1e-6, abs=1e-15)
            assert one.tip == pytest.approx(error(own, one.step), rel=1e-6, abs=1e-15)


def test_the_orders_are_those_of_the_motions(made: Callable[[str], Made]) -> None:
    section = made("precision").chapters.section("accuracy.md")
    (table,) = (block for block in section.blocks if isinstance(block, Table))
    assert len(table.lines[1:]) == 6
    for row in table.lines[1:]:
        assert [float(cell) for cell in row[2:]] == pytest.approx([1.0, 1.0, 4.0, 4.0], abs=1e-2)


def test_solutions_of_other_runs_are_refused(runs: Mapping[str, Run]) -> None:
    others = dict(runs)
    name = "free/macro/Runge-Kutta/0.008"
    others[name] = runs["control/macro/Runge-Kutta/0.01"]
    with pytest.raises(MissingError, match="not computed for these runs; runner reproduce precision does it"):
        tried.solutions(others)
