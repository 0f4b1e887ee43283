"""Calibrations in the Meca500 report: their tables, and what they compute themselves, against closed forms."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.study_sections import blocks

from runner.calibration.gravity import REST, GravityCalibration, Tool, WrenchCompensation
from runner.calibration.tool_centre_point import identify_tool_centre_point
from runner.papers.studies.meca500.figures import error, predicted
from runner.papers.studies.meca500.gravity import exact_readings, force_step, swapped_moment_step
from runner.papers.studies.meca500.tool_centre_point import common_point_covariance, independent_rows_covariance
from runner.papers.study.measured import Finding
from runner.papers.study.prose.signals import exponent, setting
from runner.reporting.document import Curves, Table

pytestmark = pytest.mark.bullet  # its study has walls and tools on the default plant
GRAVITY = 9.81
PARAMETERS = np.array([0.25, 0.3, 0.01, -0.003, 0.028, 0.4, -0.3, 0.8, 0.01, -0.02, 0.005])
ORIENTATIONS = Rotation.random(12, rng=np.random.default_rng(3)).as_matrix()


@pytest.fixture
def calibrations(made):
    """Every calibration of the plan, with few repetitions."""
    return made("meca500").calibrations


@pytest.fixture
def sections(made):
    names = ("tool_centre_point", "tool_direction", "gravity")
    return tuple(made("meca500").chapters.section(f"{name}.md") for name in names)


def table(section, caption):
    return next(block for block in blocks(section) if isinstance(block, Table) and block.caption.startswith(caption))


def test_every_table_and_figure_carries_its_command(sections):
    for section in sections:
        for block in blocks(section):
            if isinstance(block, Curves | Table):
                assert block.origin.command.startswith("runner ")


def test_the_level_of_the_base_case_is_the_base_case(calibrations):
    base = calibrations["tool_centre_point/base"].hash
    assert calibrations["tool_centre_point/poses/4"].hash == base
    assert calibrations["tool_centre_point/poses/6"].hash != base
    assert len({done.config["seed"] for done in calibrations.values()}) == len({d.hash for d in calibrations.values()})


def test_without_noise_errors_are_rounding(calibrations):
    for name in ("tool_centre_point/repeatability/0", "tool_direction/repeatability/0", "gravity/noise/0"):
        assert error()(calibrations[name]) < 1e-9
        assert predicted()(calibrations[name]) == 0.0


def test_the_tip_s_error_is_proportional_to_the_repeatability(calibrations):
    done = [calibrations[f"tool_centre_point/repeatability/{level}"] for level in ("1e-06", "2e-05", "0.0001")]
    assert exponent(setting("calibration.repeatability"), predicted())(*done) == pytest.approx(1.0, abs=1e-3)


def test_averaging_readings_makes_the_error_smaller_by_the_root(calibrations):
    done = [calibrations[f"gravity/samples/{count}"] for count in (1, 10, 100)]
    assert exponent(setting("calibration.samples"), predicted("mass"))(*done) == pytest.approx(-0.5, abs=0.01)


def test_each_calibration_with_an_error_is_counted_once(calibrations, sections):
    kinds = {name.partition("/")[0]: set() for name in calibrations}
    for name, done in calibrations.items():
        if done.consistency is not None:
            kinds[name.partition("/")[0]].add(done.hash)
    told = [block.conditions[1].measured for section in sections for block in blocks(section)
            if isinstance(block, Finding) and block.claim == "Errors are as large as predicted"]  # fmt: skip
    assert [re.search(r"calibrations: (\d+)", text)[1] for text in told] == [
        str(len(kinds[kind])) for kind in ("tool_centre_point", "tool_direction", "gravity")
    ]


def half_turns():
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, :3, :3] = [np.eye(3), np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, 1.0, -1.0]), np.diag([-1.0, -1.0, 1.0])]
    return poses


def test_covariances_by_hand_for_half_turns():
    tips = np.tile(1e-10 * np.eye(3), (4, 1, 1))
    # A'A is 8 along each axis: two of three rows hold a difference of 2.
    np.testing.assert_allclose(independent_rows_covariance(half_turns(), tips), 2e-10 / 8.0 * np.eye(3), atol=1e-25)
    # Along x the tips of poses 1, 2 less those of 3, 4 are 4 x: four independent errors over 4.
    np.testing.assert_allclose(common_point_covariance(half_turns(), tips), 4e-10 / 16.0 * np.eye(3), atol=1e-25)


def test_no_pose_singled_out_is_never_worse():
    rng = np.random.default_rng(5)
    poses = np.tile(np.eye(4), (10, 1, 1))
    poses[:, :3, :3] = Rotation.random(10, rng=rng).as_matrix()
    covariances = np.zeros((10, 6, 6))
    covariances[:, :3, :3] = 1e-10 * np.eye(3)
    first = identify_tool_centre_point(poses, covariances).covariance
    assert np.linalg.eigvalsh(first - common_point_covariance(poses, covariances[:, :3, :3])).min() > 0.0


def test_exact_readings_are_what_compensation_takes_off():
    readings = exact_readings(PARAMETERS, ORIENTATIONS, GRAVITY)
    mass, theta, centre, force, moment = PARAMETERS[0], PARAMETERS[1], *np.split(PARAMETERS[2:], 3)
    known = GravityCalibration(mass, theta, centre, force, moment, np.zeros((11, 11)), (1.0, 1.0))
    compensation = WrenchCompensation(known, np.zeros((3, 3)), GRAVITY)
    left = [compensation.external(reading, R, REST) for reading, R in zip(readings, ORIENTATIONS, strict=True)]
    np.testing.assert_allclose(left, np.zeros((12, 6)), atol=1e-14)
    upright = Tool(mass, centre, np.zeros((3, 3))).load(np.array([0.0, 0.0, -GRAVITY]), REST) + PARAMETERS[5:]
    np.testing.assert_allclose(exact_readings(PARAMETERS, np.eye(3)[None], GRAVITY)[0], upright, atol=1e-15)


def test_the_third_row_gives_the_angle_and_the_third_column_does_not():
    forces = exact_readings(PARAMETERS, ORIENTATIONS, GRAVITY)[:, :3]
    (G_c, G_s, G, left), printed = force_step(forces, ORIENTATIONS), force_step(forces, ORIENTATIONS.transpose(0, 2, 1))
    assert np.arctan2(G_s, G_c) == pytest.approx(0.3, abs=1e-12)
    assert pytest.approx(0.25 * GRAVITY) == G
    assert left < 1e-12
    assert printed[3] > 0.1


def test_swapped_axes_give_another_centre_of_mass():
    readings = exact_readings(PARAMETERS, ORIENTATIONS, GRAVITY)
    assert np.linalg.norm(swapped_moment_step(readings[:, :3], readings[:, 3:]) - PARAMETERS[2:5]) > 5e-3
