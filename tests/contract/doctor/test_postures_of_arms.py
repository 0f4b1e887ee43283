"""What the doctor finds in the postures of an arm: largest gravity torques, and singular ones."""

import numpy as np
import pytest
from support import strangers
from support.strangers import Y, Z

from runner.doctor.postures import check_gravity, describe_singular, find_largest_gravity
from runner.robots.model import STANDARD_GRAVITY, RobotModel

LENGTH, MASS = 0.3, 2.0


def planar(links, **limits):
    """An arm upright at zero, whose horizontal outstretched posture needs the most of each joint."""
    text = strangers.chain("arm", [("revolute", Z), *links * [("revolute", Y)]], LENGTH, MASS)
    for old, new in limits.items():
        text = text.replace(f'{old}="2000"', f'{old}="{new}"')
    return RobotModel(text, "tip")


def outstretched(links):
    """Torque of each joint with its links horizontal: masses in their middles."""
    return [STANDARD_GRAVITY * MASS * LENGTH * n**2 / 2.0 for n in range(links, 0, -1)]


def samples(model, number=300):
    return np.random.default_rng(0).uniform(*model.usual_range, (number, model.nq))


@pytest.mark.parametrize("links", [2, 5, 9])
def test_the_outstretched_posture_of_a_planar_chain_is_found(links):
    model = planar(links)
    found = find_largest_gravity(model, samples(model))
    assert found[0] == pytest.approx(0.0, abs=1e-9)
    assert found[1:] == pytest.approx(outstretched(links), rel=1e-5)
    assert find_largest_gravity(model, samples(model)).tolist() == found.tolist()


def test_an_effort_between_the_samples_and_the_largest_is_named():
    whole = outstretched(9)[0]
    model = planar(9, effort=f"{0.97 * whole}")
    seen = np.abs([model.gravity_torque(q) for q in samples(model)]).max(axis=0)
    assert (seen < model.effort_limits).all()
    (finding,) = check_gravity(model, samples(model))
    assert (finding.place, finding.text) == (
        "joint 'q2'",
        f"gravity asks for {whole:.3g} N m in the worst posture found, and its effort limit is {0.97 * whole:.3g} N m",
    )


def test_limits_bound_the_search():
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Y)], LENGTH, MASS).replace(
        'lower="-2.8" upper="2.8"', 'lower="-0.2" upper="0.3"'
    )
    model = RobotModel(text, "tip")
    assert find_largest_gravity(model, samples(model, 5))[1] == pytest.approx(outstretched(1)[0] * np.sin(0.3))


def test_prismatic_joints_are_moved_to_the_end_that_needs_the_most():
    kinds = [("revolute", Y), ("prismatic", Z)]
    model = RobotModel(strangers.chain("arm", kinds, LENGTH, MASS), "tip")
    lever = MASS * LENGTH / 2.0 + MASS * (LENGTH * 1.5 + 0.4)
    assert find_largest_gravity(model, samples(model, 5)) == pytest.approx(
        [STANDARD_GRAVITY * lever, STANDARD_GRAVITY * MASS], rel=1e-5
    )


def test_the_scale_of_prismatic_joints_in_a_condition_number_is_told():
    (of_turns,) = describe_singular(planar(2), samples(planar(2)))
    assert "the Jacobian of the tip's position has a condition number above 10" in of_turns.text
    model = RobotModel(strangers.MADE["crane"], "tip")
    (of_slides,) = describe_singular(model, samples(model))
    told = f"position, with slides counted as shares of the reach, {model.reach:.3g} m, has a condition number above 10"
    assert told in of_slides.text
