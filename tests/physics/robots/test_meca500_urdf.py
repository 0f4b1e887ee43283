"""Meca500's URDF against the report's table, in the modified convention, and published data."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from runner.papers.studies.meca500.equations.derivations import meca500 as report
from runner.robots.description import find_urdf, read_urdf, with_payloads
from runner.robots.inertials import Payload
from runner.robots.model import RobotModel

TABLE = [replace(row, a=row.a / 1000.0, d=row.d / 1000.0) for row in report.TABLE]  # in m


def modified_frames(rows, q):
    """Return frames 1 to n in frame 0 at joint positions q, shape (n, 4, 4)."""
    return np.array([frame[0] for frame in report.frames(q[None], rows)])


def model_of(inertials=None, payload=None):
    payloads = [] if payload is None else [payload]
    return RobotModel(with_payloads(read_urdf(find_urdf("meca500.urdf"), {}, inertials=inertials), payloads), "flange")


@pytest.fixture(scope="module")
def meca500():
    return model_of()


def within_limits(model, count):
    lower, upper = np.clip(model.position_limits, -np.pi, np.pi)
    return np.random.default_rng(5).uniform(lower, upper, (count, model.nq))


def test_the_table_s_frame_6_is_the_flange(meca500):
    for q in within_limits(meca500, 500):
        np.testing.assert_allclose(modified_frames(TABLE, q)[-1], meca500.tip_pose(q), rtol=0, atol=1e-14)


def test_check_values():
    zero = modified_frames(TABLE, np.zeros(6))[-1]
    np.testing.assert_allclose(zero[:3, 3], [0.190, 0.0, 0.308], rtol=0, atol=1e-15)
    np.testing.assert_allclose(zero[:3, :3], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], rtol=0, atol=1e-15)
    position = modified_frames(TABLE, np.array([0.1, 0.2, -0.3, 0.4, 0.5, -0.6]))[-1][:3, 3]
    np.testing.assert_allclose(position, [0.204299956, 0.033632783, 0.292475814], rtol=0, atol=5e-10)


def test_without_the_lost_turn_of_joint_2_the_tip_is_a_third_of_a_metre_off(meca500):
    turned = (TABLE[0], report.ModifiedRow(TABLE[1].alpha, TABLE[1].a, 0.0, TABLE[1].d), *TABLE[2:])
    off = [
        np.linalg.norm(modified_frames(turned, q)[-1][:3, 3] - meca500.tip_position(q))
        for q in within_limits(meca500, 2000)
    ]
    assert np.mean(off) == pytest.approx(0.34, abs=0.01)


def test_a_modified_step_is_the_product_of_its_elementary_ones():
    alpha, a, theta, d, q = 0.3, 0.2, -0.5, 0.7, 1.1
    c, s = np.cos(alpha), np.sin(alpha)
    first = np.array([[1, 0, 0, a], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])
    c, s = np.cos(theta + q), np.sin(theta + q)
    second = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
    (found,) = report.row_transform(report.ModifiedRow(alpha, a, theta, d), np.array([q]))
    np.testing.assert_allclose(found, first @ second, atol=1e-15)


def modified_jacobian(rows, q):
    """Return the geometric Jacobian of frame n in frame 0, shape (6, n): J_i = [z_i x (p_n - p_i); z_i]."""
    poses = modified_frames(rows, q)
    z, p = poses[:, :3, 2], poses[:, :3, 3]
    return np.vstack([np.cross(z, p[-1] - p).T, z.T])


def test_the_table_s_jacobian_is_the_model_s(meca500):
    for q in within_limits(meca500, 100):
        J, rotation = modified_jacobian(TABLE, q), modified_frames(TABLE, q)[-1][:3, :3]
        np.testing.assert_allclose(J, meca500.tip_jacobian(q), rtol=0, atol=1e-14)
        np.testing.assert_allclose(J[3:, 5], rotation[:, 2], rtol=0, atol=1e-15)  # joint 6 turns about z_6


@pytest.mark.parametrize("seed", range(3))
def test_the_jacobian_of_any_table_by_finite_differences(seed):
    generator, h = np.random.default_rng(seed), 1e-6
    rows = [report.ModifiedRow(*generator.uniform(-1.0, 1.0, 4)) for _ in range(5)]
    q = generator.uniform(-3.0, 3.0, 5)
    J, pose = modified_jacobian(rows, q), modified_frames(rows, q)[-1]
    for joint, e in enumerate(np.eye(5)):
        rate = (modified_frames(rows, q + h * e)[-1] - modified_frames(rows, q - h * e)[-1]) / (2.0 * h)
        skew = rate[:3, :3] @ pose[:3, :3].T
        np.testing.assert_allclose(J[:, joint], [*rate[:3, 3], skew[2, 1], skew[0, 2], skew[1, 0]], atol=1e-9)


def test_limits_are_those_of_the_arm(meca500):
    lower, upper = np.rad2deg(meca500.position_limits)
    np.testing.assert_allclose(lower, [-175, -70, -135, -170, -115, -36000], atol=1e-4)
    np.testing.assert_allclose(upper, [175, 90, 70, 170, 115, 36000], atol=1e-4)
    np.testing.assert_allclose(np.rad2deg(meca500.velocity_limits), [150, 150, 180, 300, 300, 500], atol=1e-4)
    np.testing.assert_array_equal(meca500.effort_limits, [8.4, 8.4, 8.4, 1.25, 1.25, 0.75])


@pytest.mark.parametrize(
    ("inertials", "payload", "expected"),
    [
        ("cad_closed", 0.0, [0.0, 3.87, 1.13, 0.14, 0.14, 0.0]),
        ("cad_closed", 0.5, [0.0, 5.64, 2.24, 0.63, 0.63, 0.0]),
        ("uniform_density", 0.0, [0.0, 3.42]),
        ("uniform_density", 0.5, [0.0, 5.18]),
    ],
)
def test_the_largest_gravity_torques(inertials, payload, expected):
    model = model_of(inertials, Payload("flange", payload, (0.0, 0.0, 0.03)))
    postures = within_limits(model, 1000)
    torques = np.abs([model.gravity_torque(q) for q in postures])
    for joint, value in enumerate(expected):
        starts = postures[np.argsort(-torques[:, joint])[:3]]
        limits = list(zip(*np.clip(model.position_limits, -np.pi, np.pi), strict=True))
        found = [
            minimize(lambda q, j=joint: -(model.gravity_torque(q)[j] ** 2), start, bounds=limits) for start in starts
        ]
        assert np.sqrt(max(-result.fun for result in found)) == pytest.approx(value, abs=0.006)


def test_the_sets_differ_by_the_uncertainty_that_is_stated():
    cad, uniform = (list(model_of(name).pin_model.inertias)[1:] for name in ("cad_closed", "uniform_density"))
    larger = [abs(a.mass - b.mass) / max(a.mass, b.mass) for a, b in zip(cad[:5], uniform[:5], strict=True)]
    apart = [np.linalg.norm(a.lever - b.lever) for a, b in zip(cad, uniform, strict=True)]
    assert max(larger) < 0.35
    assert max(larger) > 0.2
    assert max(apart) == pytest.approx(9.0e-3, abs=0.1e-3)


@pytest.mark.parametrize("inertials", ["cad_closed", "uniform_density"])
def test_every_tensor_could_be_that_of_a_body(inertials):
    for inertia in list(model_of(inertials).pin_model.inertias)[1:]:
        moments = np.linalg.eigvalsh(inertia.inertia)
        assert moments[0] > 0.0
        assert moments[2] < moments[0] + moments[1]


def test_the_arm_weighs_4_6_kg_with_its_base():
    for inertials in ("cad_closed", "uniform_density"):
        text = read_urdf(find_urdf("meca500.urdf"), {}, inertials=inertials)
        masses = [float(mass.get("value")) for mass in ET.fromstring(text).iter("mass")]
        assert sum(masses) == pytest.approx(4.6, abs=1e-6)


def test_shapes_are_primitives():
    root = ET.fromstring(find_urdf("meca500.urdf").read_text())
    assert {shape.tag for geometry in root.iter("geometry") for shape in geometry} == {"cylinder"}
    assert not list(root.iter("collision"))
