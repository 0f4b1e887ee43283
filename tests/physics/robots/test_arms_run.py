"""The arms that labs own, as they are: their first run is free of caveats, and alike on three engines."""

import numpy as np
import pytest

import runner

ARMS = ["panda", "fr3", "ur5e", "ur10e", "iiwa14", "gen3", "xarm7", "z1", "so101", "sawyer"]


@pytest.mark.bullet
@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name != "so101")) for name in ARMS])
def test_the_first_run_is_alike_on_three_engines(name, tmp_path):
    runs = [runner.run(robot=name, plant=plant, outputs=tmp_path) for plant in ("bullet", "mujoco", "rk4")]
    assert [list(run.caveats) for run in runs] == [[], [], []]
    assert [run.metrics["saturation_fraction"].median for run in runs] == [0.0, 0.0, 0.0]
    euler, other, exact = (run.trace().filter(regex=r"^q\d").to_numpy() for run in runs)
    np.testing.assert_allclose(other, euler, rtol=0, atol=1e-8)  # the same integration, up to rounding
    np.testing.assert_allclose(exact, euler, rtol=0, atol=1e-5)  # of another order in the step
    assert max(run.metrics["max_tracking_error"].median for run in runs) < 1e-4
