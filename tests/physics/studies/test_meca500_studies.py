"""Numbers that the Meca500 report's sections compute from single runs."""

import numpy as np
import pytest
from support.thin_plans import make_runs

from runner.controllers.stability import stiffest_wall
from runner.papers.studies.meca500.figures import (
    bounces,
    displacement,
    filtered_turn,
    servo_compliance,
    speed_shares,
    stopped,
    stopped_by,
    wrenches,
)
from runner.papers.studies.meca500.frequency_response import fitted_response, sampled_frequency_response
from runner.papers.studies.meca500.plan import GRIDS, law_in
from runner.papers.studies.meca500.step_response import step
from runner.papers.study.prose.signals import highest_of, largest_of, limit_margin, norm, turns
from runner.papers.study.study import load_study

REPORTED = GRIDS.value("step", "reported")  # s, between two reports of the real controller


@pytest.fixture(scope="module")
def planned(shared_store):
    """Run a job of the plan by its name, with further overrides."""
    jobs = load_study("meca500").jobs()
    return lambda name, *overrides: make_runs(shared_store, {name: (*jobs[name], *overrides)})[name]


@pytest.mark.parametrize("axis", ["y", "rotation x"])
def test_a_step_response_is_the_analytic_one_and_a_late_load_makes_it_late(planned, axis):
    assert step(planned(f"step/kinematic, 1 ms/{axis}"))["error"] < 1e-4
    slow = step(planned(f"step/kinematic, 16.7 ms/{axis}"))["error"]
    late = step(planned(f"step/kinematic, 16.7 ms, felt late/{axis}"))["error"]
    # The steepest the answer gets is omega_n / e of its peak a second: so far it goes in a period, at most.
    assert slow < 0.01 < late < 20.0 / np.e * REPORTED


@pytest.mark.bullet
@pytest.mark.parametrize(("axis", "load"), [("x", 2.0), ("rotation z", 0.05)])
def test_servos_give_way_as_their_springs_do_at_rest(planned, axis, load):
    found = planned(f"step/servo, 1 ms/{axis}", "duration=1")
    index = 0 if axis == "x" else 5
    rest = load / law_in(found.config).stiffness[index]
    give = displacement(found)[-1, index] - rest
    assert give == pytest.approx(servo_compliance(found)[index, index] * load, rel=0.01)
    assert give > 0.05 * rest


def test_a_fitted_sine_is_the_sampled_laws_answer(planned):
    found = planned("sine/kinematic, 16.7 ms/4.0")
    expected = sampled_frequency_response(law_in(found.config), REPORTED, np.array([2.0 * np.pi * 4.0]))[0]
    np.testing.assert_allclose(fitted_response(found), expected, rtol=1e-3)


def test_a_force_through_the_tip_turns_neither_law_nor_tool(planned):
    found = planned("tip/at the tip")
    assert filtered_turn(found) < 1e-12
    turned = highest_of(norm(turns))
    assert turned(found) < 1e-9
    assert turned(planned("tip/at the flange")) > 0.01


@pytest.mark.bullet
def test_the_force_on_a_wall_is_read_true(planned):
    found = planned("wall/servos/100000")
    wall, start = found.config["environment"], found.config["trajectory"]["start"][0]
    felt = -wrenches(found, "felt")[-1, 0]
    assert felt == pytest.approx(wall["stiffness"] * (found.vector("tip")[-1, 0] - start - wall["distance"]), rel=0.01)
    assert felt > 1.0


@pytest.mark.parametrize(("share", "unstable"), [(0.9, False), (1.1, True)])
def test_contact_bounces_beyond_the_predicted_bound_alone(planned, share, unstable):
    found = planned(f"map/kinematic/{REPORTED}/{share}")
    bound = stiffest_wall(law_in(found.config), REPORTED, 0, 0.0, 0)
    assert found.config["environment"]["stiffness"] == pytest.approx(share * bound, rel=1e-4)
    assert bounces(found) is unstable


@pytest.mark.bullet
def test_the_same_orientation_is_weighed_by_reaction_and_balance(planned):
    found = planned("rest/7")
    apart = wrenches(found, "load")[1:] - wrenches(found, "reaction")[1:]
    assert np.abs(apart).max() < 1e-9


@pytest.mark.parametrize("name", ["speed_limit", "joint_limit", "out_of_reach"])
def test_no_joint_passes_a_limit_and_the_run_says_what_held_it(planned, name):
    found = planned(f"limit/{name}")
    assert limit_margin(found).min() >= 0.0
    assert largest_of(speed_shares)(found) <= 1.0 + 1e-9
    assert stopped(found)
    assert " from " in stopped_by(found)
