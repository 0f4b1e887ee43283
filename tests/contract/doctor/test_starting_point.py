"""Starting points that the doctor proposes: home, goal and gains against the model; the report on them."""

import numpy as np
import pytest
from support import strangers

from runner.assembly.versions import versions
from runner.doctor.postures import smallest_singular_values
from runner.reporting.doctor_report import doctor_document
from runner.robots.inverse_kinematics import solve_tip_position


@pytest.mark.parametrize("name", strangers.STRANGERS)
def test_home_is_inside_the_limits_regular_and_held_by_the_joints(name):
    examination = strangers.read(name)
    model, start = examination.arm.model, examination.arm.start
    assert model.limit_margins(start.home).min() > 0.0
    assert smallest_singular_values(model, start.home[None], pose=False)[0] > 0.01 * model.reach
    assert np.all(np.abs(model.gravity_torque(start.home)) < model.effort_limits)


@pytest.mark.parametrize("name", strangers.STRANGERS)
def test_the_goal_is_away_from_home_and_can_be_reached(name):
    examination = strangers.read(name)
    model, start = examination.arm.model, examination.arm.start
    way = np.linalg.norm(start.goal - model.tip_position(start.home))
    assert 0.01 * model.reach < way < 0.5 * model.reach
    q = solve_tip_position(model, start.goal, start.home)
    np.testing.assert_allclose(model.tip_position(q), start.goal, atol=1e-9)


@pytest.mark.parametrize("name", strangers.STRANGERS)
def test_gains_are_those_that_the_joints_can_bear(name):
    assert 2.0 <= strangers.read(name).arm.start.natural_frequency <= 20.0


def test_a_weak_arm_is_led_slowly():
    strong = strangers.read("crane")
    weak = strong.urdf.replace('effort="2000.0"', 'effort="120"')
    (strangers.folder() / "weak.urdf").write_text(weak)
    from runner.doctor.examination import examine

    assert (
        examine(strangers.folder() / "weak.urdf", None).arm.start.natural_frequency < strong.arm.start.natural_frequency
    )


@pytest.mark.bullet
@pytest.mark.parametrize("name", strangers.STRANGERS)
def test_the_report_is_as_recorded(name, as_recorded):
    as_recorded("reports", f"doctor on the {name}", doctor_document(strangers.read(name), versions()))
