"""Calibrations in the Meca500 report: their tables, and what they compute themselves, against closed forms."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.engines import DEFAULT_PLANT
from support.study_sections import blocks

from runner.calibration.gravity import REST, GravityCalibration, Tool, WrenchCompensation
from runner.calibration.tool_centre_point import identify_tool_centre_point
from runner.reporting.document import Curves, Table
from runner.studies.meca500.figures import consistency, error, fit, predicted, refusal
from runner.studies.meca500.gravity import (
    _left_over,
    angles,
    exact_readings,
    force_step,
    left_over_panels,
    swapped_moment_step,
)
from runner.studies.meca500.tool_centre_point import common_point_covariance, independent_rows_covariance

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
            if isinstance(block, Curves) or (isinstance(block, Table) and not block.caption.startswith("Sets of")):
                assert block.origin.command.startswith("runner ")


def test_the_level_of_the_base_case_is_the_base_case(calibrations):
    base = calibrations["tool_centre_point/base"].hash
    assert calibrations["tool_centre_point/poses/4"].hash == base
    assert calibrations["tool_centre_point/poses/6"].hash != base
    assert len({done.config["seed"] for done in calibrations.values()}) == len({d.hash for d in calibrations.values()})


def test_refusals_name_the_reason(sections):
    poses, _, gravity = sections
    reasons = [reason for _, reason in table(poses, "Sets of poses").lines[1:]]
    assert "needs 3 or more" in reasons[0]
    assert all("condition number" in reason for reason in reasons[1:])
    assert all("not refused" not in reason for _, reason in table(gravity, "Sets of orientations").lines[1:])
    assert refusal(lambda: None) == "not refused"


def test_weighed_by_the_plant_s_reaction_the_tool_is_the_true_one(sections):
    (row,) = table(sections[2], f"Error of what is identified from {DEFAULT_PLANT}").lines[1:]
    assert len(row) == 5
    assert set(row) <= {"0", "0 (rounding)"}


def test_without_noise_errors_are_rounding(calibrations):
    for name in ("tool_centre_point/repeatability/0", "tool_direction/repeatability/0", "gravity/noise/0"):
        assert error()(calibrations[name]) < 1e-9
        assert predicted()(calibrations[name]) == 0.0


def test_the_tip_s_error_is_proportional_to_the_repeatability(calibrations):
    levels = ("1e-06", "2e-05", "0.0001")
    errors = [predicted()(calibrations[f"tool_centre_point/repeatability/{level}"]) for level in levels]
    assert fit(np.array(levels, dtype=float), np.array(errors)) == pytest.approx(1.0, abs=1e-3)


def test_averaging_readings_makes_the_error_smaller_by_the_root(calibrations):
    values = np.array([1.0, 10.0, 100.0])
    errors = [predicted("mass")(calibrations[f"gravity/samples/{value:g}"]) for value in values]
    assert fit(values, np.array(errors)) == pytest.approx(-0.5, abs=0.01)


def test_what_lies_in_the_band_is_counted_once_for_each_calibration(calibrations):
    base, exact = calibrations["gravity/base"], calibrations["gravity/noise/0"]
    judged = {**base.consistency, "holds": False}
    others = [replace(base, folder=Path(name), record={**base.record, "consistency": judged}) for name in "bc"]
    inside = replace(base, record={**base.record, "consistency": {**base.consistency, "holds": True}})
    found = consistency({"a/1": inside, "a/2": exact, "a/3": inside, "b/1": others[0]}, "a")
    assert [found[key].value for key in ("inside", "number", "outside")] == [1, 1, 0]
    found = consistency({"a/1": inside, "a/2": others[0], "a/3": others[1]}, "a")
    assert [found[key].value for key in ("inside", "number", "outside")] == [1, 3, 2]


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


def test_arc_cosine_loses_the_sign_and_arc_sine_the_half_turn(calibrations):
    assert angles(calibrations, -0.3) == ["-0.3", "0.300", "-0.300", "-0.300"]
    assert angles(calibrations, 2.0) == ["2", "2.000", "1.142", "2.000"]


def test_what_is_left_over_is_drawn_over_the_angle_from_straight_down(calibrations):
    force, moment = left_over_panels(calibrations, "gravity/base")
    rotations = _left_over(calibrations["gravity/base"])[0]
    down = np.degrees(np.arccos(rotations @ [0.0, 0.0, 1.0] @ [0.0, 0.0, -1.0]))
    for panel in (force, moment):
        middle, high = panel.series
        assert middle.x == pytest.approx(np.sort(down))
        assert (middle.y <= high.y).all()
