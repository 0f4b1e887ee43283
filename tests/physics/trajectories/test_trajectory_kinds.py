"""Trajectories from outside the package: each part that their config may offer."""

import pytest

from runner.store import open_run

RESTING = """
    from typing import Literal
    import numpy as np
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["resting"]
        {fields}
    class Resting:
        duration, run_duration, tracked = 0.0, 0.05, False
        def __init__(self, start):
            self.start = self.goal = start
        def sample(self, times):
            motion = np.zeros((len(times), 3, 3))
            motion[:, 0] = self.start
            return motion
        def distance_to_path(self, points):
            return np.linalg.norm(points - self.start, axis=1)
    def build(config, start):
        return Resting(start)
"""


@pytest.mark.parametrize("key", ["start", "goal"])
def test_a_point_out_of_reach_is_refused(own_part, cli, key):
    own = own_part("trajectory", "resting", RESTING.format(fields=f"{key}: list[float] | None"), f"{key}: [0, 0, 9]\n")
    ending = cli("--config-dir", own, "robot=macro", "trajectory=resting")
    assert ending.code == 2
    assert f"trajectory.{key}: [0.0, 0.0, 9.0] m is outside the workspace" in ending.err


def test_it_starts_where_its_config_says_else_at_home(own_part, cli):
    own = own_part("trajectory", "resting", RESTING.format(fields="start: list[float] | None"), "start: null\n")
    given = ("--config-dir", own, "robot=macro", "trajectory=resting", "plant=rk4")
    home = open_run(cli(*given).folder)
    moved = open_run(cli(*given, "trajectory.start=[0.3,1.0,0.8]").folder)
    assert moved.trace()[["tip_x", "tip_y", "tip_z"]].to_numpy()[0] == pytest.approx([0.3, 1.0, 0.8], abs=1e-9)
    assert home.trace()["q2"].iloc[0] == home.config["robot"]["home"][1]
