"""Correction of impossible inertias: a rigid body's, and the nearest of these."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from runner.robots.inertials import fix_inertia, impossible_inertia, nearest_moments
from runner.robots.tree import read_tree


@pytest.mark.parametrize("moments", [(0.1, 0.1, 0.3), (0.2, -0.1, 0.2), (1.0, 2.0, 3.5)])
def test_an_impossible_inertia_becomes_one_that_a_body_can_have(tmp_path, moments):
    values = " ".join(f'{key}="{value}"' for key, value in zip(("ixx", "iyy", "izz"), moments, strict=True))
    text = f'<robot name="x"><link name="a"><inertial><mass value="1"/><inertia {values} ixy="0.01" ixz="0" iyz="0"/>'
    (tmp_path / "x.urdf").write_text(text + "</inertial></link></robot>")
    link = read_tree(tmp_path / "x.urdf").links["a"]
    assert impossible_inertia(link)
    fix_inertia(link)
    assert impossible_inertia(link) == []
    fixed = [float(link.find("inertial/inertia").get(key)) for key in ("ixx", "iyy", "izz")]
    assert np.abs(np.subtract(fixed, moments)).max() < 0.6 * max(moments)


def test_the_excess_of_the_largest_moment_is_shared_by_all_three():
    assert nearest_moments(np.array([0.00348, 0.0169, 1.0])) == pytest.approx([0.330, 0.3434, 0.6735], abs=2e-4)
    assert nearest_moments(np.array([-0.1, 0.2, 0.3])) == pytest.approx([0.0, 0.25, 0.25], abs=2e-4)
    assert nearest_moments(np.array([-0.3, -0.2, -0.1])).tolist() == [0.0, 0.0, 0.0]


@given(st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_no_optimiser_finds_nearer_moments(values):
    moments = np.sort(values)
    found = nearest_moments(moments)
    assert found.sum() - 2.0 * found.max() >= -1e-12
    bounds = [{"type": "ineq", "fun": lambda m, i=i: m.sum() - 2.0 * m[i]} for i in range(3)]
    best = minimize(lambda m: ((m - moments) ** 2).sum(), np.ones(3), constraints=bounds, method="SLSQP", tol=1e-12)
    assert found == pytest.approx(best.x, abs=3e-4)
