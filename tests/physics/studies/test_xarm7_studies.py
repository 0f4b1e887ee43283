"""Studies on the xArm7: runs of the plan against closed forms."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.study_plans import xarm7_studies
from support.thin_plans import make_runs

from runner.papers.studies.xarm7.figures import ROWS, drifts, first_saturation, lag, sag
from runner.papers.studies.xarm7.kinematics import random_postures
from runner.papers.studies.xarm7.null_space import between_commands
from runner.papers.studies.xarm7.payload import largest_payloads, lost_when, stretched
from runner.papers.studies.xarm7.why_it_failed import invert, jacobians
from runner.papers.study.prose.signals import largest_of, moved, norm, vector
from runner.store import Run
from runner.sweeps.job import run

NULL_SPACE_BOUND, TORQUE_BOUND = 1e-6, 1e-4  # m
Make = Callable[[str], Run]


@pytest.fixture(scope="module")
def planned(shared_store: Path) -> Make:
    """Return a run of the plan by its name."""
    return lambda name: make_runs(shared_store, {name: xarm7_studies()[name]})[name]


def test_the_printed_inverse_has_nothing_to_invert_and_the_right_one_is_right(xarm7: Any) -> None:
    J = np.array([xarm7.model.tip_jacobian(q) for q in random_postures(xarm7.model, 200)])
    for rows in ROWS.values():
        result = invert(J[:, :rows])
        assert (result["ranks"] == rows).all()
        assert result["right"].max() < 1e-9
        assert (result["offs"] > 1e-3).all()


def test_of_a_tall_matrix_the_printed_inverse_is_right() -> None:
    tall = np.random.default_rng(1).normal(size=(5, 7, 3))
    for J in tall:
        np.testing.assert_allclose(np.linalg.inv(J.T @ J) @ J.T, np.linalg.pinv(J), atol=1e-12)


def test_equal_columns_get_equal_speeds(planned: Make) -> None:
    """Columns 1 and 2 of the printed Jacobian are one and the same, so its shortest motion shares between them."""
    trace = planned("printed/position/columns alone").trace()
    np.testing.assert_allclose(trace["dq1"], trace["dq2"], atol=1e-12)
    assert trace["dq1"].abs().max() > 0.01


def test_the_last_true_column_is_missing(xarm7: Any) -> None:
    postures = random_postures(xarm7.model, 50)
    true, printed = (jacobians(xarm7.model, postures, shifted, False) for shifted in (False, True))
    distance = np.linalg.norm(printed - true[:, :, 6:], axis=1).min(axis=1)
    assert (distance > 1e-3).all()


def test_the_tip_stands_still_at_1_rad_per_s_by_rk4_alone(planned: Make) -> None:
    fastest = {rule: planned(f"null_space/{rule}/1.0") for rule in ("euler", "midpoint", "rk4")}
    way = norm(moved(vector("tip")))
    moved_by = {rule: largest_of(way)(run) or 0.0 for rule, run in fastest.items()}
    assert moved_by["rk4"] < NULL_SPACE_BOUND < moved_by["midpoint"] < moved_by["euler"]
    assert fastest["rk4"].metrics["peak_joint_speed"].median == pytest.approx(1.0, abs=1e-3)


def test_between_commands_the_tip_bulges_with_the_square_of_the_period(planned: Make) -> None:
    slow, fast = (between_commands(planned(name)) for name in ("null_space/rk4/1.0", "null_space/fastest rate"))
    assert slow is not None
    assert fast is not None
    assert slow / fast == pytest.approx(2.5**2, rel=0.02)


def test_the_shortest_motion_drifts_around_a_circle_and_not_along_a_line(planned: Make) -> None:
    circle, line = (drifts(planned(f"cycles/{path}/none")) for path in ("circle", "line"))
    assert (circle > 1e-2).all()
    assert line.max() < 1e-2 * circle.min()
    assert (line[1:] < 1e-6).all()  # the first cycle begins without the error that the others carry
    assert drifts(planned("cycles/circle/posture"))[-1] < 1e-12


@pytest.mark.parametrize("rate", [25, 100])
def test_the_lag_is_the_closed_form(planned: Make, rate: int) -> None:
    run = planned(f"rates/kinematic/as_reported/{rate}")
    assert run.metrics["max_axis_error"].median == pytest.approx(lag(run, rate), rel=2e-3)


def test_the_sag_is_the_closed_form_where_the_servo_is_stiff(planned: Make) -> None:
    stiff = planned("stiffness/7500/false/commanded")
    error = float(np.abs(stiff.trace()[["error_x", "error_y", "error_z"]].to_numpy()[-1]).max())
    assert error == pytest.approx(sag(stiff), rel=0.02)


def test_a_payload_meets_each_limit_where_the_torque_is_the_limit() -> None:
    torque = np.array([[10.0, -5.0, 1.0], [20.0, -8.0, 1.0]])
    added = np.array([[4.0, -1.0, 0.0], [5.0, -2.0, 0.0]])
    masses = largest_payloads(torque, added, np.array([50.0, 20.0, 5.0]))
    np.testing.assert_allclose(masses, [6.0, 6.0, np.inf])


def test_the_torques_asked_for_are_linear_in_the_payload(planned: Make) -> None:
    names = [f"tau{joint}" for joint in range(1, 8)]
    light, heavy = (planned(f"payload/0.643/asked/{mass}").trace()[names].to_numpy() for mass in (0, 5))
    outputs = planned("payload/0.643/asked/0").folder.parent.parent
    between = run(*xarm7_studies()["payload/0.643/asked/0"][:-1], "robot.payload.mass=2", f"outputs={outputs}")
    np.testing.assert_allclose(between.trace()[names].to_numpy(), light + 0.4 * (heavy - light), atol=1e-9)


def test_stretched_out_the_arm_is_as_long_as_its_links(planned: Make) -> None:
    """Shoulder to elbow, elbow to wrist, wrist to flange: the limits allow all three to point the same way."""
    links = ((0.293, 0.0525), (0.0775, 0.3425), (0.076, 0.097))  # m, offsets along and across each
    assert stretched(planned("payload/0.643/asked/0"))[0] == pytest.approx(
        sum(np.hypot(*link) for link in links), abs=1e-9
    )


def test_stretched_out_the_shoulder_holds_what_balances_about_its_axis(planned: Make, xarm7: Any) -> None:
    """Its limit less the payload's moment is the arm's own weight's, larger than in any other posture."""
    distance, payloads = stretched(planned("payload/0.643/asked/0"))
    own = xarm7.model.effort_limits[1] - 9.81 * payloads[1] * distance
    heaviest = max(abs(xarm7.model.gravity_torque(q)[1]) for q in random_postures(xarm7.model, 1000))
    assert own == pytest.approx(heaviest, rel=0.1)
    assert own > heaviest


@pytest.mark.costs(2)
def test_the_printed_line_takes_3_kg_and_not_the_rated_payload(planned: Make) -> None:
    held, lost = (planned(f"payload/0.643/{mass}") for mass in ("3", "3.5"))
    assert (lost_when(held), first_saturation(held)) == ("not lost", None)
    saturated = first_saturation(lost)
    assert saturated is not None
    assert saturated[0] == 1  # the shoulder
    assert float(lost_when(lost)) > saturated[1]


@pytest.mark.bullet  # which goes on beyond joint limits
@pytest.mark.parametrize("law", ["operational_space", "computed_torque"])
def test_the_torque_laws_hold_the_line_without_load_and_lose_it_above_what_the_shoulder_holds(
    planned: Make, law: str
) -> None:
    unloaded = planned(f"torque/{law}/0")
    assert unloaded.metrics["max_axis_error"].median < TORQUE_BOUND
    assert first_saturation(unloaded) is None
    assert planned(f"torque/{law}/3.5").metrics["max_axis_error"].median > TORQUE_BOUND
