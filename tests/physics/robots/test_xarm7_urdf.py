"""xArm7's URDF against the chain of the xArm7 report and published data."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from scipy.optimize import minimize
from support.arms import urdf_of

from runner.robots.description import find_urdf, read_urdf, with_payloads
from runner.robots.inertials import Payload
from runner.robots.model import RobotModel

EXACT = (math.hypot(0.0775, 0.3425), math.atan2(0.0775, 0.3425), math.hypot(0.076, 0.097), math.atan2(0.076, 0.097))
ROUNDED = (0.3512, 0.2225, 0.1232, 0.6646)  # as the report prints l4, theta1, l5, theta2
POSTURE = np.array([0.1, 0.75, 0.2, 1.5, -0.3, 0.75, 0.4])


@pytest.fixture(scope="module")
def urdf():
    return urdf_of("xarm7")


@pytest.fixture(scope="module")
def xarm7(urdf):
    return RobotModel(urdf, "flange")


def turn_x(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def turn_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def shift(x=0.0, z=0.0):
    pose = np.eye(4)
    pose[:3, 3] = x, 0.0, z
    return pose


def chain(q, l4, theta1, l5, theta2):
    """Return the pose of the report's frame 7, factor by factor as written there."""
    right = math.pi / 2
    factors = (
        (turn_z(q[0]), shift(z=0.267)),
        (turn_x(-right), turn_z(q[1])),
        (turn_x(right), turn_z(q[2]), shift(z=0.293)),
        (turn_x(right), shift(x=0.0525), turn_z(q[3])),
        (turn_x(right), shift(x=l4 * math.sin(theta1)), turn_z(q[4]), shift(z=l4 * math.cos(theta1))),
        (turn_x(right), turn_z(q[5])),
        (turn_x(-right), shift(x=l5 * math.sin(theta2)), turn_z(q[6]), shift(z=l5 * math.cos(theta2))),
    )
    return np.linalg.multi_dot([factor for joint in factors for factor in joint])


def within_limits(model, count):
    low, high = model.position_limits
    return np.random.default_rng(7).uniform(low, high, (count, model.nq))


def inertials(urdf):
    for link in ET.fromstring(urdf).iter("link"):
        values = {key: float(value) for key, value in link.find("inertial/inertia").attrib.items()}
        tensor = np.array(
            [
                [values["ixx"], values["ixy"], values["ixz"]],
                [values["ixy"], values["iyy"], values["iyz"]],
                [values["ixz"], values["iyz"], values["izz"]],
            ]
        )
        yield link.get("name"), float(link.find("inertial/mass").get("value")), tensor


def test_forward_kinematics_is_the_report_s_chain_with_exact_constants(xarm7):
    for q in within_limits(xarm7, 200):
        np.testing.assert_allclose(xarm7.tip_pose(q), chain(q, *EXACT), rtol=0, atol=1e-12)


def test_the_check_value_holds_to_the_rounding_of_the_report_s_constants(xarm7):
    printed = np.array([0.58447967, 0.15969098, 0.15779577])
    np.testing.assert_allclose(chain(POSTURE, *ROUNDED)[:3, 3], printed, rtol=0, atol=5e-9)
    assert np.linalg.norm(xarm7.tip_position(POSTURE) - printed) < 6.6e-5  # half a unit of the last digit of l4 and l5


def test_the_flange_at_zero_points_down(xarm7):
    pose = xarm7.tip_pose(np.zeros(7))
    np.testing.assert_allclose(pose[:3, 3], [0.206, 0.0, 0.1205], rtol=0, atol=1e-15)
    np.testing.assert_allclose(pose[:3, :3], np.diag([1.0, -1.0, -1.0]), rtol=0, atol=1e-15)


def test_masses_are_the_set_s_and_the_flange_has_none(urdf, xarm7):
    masses = {name: mass for name, mass, _ in inertials(urdf)}
    assert list(masses) == ["link_base", *(f"link{index}" for index in range(1, 8)), "flange"]
    assert xarm7.mass == pytest.approx(10.4315, abs=1e-12)  # the base does not move
    assert masses["flange"] == 0.0


def test_every_tensor_could_be_that_of_a_body(urdf):
    for name, mass, tensor in inertials(urdf):
        moments = np.linalg.eigvalsh(tensor)
        if name == "flange":
            assert not tensor.any()
            continue
        assert moments[0] > 0.0
        assert moments[2] < moments[0] + moments[1]
        assert 0.015 < math.sqrt(moments[0] / mass) < math.sqrt(moments[2] / mass) < 0.08


def test_limits_are_those_of_the_arm(xarm7):
    lower, upper = np.rad2deg(xarm7.position_limits)
    degrees = [(-360, 360), (-118, 120), (-360, 360), (-11, 225), (-360, 360), (-97, 180), (-360, 360)]
    np.testing.assert_allclose(lower, [low for low, _ in degrees], atol=1e-3)
    np.testing.assert_allclose(upper, [high for _, high in degrees], atol=1e-3)
    np.testing.assert_allclose(xarm7.velocity_limits, np.pi, atol=1e-6)
    np.testing.assert_array_equal(xarm7.effort_limits, [50, 50, 30, 30, 30, 20, 20])


def largest_gravity_torque(model, joint):
    """Return the largest gravity torque of a joint within the limits, in N m: the best of random postures, refined."""
    postures = within_limits(model, 1000)
    torques = np.abs([model.gravity_torque(q)[joint] for q in postures])
    limits = list(zip(*model.position_limits, strict=True))
    found = [
        minimize(lambda q: -(model.gravity_torque(q)[joint] ** 2), start, bounds=limits)
        for start in postures[np.argsort(-torques)[:3]]
    ]
    return math.sqrt(max(-result.fun for result in found))


@pytest.mark.parametrize(
    ("inertials", "expected"),
    [
        ("type7_HT_BR2", 32.95),
        ("type7_HT_BR", 30.04),
        ("type7_HT_LD", 33.88),
        ("type7_UJ_BR_2403", 36.88),
        ("legacy_wrong", 9.70),
    ],
)
def test_the_shoulder_carries_the_arm_with_every_set(inertials, expected):
    model = RobotModel(read_urdf(find_urdf("xarm7.urdf"), {}, inertials=inertials), "flange")
    assert largest_gravity_torque(model, 1) == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize(("joint", "expected"), [(0, 0.0), (2, 15.81), (3, 12.71), (4, 1.14), (5, 1.13), (6, 0.011)])
def test_the_other_joints_carry_the_arm(xarm7, joint, expected):
    torque = largest_gravity_torque(xarm7, joint)
    assert torque == pytest.approx(expected, abs=0.01)
    assert torque < 0.66 * xarm7.effort_limits[joint]


@pytest.mark.parametrize(("joint", "expected"), [(1, 59.4), (2, 33.8), (3, 28.9)])
def test_the_rated_payload_is_more_than_the_efforts_hold_when_stretched(joint, expected):
    loaded = with_payloads(read_urdf(find_urdf("xarm7.urdf"), {}), [Payload("flange", 3.5, (0.0, 0.0, 0.0))])
    model = RobotModel(loaded, "flange")
    torque = largest_gravity_torque(model, joint)
    assert torque == pytest.approx(expected, abs=0.05)
    assert (torque > model.effort_limits[joint]) == (joint != 3)


@pytest.mark.parametrize("inertials", ["type7_HT_BR", "type7_HT_LD", "type7_UJ_BR_2403", "legacy_wrong"])
def test_every_tensor_of_the_other_sets_could_be_that_of_a_body(inertials):
    model = RobotModel(read_urdf(find_urdf("xarm7.urdf"), {}, inertials=inertials), "flange")
    for inertia in list(model.pin_model.inertias)[1:]:
        moments = np.linalg.eigvalsh(inertia.inertia)
        assert moments[0] > 0.0
        assert moments[2] < moments[0] + moments[1]


@pytest.mark.parametrize(
    ("inertials", "mass"),
    [("type7_HT_BR", 9.5454), ("type7_HT_LD", 10.7234), ("type7_UJ_BR_2403", 11.7844), ("legacy_wrong", 2.76914)],
)
def test_the_other_sets_weigh_what_their_source_says(inertials, mass):
    model = RobotModel(read_urdf(find_urdf("xarm7.urdf"), {}, inertials=inertials), "flange")
    assert model.mass == pytest.approx(mass, abs=1e-12)


def test_shapes_are_primitives(urdf):
    geometries = {shape.tag for geometry in ET.fromstring(urdf).iter("geometry") for shape in geometry}
    assert geometries == {"cylinder"}
    assert not list(ET.fromstring(urdf).iter("collision"))
