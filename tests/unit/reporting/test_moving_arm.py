"""Moving arm: its frames against the instants and the area of the motion."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from runner.reporting.charts.arm import moving_arm

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def moving(macro):
    q = np.linspace([0.0, 0.2, -0.3], [1.0, 0.6, 0.4], 12)
    path = macro.tip_positions(q)
    return ET.fromstring(moving_arm(macro, q, 5.0, path, path))


def test_the_arm_goes_through_all_instants_in_the_time_of_the_motion(moving):
    (animation,) = [each for each in moving.iter(f"{SVG}animate") if each.get("attributeName") == "points"]
    assert animation.get("values").count(";") == 11
    assert animation.get("dur") == "5s"
    chains = [
        np.array([[*map(float, point.split(","))] for point in frame.split()])
        for frame in animation.get("values").split(";")
    ]
    assert {len(chain) for chain in chains} == {4}  # three joints and the tip
    assert np.ptp([chain[-1] for chain in chains], axis=0).max() > 20.0
    assert np.ptp([chain[0] for chain in chains], axis=0).max() < 0.2  # the first joint stays


def test_everything_lies_within_the_drawing(moving):
    width, height = map(float, moving.get("viewBox").split()[2:])
    text = ET.tostring(moving, encoding="unicode")
    for x, y in re.findall(r"([-\\d.]+),([-\\d.]+)", text):
        assert 0.0 <= float(x) <= width
        assert 0.0 <= float(y) <= height


@pytest.mark.parametrize(("seconds", "shown"), [(0.2, "3s"), (60.0, "5s")])
def test_a_motion_is_shown_neither_too_fast_nor_too_slow(macro, seconds, shown):
    q = np.zeros((2, 3))
    path = macro.tip_positions(q)
    assert f'dur="{shown}"' in moving_arm(macro, q, seconds, path, path)
